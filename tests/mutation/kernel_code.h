// A kernel's SPIR-V words taken apart so that single instructions can be changed: functions, basic blocks, types,
// constants, and where in the GLSL an instruction comes from. Khronos SPIR-V 1.6, 2.3 and 2.4.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace forceshade::mutation {

using Words = std::vector<std::uint32_t>;

struct Instruction {
    std::uint32_t code = 0; /* spv::Op */
    std::size_t at = 0;     /* its first word */
    std::size_t count = 0;  /* words */
};

/// A basic block of a function, in order.
struct Block {
    std::string function;  /* "contact_at" */
    std::size_t first = 0; /* its first instruction after the label, phis and variables */
    std::size_t end = 0;   /* behind its last */
};

/// Words to put in the place of some others.
struct Edit {
    std::size_t at = 0;      /* the first of them */
    std::size_t removed = 0; /* how many */
    Words inserted;
};

class KernelCode {
public:
    /// `words` as embedded; `with_lines` the same kernel compiled with OpLine. \throws std::runtime_error if the two
    /// are not the same but for that.
    KernelCode(std::span<const std::uint32_t> words, std::span<const std::uint32_t> with_lines);

    const Words& words() const { return words_; }
    const std::vector<Instruction>& instructions() const { return instructions_; }
    const std::vector<Block>& blocks() const { return blocks_; }

    std::uint32_t word(const Instruction& instruction, std::size_t i) const { return words_[instruction.at + i]; }
    /// The result id; 0: none.
    std::uint32_t result(const Instruction& instruction) const;
    /// "contact.glsl:41" of the instruction of this number; empty outside of functions.
    const std::string& line(std::size_t instruction) const { return lines_[instruction]; }

    /// The type of a result; 0 if it has none.
    std::uint32_t type_of(std::uint32_t id) const;
    /// What defines an id; null: nothing.
    const Instruction* definition(std::uint32_t id) const;
    /// The name in GLSL, or "%12".
    std::string name_of(std::uint32_t id) const;
    /// The variable that a pointer points into; 0 if it comes from elsewhere.
    std::uint32_t variable_of(std::uint32_t pointer) const;
    /// The variable at a binding of set 0. \throws std::runtime_error if there is none.
    std::uint32_t variable_at(std::uint32_t binding) const;
    /// The id of a type, a constant or the like among those that stand before the functions, with these words after
    /// the first one, the result left out; 0: there is none.
    std::uint32_t find_global(std::uint32_t code, const Words& operands) const;

private:
    void find_functions(const std::vector<std::string>& lines);

    Words words_;
    std::vector<Instruction> instructions_;
    std::vector<Block> blocks_;
    std::vector<std::string> lines_;                         // by instruction
    std::unordered_map<std::uint32_t, std::size_t> defined_; // the instruction of an id
    std::unordered_map<std::uint32_t, std::string> names_;
    std::map<std::uint32_t, std::uint32_t> bound_; // variable of a binding
};

/// The words of a kernel with some changes. New ids and the constants that they stand for are made as they are asked
/// for.
class Changed {
public:
    explicit Changed(const KernelCode& code) : code_(code), bound_(code.words()[3]) {}

    std::uint32_t new_id() { return bound_++; }
    /// A scalar constant of this type and bits, `bits` in one word or two.
    std::uint32_t constant(std::uint32_t type, std::uint64_t bits);
    /// A vector with the same scalar in each component, or the scalar.
    std::uint32_t splat(std::uint32_t type, std::uint64_t bits);
    void edit(Edit edit) { edits_.push_back(std::move(edit)); }

    /// All of it applied.
    Words words() const;

private:
    const KernelCode& code_;
    std::uint32_t bound_;
    Words constants_; // instructions
    std::vector<Edit> edits_;
};

/// An instruction's words.
Words instruction(std::uint32_t code, const Words& operands);

} // namespace forceshade::mutation
