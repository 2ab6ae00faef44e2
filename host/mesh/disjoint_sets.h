// Things joined into sets (union-find with path halving).
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace forceshade {

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

    /// The set's least member.
    std::uint32_t find(std::uint32_t member) noexcept {
        while (parents_[member] != member)
            member = parents_[member] = parents_[parents_[member]];
        return member;
    }

    void join(std::uint32_t a, std::uint32_t b) noexcept {
        a = find(a);
        b = find(b);
        if (a < b)
            parents_[b] = a;
        else
            parents_[a] = b;
    }

private:
    std::vector<std::uint32_t> parents_;
};

} // namespace forceshade
