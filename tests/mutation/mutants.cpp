#include "tests/mutation/mutants.h"

#include <bit>
#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.hpp>

#include "tests/mutation/unread.h"

namespace forceshade::mutation {
namespace {

struct Swap {
    std::uint32_t code;
    const char* name;
    std::initializer_list<std::uint32_t> others;
    bool commutes = true;
};

// Another operation on the same operands; a copy where there is but one.
const Swap kSwaps[] = {
    {spv::OpFAdd, "FAdd", {spv::OpFSub}},
    {spv::OpFSub, "FSub", {spv::OpFAdd}, false},
    {spv::OpFMul, "FMul", {spv::OpFAdd, spv::OpFDiv}},
    {spv::OpFDiv, "FDiv", {spv::OpFMul}, false},
    {spv::OpIAdd, "IAdd", {spv::OpISub}},
    {spv::OpISub, "ISub", {spv::OpIAdd}, false},
    {spv::OpIMul, "IMul", {spv::OpIAdd}},
    {spv::OpUDiv, "UDiv", {spv::OpIMul}, false},
    {spv::OpUMod, "UMod", {spv::OpUDiv}, false},
    {spv::OpShiftLeftLogical, "ShiftLeft", {spv::OpShiftRightLogical}, false},
    {spv::OpShiftRightLogical, "ShiftRight", {spv::OpShiftLeftLogical}, false},
    {spv::OpBitwiseAnd, "And", {spv::OpBitwiseOr}},
    {spv::OpBitwiseOr, "Or", {spv::OpBitwiseAnd}},
    {spv::OpBitwiseXor, "Xor", {spv::OpBitwiseOr}},
    {spv::OpLogicalAnd, "LogicalAnd", {spv::OpLogicalOr}},
    {spv::OpLogicalOr, "LogicalOr", {spv::OpLogicalAnd}},
    {spv::OpFNegate, "FNegate", {spv::OpCopyObject}},
    {spv::OpNot, "Not", {spv::OpCopyObject}},
    {spv::OpLogicalNot, "LogicalNot", {spv::OpCopyObject}},
    {spv::OpFOrdLessThan, "FLess", {spv::OpFOrdLessThanEqual, spv::OpFOrdGreaterThan}},
    {spv::OpFOrdLessThanEqual, "FLessEqual", {spv::OpFOrdLessThan, spv::OpFOrdGreaterThanEqual}},
    {spv::OpFOrdGreaterThan, "FGreater", {spv::OpFOrdGreaterThanEqual, spv::OpFOrdLessThan}},
    {spv::OpFOrdGreaterThanEqual, "FGreaterEqual", {spv::OpFOrdGreaterThan, spv::OpFOrdLessThanEqual}},
    {spv::OpFOrdEqual, "FEqual", {spv::OpFUnordNotEqual}},
    {spv::OpFUnordNotEqual, "FNotEqual", {spv::OpFOrdEqual}},
    {spv::OpULessThan, "ULess", {spv::OpULessThanEqual, spv::OpUGreaterThan}},
    {spv::OpULessThanEqual, "ULessEqual", {spv::OpULessThan, spv::OpUGreaterThanEqual}},
    {spv::OpUGreaterThan, "UGreater", {spv::OpUGreaterThanEqual, spv::OpULessThan}},
    {spv::OpUGreaterThanEqual, "UGreaterEqual", {spv::OpUGreaterThan, spv::OpULessThanEqual}},
    {spv::OpSLessThan, "SLess", {spv::OpSLessThanEqual, spv::OpSGreaterThan}},
    {spv::OpIEqual, "IEqual", {spv::OpINotEqual}},
    {spv::OpINotEqual, "INotEqual", {spv::OpIEqual}},
};

const Swap* swap_of(std::uint32_t code) {
    for (const Swap& swap : kSwaps)
        if (swap.code == code)
            return &swap;
    return nullptr;
}

const char* name_of_code(std::uint32_t code) {
    if (const Swap* swap = swap_of(code))
        return swap->name;
    switch (code) {
    case spv::OpSLessThanEqual:
        return "SLessEqual";
    case spv::OpSGreaterThan:
        return "SGreater";
    case spv::OpCopyObject:
        return "copy";
    case spv::OpSelect:
        return "Select";
    case spv::OpBranchConditional:
        return "Branch";
    case spv::OpStore:
        return "Store";
    case spv::OpReturnValue:
        return "Return";
    case spv::OpExtInst:
        return "Function";
    case spv::OpCompositeConstruct:
        return "Vector";
    case spv::OpCompositeExtract:
        return "Component";
    case spv::OpAccessChain:
        return "Member";
    case spv::OpPhi:
        return "Phi";
    default:
        return "Other";
    }
}

// Operands that may be constants: the words from `first` to `last`.
struct Operands {
    std::size_t first = 0, last = 0;
};

Operands value_operands(const Instruction& one) {
    if (swap_of(one.code))
        return {3, one.count};
    switch (one.code) {
    case spv::OpSelect:
        return {4, one.count};
    case spv::OpCompositeConstruct:
        return {3, one.count};
    case spv::OpStore:
        return {2, 3};
    case spv::OpReturnValue:
        return {1, 2};
    case spv::OpExtInst:
        return {5, one.count};
    default:
        return {};
    }
}

// A mutant's list in the making.
class Lister {
public:
    explicit Lister(const KernelCode& code) : code_(code), unread_(code) {
        for (const Instruction& one : code.instructions())
            if (one.code == spv::OpStore)
                ++stores_[code.variable_of(code.word(one, 1))];
    }

    std::vector<Mutant> list() {
        std::string function;
        for (block_ = 0; block_ < code_.blocks().size(); ++block_) {
            const Block& block = code_.blocks()[block_];
            if (std::exchange(function, block.function) != block.function)
                counts_.clear();
            for (std::size_t i = block.first; i < block.end; ++i)
                add_all(i);
        }
        return std::move(mutants_);
    }

private:
    void add_all(std::size_t i) {
        at_ = i;
        const Instruction& one = code_.instructions()[i];
        ++counts_[one.code];
        if (const Swap* swap = swap_of(one.code)) {
            for (const std::uint32_t other : swap->others)
                add(fmt::format("to {}", name_of_code(other)),
                    {one.at, 1, {static_cast<std::uint32_t>(one.count) << spv::WordCountShift | other}});
            if (!swap->commutes)
                exchange(3, 4);
        }
        if (one.code == spv::OpSelect)
            exchange(4, 5);
        if (one.code == spv::OpBranchConditional)
            exchange(2, 3);
        if (one.code == spv::OpCompositeConstruct && one.count >= 5)
            exchange(3, 4);
        if (one.code == spv::OpStore)
            leave_out();
        if (one.code == spv::OpExtInst)
            replace_function();
        if (one.code == spv::OpCompositeExtract && one.count == 5)
            other_component();
        if (one.code == spv::OpAccessChain)
            other_member();
        const Operands values = value_operands(one);
        for (std::size_t word = values.first; word < values.last; ++word)
            change_constant(word);
    }

    const Instruction& here() const { return code_.instructions()[at_]; }

    void add(const std::string& change, const std::function<void(Changed&)>& apply) {
        const std::uint32_t id = code_.result(here());
        mutants_.push_back({block_,
                            fmt::format("{} {}#{} {}", code_.blocks()[block_].function, name_of_code(here().code),
                                        counts_[here().code], change),
                            fmt::format("{} {}", code_.line(at_), id ? fmt::format("%{}", id) : "-"), unread_[at_],
                            apply});
    }
    void add(const std::string& change, const Edit& edit) {
        add(change, [edit](Changed& changed) { changed.edit(edit); });
    }

    void exchange(std::size_t left, std::size_t right) {
        const std::uint32_t a = code_.word(here(), left), b = code_.word(here(), right);
        if (is_same(a, b) || code_.type_of(a) != code_.type_of(b))
            return;
        add("exchanged", [at = here().at, left, right, a, b](Changed& changed) {
            changed.edit({at + left, 1, {b}});
            changed.edit({at + right, 1, {a}});
        });
    }

    // True of two loads from one place too.
    bool is_same(std::uint32_t a, std::uint32_t b) const {
        const Instruction *one = code_.definition(a), *other = code_.definition(b);
        return a == b ||
               (one->code == spv::OpLoad && other->code == spv::OpLoad && code_.word(*one, 3) == code_.word(*other, 3));
    }

    bool is_zero(const Instruction* constant) const {
        if (!constant)
            return false;
        bool zero = constant->code == spv::OpConstant;
        for (std::size_t word = 3; word < constant->count; ++word)
            zero = zero && code_.word(*constant, word) == 0;
        return zero || constant->code == spv::OpConstantNull || constant->code == spv::OpConstantFalse;
    }

    void leave_out() {
        const std::uint32_t variable = code_.variable_of(code_.word(here(), 1));
        const Instruction* defined = code_.definition(variable);
        if (!defined)
            return; // to a parameter
        if (code_.word(*defined, 3) == spv::StorageClassFunction &&
            (stores_[variable] < 2 || is_zero(code_.definition(code_.word(here(), 2)))))
            return;
        add("left out", {here().at, here().count, {}});
    }

    void replace_function() {
        const auto to = [&](std::uint32_t other, const char* name) {
            add(fmt::format("to {}", name), {here().at + 4, 1, {other}});
        };
        switch (code_.word(here(), 4)) {
        case GLSLstd450UMin:
            return to(GLSLstd450UMax, "UMax");
        case GLSLstd450UMax:
            return to(GLSLstd450UMin, "UMin");
        case GLSLstd450Floor:
            to(GLSLstd450Ceil, "Ceil");
            break;
        case GLSLstd450Sqrt:
        case GLSLstd450FAbs:
            break;
        default:
            return;
        }
        add("to copy",
            {here().at, here().count,
             instruction(spv::OpCopyObject, {code_.word(here(), 1), code_.word(here(), 2), code_.word(here(), 5)})});
    }

    void other_component() {
        const Instruction& type = *code_.definition(code_.type_of(code_.word(here(), 3)));
        const std::uint32_t component = code_.word(here(), 4);
        if (type.code == spv::OpTypeVector) {
            const std::uint32_t next = (component + 1) % code_.word(type, 3);
            add(fmt::format("{} to {}", component, next), {here().at + 4, 1, {next}});
        }
        if (type.code == spv::OpTypeStruct)
            if (const std::optional<std::uint32_t> next = sibling(type, component))
                add(fmt::format("{} to {}", component, *next), {here().at + 4, 1, {*next}});
    }

    // The next member of the same type.
    std::optional<std::uint32_t> sibling(const Instruction& type, std::uint32_t member) const {
        const auto members = static_cast<std::uint32_t>(type.count - 2);
        for (std::uint32_t step = 1; step < members; ++step)
            if (const std::uint32_t next = (member + step) % members;
                code_.word(type, 2 + next) == code_.word(type, 2 + member))
                return next;
        return std::nullopt;
    }

    // The last index, of a vector or a struct; those before it lead there.
    void other_member() {
        std::uint32_t type = code_.type_of(code_.word(here(), 3)); // the pointer's
        type = code_.word(*code_.definition(type), 3);
        for (std::size_t word = 4; word + 1 < here().count; ++word) {
            const Instruction& outer = *code_.definition(type);
            const Instruction& index = *code_.definition(code_.word(here(), word));
            type = code_.word(outer, outer.code == spv::OpTypeStruct ? 2 + code_.word(index, 3) : 2);
        }
        const Instruction& outer = *code_.definition(type);
        const Instruction& index = *code_.definition(code_.word(here(), here().count - 1));
        if (index.code != spv::OpConstant)
            return;
        const std::uint32_t member = code_.word(index, 3);
        std::optional<std::uint32_t> next;
        if (outer.code == spv::OpTypeVector)
            next = (member + 1) % code_.word(outer, 3);
        if (outer.code == spv::OpTypeStruct)
            next = sibling(outer, member);
        if (!next)
            return;
        add(fmt::format("{} to {}", member, *next),
            [at = here().at + here().count - 1, type = code_.word(index, 1), next = *next](Changed& changed) {
                changed.edit({at, 1, {changed.constant(type, next)}});
            });
        // What is stored there instead may be read.
        Part instead = unread_.part_of(code_.result(here()));
        if (!instead.members.empty())
            instead.members.back() = *next;
        mutants_.back().unread = mutants_.back().unread && unread_.is_unread(instead);
    }

    void change_constant(std::size_t word) {
        const Instruction* constant = code_.definition(code_.word(here(), word));
        if (!constant)
            return;
        const auto to = [&](const std::string& change, std::uint64_t bits) {
            add(fmt::format("operand {} {}", word, change),
                [at = here().at + word, type = code_.word(*constant, 1), bits](Changed& changed) {
                    changed.edit({at, 1, {changed.constant(type, bits)}});
                });
        };
        if (constant->code == spv::OpConstantTrue)
            return to("true to false", 0);
        if (constant->code == spv::OpConstantFalse)
            return to("false to true", 1);
        if (constant->code != spv::OpConstant)
            return;
        const Instruction& type = *code_.definition(code_.word(*constant, 1));
        const std::uint32_t low = code_.word(*constant, 3);
        if (type.code == spv::OpTypeInt) {
            if (code_.word(type, 2) == 32)
                to(fmt::format("{} to {}", low, low + 1), low + 1);
            return;
        }
        if (code_.word(type, 2) == 32)
            return change_real(std::bit_cast<float>(low), to);
        change_real(std::bit_cast<double>(std::uint64_t(code_.word(*constant, 4)) << 32 | low), to);
    }

    template <typename Real, typename To> static void change_real(Real value, const To& to) {
        const auto bits = [](Real real) -> std::uint64_t {
            if constexpr (sizeof(Real) == 4)
                return std::bit_cast<std::uint32_t>(real);
            else
                return std::bit_cast<std::uint64_t>(real);
        };
        if (!std::isfinite(value))
            return;
        // Named without the value, which may differ with the precision.
        if (value == 0)
            return to("0 to 1", bits(1));
        to("doubled", bits(2 * value));
        to("to the next", bits(std::nextafter(value, Real(2) * value)));
    }

    const KernelCode& code_;
    Unread unread_;
    std::map<std::uint32_t, int> stores_; // to each variable
    std::map<std::uint32_t, int> counts_; // of each operation, in the present function
    std::size_t block_ = 0, at_ = 0;
    std::vector<Mutant> mutants_;
};

// The type of what a runtime array at a binding holds.
std::uint32_t element_type(const KernelCode& code, std::uint32_t binding) {
    const Instruction& pointer = *code.definition(code.type_of(code.variable_at(binding)));
    const Instruction& structure = *code.definition(code.word(pointer, 3));
    return code.word(*code.definition(code.word(structure, 2)), 2);
}

} // namespace

std::vector<Mutant> mutants_of(const KernelCode& code) {
    return Lister(code).list();
}

std::size_t coverage_stride(const KernelCode& code, std::uint32_t binding) {
    const Instruction* type = code.definition(element_type(code, binding));
    std::size_t count = 1;
    if (type->code == spv::OpTypeVector) {
        count = code.word(*type, 3);
        type = code.definition(code.word(*type, 2));
    }
    return count * code.word(*type, 2) / 32;
}

Words with_coverage(const KernelCode& code, std::uint32_t binding, const std::vector<std::size_t>& blocks) {
    const std::uint32_t variable = code.variable_at(binding);
    const std::uint32_t element = element_type(code, binding);
    const std::uint32_t storage = code.word(*code.definition(code.type_of(variable)), 2);
    const std::uint32_t pointer = code.find_global(spv::OpTypePointer, {storage, element});
    const std::uint32_t index = code.find_global(spv::OpTypeInt, {32, 0});
    if (pointer == 0 || index == 0)
        throw std::runtime_error("nothing is stored to the buffer that is to show what ran");
    Changed changed(code);
    const std::uint32_t zero = changed.constant(index, 0);
    const std::uint32_t mark = changed.splat(element, std::uint64_t(kCovered) << 32 | kCovered);
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const std::uint32_t chain = changed.new_id();
        Words inserted = instruction(spv::OpAccessChain,
                                     {pointer, chain, variable, zero, changed.constant(index, std::uint32_t(i))});
        const Words store = instruction(spv::OpStore, {chain, mark});
        inserted.insert(inserted.end(), store.begin(), store.end());
        changed.edit({code.instructions()[code.blocks()[blocks[i]].first].at, 0, inserted});
    }
    for (const Instruction& one : code.instructions())
        if (one.code == spv::OpStore && code.variable_of(code.word(one, 1)) == variable)
            changed.edit({one.at, one.count, {}});
    return changed.words();
}

} // namespace forceshade::mutation
