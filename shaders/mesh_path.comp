// Exploration paths on a mesh: an invocation takes one path through many steps. Here stands what most steps need: a proxy
// that slides over faces, none in its way but those that the host listed, and rests on one or two of them. A step that
// needs more is left, as it began, to the host, which finds its contact.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "laws/elementary.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX) in;
layout(constant_id = kSpecShading) const uint SHADING = kShadingNone;
layout(constant_id = kSpecMap) const uint MAP = kMapNone;
layout(constant_id = kSpecTexture) const uint TEXTURE = kMapNone;
layout(constant_id = kSpecChannels) const uint CHANNELS = 0u;
layout(constant_id = kSpecMotion) const uint MOTION = kMotionStrokes;
layout(constant_id = kSpecLoop) const uint LOOP = kLoopOpen;
layout(constant_id = kSpecHarmonics) const uint HARMONICS = 0u;
layout(constant_id = kSpecFriction) const uint FRICTION = 0u;
layout(constant_id = kSpecQuantised) const uint QUANTISED = 0u;
layout(constant_id = kSpecCoupled) const uint COUPLED = 0u;
layout(constant_id = kSpecUnroll) const uint UNROLL = 1u;

layout(std430, set = 0, binding = kMeshPathBindMapGradients) readonly buffer MapBuffer { real map_gradients[]; };
layout(std430, set = 0, binding = kMeshPathBindTextureGradients) readonly buffer TextureBuffer { real texture_gradients[]; };
layout(std430, set = 0, binding = kMeshPathBindMotions) readonly buffer MotionBuffer { MotionParams motions[]; };
layout(std430, set = 0, binding = kMeshPathBindHarmonics) readonly buffer HarmonicBuffer { Harmonic harmonics[]; };
layout(std430, set = 0, binding = kMeshPathBindHands) readonly buffer HandBuffer { HandParams hands[]; };
layout(std430, set = 0, binding = kMeshPathBindRecorded) readonly buffer RecordedBuffer { real recorded[]; };
layout(std430, set = 0, binding = kMeshPathBindStates) buffer StateBuffer { PathState states[]; };
layout(std430, set = 0, binding = kMeshPathBindSamples) writeonly buffer SampleBuffer { real sample_out[]; };
layout(std430, set = 0, binding = kMeshPathBindFacet) writeonly buffer FacetIdBuffer { uint facet_out[]; };

// Copies made before any branch: there a uniform load is one load, within branches it is one a lane.
LawParams law;
MeshParams mesh;

#include "laws/mesh_triangle.glsl"
#include "laws/god_object.glsl"
#include "laws/height_map.glsl"

// What mesh_contact.glsl reads.
#define facet_words indices
#define status walk_words[kWalkWordCount * chunk.paths]

real3 facet_normal(uint facet) {
    return vectors[3u * mesh.triangles + facet].xyz;
}

real3 vertex_position(uint vertex) {
    return vectors[chunk.vertices + 2u * vertex].xyz;
}

real3 vertex_normal(uint vertex) {
    return vectors[chunk.vertices + 2u * vertex + 1u].xyz;
}

#include "laws/mesh_contact.glsl"
#define Stretch MotionStretch
#include "laws/motion.glsl"
#undef Stretch
#include "laws/path_step.glsl"

// L7 to L9 on the god-object's contact (L6), step for step as host/reference/god_object.h.

// The force on a probe (in the mesh's frame) that a god-object holds. The facet shaded is the lowest of those that hold
// it; seen from behind, its interpolated normal is reversed.
Contact force_of(Rest rest, real3 probe) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), to_scene(probe), kNoFacet);
    if (rest.count == 0u)
        return contact;
    real3 offset = difference(rest.proxy, probe);
    precise real size = root(product(offset, offset));
    MeshTouch touch = MeshTouch(rest.facets.x, offset, rest.proxy, size);
    real3 pull = scaled(mesh.stiffness, offset);
    precise real depth = size * mesh.scale;
    contact.depth = depth;
    contact.facet = touch.facet;
    contact.proxy = to_scene(rest.proxy);
    contact.unshaded = pull;
    real3 shaded = shaded_force(touch, rest.back ? -pull : pull);
    contact.force = shaded;
    if (TEXTURE != kMapNone) {
        real2 place = map_place(rest.proxy);
        real3 slope = in_plane(texture_gradient(place.x, place.y), facet_normal(touch.facet));
        precise real tug = law.texture_stiffness * depth;
        contact.force = difference(contact.force, scaled(tug, slope));
        contact.unshaded = difference(contact.unshaded, scaled(tug, slope));
    }
    if (rest.back)
        contact.force = difference(difference(contact.unshaded, pull), shaded);
    return contact;
}

// One after the other in the buffer of samples, those that are asked for.
const uint kPositionWidth = (CHANNELS & kChannelPosition) != 0u ? 3u : 0u;
const uint kForceWidth = (CHANNELS & kChannelForce) != 0u ? 3u : 0u;
const uint kDepthWidth = (CHANNELS & kChannelDepth) != 0u ? 1u : 0u;

void store_vector(uint at, real3 value) {
    sample_out[at] = value.x;
    sample_out[at + 1u] = value.y;
    sample_out[at + 2u] = value.z;
}

void store(uint path, uint step, PathSample taken) {
    uint samples = chunk.rows * chunk.paths;
    uint at = (step - chunk.row_first) * chunk.paths + path;
    if ((CHANNELS & kChannelPosition) != 0u)
        store_vector(3u * at, taken.position);
    if ((CHANNELS & kChannelForce) != 0u)
        store_vector(kPositionWidth * samples + 3u * at, taken.force);
    if ((CHANNELS & kChannelDepth) != 0u)
        sample_out[(kPositionWidth + kForceWidth) * samples + at] = taken.depth;
    if ((CHANNELS & kChannelProxy) != 0u)
        store_vector((kPositionWidth + kForceWidth + kDepthWidth) * samples + 3u * at, taken.proxy);
    if ((CHANNELS & kChannelFacet) != 0u)
        facet_out[at] = taken.facet;
}

// The motion's place at a step, m; a recorded path of `steps` steps rests where it ends.
real3 target_at(MotionParams motion, uint path, uint step, uint steps) {
    if (MOTION == kMotionRecorded) {
        uint row = max(min(step, steps - 1u), chunk.row_first) - chunk.row_first; // one that ended before does not matter
        uint at = 3u * (row * chunk.paths + path);
        return real3(recorded[at], recorded[at + 1u], recorded[at + 2u]);
    }
    return motion_at(motion, path, chunk.paths, step);
}

real3 to_mesh(real3 place) {
    return divided(difference(place, real3(mesh.centre_x, mesh.centre_y, mesh.centre_z)), mesh.scale);
}

// Hash of the walk, and of the triangles that hold the proxy.
uint trail_of(Rest rest) {
    uint trail = walk_trail;
    trail = rest.count > 0u ? hashed(trail, rest.triangles.x) : trail;
    return rest.count > 1u ? hashed(trail, rest.triangles.y) : trail;
}

// Whether a step begins with what the host takes.
bool begins_left(uint constraints, real3 probe) {
    return (constraints & kConstraintCornered) != 0u || !is_finite(probe);
}

PathSample sample_of(inout real lag, Rest rest, HandParams hand, real3 position, real3 probe) {
    Contact contact = force_of(rest, probe);
    real3 force = displayed(lag, hand, contact.force, contact.depth);
    bool free = contact.facet == kNoFacet; // not there and back through the mesh's frame
    real3 proxy = real3(free ? position.x : contact.proxy.x, free ? position.y : contact.proxy.y,
                        free ? position.z : contact.proxy.z);
    return PathSample(position, force, contact.depth, proxy, contact.facet);
}

void main() {
    law = law_params.law;
    mesh = law_params.mesh;
    exact_zero = real(mesh.zero);
    least_reach = square_of(real(chunk.stretch));
    uint pause = chunk.pause;
    spent = 0u;
    is_left = false;
    uint path = listed_path();
    if (path == kNoPath)
        return;
    uint steps = walk_word(path, kWalkWordSteps);
    uint end = min(chunk.step_end, steps);
    MotionParams motion = motions[MOTION == kMotionRecorded ? 0u : path];
    HandParams hand = hands[chunk.own_hands * path];
    per_phase_step = quotient(ONE, real(int(motion.phase_step)));
    round_end = in_world(motion, place_at(motion, 0u), real3(exact_zero));
    PathState state = states[path];
    real3 here = target_at(motion, path, walk_word(path, kWalkWordStep), steps);
    if (walk_word(path, kWalkWordStep) == 0u && walk_word(path, kWalkWordPhase) == kPhaseStep)
        state = begin_state(hand, here);
    real3 unit = normalised(real3(state.force_x, state.force_y, state.force_z));
    bool left = leaves(state, hand, here);
    real3 position = probe_at(state, hand, here);
    real3 probe = to_mesh(position);

    uint constraints = walk_word(path, kWalkWordConstraints);
    uvec3 triangles = walk_triangles(path);
    real3 proxy = walk_real3(path, kWalkRealProxy);
    free_place = walk_real3(path, kWalkRealFree);
    free_distance = walk_reals[kWalkRealReach * chunk.paths + path];
    begin_update(proxy, probe, constraints & kConstraintCount, triangles);
    bool found = walk_word(path, kWalkWordPhase) == kPhaseContact;
    Rest rest = out_of_contact(walk_real3(path, kWalkRealContact));
    rest.count = (constraints & kContactTouching) != 0u ? 1u : 0u;
    rest.facets.x = triangle_words[2u * walk_word(path, kWalkWordContact)].x;
    rest.sources = uvec2(0u, 1u);
    rest.back = (constraints & kContactBack) != 0u;
    is_left = !found && !left && (is_left || begins_left(constraints, probe));
    bool going = !is_left, complete = false;
    [[dont_unroll]] do {
        complete = found || left;
        if (!complete) {
            walk_on();
            is_left = is_left || (!walk_runs && !walk_rests) || spent > chunk.limit;
            if (walk_rests)
                rest = contact_at_rest();
            complete = walk_rests && !is_left;
        }
        if (complete) {
            PathSample taken = sample_of(state.lag, rest, hand, position, probe);
            if (left)
                taken = left_sample(state);
            store(path, state.step, taken);
            real3 next = target_at(motion, path, state.step + 1u, steps);
            if (left)
                ++state.step;
            else
                take_step(state, unit, hand, motion, taken, here, next, (constraints & kContactUnfinished) == 0u,
                          found ? walk_word(path, kWalkWordTrail) : trail_of(rest), steps);
            here = next;
            if (state.step < steps)
                left = leaves(state, hand, here);
            if (!found) {
                proxy = walk_proxy;
                constraints = rest.count;
                triangles.xy = rest.triangles;
            }
            found = false;
            constraints &= kConstraintCount | kConstraintCornered;
            position = probe_at(state, hand, here);
            probe = to_mesh(position);
            go_on(constraints & kConstraintCount, rest.sources, probe);
            is_left = !left && (is_left || begins_left(constraints, probe));
        }
        // Not within a step, if it can be helped: it would begin anew.
        going = !is_left && state.step < end && (spent < pause || (!complete && spent < 2u * pause));
        ++spent;
    } while (going);
    // A driver that silently ends long loops leaves a lane going. Not "going": compilers know that the loop ends by it.
    if (!is_left && state.step < end && (spent <= pause || (!complete && spent <= 2u * pause)))
        atomicOr(status, kStatusUnfinished);
    bool begun = is_left || (walk_substeps > 0u && !left);
    put_walk_word(path, kWalkWordPhase, begun && state.step < end ? kPhaseHost : kPhaseStep);
    put_walk_word(path, kWalkWordStep, state.step);
    put_walk_word(path, kWalkWordConstraints, constraints);
    put_walk_triangles(path, triangles);
    put_walk_real3(path, kWalkRealProxy, proxy);
    put_walk_real3(path, kWalkRealProbe, probe);
    states[path] = state;
}
