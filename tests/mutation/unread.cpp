#include "tests/mutation/unread.h"

#include <algorithm>

#include <spirv/unified1/spirv.hpp>

namespace forceshade::mutation {
namespace {

bool is_chain(std::uint32_t code) {
    return code == spv::OpAccessChain || code == spv::OpInBoundsAccessChain;
}

// Does nothing but give a result.
bool is_pure(std::uint32_t code) {
    switch (code) {
    case spv::OpFunction:
    case spv::OpFunctionParameter:
    case spv::OpFunctionCall:
    case spv::OpLabel:
    case spv::OpVariable:
        return false;
    default:
        return code < spv::OpAtomicLoad || code > spv::OpAtomicXor;
    }
}

} // namespace

Unread::Unread(const KernelCode& code) : code_(code), unread_(code.instructions().size(), false) {
    do
        find_reads();
    while (find_unread());
}

Part Unread::part_of(std::uint32_t pointer) const {
    const Instruction* one = code_.definition(pointer);
    if (one && one->code == spv::OpVariable)
        return {pointer, {}};
    if (!one || !is_chain(one->code))
        return {};
    Part part = part_of(code_.word(*one, 3));
    for (std::size_t word = 4; word < one->count; ++word) {
        const Instruction* index = code_.definition(code_.word(*one, word));
        if (!index || index->code != spv::OpConstant)
            break; // any of them
        part.members.push_back(code_.word(*index, 3));
    }
    return part;
}

bool Unread::is_unread(const Part& part) const {
    const Instruction* variable = code_.definition(part.variable);
    if (!variable ||
        (code_.word(*variable, 3) != spv::StorageClassFunction && code_.word(*variable, 3) != spv::StorageClassPrivate))
        return false;
    return std::ranges::none_of(read_, [&](const Part& read) {
        const std::size_t shared = std::min(read.members.size(), part.members.size());
        return read.variable == part.variable &&
               std::equal(read.members.begin(), read.members.begin() + std::ptrdiff_t(shared), part.members.begin());
    });
}

// By what is not unread itself.
void Unread::find_reads() {
    read_.clear();
    bool within = false;
    for (std::size_t i = 0; i < unread_.size(); ++i) {
        const Instruction& one = code_.instructions()[i];
        within = within || one.code == spv::OpFunction;
        if (!within || unread_[i] || is_chain(one.code))
            continue;
        // All but where a store goes: a load, or a call that is given the pointer.
        for (std::size_t word = one.code == spv::OpStore ? 2 : 1; word < one.count; ++word)
            if (const std::uint32_t id = code_.word(one, word); id != code_.result(one))
                if (const Part part = part_of(id); part.variable != 0)
                    read_.insert(part);
    }
}

// True if something more is.
bool Unread::find_unread() {
    std::set<std::uint32_t> used;
    bool within = false;
    for (std::size_t i = 0; i < unread_.size(); ++i) {
        const Instruction& one = code_.instructions()[i];
        within = within || one.code == spv::OpFunction;
        for (std::size_t word = 1; within && !unread_[i] && word < one.count; ++word)
            if (code_.word(one, word) != code_.result(one))
                used.insert(code_.word(one, word)); // or a number, which does no harm
    }
    bool more = false;
    within = false;
    for (std::size_t i = 0; i < unread_.size(); ++i) {
        const Instruction& one = code_.instructions()[i];
        within = within || one.code == spv::OpFunction;
        if (!within || unread_[i])
            continue;
        const std::uint32_t result = code_.result(one);
        unread_[i] = one.code == spv::OpStore ? is_unread(part_of(code_.word(one, 1)))
                                              : result != 0 && is_pure(one.code) && !used.contains(result);
        more = more || unread_[i];
    }
    return more;
}

} // namespace forceshade::mutation
