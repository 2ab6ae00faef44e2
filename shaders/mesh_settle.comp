// Updates of god-objects on a mesh that come to rest at edges and corners, as the kernel of walks (mesh_rest.comp) leaves
// them, or that begin there: tries the ways that lead on until none comes closer. An invocation takes one path through
// its one update, or as far as its loops may go: the rest comes with the next dispatch.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "laws/real.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kMeshPathSpecLocalX) in;

struct MeshNode4 {
    vec4 low_x;
    vec4 low_y;
    vec4 low_z;
    vec4 high_x;
    vec4 high_y;
    vec4 high_z;
    uvec4 child;
};
layout(std430, set = 0, binding = kMeshPathBindNodes) readonly buffer NodeBuffer { MeshNode4 nodes[]; };

#define FS_RARE
#define FS_SETTLE
#define POOL kMeshPool
#include "laws/vector.glsl"
#include "laws/mesh_triangle.glsl"
#include "laws/god_object.glsl"
#include "laws/mesh_path_walk.glsl"

uvec3 walk_word3(uint path, uint field) {
    return uvec3(walk_word(path, field), walk_word(path, field + 1u), walk_word(path, field + 2u));
}

void put_walk_word3(uint path, uint field, uvec3 values) {
    put_walk_word(path, field, values.x);
    put_walk_word(path, field + 1u, values.y);
    put_walk_word(path, field + 2u, values.z);
}

// The rest that an update begins with, or that its walk came to.
void take_rest(uint path, bool begins) {
    uint bits = walk_word(path, kWalkWordSettling);
    walk_proxy = walk_real3(path, begins ? kWalkRealProxy : kWalkRealAt);
    walk_substeps = begins ? 0u : walk_word(path, kWalkWordSubsteps);
    now.proxy = walk_proxy;
    now.triangles = walk_word3(path, begins ? kWalkWordTriangles : kWalkWordBefore);
    now.count = begins ? walk_word(path, kWalkWordHeld) & kHeldCount : bits_at(bits >> kSettlingCount, 0u, 2u);
    now.cornered = true;
    now.front = true;
    before = now;
    found = out_of_contact(walk_proxy);
    felt = found;
    halted = !begins && bits_at(bits, kSettlingHalted, 1u) != 0u;
    rounds = 0u;
    trying = kTryNothing;
    both_sides = false;
    doing = kDoHold;
}

void put_settling(uint path) {
    uint bits = before.count << kSettlingCount | felt.count << kSettlingContact |
                (felt.back ? 1u : 0u) << kSettlingBack | (before.front ? 1u : 0u) << kSettlingFront |
                (halted ? 1u : 0u) << kSettlingHalted | (crossing.corner ? 1u : 0u) << kSettlingCorner |
                trying << kSettlingTrying | (jumps ? 1u : 0u) << kSettlingJump |
                (jumps_over ? 1u : 0u) << kSettlingOver;
    put_walk_word(path, kWalkWordStage, kStageSettle);
    put_walk_word(path, kWalkWordSettling, bits);
    put_walk_word(path, kWalkWordRounds, rounds);
    put_walk_word(path, kWalkWordVertex, crossing.vertex);
    put_walk_word(path, kWalkWordWay, way.triangle);
    put_walk_word(path, kWalkWordTried, ways_tried << kTriedWays | strides_tried << kTriedStrides |
                                            (lifted ? 1u : 0u) << kTriedLifted | way.edge << kTriedEdge);
    put_walk_word3(path, kWalkWordBefore, before.triangles);
    put_walk_word3(path, kWalkWordContact, felt.triangles);
    put_walk_real3(path, kWalkRealBefore, before.proxy);
    put_walk_real3(path, kWalkRealContact, felt.proxy);
    put_walk_real3(path, kWalkRealFrom, crossing.place);
    put_walk_real3(path, kWalkRealOut, crossing.out_way);
    put_walk_real3(path, kWalkRealThere, way_goal);
    put_walk_real3(path, kWalkRealTo, jump_goal);
    walk_reals[kWalkRealGain * chunk.paths + path] = way.gain;
}

void take_settling(uint path) {
    uint bits = walk_word(path, kWalkWordSettling);
    uint tried = walk_word(path, kWalkWordTried);
    before = Kept(walk_real3(path, kWalkRealBefore), walk_word3(path, kWalkWordBefore), bits_at(bits >> kSettlingCount, 0u, 2u),
                  true, bits_at(bits, kSettlingFront, 1u) != 0u);
    now = before;
    felt = out_of_contact(walk_real3(path, kWalkRealContact));
    felt.triangles = walk_word3(path, kWalkWordContact);
    felt.count = bits_at(bits >> kSettlingContact, 0u, 2u);
    felt.back = bits_at(bits, kSettlingBack, 1u) != 0u;
    found = felt;
    halted = bits_at(bits, kSettlingHalted, 1u) != 0u;
    rounds = walk_word(path, kWalkWordRounds);
    trying = bits_at(bits >> kSettlingTrying, 0u, 2u);
    bool corner = bits_at(bits, kSettlingCorner, 1u) != 0u;
    crossing = Crossing(walk_real3(path, kWalkRealFrom), reach_of(corner), walk_real3(path, kWalkRealOut), corner,
                        walk_word(path, kWalkWordVertex));
    way = Way(walk_reals[kWalkRealGain * chunk.paths + path], walk_word(path, kWalkWordWay),
              bits_at(tried >> kTriedEdge, 0u, 4u));
    ways_tried = bits_at(tried >> kTriedWays, 0u, 4u);
    strides_tried = bits_at(tried >> kTriedStrides, 0u, 4u);
    lifted = bits_at(tried, kTriedLifted, 1u) != 0u;
    way_goal = walk_real3(path, kWalkRealThere);
    jump_goal = walk_real3(path, kWalkRealTo);
    jumps = bits_at(bits, kSettlingJump, 1u) != 0u;
    jumps_over = bits_at(bits, kSettlingOver, 1u) != 0u;
    both_sides = false;
    doing = kDoWalk;
    take_walk(path);
}

void put_settled(uint path) {
    bool cornered = before.cornered;
    uint count = cornered ? before.count : felt.count;
    uvec3 triangles = uvec3(cornered ? before.triangles.x : felt.triangles.x, cornered ? before.triangles.y : felt.triangles.y,
                            cornered ? before.triangles.z : felt.triangles.z);
    put_walk_word(path, kWalkWordPhase, kPhaseFelt);
    put_walk_word(path, kWalkWordStage, kStageBegin);
    put_walk_word(path, kWalkWordHeld, count | (cornered ? kHeldCornered : 0u) | (felt.count > 0u ? kHeldTouching : 0u) |
                                           (felt.back ? kHeldBack : 0u));
    put_walk_triangles(path, triangles);
    put_walk_word(path, kWalkWordFelt, felt.count > 0u ? felt.triangles.x : 0u);
    put_walk_real3(path, kWalkRealProxy, before.proxy);
    put_walk_real3(path, kWalkRealRest, felt.proxy);
}

void main() {
    exact_zero = real(law_params.mesh.zero);
    corner_words = 2u * law_params.mesh.triangles;
    vertex_begin = chunk.vertices;
    vertex_vectors = chunk.vertex_vectors;
    spent = 0u;
    spent_limit = chunk.limit;
    overrun = false;
    is_rare = false;
    near_count = 0u;
    near_crowded = false;
    jumps = false;
    jumps_over = false;
    uint pause = chunk.pause;
    uint path = listed_path();
    if (path == kNoPath)
        return;
    walk_probe = walk_real3(path, kWalkRealProbe);
    if (!is_finite(walk_probe)) { // changes nothing and is out of contact
        put_walk_word(path, kWalkWordPhase, kPhaseFelt);
        put_walk_real3(path, kWalkRealRest, walk_probe);
        return;
    }
    uint stage = walk_word(path, kWalkWordStage);
    forget_all();
    take_rest(path, stage == kStageBegin);
    if (stage == kStageSettle)
        take_settling(path);
    bool going = true;
    [[dont_unroll]] do {
        bool looking = going && doing < kDoWalk;
        [[dont_unroll]] do {
            if (looking)
                look_on();
            looking = looking && doing < kDoWalk && !overrun;
        } while (looking);
        bool walking = going && doing == kDoWalk && !overrun;
        [[dont_unroll]] do {
            if (walking)
                walk_or_jump();
            walking = walking && doing == kDoWalk && !overrun && spent < pause;
        } while (walking);
        going = going && !overrun && (doing < kDoWalk || (doing == kDoWalk && spent < pause));
    } while (going);
    // A driver that silently ends long loops leaves a lane going.
    if (going)
        atomicOr(walk_words[kWalkWordCount * chunk.paths], kStatusUnfinished);
    bool alone = walk_word(path, kWalkWordPhase) == kPhaseSettleAlone;
    if (overrun)
        put_walk_word(path, kWalkWordPhase, alone ? kPhaseHost : kPhaseSettleAlone);
    else if (doing == kDoHost)
        put_walk_word(path, kWalkWordPhase, kPhaseHost);
    else if (doing == kDoEnd)
        put_settled(path);
    else {
        put_walk_word(path, kWalkWordPhase, kPhaseSettle);
        put_walk(path);
        put_settling(path);
    }
}
