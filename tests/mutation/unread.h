// What a kernel computes and nothing reads: an unoptimised kernel copies whole structs, of which a law needs a part.
#pragma once

#include <set>
#include <vector>

#include "tests/mutation/kernel_code.h"

namespace forceshade::mutation {

/// A variable, and the members that lead to a part of it as far as they are constants.
struct Part {
    std::uint32_t variable = 0;
    std::vector<std::uint32_t> members;
    bool operator<(const Part& other) const {
        return variable != other.variable ? variable < other.variable : members < other.members;
    }
};

class Unread {
public:
    explicit Unread(const KernelCode& code);

    /// True if the instruction of this number has no effect but on what nothing reads.
    bool operator[](std::size_t instruction) const { return unread_[instruction]; }
    /// True of a part of a kernel's own variable if nothing reads it, or any of what it is a part of.
    bool is_unread(const Part& part) const;
    /// What a pointer points to; no variable if it comes from elsewhere.
    Part part_of(std::uint32_t pointer) const;

private:
    void find_reads();
    bool find_unread();

    const KernelCode& code_;
    std::vector<bool> unread_; // by instruction
    std::set<Part> read_;
};

} // namespace forceshade::mutation
