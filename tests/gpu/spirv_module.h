// SPIR-V words taken apart as far as the tests ask: decorations, struct layouts, arithmetic. Khronos SPIR-V 1.6, 2.3.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace forceshade::test {

class SpirvModule {
public:
    /// \throws std::runtime_error if the words are no SPIR-V.
    explicit SpirvModule(std::span<const std::uint32_t> words);
    SpirvModule(const SpirvModule&) = delete; // its tables point into itself
    SpirvModule& operator=(const SpirvModule&) = delete;

    struct Member {
        std::uint32_t type = 0;
        std::string name;
        std::uint32_t offset = 0; /* bytes */
    };
    /// Members of a struct type, in order.
    std::vector<Member> members(std::uint32_t type) const;

    /// The struct type of the buffer at a binding of set 0; none if there is no such buffer.
    std::optional<std::uint32_t> buffer(std::uint32_t binding) const;
    /// The struct type of the push constants.
    std::optional<std::uint32_t> push_constants() const;
    /// Bytes from one element to the next, bytes an element takes by its type (scalars and vectors), and that type.
    struct Array {
        std::uint32_t stride = 0, element = 0, type = 0; /* element: 0 of a struct */
    };
    std::optional<Array> array(std::uint32_t type) const;

    const std::set<std::uint32_t>& bindings() const { return bindings_; }
    const std::set<std::uint32_t>& specialization_ids() const { return specialization_ids_; }
    const std::set<std::uint32_t>& capabilities() const { return capabilities_; }

    /// What may round in another way than written: arithmetic on reals without NoContraction, and operations whose
    /// rounding Vulkan leaves open (dot products, built-in functions other than floor, abs and sqrt).
    std::vector<std::string> inexact() const;
    /// Additions, subtractions, multiplications and divisions of reals.
    std::size_t arithmetic_count() const { return arithmetic_; }

private:
    struct Instruction {
        std::uint32_t code;
        std::vector<std::uint32_t> operands;
    };
    void decorate(const Instruction& instruction);
    std::uint32_t size_of(std::uint32_t type) const;
    bool is_real(std::uint32_t type) const;
    std::optional<std::uint32_t> struct_of_variable(std::uint32_t storage, std::optional<std::uint32_t> binding) const;

    std::vector<Instruction> instructions_;
    std::map<std::uint32_t, const Instruction*> types_; // by result id
    std::map<std::uint32_t, std::uint32_t> binding_of_, stride_of_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> offset_of_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> member_name_;
    std::set<std::uint32_t> exact_, bindings_, specialization_ids_, capabilities_;
    std::size_t arithmetic_ = 0;
};

} // namespace forceshade::test
