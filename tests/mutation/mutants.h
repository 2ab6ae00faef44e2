// Kernels with one instruction changed, and a kernel that shows which of its basic blocks run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/mutation/kernel_code.h"

namespace forceshade::mutation {

/// One instruction of a kernel, changed in one way.
struct Mutant {
    std::size_t block = 0; /* of KernelCode::blocks() */
    std::string key;       /* "contact_at FSub#3 to FAdd": the same in every precision, while its function stays */
    std::string place;     /* "contact.glsl:41 %345" */
    bool unread = false;   /* nothing reads what the instruction gives */
    std::function<void(Changed&)> apply;
};

/// All of them, of every function:
/// - another operation: + for -, * for /, < for <= and >, == for !=, and for or, min for max, no operation for a
///   negation or a built-in function;
/// - the operands of what does not commute exchanged: -, /, select, the parts of a vector, the two ways of a branch;
/// - a constant operand changed: 0 to 1, else doubled (reals, and again to the next one) or plus 1 (integers), true to
///   false;
/// - another component of a vector or member of a struct, of the same type;
/// - a store left out, if another one writes to the same variable or the variable is no function's: what nothing
///   writes has no value in SPIR-V, and the driver might choose the right one. It chooses 0, so no store of 0 to a
///   function's variable either.
/// Not changed: what specialization constants are computed from, calls, and addresses of arrays.
std::vector<Mutant> mutants_of(const KernelCode& code);

inline constexpr std::uint32_t kCovered = 0x4B1D5EEDu; /* what a block that ran leaves in each word */

/// The kernel without its stores to the buffer at this binding, to which instead block blocks[i] stores kCovered, as
/// element i. A store to every block takes a driver ten times as long to compile.
Words with_coverage(const KernelCode& code, std::uint32_t binding, const std::vector<std::size_t>& blocks);
/// Words of an element of that buffer.
std::size_t coverage_stride(const KernelCode& code, std::uint32_t binding);

} // namespace forceshade::mutation
