// The embedded SPIR-V against what C++ believes of it: offsets, bindings, constants, capabilities; and that every
// operation of the laws rounds as it is written.
#include <gtest/gtest.h>
#include <spirv/unified1/spirv.hpp>

#include "shaders/kernels.h"
#include "tests/gpu/spirv_layouts.h"

namespace forceshade {
namespace {

namespace broken {
#include "imprecise_f32.spv.h"
#include "imprecise_f64.spv.h"
#include "imprecise_mesh_f32.spv.h"
#include "imprecise_mesh_f64.spv.h"
} // namespace broken

using test::SpirvModule;

const SpirvModule& f32() {
    static const SpirvModule module(kernels::field_f32());
    return module;
}
const SpirvModule& f32_packed() {
    static const SpirvModule module(kernels::field_f32_packed());
    return module;
}
const SpirvModule& f64() {
    static const SpirvModule module(kernels::field_f64());
    return module;
}

const SpirvModule& mesh_f32() {
    static const SpirvModule module(kernels::mesh_field_f32());
    return module;
}
const SpirvModule& mesh_f64() {
    static const SpirvModule module(kernels::mesh_field_f64());
    return module;
}

TEST(Spirv, OffsetsEqualThoseOfCpp) {
    test::expect_mesh_layout<float>(mesh_f32());
    test::expect_mesh_layout<double>(mesh_f64());
    test::expect_layout<float>(f32());
    test::expect_layout<float>(f32_packed());
    test::expect_layout<double>(f64());
}

TEST(Spirv, ArraysAreDense) {
    for (const SpirvModule* module : {&mesh_f32(), &mesh_f64()})
        for (std::uint32_t binding = layout::kMeshBindAxes; binding < layout::kMeshBindCount; ++binding)
            if (binding != layout::kMeshBindStatus)
                test::expect_dense(*module, binding);
    test::expect_arrays<float>(f32());
    test::expect_arrays<float>(f32_packed());
    test::expect_arrays<double>(f64());
}

TEST(Spirv, BindingsAndConstantsAreThoseOfTheLayout) {
    const auto bindings = [](std::uint32_t count) {
        std::set<std::uint32_t> all;
        for (std::uint32_t i = 0; i < count; ++i)
            all.insert(i);
        return all;
    };
    using namespace layout;
    const std::set<std::uint32_t> field{kSpecLocalX,    kSpecSurface, kSpecShading, kSpecDepth,
                                        kSpecReference, kSpecMap,     kSpecTexture, kSpecChannels};
    const std::set<std::uint32_t> mesh{kSpecLocalX,  kSpecShading,  kSpecInside, kSpecMap,
                                       kSpecTexture, kSpecChannels, kSpecFree,   kSpecUnroll};
    for (const SpirvModule* module : {&f32(), &f32_packed(), &f64()}) {
        EXPECT_EQ(module->bindings(), bindings(kBindCount));
        EXPECT_EQ(module->specialization_ids(), field);
    }
    for (const SpirvModule* module : {&mesh_f32(), &mesh_f64()}) {
        EXPECT_EQ(module->bindings(), bindings(kMeshBindCount));
        EXPECT_EQ(module->specialization_ids(), mesh);
    }
}

// A device without 64-bit numbers must be able to take the plain kernel.
TEST(Spirv, CapabilitiesAreTheFewest) {
    const std::set<std::uint32_t> plain{spv::CapabilityShader};
    EXPECT_EQ(f32().capabilities(), plain);
    EXPECT_EQ(mesh_f32().capabilities(), plain);
    EXPECT_EQ(mesh_f64().capabilities(), (std::set<std::uint32_t>{spv::CapabilityShader, spv::CapabilityFloat64}));
    EXPECT_EQ(f32_packed().capabilities(), (std::set<std::uint32_t>{spv::CapabilityShader, spv::CapabilityInt64}));
    EXPECT_EQ(f64().capabilities(), (std::set<std::uint32_t>{spv::CapabilityShader, spv::CapabilityFloat64}));
}

TEST(Spirv, EveryOperationRoundsAsWritten) {
    for (const SpirvModule* module : {&f32(), &f32_packed(), &f64(), &mesh_f32(), &mesh_f64()}) {
        EXPECT_GT(module->arithmetic_count(), 100u);
        for (const std::string& complaint : module->inexact())
            ADD_FAILURE() << complaint;
    }
}

// The check must see a kernel whose `precise` is gone, and one that uses what Vulkan leaves open.
TEST(Spirv, TheCheckSeesWhatIsNotPrecise) {
    for (const SpirvModule& module : {SpirvModule(broken::imprecise_f32), SpirvModule(broken::imprecise_f64),
                                      SpirvModule(broken::imprecise_mesh_f32), SpirvModule(broken::imprecise_mesh_f64)})
        EXPECT_EQ(module.inexact().size(), module.arithmetic_count());
    // The same words with the square root made a sine: function 31 to 13 of GLSL.std.450.
    const auto words = kernels::field_f32();
    std::vector<std::uint32_t> sines(words.begin(), words.end());
    for (std::size_t at = 5; at < sines.size(); at += sines[at] >> spv::WordCountShift)
        if ((sines[at] & spv::OpCodeMask) == spv::OpExtInst && sines[at + 4] == 31)
            sines[at + 4] = 13;
    EXPECT_FALSE(SpirvModule(sines).inexact().empty());
}

TEST(Spirv, WordsThatAreNoSpirvAreRefused) {
    const std::vector<std::uint32_t> nothing, zeros(16, 0);
    EXPECT_THROW(SpirvModule{nothing}, std::runtime_error);
    EXPECT_THROW(SpirvModule{zeros}, std::runtime_error);
    const auto words = kernels::field_f32();
    std::vector<std::uint32_t> cut(words.begin(), words.end());
    cut.push_back(5u << spv::WordCountShift | spv::OpFAdd); // and nothing of what it announces
    EXPECT_THROW(SpirvModule{cut}, std::runtime_error);
}

} // namespace
} // namespace forceshade
