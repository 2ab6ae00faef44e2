// Updates of god-objects on a mesh, as far as the kernel of paths (mesh_path.comp) leaves them: moves that meet what the
// host could not list, edges, corners, proxies far off. An invocation takes one path through its one update, or as far as
// its loops may go: the rest comes with the next dispatch. An update that ends at an edge or a corner is left, as it
// began, to the host.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "laws/elementary.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX) in;

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
#define POOL kMeshPool
#include "laws/mesh_triangle.glsl"
#include "laws/god_object.glsl"

// What a walk that goes on with the next dispatch must know.
void put_walk(uint path) {
    put_walk_word(path, kWalkWordSubsteps, walk_substeps);
    put_walk_word(path, kWalkWordTread, tread_substeps);
    put_walk_word(path, kWalkWordPool, pool_count | pool_faceless << kPoolFaceless);
    [[unroll]] for (uint i = 0u; i < POOL; ++i)
        put_walk_word(path, kWalkWordPooled + i, pool_index[i]);
    put_walk_real3(path, kWalkRealAt, walk_proxy);
    put_walk_real3(path, kWalkRealTread, tread_place);
}

void take_walk(uint path) {
    walk_proxy = walk_real3(path, kWalkRealAt);
    walk_substeps = walk_word(path, kWalkWordSubsteps);
    walk_corner = false;
    walk_rests = false;
    walk_runs = true;
    tread_place = walk_real3(path, kWalkRealTread);
    tread_substeps = walk_word(path, kWalkWordTread);
    uint word = walk_word(path, kWalkWordPool);
    forget_all();
    uint count = word & kPoolCount;
    [[dont_unroll]] do {
        if (pool_count < count) {
            uint triangle = walk_word(path, kWalkWordPooled + pool_count);
            remember(triangle, triangle_at(triangle), POOL);
        }
        ++spent;
    } while (pool_count < count);
    pool_faceless = word >> kPoolFaceless;
}

void put_rest(uint path, Rest rest) {
    uint bits = (rest.count > 0u ? kHeldTouching : 0u) | (rest.back ? kHeldBack : 0u);
    put_walk_word(path, kWalkWordPhase, kPhaseFelt);
    put_walk_word(path, kWalkWordHeld, rest.count | bits);
    put_walk_triangles(path, rest.triangles);
    put_walk_word(path, kWalkWordFelt, rest.triangles.x);
    put_walk_real3(path, kWalkRealProxy, walk_proxy);
    put_walk_real3(path, kWalkRealRest, rest.proxy);
    // The next steps of a probe in the open most likely meet nothing either.
    if (rest.count == 0u) {
        put_walk_real3(path, kWalkRealFree, walk_proxy);
        walk_reals[kWalkRealReach * chunk.paths + path] = free_reach(walk_proxy);
    }
}

void main() {
    exact_zero = real(law_params.mesh.zero);
    spent = 0u;
    spent_limit = chunk.limit;
    overrun = false;
    is_rare = false;
    uint pause = chunk.pause;
    uint path = listed_path();
    if (path == kNoPath)
        return;
    uint held = walk_word(path, kWalkWordHeld);
    uvec3 triangles = walk_triangles(path);
    real3 probe = walk_real3(path, kWalkRealProbe);
    if (!is_finite(probe)) { // changes nothing and is out of contact
        put_walk_word(path, kWalkWordPhase, kPhaseFelt);
        put_walk_real3(path, kWalkRealRest, probe);
        return;
    }
    if (walk_word(path, kWalkWordStage) == kStageBegin)
        begin_update(walk_real3(path, kWalkRealProxy), probe, held, triangles);
    else {
        walk_probe = probe;
        take_walk(path);
    }
    bool going = walk_runs;
    [[dont_unroll]] do {
        if (going) {
            walk_on();
            going = walk_runs && !overrun && spent < pause;
        }
    } while (going);
    // A driver that silently ends long loops leaves a lane going.
    if (going)
        atomicOr(walk_words[kWalkWordCount * chunk.paths], kStatusUnfinished);
    // What does not come to rest on faces alone may go on, which the host finds out.
    bool ends = !walk_runs && !overrun;
    bool on_faces = ends && (resting.count == 0u || (walk_rests && !is_doubtful())) && walk_substeps < kSubsteps;
    Rest rest = out_of_contact(walk_probe);
    if (on_faces)
        rest = contact_at_rest();
    if (on_faces && !overrun)
        put_rest(path, rest);
    else if (ends && !on_faces)
        put_walk_word(path, kWalkWordPhase, kPhaseHost);
    else if (!overrun) {
        put_walk(path);
        put_walk_word(path, kWalkWordStage, kStageWalk);
    }
    if (overrun)
        put_walk_word(path, kWalkWordPhase, walk_word(path, kWalkWordPhase) == kPhaseAlone ? kPhaseHost : kPhaseAlone);
    if (ends || overrun)
        put_walk_word(path, kWalkWordStage, kStageBegin);
}
