// The force field of a mesh over a dense grid. An invocation takes one block of 2^3 samples and the candidates that the
// host found for it: a candidate is loaded once for eight samples, and most of what they compute of it they share.
// Samples of blocks that are not listed are out of contact: the host fills them, but for their proxies (FREE).
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "laws/elementary.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX) in;
layout(constant_id = kSpecShading) const uint SHADING = kShadingNone;
layout(constant_id = kSpecInside) const uint INSIDE = kInsidePseudonormal;
layout(constant_id = kSpecMap) const uint MAP = kMapNone;
layout(constant_id = kSpecTexture) const uint TEXTURE = kMapNone;
layout(constant_id = kSpecChannels) const uint CHANNELS = kChannelForce;
layout(constant_id = kSpecFree) const uint FREE = 0u;
layout(constant_id = kSpecUnroll) const uint UNROLL = 1u;

layout(std430, set = 0, binding = kMeshBindLaw) readonly buffer LawBuffer { MeshLawParams law_params; };
layout(std430, set = 0, binding = kMeshBindAxes) readonly buffer AxesBuffer { real axes[]; };
layout(std430, set = 0, binding = kMeshBindMapGradients) readonly buffer MapBuffer { real map_gradients[]; };
layout(std430, set = 0, binding = kMeshBindTextureGradients) readonly buffer TextureBuffer { real texture_gradients[]; };
layout(std430, set = 0, binding = kMeshBindRecords) readonly buffer RecordBuffer { real4 records[]; };
layout(std430, set = 0, binding = kMeshBindTriangles) readonly buffer TriangleBuffer { uvec4 triangle_words[]; };
layout(std430, set = 0, binding = kMeshBindVertices) readonly buffer VertexBuffer { real4 vertices[]; };
layout(std430, set = 0, binding = kMeshBindNormals) readonly buffer NormalBuffer { real4 normals[]; };
layout(std430, set = 0, binding = kMeshBindFacets) readonly buffer FacetBuffer { uint facet_words[]; };
layout(std430, set = 0, binding = kMeshBindPlan) readonly buffer PlanBuffer { uint plan[]; };
layout(std430, set = 0, binding = kMeshBindStatus) buffer StatusBuffer { uint status; };
layout(std430, set = 0, binding = kMeshBindForce) writeonly buffer ForceBuffer { real force_out[]; };
layout(std430, set = 0, binding = kMeshBindDepth) writeonly buffer DepthBuffer { real depth_out[]; };
layout(std430, set = 0, binding = kMeshBindFacet) writeonly buffer FacetIdBuffer { uint facet_out[]; };
layout(std430, set = 0, binding = kMeshBindProxy) writeonly buffer ProxyBuffer { real proxy_out[]; };
layout(std430, set = 0, binding = kMeshBindUnshaded) writeonly buffer UnshadedBuffer { real unshaded_out[]; };
layout(push_constant) uniform Push { MeshChunkParams chunk; };

// Copies made before any branch: there a uniform load is one load, within branches it is one a lane.
LawParams law;
MeshParams mesh;
// Zero, and unknown to the compiler where a sign of zero may come of it: llvmpipe takes x * 0 for 0 and 0 - x for -x.
real exact_zero;

const uint kNoCandidate = 0xFFFFFFFFu;
#ifdef FS_F64
#define INFINITY packDouble2x32(uvec2(0u, 0x7FF00000u))
#else
#define INFINITY uintBitsToFloat(0x7F800000u)
#endif

#include "laws/height_map.glsl"
#include "laws/mesh_triangle.glsl"
#include "laws/mesh_nearest.glsl"
#include "laws/mesh_contact.glsl"

// L6 static: whether a probe is inside, and its contact, once the nearest triangle is known, step for step as
// host/reference/mesh_nearest.h.

// The pseudonormal of the feature points away from the probe.
bool inside_by_pseudonormal(MeshTriangle triangle, real3 normal, TrianglePoint point) {
    real3 outward = normal;
    if (point.feature >= kMeshCorner)
        outward = vertex_pseudonormal(triangle.corners[point.feature - kMeshCorner]);
    else if (point.feature >= kMeshEdge) {
        uint across = triangle.neighbours[point.feature - kMeshEdge];
        if (across != kMeshBorder && (across & kMeshManyBit) != 0u)
            outward = edge_pseudonormal(across & ~kMeshManyBit);
        else if (across != kMeshBorder)
            outward = sum(normal, neighbour_normal(across));
    }
    return product(point.offset, outward) > ZERO;
}

// The contact with the nearest of the candidates; `inside` by the winding number.
Contact contact_at(real3 probe, uint candidate, bool inside) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), to_scene(probe), kNoFacet);
    if (candidate == kNoCandidate)
        return contact;
    MeshTriangle triangle = mesh_triangle(candidate >> kMeshCandidateShift);
    Triangle shape = triangle_shape(candidate);
    TrianglePoint point = nearest_on_triangle(probe, shape);
    if (INSIDE == kInsidePseudonormal)
        inside = inside_by_pseudonormal(triangle, shape.normal, point);
    if (!inside)
        return contact;
    precise real size = root(point.square);
    return touching_contact(MeshTouch(triangle.facet, point.offset, sum(probe, point.offset), size));
}

void store(uint at, Contact contact) {
    if ((CHANNELS & kChannelForce) != 0u)
        STORE_VECTOR(force_out, at, contact.force)
    if ((CHANNELS & kChannelDepth) != 0u)
        depth_out[at] = contact.depth;
    if ((CHANNELS & kChannelFacet) != 0u)
        facet_out[at] = contact.facet;
    if ((CHANNELS & kChannelProxy) != 0u)
        STORE_VECTOR(proxy_out, at, contact.proxy)
    if ((CHANNELS & kChannelUnshaded) != 0u)
        STORE_VECTOR(unshaded_out, at, contact.unshaded)
}

// The coordinates of two neighbouring samples; the last one twice where there is no second.
real2 coordinates(uint axis, uint first, uint count) {
    return real2(axes[axis + first], axes[axis + min(first + 1u, count - 1u)]);
}

// One sample of a free block, of every sample of the chunk.
void store_free_proxy(uint at) {
    uint row = at / chunk.x_pitch;
    if (row >= chunk.y_count * chunk.z_count)
        return;
    real3 probe = real3(axes[at % chunk.x_pitch], axes[chunk.y_axis + chunk.y_first + row % chunk.y_count],
                        axes[chunk.z_axis + chunk.z_first + row / chunk.y_count]);
    real3 proxy = to_scene(probe);
    STORE_VECTOR(proxy_out, at, proxy)
}

Winners search(uint first, uint count, Points probes) {
    Winners winners = Winners(Eight(real4(INFINITY), real4(INFINITY)), uvec4(kNoCandidate), uvec4(kNoCandidate));
    uint left = count;
    for (uint at = first; at != first + count; ++at) {
        --left;
        uint candidate = plan[at];
        uint record = 3u * (candidate >> kMeshCandidateShift);
        consider(candidate, records[record], records[record + 1u], records[record + 2u], probes, winners);
    }
    // A driver that silently ends long loops leaves some. Not "at": compilers know where loops end by it.
    if (left != 0u)
        atomicOr(status, kStatusUnfinished);
    return winners;
}

void main() {
    law = law_params.law;
    mesh = law_params.mesh;
    exact_zero = real(mesh.zero);
    uint item = gl_GlobalInvocationID.x;
    if (FREE != 0u) {
        store_free_proxy(item);
        return;
    }
    if (item >= chunk.blocks)
        return;
    uint words = kMeshBlockWords * item;
    uint x = plan[words];
    uint y = plan[words + 1u];
    uint z = plan[words + 2u];
    uint inside = plan[words + 5u] & 0xFFu;
    uint wanted = plan[words + 5u] >> 8;
    Points probes = Points(coordinates(0u, x, chunk.x_pitch), coordinates(chunk.y_axis + chunk.y_first, y, chunk.y_count),
                           coordinates(chunk.z_axis + chunk.z_first, z, chunk.z_count));
    Winners winners = search(chunk.candidates + plan[words + 3u], plan[words + 4u], probes);
    uint done = 0u;
    [[dont_unroll]] for (; done < 8u; ++done) {
        bvec3 second = bvec3((done & 1u) != 0u, (done & 2u) != 0u, (done & 4u) != 0u);
        if ((wanted >> done & 1u) == 0u || (second.y && y + 1u >= chunk.y_count) || (second.z && z + 1u >= chunk.z_count))
            continue;
        real3 probe = real3(second.x ? probes.x.y : probes.x.x, second.y ? probes.y.y : probes.y.x,
                            second.z ? probes.z.y : probes.z.x);
        uint winner = second.z ? winners.second[done & 3u] : winners.first[done & 3u];
        Contact contact = contact_at(probe, winner, (inside >> done & 1u) != 0u);
        uint row = (z + (second.z ? 1u : 0u)) * chunk.y_count + y + (second.y ? 1u : 0u);
        store(row * chunk.x_pitch + x + (second.x ? 1u : 0u), contact);
    }
}
