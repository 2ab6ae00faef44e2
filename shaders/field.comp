// A force field over a dense grid. An invocation takes LANES neighbouring samples of x in `chunk.rows` rows: what depends
// on (x, y) alone is computed once for them, and stores, the dearest thing on a software device, travel four words at a time.
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#ifdef FS_PACKED
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#endif
#include "laws/elementary.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX) in;
layout(constant_id = kSpecSurface) const uint SURFACE = kSurfaceBump;
layout(constant_id = kSpecShading) const uint SHADING = kShadingNone;
layout(constant_id = kSpecDepth) const uint DEPTH = kDepthVertical;
layout(constant_id = kSpecReference) const uint REFERENCE = kReferenceNormal;
layout(constant_id = kSpecMap) const uint MAP = kMapNone;
layout(constant_id = kSpecTexture) const uint TEXTURE = kMapNone;
layout(constant_id = kSpecChannels) const uint CHANNELS = kChannelForce;

layout(std430, set = 0, binding = kBindLaw) readonly buffer LawBuffer { LawParams law_params; };
layout(std430, set = 0, binding = kBindAxes) readonly buffer AxesBuffer { real axes[]; };
layout(std430, set = 0, binding = kBindFacetVertices) readonly buffer FacetBuffer { real facet_vertices[]; };
layout(std430, set = 0, binding = kBindMapGradients) readonly buffer MapBuffer { real map_gradients[]; };
layout(std430, set = 0, binding = kBindTextureGradients) readonly buffer TextureBuffer { real texture_gradients[]; };
layout(std430, set = 0, binding = kBindStatus) buffer StatusBuffer { uint status; };
layout(push_constant) uniform Push { ChunkParams chunk; };

// A copy made before any branch: there a uniform load is one load, within branches it is one a lane.
LawParams law;
// Zero, and unknown to the compiler where a sign of zero may come of it: llvmpipe takes x * 0 for 0 and 0 - x for -x.
real exact_zero;

#include "laws/height_map.glsl"
#include "laws/surfaces.glsl"
#include "laws/contact.glsl"
#include "stores.glsl"

// Where a column differs from y to y, an invocation's rows are those of one y; else they are neighbours in memory.
const bool ALONG_Z = MAP == kMapGaussian || MAP == kMapSamples || TEXTURE == kMapGaussian || TEXTURE == kMapSamples;

// The rows of one invocation, counted within the chunk.
struct Rows {
    uint y; // of the first
    uint z;
    uint count;
    uint stride; // from one to the next, in rows
};

Rows rows_of(uint part) {
    if (ALONG_Z) {
        uint z = part / chunk.y_count * chunk.rows;
        uint count = z < chunk.z_count ? min(chunk.rows, chunk.z_count - z) : 0u;
        return Rows(part % chunk.y_count, z, count, chunk.y_count);
    }
    uint first = part * chunk.rows;
    uint all = chunk.y_count * chunk.z_count;
    uint count = first < all ? min(chunk.rows, all - first) : 0u;
    return Rows(first % chunk.y_count, first / chunk.y_count, count, 1u);
}

void main() {
    law = law_params;
    exact_zero = TEXTURE == kMapNone && SHADING != kShadingHeightMap ? ZERO : real(law.zero);
    uint blocks = chunk.x_pitch / LANES; // of a row
    uint block = gl_GlobalInvocationID.x % blocks;
    Rows rows = rows_of(gl_GlobalInvocationID.x / blocks);
    if (rows.count == 0u)
        return;
    uint y_axis = chunk.y_axis + chunk.y_first;
    uint z_axis = chunk.z_axis + chunk.z_first + rows.z;
    uint y = rows.y;
    real y_metres = axes[y_axis + y];
    Column columns[LANES];
    // Unrolled, it would be most of the code that a software driver has to compile.
    [[dont_unroll]] for (uint i = 0u; i < LANES; ++i)
        columns[i] = column_at(axes[LANES * block + i], y_metres);
    uint at = (rows.z * chunk.y_count + y) * blocks + block;
    uint done = 0u;
    while (done < rows.count) {
        real z_metres = axes[z_axis++];
        uint end = ALONG_Z ? done + 1u : min(rows.count, done + chunk.y_count - y);
        for (; done < end; ++done) {
            // Only the proxy shows the y of a column that serves for all of them.
            if (!ALONG_Z && (CHANNELS & kChannelProxy) != 0u)
                y_metres = axes[y_axis + y++];
            Contact contacts[LANES];
            for (uint i = 0u; i < LANES; ++i)
                contacts[i] = contact_at(columns[i], y_metres, z_metres);
            store(at, contacts);
            at += rows.stride * blocks;
        }
        y = 0u;
    }
    // A driver that silently ends long loops leaves done behind.
    if (done != rows.count)
        atomicOr(status, kStatusUnfinished);
}
