// What C++ believes of the kernels' buffers, held against the embedded SPIR-V.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shaders/shared/layout.h"
#include "tests/gpu/spirv_module.h"

namespace forceshade::test {

struct Expected {
    const char* name;
    std::size_t offset;
};

#define FS_MEMBER(type, member)                                                                                        \
    Expected {                                                                                                         \
#member, offsetof(type, member)                                                                                \
    }

template <typename real> std::vector<Expected> map_members() {
    using Map = layout::MapParams<real>;
    return {FS_MEMBER(Map, half_width),  FS_MEMBER(Map, half_length),    FS_MEMBER(Map, radius),
            FS_MEMBER(Map, slope),       FS_MEMBER(Map, inverse_length), FS_MEMBER(Map, nodes_per_x),
            FS_MEMBER(Map, nodes_per_y), FS_MEMBER(Map, columns),        FS_MEMBER(Map, rows)};
}

template <typename real> std::vector<Expected> law_members() {
    using Law = layout::LawParams<real>;
    return {FS_MEMBER(Law, stiffness),    FS_MEMBER(Law, texture_stiffness),
            FS_MEMBER(Law, half_width),   FS_MEMBER(Law, radius),
            FS_MEMBER(Law, centre_depth), FS_MEMBER(Law, map),
            FS_MEMBER(Law, texture),      FS_MEMBER(Law, facets),
            FS_MEMBER(Law, zero)};
}

template <typename real> std::vector<Expected> mesh_members() {
    using Mesh = layout::MeshParams<real>;
    return {FS_MEMBER(Mesh, centre_x),  FS_MEMBER(Mesh, centre_y), FS_MEMBER(Mesh, centre_z),  FS_MEMBER(Mesh, map_x),
            FS_MEMBER(Mesh, map_y),     FS_MEMBER(Mesh, scale),    FS_MEMBER(Mesh, stiffness), FS_MEMBER(Mesh, facets),
            FS_MEMBER(Mesh, triangles), FS_MEMBER(Mesh, nodes),    FS_MEMBER(Mesh, zero)};
}

inline std::vector<Expected> mesh_chunk_members() {
    using Chunk = layout::MeshChunkParams;
    return {FS_MEMBER(Chunk, x_pitch), FS_MEMBER(Chunk, y_first), FS_MEMBER(Chunk, y_count),
            FS_MEMBER(Chunk, y_axis),  FS_MEMBER(Chunk, z_first), FS_MEMBER(Chunk, z_count),
            FS_MEMBER(Chunk, z_axis),  FS_MEMBER(Chunk, blocks),  FS_MEMBER(Chunk, candidates)};
}

inline std::vector<Expected> chunk_members() {
    using Chunk = layout::ChunkParams;
    return {FS_MEMBER(Chunk, x_pitch), FS_MEMBER(Chunk, y_first), FS_MEMBER(Chunk, y_count), FS_MEMBER(Chunk, y_axis),
            FS_MEMBER(Chunk, z_first), FS_MEMBER(Chunk, z_count), FS_MEMBER(Chunk, z_axis),  FS_MEMBER(Chunk, rows)};
}

inline void expect_members(const SpirvModule& module, std::uint32_t type, const std::vector<Expected>& expected) {
    const auto members = module.members(type);
    ASSERT_EQ(members.size(), expected.size());
    for (std::size_t i = 0; i < members.size(); ++i) {
        EXPECT_EQ(members[i].name, expected[i].name);
        EXPECT_EQ(members[i].offset, expected[i].offset) << expected[i].name;
    }
}

template <typename real> void expect_layout(const SpirvModule& module) {
    const auto law_buffer = module.members(module.buffer(layout::kBindLaw).value());
    ASSERT_EQ(law_buffer.size(), 1u);
    EXPECT_EQ(law_buffer[0].offset, 0u);
    expect_members(module, law_buffer[0].type, law_members<real>());
    const auto law = module.members(law_buffer[0].type);
    expect_members(module, law[5].type, map_members<real>());
    expect_members(module, law[6].type, map_members<real>());
    const auto push = module.members(module.push_constants().value());
    ASSERT_EQ(push.size(), 1u);
    EXPECT_EQ(push[0].offset, 0u);
    expect_members(module, push[0].type, chunk_members());
}

template <typename real> void expect_mesh_layout(const SpirvModule& module) {
    using Params = layout::MeshLawParams<real>;
    const auto law_buffer = module.members(module.buffer(layout::kMeshBindLaw).value());
    ASSERT_EQ(law_buffer.size(), 1u);
    expect_members(module, law_buffer[0].type, {FS_MEMBER(Params, law), FS_MEMBER(Params, mesh)});
    const auto params = module.members(law_buffer[0].type);
    expect_members(module, params[0].type, law_members<real>());
    expect_members(module, params[1].type, mesh_members<real>());
    const auto push = module.members(module.push_constants().value());
    ASSERT_EQ(push.size(), 1u);
    expect_members(module, push[0].type, mesh_chunk_members());
}

inline std::vector<Expected> path_chunk_members() {
    using Chunk = layout::PathChunkParams;
    return {FS_MEMBER(Chunk, paths),     FS_MEMBER(Chunk, step_first), FS_MEMBER(Chunk, step_end),
            FS_MEMBER(Chunk, row_first), FS_MEMBER(Chunk, steps),      FS_MEMBER(Chunk, own_lengths),
            FS_MEMBER(Chunk, own_hands), FS_MEMBER(Chunk, stretch)};
}

inline std::vector<Expected> mesh_path_chunk_members() {
    using Chunk = layout::MeshPathChunkParams;
    return {FS_MEMBER(Chunk, first),     FS_MEMBER(Chunk, listed),  FS_MEMBER(Chunk, paths),
            FS_MEMBER(Chunk, row_first), FS_MEMBER(Chunk, rows),    FS_MEMBER(Chunk, step_end),
            FS_MEMBER(Chunk, own_hands), FS_MEMBER(Chunk, pause),   FS_MEMBER(Chunk, limit),
            FS_MEMBER(Chunk, stretch),   FS_MEMBER(Chunk, vertices)};
}

template <typename real> std::vector<Expected> motion_members() {
    using Motion = layout::MotionParams<real>;
    return {FS_MEMBER(Motion, centre_x),     FS_MEMBER(Motion, centre_y),    FS_MEMBER(Motion, centre_z),
            FS_MEMBER(Motion, heading_x),    FS_MEMBER(Motion, heading_y),   FS_MEMBER(Motion, reach),
            FS_MEMBER(Motion, across),       FS_MEMBER(Motion, depth),       FS_MEMBER(Motion, depth_back),
            FS_MEMBER(Motion, lift),         FS_MEMBER(Motion, phase),       FS_MEMBER(Motion, phase_step),
            FS_MEMBER(Motion, radius_phase), FS_MEMBER(Motion, radius_step), FS_MEMBER(Motion, run),
            FS_MEMBER(Motion, turn),         FS_MEMBER(Motion, lines),       FS_MEMBER(Motion, key_low),
            FS_MEMBER(Motion, key_high),     FS_MEMBER(Motion, zero)};
}

template <typename real> std::vector<Expected> harmonic_members() {
    using Harmonic = layout::Harmonic<real>;
    return {FS_MEMBER(Harmonic, amplitude), FS_MEMBER(Harmonic, phase), FS_MEMBER(Harmonic, phase_step)};
}

template <typename real> std::vector<Expected> axis_members() {
    using Axis = layout::AxisMap<real>;
    return {FS_MEMBER(Axis, x_error), FS_MEMBER(Axis, x_speed), FS_MEMBER(Axis, x_force),
            FS_MEMBER(Axis, v_error), FS_MEMBER(Axis, v_speed), FS_MEMBER(Axis, v_force)};
}

template <typename real> std::vector<Expected> hand_members() {
    using Hand = layout::HandParams<real>;
    return {FS_MEMBER(Hand, lateral),     FS_MEMBER(Hand, vertical),  FS_MEMBER(Hand, rate),
            FS_MEMBER(Hand, period),      FS_MEMBER(Hand, stiffness), FS_MEMBER(Hand, stiffness_z),
            FS_MEMBER(Hand, damping),     FS_MEMBER(Hand, push_x),    FS_MEMBER(Hand, push_y),
            FS_MEMBER(Hand, push_z),      FS_MEMBER(Hand, quantum),   FS_MEMBER(Hand, coulomb),
            FS_MEMBER(Hand, max_force),   FS_MEMBER(Hand, gain),      FS_MEMBER(Hand, bound),
            FS_MEMBER(Hand, start_depth), FS_MEMBER(Hand, delay),     FS_MEMBER(Hand, zero)};
}

template <typename real> std::vector<Expected> metrics_members() {
    using Metrics = layout::PathMetrics<real>;
    return {FS_MEMBER(Metrics, largest_force),
            FS_MEMBER(Metrics, force_square),
            FS_MEMBER(Metrics, force_square_rest),
            FS_MEMBER(Metrics, largest_turn),
            FS_MEMBER(Metrics, steepest_turn),
            FS_MEMBER(Metrics, steepest_distance),
            FS_MEMBER(Metrics, least_depth),
            FS_MEMBER(Metrics, largest_depth),
            FS_MEMBER(Metrics, depth),
            FS_MEMBER(Metrics, depth_rest),
            FS_MEMBER(Metrics, depth_square),
            FS_MEMBER(Metrics, depth_square_rest),
            FS_MEMBER(Metrics, work),
            FS_MEMBER(Metrics, work_rest),
            FS_MEMBER(Metrics, effort),
            FS_MEMBER(Metrics, effort_rest),
            FS_MEMBER(Metrics, round_begin),
            FS_MEMBER(Metrics, round_begin_rest),
            FS_MEMBER(Metrics, largest_round),
            FS_MEMBER(Metrics, least_round),
            FS_MEMBER(Metrics, early_speed),
            FS_MEMBER(Metrics, late_speed),
            FS_MEMBER(Metrics, contact_samples),
            FS_MEMBER(Metrics, rounds),
            FS_MEMBER(Metrics, unstable_step),
            FS_MEMBER(Metrics, fell),
            FS_MEMBER(Metrics, unfinished),
            FS_MEMBER(Metrics, zero)};
}

template <typename real> std::vector<Expected> state_members() {
    using State = layout::PathState<real>;
    return {FS_MEMBER(State, x),
            FS_MEMBER(State, y),
            FS_MEMBER(State, z),
            FS_MEMBER(State, speed_x),
            FS_MEMBER(State, speed_y),
            FS_MEMBER(State, speed_z),
            FS_MEMBER(State, measured_x),
            FS_MEMBER(State, measured_y),
            FS_MEMBER(State, measured_z),
            FS_MEMBER(State, force_x),
            FS_MEMBER(State, force_y),
            FS_MEMBER(State, force_z),
            FS_MEMBER(State, anchor_x),
            FS_MEMBER(State, anchor_y),
            FS_MEMBER(State, anchor_z),
            FS_MEMBER(State, anchor_force_x),
            FS_MEMBER(State, anchor_force_y),
            FS_MEMBER(State, anchor_force_z),
            FS_MEMBER(State, steepest),
            FS_MEMBER(State, metrics),
            FS_MEMBER(State, step),
            FS_MEMBER(State, directed)};
}

// A buffer of structs, one after the other as C++ has them.
inline void expect_structs(const SpirvModule& module, std::uint32_t binding, const std::vector<Expected>& members,
                           std::size_t size) {
    const auto buffer = module.members(module.buffer(binding).value());
    ASSERT_EQ(buffer.size(), 1u);
    const auto array = module.array(buffer[0].type);
    ASSERT_TRUE(array) << "binding " << binding;
    EXPECT_EQ(array->stride, size) << "binding " << binding;
    expect_members(module, array->type, members);
}

template <typename real> void expect_path_layout(const SpirvModule& module) {
    const auto law_buffer = module.members(module.buffer(layout::kPathBindLaw).value());
    ASSERT_EQ(law_buffer.size(), 1u);
    expect_members(module, law_buffer[0].type, law_members<real>());
    expect_structs(module, layout::kPathBindMotions, motion_members<real>(), sizeof(layout::MotionParams<real>));
    expect_structs(module, layout::kPathBindHarmonics, harmonic_members<real>(), sizeof(layout::Harmonic<real>));
    expect_structs(module, layout::kPathBindHands, hand_members<real>(), sizeof(layout::HandParams<real>));
    expect_structs(module, layout::kPathBindStates, state_members<real>(), sizeof(layout::PathState<real>));
    const auto hands = module.members(module.buffer(layout::kPathBindHands).value());
    expect_members(module, module.members(module.array(hands[0].type)->type)[0].type, axis_members<real>());
    const auto states = module.members(module.buffer(layout::kPathBindStates).value());
    expect_members(module, module.members(module.array(states[0].type)->type)[19].type, metrics_members<real>());
    const auto push = module.members(module.push_constants().value());
    ASSERT_EQ(push.size(), 1u);
    expect_members(module, push[0].type, path_chunk_members());
}

template <typename real> void expect_mesh_path_layout(const SpirvModule& module) {
    const auto law_buffer = module.members(module.buffer(layout::kMeshPathBindLaw).value());
    ASSERT_EQ(law_buffer.size(), 1u);
    using Params = layout::MeshLawParams<real>;
    expect_members(module, law_buffer[0].type, {FS_MEMBER(Params, law), FS_MEMBER(Params, mesh)});
    const auto params = module.members(law_buffer[0].type);
    expect_members(module, params[0].type, law_members<real>());
    expect_members(module, params[1].type, mesh_members<real>());
    const auto expect_if_there = [&](std::uint32_t binding, const std::vector<Expected>& members, std::size_t size) {
        if (module.bindings().contains(binding))
            expect_structs(module, binding, members, size);
    };
    expect_if_there(layout::kMeshPathBindMotions, motion_members<real>(), sizeof(layout::MotionParams<real>));
    expect_if_there(layout::kMeshPathBindHarmonics, harmonic_members<real>(), sizeof(layout::Harmonic<real>));
    expect_if_there(layout::kMeshPathBindHands, hand_members<real>(), sizeof(layout::HandParams<real>));
    expect_if_there(layout::kMeshPathBindStates, state_members<real>(), sizeof(layout::PathState<real>));
    const auto push = module.members(module.push_constants().value());
    ASSERT_EQ(push.size(), 1u);
    expect_members(module, push[0].type, mesh_path_chunk_members());
}

inline void expect_dense(const SpirvModule& module, std::uint32_t binding) {
    const auto members = module.members(module.buffer(binding).value());
    ASSERT_EQ(members.size(), 1u);
    const auto array = module.array(members[0].type);
    ASSERT_TRUE(array) << "binding " << binding;
    EXPECT_EQ(array->stride, array->element) << "binding " << binding;
}

template <typename real> void expect_arrays(const SpirvModule& module) {
    for (std::uint32_t binding = layout::kBindAxes; binding < layout::kBindCount; ++binding) {
        if (binding == layout::kBindStatus)
            continue;
        const auto members = module.members(module.buffer(binding).value());
        ASSERT_EQ(members.size(), 1u);
        const auto array = module.array(members[0].type);
        ASSERT_TRUE(array) << "binding " << binding;
        // Results are read as dense reals, whatever vectors they are stored as.
        EXPECT_EQ(array->stride, array->element) << "binding " << binding;
        if (binding < layout::kBindStatus) {
            EXPECT_EQ(array->stride, sizeof(real)) << "binding " << binding;
        }
    }
}

} // namespace forceshade::test
