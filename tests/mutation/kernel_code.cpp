#include "tests/mutation/kernel_code.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#define SPV_ENABLE_UTILITY_CODE
#include <spirv/unified1/spirv.hpp>

namespace forceshade::mutation {
namespace {

constexpr std::size_t kHeader = 5; // words before the first instruction

std::vector<Instruction> instructions_of(std::span<const std::uint32_t> words) {
    if (words.size() < kHeader || words[0] != spv::MagicNumber)
        throw std::runtime_error("no SPIR-V");
    std::vector<Instruction> all;
    for (std::size_t at = kHeader; at < words.size();) {
        const std::size_t count = words[at] >> spv::WordCountShift;
        if (count == 0 || at + count > words.size())
            throw std::runtime_error("SPIR-V ends within an instruction");
        all.push_back({words[at] & spv::OpCodeMask, at, count});
        at += count;
    }
    return all;
}

// A literal string begins at `word` of the instruction.
std::string string_at(std::span<const std::uint32_t> words, const Instruction& instruction, std::size_t word) {
    std::string text((instruction.count - word) * sizeof(std::uint32_t), '\0');
    std::memcpy(text.data(), words.data() + instruction.at + word, text.size());
    return text.substr(0, text.find('\0'));
}

bool is_debug(std::uint32_t code) {
    return code == spv::OpLine || code == spv::OpNoLine;
}

// File and line of each instruction of the functions, in order; the codes too.
std::vector<std::pair<std::uint32_t, std::string>> lines_of(std::span<const std::uint32_t> words) {
    std::unordered_map<std::uint32_t, std::string> files;
    std::vector<std::pair<std::uint32_t, std::string>> lines;
    std::string line;
    bool in_function = false;
    for (const Instruction& one : instructions_of(words)) {
        if (one.code == spv::OpString) {
            const std::string path = string_at(words, one, 2);
            files[words[one.at + 1]] = path.substr(path.rfind('/') + 1);
        }
        if (one.code == spv::OpLine)
            line = fmt::format("{}:{}", files[words[one.at + 1]], words[one.at + 2]);
        in_function = in_function || one.code == spv::OpFunction;
        if (in_function && !is_debug(one.code))
            lines.emplace_back(one.code, line);
    }
    return lines;
}

} // namespace

KernelCode::KernelCode(std::span<const std::uint32_t> words, std::span<const std::uint32_t> with_lines)
    : words_(words.begin(), words.end()), instructions_(instructions_of(words)) {
    for (std::size_t i = 0; i < instructions_.size(); ++i) {
        const Instruction& one = instructions_[i];
        if (const std::uint32_t id = result(one))
            defined_[id] = i;
        if (one.code == spv::OpName)
            names_[word(one, 1)] = string_at(words_, one, 2);
        if (one.code == spv::OpDecorate && word(one, 2) == spv::DecorationBinding)
            bound_[word(one, 3)] = word(one, 1);
    }
    std::vector<std::string> lines;
    const auto functions = std::ranges::find(instructions_, std::uint32_t(spv::OpFunction), &Instruction::code);
    lines.resize(static_cast<std::size_t>(functions - instructions_.begin()));
    for (const auto& [code, line] : lines_of(with_lines)) {
        if (lines.size() >= instructions_.size() || code != instructions_[lines.size()].code)
            throw std::runtime_error("the kernel with lines is another kernel");
        lines.push_back(line);
    }
    if (lines.size() != instructions_.size())
        throw std::runtime_error("the kernel with lines is shorter");
    find_functions(lines);
    lines_ = std::move(lines);
}

void KernelCode::find_functions(const std::vector<std::string>& lines) {
    std::string function;
    bool within = false; // a block
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Instruction& one = instructions_[i];
        if (one.code == spv::OpFunction) {
            function = name_of(word(one, 2)); // "contact_at(struct-Column;f1;f1;"
            function = function.substr(0, function.find('('));
        }
        within = one.code != spv::OpFunctionEnd && (within || one.code == spv::OpLabel);
        if (one.code == spv::OpLabel) {
            std::size_t first = i + 1;
            while (instructions_[first].code == spv::OpPhi || instructions_[first].code == spv::OpVariable)
                ++first;
            blocks_.push_back({function, first, first});
        }
        if (within)
            blocks_.back().end = i + 1;
    }
}

std::uint32_t KernelCode::result(const Instruction& instruction) const {
    bool has_result = false, has_type = false;
    spv::HasResultAndType(static_cast<spv::Op>(instruction.code), &has_result, &has_type);
    return has_result ? word(instruction, has_type ? 2 : 1) : 0;
}

std::uint32_t KernelCode::type_of(std::uint32_t id) const {
    const Instruction* one = definition(id);
    if (!one)
        return 0;
    bool has_result = false, has_type = false;
    spv::HasResultAndType(static_cast<spv::Op>(one->code), &has_result, &has_type);
    return has_type ? word(*one, 1) : 0;
}

const Instruction* KernelCode::definition(std::uint32_t id) const {
    const auto found = defined_.find(id);
    return found == defined_.end() ? nullptr : &instructions_[found->second];
}

std::string KernelCode::name_of(std::uint32_t id) const {
    const auto found = names_.find(id);
    return found == names_.end() || found->second.empty() ? fmt::format("%{}", id) : found->second;
}

std::uint32_t KernelCode::variable_of(std::uint32_t pointer) const {
    const Instruction* one = definition(pointer);
    while (one && (one->code == spv::OpAccessChain || one->code == spv::OpInBoundsAccessChain))
        one = definition(word(*one, 3));
    return one && one->code == spv::OpVariable ? word(*one, 2) : 0;
}

std::uint32_t KernelCode::variable_at(std::uint32_t binding) const {
    const auto found = bound_.find(binding);
    if (found == bound_.end())
        throw std::runtime_error(fmt::format("the kernel has no binding {}", binding));
    return found->second;
}

std::uint32_t KernelCode::find_global(std::uint32_t code, const Words& operands) const {
    for (const Instruction& one : instructions_) {
        if (one.code == spv::OpFunction)
            return 0;
        const std::uint32_t id = one.code == code ? result(one) : 0;
        if (id == 0)
            continue;
        Words others;
        for (std::size_t i = 1; i < one.count; ++i)
            if (word(one, i) != id || (i > 2))
                others.push_back(word(one, i));
        if (others == operands)
            return id;
    }
    return 0;
}

Words instruction(std::uint32_t code, const Words& operands) {
    Words words{static_cast<std::uint32_t>(operands.size() + 1) << spv::WordCountShift | code};
    words.insert(words.end(), operands.begin(), operands.end());
    return words;
}

std::uint32_t Changed::constant(std::uint32_t type, std::uint64_t bits) {
    const Instruction& scalar = *code_.definition(type);
    Words operands{type, new_id(), static_cast<std::uint32_t>(bits)};
    const std::uint32_t id = operands[1];
    if (scalar.code == spv::OpTypeBool)
        operands.pop_back();
    else if (code_.word(scalar, 2) == 64)
        operands.push_back(static_cast<std::uint32_t>(bits >> 32));
    const std::uint32_t code = scalar.code != spv::OpTypeBool ? spv::OpConstant
                               : bits                         ? spv::OpConstantTrue
                                                              : spv::OpConstantFalse;
    const Words made = instruction(code, operands);
    constants_.insert(constants_.end(), made.begin(), made.end());
    return id;
}

std::uint32_t Changed::splat(std::uint32_t type, std::uint64_t bits) {
    const Instruction& vector = *code_.definition(type);
    if (vector.code != spv::OpTypeVector)
        return constant(type, bits);
    const std::uint32_t scalar = constant(code_.word(vector, 2), bits);
    Words operands{type, new_id()};
    operands.insert(operands.end(), code_.word(vector, 3), scalar);
    const Words made = instruction(spv::OpConstantComposite, operands);
    constants_.insert(constants_.end(), made.begin(), made.end());
    return operands[1];
}

Words Changed::words() const {
    const auto& all = code_.instructions();
    const auto functions = std::ranges::find(all, std::uint32_t(spv::OpFunction), &Instruction::code);
    std::vector<Edit> edits = edits_;
    edits.push_back({functions->at, 0, constants_});
    std::ranges::stable_sort(edits, {}, &Edit::at);
    Words words;
    std::size_t at = 0;
    const Words& from = code_.words();
    const auto copy_to = [&](std::size_t end) {
        words.insert(words.end(), from.begin() + std::ptrdiff_t(at), from.begin() + std::ptrdiff_t(end));
    };
    for (const Edit& edit : edits) {
        copy_to(edit.at);
        words.insert(words.end(), edit.inserted.begin(), edit.inserted.end());
        at = edit.at + edit.removed;
    }
    copy_to(from.size());
    words[3] = bound_;
    return words;
}

} // namespace forceshade::mutation
