// Exploration paths over analytic surfaces (L1 to L5, L8), open and closed loop. An invocation takes one path through the
// steps of the dispatch; its state lies in registers, between dispatches in a buffer.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "laws/elementary.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX) in;
layout(constant_id = kSpecSurface) const uint SURFACE = kSurfaceBump;
layout(constant_id = kSpecShading) const uint SHADING = kShadingNone;
layout(constant_id = kSpecDepth) const uint DEPTH = kDepthVertical;
layout(constant_id = kSpecReference) const uint REFERENCE = kReferenceNormal;
layout(constant_id = kSpecMap) const uint MAP = kMapNone;
layout(constant_id = kSpecTexture) const uint TEXTURE = kMapNone;
layout(constant_id = kSpecChannels) const uint CHANNELS = 0u;
layout(constant_id = kSpecMotion) const uint MOTION = kMotionStrokes;
layout(constant_id = kSpecLoop) const uint LOOP = kLoopOpen;
layout(constant_id = kSpecFollow) const uint FOLLOW = kFollowPlane;
layout(constant_id = kSpecHarmonics) const uint HARMONICS = 0u;
layout(constant_id = kSpecFriction) const uint FRICTION = 0u;
layout(constant_id = kSpecQuantised) const uint QUANTISED = 0u;
layout(constant_id = kSpecCoupled) const uint COUPLED = 0u;

layout(std430, set = 0, binding = kPathBindLaw) readonly buffer LawBuffer { LawParams law_params; };
layout(std430, set = 0, binding = kPathBindFacetVertices) readonly buffer FacetBuffer { real facet_vertices[]; };
layout(std430, set = 0, binding = kPathBindMapGradients) readonly buffer MapBuffer { real map_gradients[]; };
layout(std430, set = 0, binding = kPathBindTextureGradients) readonly buffer TextureBuffer { real texture_gradients[]; };
layout(std430, set = 0, binding = kPathBindMotions) readonly buffer MotionBuffer { MotionParams motions[]; };
layout(std430, set = 0, binding = kPathBindHarmonics) readonly buffer HarmonicBuffer { Harmonic harmonics[]; };
layout(std430, set = 0, binding = kPathBindHands) readonly buffer HandBuffer { HandParams hands[]; };
layout(std430, set = 0, binding = kPathBindLengths) readonly buffer LengthBuffer { uint lengths[]; };
layout(std430, set = 0, binding = kPathBindRecorded) readonly buffer RecordedBuffer { real recorded[]; };
layout(std430, set = 0, binding = kPathBindStates) buffer StateBuffer { PathState states[]; };
layout(std430, set = 0, binding = kPathBindStatus) buffer StatusBuffer { uint status; };
layout(std430, set = 0, binding = kPathBindPosition) writeonly buffer PositionBuffer { real position_out[]; };
layout(std430, set = 0, binding = kPathBindForce) writeonly buffer ForceBuffer { real force_out[]; };
layout(std430, set = 0, binding = kPathBindDepth) writeonly buffer DepthBuffer { real depth_out[]; };
layout(std430, set = 0, binding = kPathBindFacet) writeonly buffer FacetIdBuffer { uint facet_out[]; };
layout(std430, set = 0, binding = kPathBindProxy) writeonly buffer ProxyBuffer { real proxy_out[]; };
layout(push_constant) uniform Push { PathChunkParams chunk; };

// A copy made before any branch: there a uniform load is one load, within branches it is one a lane.
LawParams law;
// Zero, and unknown to the compiler where a sign of zero may come of it: llvmpipe takes x * 0 for 0 and 0 - x for -x.
real exact_zero;

#include "laws/height_map.glsl"
#include "laws/surfaces.glsl"
#include "laws/contact.glsl"
#define KEPT_HARMONICS 16u
#include "laws/motion.glsl"
#include "laws/path_step.glsl"

// L3 along a path: the facet of the last probe serves until one leaves it. Where no lane's has, a software device goes
// through the search once all the same, without a result, but not through its bisection.

Slope remembered_slope = Slope(ZERO, ZERO, ZERO, ZERO, ZERO, ONE); // holds no x
uint remembered_id = 0u;

// The same as facet_at(x).
Facet remembered_facet_at(real x) {
    bool on_facets = is_on_facets(x);
    bool elsewhere = on_facets && !(x >= remembered_slope.left && x < remembered_slope.right);
    while (elsewhere) {
        remembered_id = facet_index(x, law.facets);
        remembered_slope = slope_of(remembered_id);
        elsewhere = false;
    }
    return Facet(on_facets ? height_on(remembered_slope, x) : exact_zero, on_facets ? remembered_slope.normal_x : exact_zero,
                 on_facets ? remembered_slope.normal_z : ONE, on_facets ? remembered_id : law.facets);
}

// L1 to L5: the nominal surface, m, from which a motion that follows it measures its depth.
real nominal_height(real x) {
    if (SURFACE == kSurfaceBump)
        return remembered_facet_at(x).height;
    if (SURFACE == kSurfaceCylinderBump && abs(x) < law.half_width)
        return cylinder_height(law.half_width, law.radius, law.centre_depth, x);
    return exact_zero;
}

// A place that was measured from the surface below or above it.
real3 above_surface(real3 place) {
    precise real z = place.z + nominal_height(place.x);
    return real3(place.xy, z);
}

// A sample into the channels that are asked for.
void store(uint at, PathSample taken) {
    if ((CHANNELS & kChannelPosition) != 0u)
        STORE_VECTOR(position_out, at, taken.position)
    if ((CHANNELS & kChannelForce) != 0u)
        STORE_VECTOR(force_out, at, taken.force)
    if ((CHANNELS & kChannelDepth) != 0u)
        depth_out[at] = taken.depth;
    if ((CHANNELS & kChannelFacet) != 0u)
        facet_out[at] = taken.facet;
    if ((CHANNELS & kChannelProxy) != 0u)
        STORE_VECTOR(proxy_out, at, taken.proxy)
}

// Where rounds begin and end, m.
real3 round_end_of(MotionParams motion) {
    real3 place = in_world(motion, place_at(motion, 0u), real3(exact_zero));
    return FOLLOW == kFollowSurface ? above_surface(place) : place;
}

// The motion's place at a step, m; a recorded path of `steps` steps rests where it ends.
real3 target_at(MotionParams motion, uint path, uint step, uint steps) {
    if (MOTION == kMotionRecorded) {
        uint row = max(min(step, steps - 1u), chunk.step_first) - chunk.step_first; // one that ended before does not matter
        uint at = 3u * (row * chunk.paths + path);
        return real3(recorded[at], recorded[at + 1u], recorded[at + 2u]);
    }
    real3 place = motion_at(motion, path, chunk.paths, step);
    return FOLLOW == kFollowSurface ? above_surface(place) : place;
}

PathSample sample_at(inout real lag, real3 probe, HandParams hand) {
    Facet plane = Facet(exact_zero, exact_zero, ONE, 0u);
    Facet facet = SURFACE == kSurfaceBump ? remembered_facet_at(probe.x) : plane;
    Contact contact = contact_at(column_over(facet, probe.x, probe.y), probe.y, probe.z);
    real3 force = displayed(lag, hand, contact.force, contact.depth);
    return PathSample(probe, force, contact.depth, contact.proxy, contact.facet);
}

void main() {
    law = law_params;
    exact_zero = real(law.zero);
    least_reach = square_of(real(chunk.stretch));
    uint path = min(gl_GlobalInvocationID.x, chunk.paths - 1u);
    MotionParams motion = motions[MOTION == kMotionRecorded ? 0u : path];
    HandParams hand = hands[chunk.own_hands * path];
    uint steps = chunk.own_lengths != 0u ? lengths[path] : chunk.steps;
    keep_harmonics(path, chunk.paths);
    per_phase_step = quotient(ONE, real(int(motion.phase_step)));
    round_end = round_end_of(motion);
    real3 here = target_at(motion, path, chunk.step_first, steps);
    PathState state = states[path];
    if (chunk.step_first == 0u)
        state = begin_state(hand, here);
    bool idle = gl_GlobalInvocationID.x >= chunk.paths; // fills the last work group
    uint end = idle ? state.step : min(chunk.step_end, steps);
    real3 unit = normalised(real3(state.force_x, state.force_y, state.force_z));
    uint at = path;
    while (state.step < end && !leaves(state, hand, here)) {
        real3 next = target_at(motion, path, state.step + 1u, steps);
        PathSample taken = sample_at(state.lag, probe_at(state, hand, here), hand);
        store(at, taken);
        take_step(state, unit, hand, motion, taken, here, next, true, 0u, steps);
        here = next;
        at += chunk.paths;
    }
    while (LOOP == kLoopClosed && state.step < end) {
        store(at, left_sample(state));
        ++state.step;
        at += chunk.paths;
    }
    if (!idle)
        states[path] = state;
    // A driver that silently ends long loops leaves steps undone. Not "<": compilers know that loops end by it.
    if (state.step != end)
        atomicOr(status, kStatusUnfinished);
}
