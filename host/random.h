// Random numbers, the same on every machine (splitmix64: Steele, Lea & Flood 2014).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace forceshade {

/// A bijection that leaves no pattern.
constexpr std::uint64_t scrambled(std::uint64_t number) {
    number = (number ^ (number >> 30)) * 0xBF58476D1CE4E5B9u;
    number = (number ^ (number >> 27)) * 0x94D049BB133111EBu;
    return number ^ (number >> 31);
}

class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    /// Of a seed and a name (FNV-1a over the name's bytes).
    Random(std::uint64_t seed, std::string_view name) : state_(seed ^ 0xCBF29CE484222325u) {
        for (const char c : name)
            state_ = (state_ ^ static_cast<unsigned char>(c)) * 0x100000001B3u;
    }
    std::uint64_t word() { return scrambled(state_ += 0x9E3779B97F4A7C15u); }
    /// In [0, 1).
    double uniform() { return static_cast<double>(word() >> 11) * 0x1p-53; }
    /// In [low, high).
    double operator()(double low, double high) { return low + (high - low) * uniform(); }
    /// An integer in [0, count), each equally often.
    std::uint64_t below(std::uint64_t count) {
        const std::uint64_t whole = UINT64_MAX - UINT64_MAX % count;
        std::uint64_t one = word();
        while (one >= whole)
            one = word();
        return one % count;
    }
    /// Where one falls among shares whose sum is 1.
    std::size_t among(std::span<const double> shares) {
        double left = uniform();
        std::size_t at = 0;
        while (at + 1 < shares.size() && left >= shares[at])
            left -= shares[at++];
        return at;
    }

private:
    std::uint64_t state_;
};

} // namespace forceshade
