// The kernels of paths: their SPIR-V against what C++ believes of it; every operation of the laws rounds as written.
#include <spirv/unified1/spirv.hpp>

#include "shaders/kernels.h"
#include "tests/gpu/spirv_layouts.h"

namespace forceshade {
namespace {

namespace broken {
#include "imprecise_mesh_path_f32.spv.h"
#include "imprecise_mesh_path_f64.spv.h"
#include "imprecise_path_f32.spv.h"
#include "imprecise_path_f64.spv.h"
} // namespace broken

using test::SpirvModule;

struct Kernel {
    const char* name;
    std::span<const std::uint32_t> words;
    bool f64;
};

const std::vector<Kernel>& paths() {
    static const std::vector<Kernel> all{{"path f32", kernels::path_f32(), false},
                                         {"path f64", kernels::path_f64(), true}};
    return all;
}

const std::vector<Kernel>& mesh_paths() {
    static const std::vector<Kernel> all{{"mesh_path f32", kernels::mesh_path_f32(), false},
                                         {"mesh_path f64", kernels::mesh_path_f64(), true}};
    return all;
}

std::set<std::uint32_t> numbers(std::uint32_t count) {
    std::set<std::uint32_t> all;
    for (std::uint32_t i = 0; i < count; ++i)
        all.insert(i);
    return all;
}

TEST(PathSpirv, OffsetsEqualThoseOfCpp) {
    test::expect_path_layout<float>(SpirvModule(kernels::path_f32()));
    test::expect_path_layout<double>(SpirvModule(kernels::path_f64()));
    for (const Kernel& kernel : mesh_paths()) {
        SCOPED_TRACE(kernel.name);
        const SpirvModule module(kernel.words);
        if (kernel.f64)
            test::expect_mesh_path_layout<double>(module);
        else
            test::expect_mesh_path_layout<float>(module);
    }
}

TEST(PathSpirv, ArraysAreDense) {
    for (const Kernel& kernel : paths())
        for (const std::uint32_t binding :
             {layout::kPathBindFacetVertices, layout::kPathBindMapGradients, layout::kPathBindTextureGradients,
              layout::kPathBindLengths, layout::kPathBindRecorded, layout::kPathBindPosition, layout::kPathBindForce,
              layout::kPathBindDepth, layout::kPathBindFacet, layout::kPathBindProxy})
            test::expect_dense(SpirvModule(kernel.words), binding);
    for (const Kernel& kernel : mesh_paths()) {
        SCOPED_TRACE(kernel.name);
        const SpirvModule module(kernel.words);
        for (const std::uint32_t binding :
             {layout::kMeshPathBindMapGradients, layout::kMeshPathBindTextureGradients, layout::kMeshPathBindVectors,
              layout::kMeshPathBindTriangles, layout::kMeshPathBindIndices, layout::kMeshPathBindRecorded,
              layout::kMeshPathBindWalkWords, layout::kMeshPathBindWalkReals, layout::kMeshPathBindSamples,
              layout::kMeshPathBindFacet})
            if (module.bindings().contains(binding))
                test::expect_dense(module, binding);
    }
}

TEST(PathSpirv, BindingsAndConstantsAreThoseOfTheLayout) {
    for (const Kernel& kernel : paths()) {
        EXPECT_EQ(SpirvModule(kernel.words).bindings(), numbers(layout::kPathBindCount));
        EXPECT_EQ(
            SpirvModule(kernel.words).specialization_ids(),
            (std::set<std::uint32_t>{layout::kSpecLocalX, layout::kSpecSurface, layout::kSpecShading,
                                     layout::kSpecDepth, layout::kSpecReference, layout::kSpecMap, layout::kSpecTexture,
                                     layout::kSpecChannels, layout::kSpecMotion, layout::kSpecLoop, layout::kSpecFollow,
                                     layout::kSpecHarmonics, layout::kSpecFriction, layout::kSpecQuantised}));
    }
    // The two on meshes share one set, of which each takes what it needs.
    std::set<std::uint32_t> bindings, constants;
    for (const Kernel& kernel : mesh_paths()) {
        const SpirvModule module(kernel.words);
        bindings.insert(module.bindings().begin(), module.bindings().end());
        constants.insert(module.specialization_ids().begin(), module.specialization_ids().end());
    }
    EXPECT_EQ(bindings, numbers(layout::kMeshPathBindCount));
    EXPECT_EQ(constants, (std::set<std::uint32_t>{layout::kSpecLocalX, layout::kSpecShading, layout::kSpecMap,
                                                  layout::kSpecTexture, layout::kSpecChannels, layout::kSpecMotion,
                                                  layout::kSpecLoop, layout::kSpecHarmonics, layout::kSpecFriction,
                                                  layout::kSpecQuantised, layout::kSpecUnroll}));
}

TEST(PathSpirv, CapabilitiesAreTheFewest) {
    const std::set<std::uint32_t> plain{spv::CapabilityShader}, both{spv::CapabilityShader, spv::CapabilityFloat64};
    EXPECT_EQ(SpirvModule(kernels::path_f32()).capabilities(), plain);
    EXPECT_EQ(SpirvModule(kernels::path_f64()).capabilities(), both);
    EXPECT_EQ(SpirvModule(kernels::mesh_path_f32()).capabilities(), plain);
    EXPECT_EQ(SpirvModule(kernels::mesh_path_f64()).capabilities(), both);
}

TEST(PathSpirv, EveryOperationRoundsAsWritten) {
    for (const auto* kernels : {&paths(), &mesh_paths()})
        for (const Kernel& kernel : *kernels) {
            const SpirvModule module(kernel.words);
            EXPECT_GT(module.arithmetic_count(), 100u) << kernel.name;
            for (const std::string& complaint : module.inexact())
                ADD_FAILURE() << kernel.name << ": " << complaint;
        }
}

TEST(PathSpirv, TheCheckSeesWhatIsNotPrecise) {
    for (const std::span<const std::uint32_t> words : {std::span<const std::uint32_t>(broken::imprecise_path_f32),
                                                       std::span<const std::uint32_t>(broken::imprecise_path_f64),
                                                       std::span<const std::uint32_t>(broken::imprecise_mesh_path_f32),
                                                       std::span<const std::uint32_t>(broken::imprecise_mesh_path_f64)})
        EXPECT_GT(SpirvModule(words).inexact().size(), 100u);
}

} // namespace
} // namespace forceshade
