// The embedded SPIR-V against what C++ believes of it: offsets, bindings, constants, capabilities; and that every
// operation of the laws rounds as it is written.
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <spirv/unified1/spirv.hpp>

#include "shaders/kernels.h"
#include "shaders/shared/layout.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/spirv_module.h"

namespace forceshade {
namespace {

using test::SpirvModule;
using Numbers = std::set<std::uint32_t>;
using Words = std::span<const std::uint32_t>;

struct Expected {
    const char* name;
    std::size_t offset;
};

// FS_MEMBERS(Type, a, b, ...): {{"a", offsetof(Type, a)}, {"b", offsetof(Type, b)}, ...}, 64 at most.
#define FS_PARENTHESES ()
#define FS_EXPAND_1(...) __VA_ARGS__
#define FS_EXPAND_4(...) FS_EXPAND_1(FS_EXPAND_1(FS_EXPAND_1(FS_EXPAND_1(__VA_ARGS__))))
#define FS_EXPAND_16(...) FS_EXPAND_4(FS_EXPAND_4(FS_EXPAND_4(FS_EXPAND_4(__VA_ARGS__))))
#define FS_EXPAND(...) FS_EXPAND_16(FS_EXPAND_16(FS_EXPAND_16(FS_EXPAND_16(__VA_ARGS__))))
#define FS_NEXT_MEMBER() FS_MEMBER
#define FS_MEMBER(Type, member, ...)                                                                                   \
    Expected{#member, offsetof(Type, member)}, __VA_OPT__(FS_NEXT_MEMBER FS_PARENTHESES(Type, __VA_ARGS__))
// clang-format off
#define FS_MEMBERS(Type, ...) std::vector<Expected>{FS_EXPAND(FS_MEMBER(Type, __VA_ARGS__))}
// clang-format on

template <typename real>
const std::vector<Expected> kMapMembers = FS_MEMBERS(layout::MapParams<real>, half_width, half_length, radius, slope,
                                                     inverse_length, nodes_per_x, nodes_per_y, columns, rows);
template <typename real>
const std::vector<Expected> kLawMembers = FS_MEMBERS(layout::LawParams<real>, stiffness, texture_stiffness, half_width,
                                                     radius, centre_depth, map, texture, facets, zero);
template <typename real>
const std::vector<Expected> kMeshMembers = FS_MEMBERS(layout::MeshParams<real>, centre_x, centre_y, centre_z, map_x,
                                                      map_y, scale, stiffness, facets, triangles, nodes, zero);
const std::vector<Expected> kMeshChunkMembers = FS_MEMBERS(layout::MeshChunkParams, x_pitch, y_first, y_count, y_axis,
                                                           z_first, z_count, z_axis, blocks, candidates);
const std::vector<Expected> kChunkMembers =
    FS_MEMBERS(layout::ChunkParams, x_pitch, y_first, y_count, y_axis, z_first, z_count, z_axis, rows);
const std::vector<Expected> kPathChunkMembers =
    FS_MEMBERS(layout::PathChunkParams, paths, step_first, step_end, steps, own_lengths, own_hands, stretch);
const std::vector<Expected> kMeshPathChunkMembers =
    FS_MEMBERS(layout::MeshPathChunkParams, first, listed, paths, row_first, rows, step_end, own_hands, pause, limit,
               stretch, vertices);
template <typename real>
const std::vector<Expected> kMotionMembers = FS_MEMBERS(layout::MotionParams<real>, centre_x, centre_y, centre_z,
                                                        heading_x, heading_y, reach, across, depth, depth_back, lift,
                                                        phase, phase_step, radius_phase, radius_step, run, turn, lines,
                                                        key_low, key_high, zero);
template <typename real>
const std::vector<Expected> kHarmonicMembers = FS_MEMBERS(layout::Harmonic<real>, amplitude, phase, phase_step);
template <typename real>
const std::vector<Expected> kAxisMembers = FS_MEMBERS(layout::AxisMap<real>, x_error, x_speed, x_force, v_error,
                                                      v_speed, v_force);
template <typename real>
const std::vector<Expected> kHandMembers = FS_MEMBERS(layout::HandParams<real>, lateral, vertical, rate, period,
                                                      stiffness, stiffness_z, damping, push_x, push_y, push_z, quantum,
                                                      coulomb, max_force, gain, bound, start_depth, coupling, delay,
                                                      zero);
template <typename real>
const std::vector<Expected> kMetricsMembers =
    FS_MEMBERS(layout::PathMetrics<real>, largest_force, force_square, force_square_rest, largest_turn, steepest_turn,
               steepest_distance, least_depth, largest_depth, first_depth, depth, depth_rest, depth_square,
               depth_square_rest, work, work_rest, effort, effort_rest, round_begin, round_begin_rest, largest_round,
               least_round, early_speed, late_speed, contact_samples, rounds, unstable_step, fell, unfinished, trail);
template <typename real>
const std::vector<Expected> kStateMembers = FS_MEMBERS(layout::PathState<real>, x, y, z, speed_x, speed_y, speed_z,
                                                       measured_x, measured_y, measured_z, force_x, force_y, force_z,
                                                       anchor_x, anchor_y, anchor_z, anchor_force_x, anchor_force_y,
                                                       anchor_force_z, steepest, lag, metrics, step, directed);

void expect_members(const SpirvModule& module, std::uint32_t type, const std::vector<Expected>& expected) {
    const auto members = module.members(type);
    ASSERT_EQ(members.size(), expected.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
        EXPECT_EQ(members[i].name, expected[i].name);
        EXPECT_EQ(members[i].offset, expected[i].offset) << expected[i].name;
    }
}

// A buffer of structs, one after the other as C++ has them; of kernels that have it. Gives the struct's type.
std::uint32_t expect_structs(const SpirvModule& module, std::uint32_t binding, const std::vector<Expected>& members,
                             std::size_t size) {
    if (!module.bindings().contains(binding))
        return 0;
    const auto buffer = module.members(module.buffer(binding).value());
    const auto array = module.array(buffer.at(0).type);
    EXPECT_TRUE(buffer.size() == 1 && array && array->stride == size) << "binding " << binding;
    expect_members(module, array->type, members);
    return array->type;
}

// The laws' parameters, on meshes with the mesh's, and the push constants.
template <typename real>
void expect_params(const SpirvModule& module, std::uint32_t binding, bool mesh, const std::vector<Expected>& chunk) {
    const auto buffer = module.members(module.buffer(binding).value());
    ASSERT_EQ(buffer.size(), 1u);
    EXPECT_EQ(buffer[0].offset, 0u);
    std::uint32_t law = buffer[0].type;
    if (mesh) {
        expect_members(module, law, FS_MEMBERS(layout::MeshLawParams<real>, law, mesh));
        const auto params = module.members(law);
        expect_members(module, params.at(1).type, kMeshMembers<real>);
        law = params[0].type;
    }
    expect_members(module, law, kLawMembers<real>);
    expect_members(module, module.members(law).at(5).type, kMapMembers<real>);
    expect_members(module, module.members(law).at(6).type, kMapMembers<real>);
    const auto push = module.members(module.push_constants().value());
    ASSERT_EQ(push.size(), 1u);
    EXPECT_EQ(push[0].offset, 0u);
    expect_members(module, push[0].type, chunk);
}

// What paths have beside them: `motions` and the two bindings behind it, `states`.
template <typename real>
void expect_path_structs(const SpirvModule& module, std::uint32_t motions, std::uint32_t states) {
    using namespace layout;
    expect_structs(module, motions, kMotionMembers<real>, sizeof(MotionParams<real>));
    expect_structs(module, motions + 1, kHarmonicMembers<real>, sizeof(layout::Harmonic<real>));
    if (const auto hand = expect_structs(module, motions + 2, kHandMembers<real>, sizeof(HandParams<real>))) {
        expect_members(module, module.members(hand).at(0).type, kAxisMembers<real>);
        expect_members(module, module.members(hand).at(16).type,
                       FS_MEMBERS(layout::Coupling<real>, depth, lag, free, kept, rest));
    }
    if (const auto state = expect_structs(module, states, kStateMembers<real>, sizeof(PathState<real>)))
        expect_members(module, module.members(state).at(20).type, kMetricsMembers<real>);
}

template <typename real> void expect_layout(const SpirvModule& module, const std::string& kernel) {
    if (kernel == "field")
        expect_params<real>(module, layout::kBindLaw, false, kChunkMembers);
    if (kernel == "mesh_field")
        expect_params<real>(module, layout::kMeshBindLaw, true, kMeshChunkMembers);
    if (kernel == "path")
        expect_params<real>(module, layout::kPathBindLaw, false, kPathChunkMembers);
    if (kernel == "mesh_path")
        expect_params<real>(module, layout::kMeshPathBindLaw, true, kMeshPathChunkMembers);
    if (kernel == "path")
        expect_path_structs<real>(module, layout::kPathBindMotions, layout::kPathBindStates);
    if (kernel == "mesh_path")
        expect_path_structs<real>(module, layout::kMeshPathBindMotions, layout::kMeshPathBindStates);
}

Numbers up_to(std::uint32_t count) {
    Numbers all;
    for (std::uint32_t i = 0; i < count; ++i)
        all.insert(i);
    return all;
}

struct Kernel {
    const char* variant; // of broken_kernels.h
    std::string name;
    Words words;
    std::size_t real;     /* bytes */
    Numbers capabilities; // no more: a device without 64-bit numbers must be able to take the plain kernel
};

const std::vector<Kernel>& all_kernels() {
    const Numbers plain{spv::CapabilityShader}, wide{spv::CapabilityShader, spv::CapabilityFloat64};
    static const std::vector<Kernel> all{
        {"f32", "field", kernels::field_f32(), 4, plain},
        {"f32_packed", "field", kernels::field_f32_packed(), 4, {spv::CapabilityShader, spv::CapabilityInt64}},
        {"f32_exact", "field", kernels::field_f32_exact(), 4, wide},
        {"f64", "field", kernels::field_f64(), 8, wide},
        {"mesh_f32", "mesh_field", kernels::mesh_field_f32(), 4, plain},
        {"mesh_f32_exact", "mesh_field", kernels::mesh_field_f32_exact(), 4, wide},
        {"mesh_f64", "mesh_field", kernels::mesh_field_f64(), 8, wide},
        {"path_f32", "path", kernels::path_f32(), 4, plain},
        {"path_f32_exact", "path", kernels::path_f32_exact(), 4, wide},
        {"path_f64", "path", kernels::path_f64(), 8, wide},
        {"mesh_path_f32", "mesh_path", kernels::mesh_path_f32(), 4, plain},
        {"mesh_path_f32_exact", "mesh_path", kernels::mesh_path_f32_exact(), 4, wide},
        {"mesh_path_f64", "mesh_path", kernels::mesh_path_f64(), 8, wide}};
    return all;
}

class Spirv : public ::testing::TestWithParam<Kernel> {
protected:
    const Kernel& kernel = GetParam();
    const SpirvModule module{kernel.words};
};

TEST_P(Spirv, OffsetsEqualThoseOfCpp) {
    kernel.real == 4 ? expect_layout<float>(module, kernel.name) : expect_layout<double>(module, kernel.name);
}

// Results are read as dense reals, whatever vectors they are stored as.
TEST_P(Spirv, ArraysAreDense) {
    std::size_t arrays = 0;
    for (const std::uint32_t binding : module.bindings()) {
        const auto members = module.members(module.buffer(binding).value());
        const auto array = module.array(members.at(0).type);
        if (!array || array->element == 0) // parameters, a status, structs
            continue;
        ++arrays;
        EXPECT_EQ(members.size(), 1u);
        EXPECT_EQ(array->stride, array->element) << "binding " << binding;
        if (kernel.name == "field" && binding > layout::kBindLaw && binding < layout::kBindStatus) {
            EXPECT_EQ(array->stride, kernel.real) << "binding " << binding;
        }
    }
    EXPECT_GE(arrays, 9u);
}

TEST_P(Spirv, CapabilitiesAreTheFewest) {
    EXPECT_EQ(module.capabilities(), kernel.capabilities);
}

TEST_P(Spirv, EveryOperationRoundsAsWritten) {
    EXPECT_GT(module.arithmetic_count(), 100u);
    for (const std::string& complaint : module.inexact())
        ADD_FAILURE() << complaint;
    // The check must see a kernel whose `precise` is gone.
    const SpirvModule imprecise(test::broken_words(test::Break::imprecise, kernel.variant));
    EXPECT_GT(imprecise.inexact().size(), 100u);
}

INSTANTIATE_TEST_SUITE_P(Kernels, Spirv, ::testing::ValuesIn(all_kernels()),
                         [](const auto& of) { return std::string(of.param.variant); });

TEST(SpirvModules, HaveTheBindingsAndConstantsOfTheLayout) {
    using namespace layout;
    const Numbers law{kSpecLocalX, kSpecShading, kSpecMap, kSpecTexture, kSpecChannels};
    const Numbers surface{kSpecSurface, kSpecDepth, kSpecReference};
    const Numbers path{kSpecMotion, kSpecLoop, kSpecHarmonics, kSpecFriction, kSpecQuantised, kSpecCoupled};
    const auto all = [](std::initializer_list<Numbers> sets) {
        Numbers sum;
        for (const Numbers& some : sets)
            sum.insert(some.begin(), some.end());
        return sum;
    };
    // The two of paths on meshes share one set, of which each takes what it needs.
    Numbers bindings, constants;
    for (const Kernel& kernel : all_kernels()) {
        const SpirvModule module(kernel.words);
        SCOPED_TRACE(kernel.variant);
        if (kernel.name == "field") {
            EXPECT_EQ(module.bindings(), up_to(kBindCount));
            EXPECT_EQ(module.specialization_ids(), all({law, surface}));
        } else if (kernel.name == "mesh_field") {
            EXPECT_EQ(module.bindings(), up_to(kMeshBindCount));
            EXPECT_EQ(module.specialization_ids(), all({law, {kSpecInside, kSpecFree, kSpecUnroll}}));
        } else if (kernel.name == "path") {
            EXPECT_EQ(module.bindings(), up_to(kPathBindCount));
            EXPECT_EQ(module.specialization_ids(), all({law, surface, path, {kSpecFollow}}));
        } else {
            bindings = all({bindings, module.bindings()});
            constants = all({constants, module.specialization_ids()});
        }
    }
    EXPECT_EQ(bindings, up_to(kMeshPathBindCount));
    EXPECT_EQ(constants, all({law, path, {kSpecUnroll}}));
}

// What Vulkan leaves open: the same words with the square root made a sine, function 31 to 13 of GLSL.std.450.
TEST(SpirvModules, AreInexactWithASine) {
    std::vector<std::uint32_t> sines(all_kernels()[0].words.begin(), all_kernels()[0].words.end());
    for (std::size_t at = 5; at < sines.size(); at += sines[at] >> spv::WordCountShift)
        if ((sines[at] & spv::OpCodeMask) == spv::OpExtInst && sines[at + 4] == 31)
            sines[at + 4] = 13;
    EXPECT_FALSE(SpirvModule(sines).inexact().empty());
}

TEST(SpirvModules, AreRefusedWhereWordsAreNoSpirv) {
    const std::vector<std::uint32_t> nothing, zeros(16, 0);
    EXPECT_THROW(SpirvModule{nothing}, std::runtime_error);
    EXPECT_THROW(SpirvModule{zeros}, std::runtime_error);
    std::vector<std::uint32_t> cut(all_kernels()[0].words.begin(), all_kernels()[0].words.end());
    cut.push_back(5u << spv::WordCountShift | spv::OpFAdd); // and nothing of what it announces
    EXPECT_THROW(SpirvModule{cut}, std::runtime_error);
}

} // namespace
} // namespace forceshade
