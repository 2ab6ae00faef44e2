#include "tests/gpu/spirv_module.h"

#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>
#include <spirv/unified1/spirv.hpp>

namespace forceshade::test {
namespace {

constexpr std::size_t kHeader = 5; // words before the first instruction

// A literal string begins at `word` of the operands.
std::string string_at(const std::vector<std::uint32_t>& operands, std::size_t word) {
    std::string text((operands.size() - word) * sizeof(std::uint32_t), '\0');
    std::memcpy(text.data(), operands.data() + word, text.size());
    return text.substr(0, text.find('\0'));
}

bool is_type(std::uint32_t code) {
    return code >= spv::OpTypeVoid && code <= spv::OpTypeFunction;
}

// Rounds once, as written, if it carries NoContraction.
bool is_arithmetic(std::uint32_t code) {
    return code == spv::OpFAdd || code == spv::OpFSub || code == spv::OpFMul || code == spv::OpFDiv;
}

// Rounds in an order or with an error that Vulkan leaves to the driver, decorated or not.
bool is_open(std::uint32_t code) {
    return code >= spv::OpFRem && code <= spv::OpDot; // remainders, products of vectors and matrices
}

// Exact, or rounded once.
bool is_well_rounded(std::uint32_t function) {
    switch (function) {
    case GLSLstd450FAbs:
    case GLSLstd450Floor:
    case GLSLstd450Sqrt:
    case GLSLstd450PackDouble2x32:
        return true;
    default:
        return false;
    }
}

} // namespace

SpirvModule::SpirvModule(std::span<const std::uint32_t> words) {
    if (words.size() < kHeader || words[0] != spv::MagicNumber)
        throw std::runtime_error("no SPIR-V");
    for (std::size_t at = kHeader; at < words.size();) {
        const std::uint32_t count = words[at] >> spv::WordCountShift;
        if (count == 0 || at + count > words.size())
            throw std::runtime_error("SPIR-V ends within an instruction");
        const auto operands = words.subspan(at + 1, count - 1);
        instructions_.push_back({words[at] & spv::OpCodeMask, {operands.begin(), operands.end()}});
        at += count;
    }
    for (const Instruction& instruction : instructions_) {
        if (is_type(instruction.code))
            types_[instruction.operands[0]] = &instruction;
        if (instruction.code == spv::OpCapability)
            capabilities_.insert(instruction.operands[0]);
        if (instruction.code == spv::OpMemberName)
            member_name_[{instruction.operands[0], instruction.operands[1]}] = string_at(instruction.operands, 2);
        arithmetic_ += is_arithmetic(instruction.code);
        decorate(instruction);
    }
}

void SpirvModule::decorate(const Instruction& instruction) {
    const auto& operands = instruction.operands;
    if (instruction.code == spv::OpMemberDecorate && operands[2] == spv::DecorationOffset)
        offset_of_[{operands[0], operands[1]}] = operands[3];
    if (instruction.code != spv::OpDecorate)
        return;
    switch (operands[1]) {
    case spv::DecorationNoContraction:
        exact_.insert(operands[0]);
        break;
    case spv::DecorationBinding:
        binding_of_[operands[0]] = operands[2];
        bindings_.insert(operands[2]);
        break;
    case spv::DecorationArrayStride:
        stride_of_[operands[0]] = operands[2];
        break;
    case spv::DecorationSpecId:
        specialization_ids_.insert(operands[2]);
        break;
    default:
        break;
    }
}

std::vector<SpirvModule::Member> SpirvModule::members(std::uint32_t type) const {
    const Instruction& structure = *types_.at(type);
    if (structure.code != spv::OpTypeStruct)
        throw std::runtime_error("no struct");
    std::vector<Member> result;
    for (std::uint32_t i = 0; i + 1 < structure.operands.size(); ++i) {
        const auto name = member_name_.find({type, i});
        result.push_back(
            {structure.operands[i + 1], name == member_name_.end() ? "" : name->second, offset_of_.at({type, i})});
    }
    return result;
}

std::optional<std::uint32_t> SpirvModule::struct_of_variable(std::uint32_t storage,
                                                             std::optional<std::uint32_t> binding) const {
    for (const Instruction& variable : instructions_) {
        if (variable.code != spv::OpVariable || variable.operands[2] != storage)
            continue;
        const auto bound = binding_of_.find(variable.operands[1]);
        if (binding && (bound == binding_of_.end() || bound->second != *binding))
            continue;
        return types_.at(variable.operands[0])->operands[2]; // what the variable's pointer type points to
    }
    return std::nullopt;
}

std::optional<std::uint32_t> SpirvModule::buffer(std::uint32_t binding) const {
    if (const auto found = struct_of_variable(spv::StorageClassStorageBuffer, binding))
        return found;
    return struct_of_variable(spv::StorageClassUniform, binding); // SPIR-V before 1.3
}

std::optional<std::uint32_t> SpirvModule::push_constants() const {
    return struct_of_variable(spv::StorageClassPushConstant, std::nullopt);
}

std::uint32_t SpirvModule::size_of(std::uint32_t type) const {
    const Instruction& found = *types_.at(type);
    if (found.code == spv::OpTypeInt || found.code == spv::OpTypeFloat)
        return found.operands[1] / 8;
    if (found.code == spv::OpTypeVector)
        return size_of(found.operands[1]) * found.operands[2];
    return 0;
}

std::optional<SpirvModule::Array> SpirvModule::array(std::uint32_t type) const {
    const Instruction& found = *types_.at(type);
    if (found.code != spv::OpTypeRuntimeArray && found.code != spv::OpTypeArray)
        return std::nullopt;
    return Array{stride_of_.at(type), size_of(found.operands[1]), found.operands[1]};
}

bool SpirvModule::is_real(std::uint32_t type) const {
    const Instruction& found = *types_.at(type);
    if (found.code == spv::OpTypeVector)
        return is_real(found.operands[1]);
    return found.code == spv::OpTypeFloat;
}

std::vector<std::string> SpirvModule::inexact() const {
    std::vector<std::string> complaints;
    for (const Instruction& instruction : instructions_) {
        const auto& operands = instruction.operands;
        if (is_arithmetic(instruction.code) && !exact_.contains(operands[1]))
            complaints.push_back(fmt::format("operation {} of %{} lacks NoContraction", instruction.code, operands[1]));
        if (is_open(instruction.code))
            complaints.push_back(fmt::format("operation {} of %{}", instruction.code, operands[1]));
        if (instruction.code == spv::OpExtInst && is_real(operands[0]) && !is_well_rounded(operands[3]))
            complaints.push_back(fmt::format("GLSL.std.450 function {} of %{}", operands[3], operands[1]));
    }
    return complaints;
}

} // namespace forceshade::test
