// A force field over a dense grid: one invocation evaluates two neighbouring x and LAYERS z samples above them.
// Stores are the dearest thing here, so with FS_PACKED two reals travel in one 64-bit store where the device has such integers.
#version 450
#extension GL_GOOGLE_include_directive : require
#ifdef FS_PACKED
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#endif
#include "laws/real.glsl"
#include "shared/layout.h"

layout(local_size_x_id = kSpecLocalX, local_size_y_id = kSpecLocalY) in;
layout(constant_id = kSpecSurface) const uint SURFACE = kSurfaceBump;
layout(constant_id = kSpecShading) const uint SHADING = kShadingNone;
layout(constant_id = kSpecDepth) const uint DEPTH = kDepthVertical;
layout(constant_id = kSpecReference) const uint REFERENCE = kReferenceNormal;
layout(constant_id = kSpecMap) const uint MAP = kMapNone;
layout(constant_id = kSpecTexture) const uint TEXTURE = kMapNone;
layout(constant_id = kSpecChannels) const uint CHANNELS = kChannelForce;
layout(constant_id = kSpecLayers) const uint LAYERS = 16;

layout(std430, set = 0, binding = kBindLaw) readonly buffer LawBuffer { LawParams law; };
layout(std430, set = 0, binding = kBindAxes) readonly buffer AxesBuffer { real axes[]; };
layout(std430, set = 0, binding = kBindFacetVertices) readonly buffer FacetBuffer { real facet_vertices[]; };
layout(std430, set = 0, binding = kBindMapGradients) readonly buffer MapBuffer { real map_gradients[]; };
layout(std430, set = 0, binding = kBindTextureGradients) readonly buffer TextureBuffer { real texture_gradients[]; };
layout(std430, set = 0, binding = kBindStatus) buffer StatusBuffer { uint status; };
#ifdef FS_PACKED
#define STORED uint64_t
#else
#define STORED real
#endif
layout(std430, set = 0, binding = kBindForce) writeonly buffer ForceBuffer { STORED force_out[]; };
layout(std430, set = 0, binding = kBindDepth) writeonly buffer DepthBuffer { STORED depth_out[]; };
layout(std430, set = 0, binding = kBindFacet) writeonly buffer FacetIdBuffer { uint facet_out[]; };
layout(std430, set = 0, binding = kBindProxy) writeonly buffer ProxyBuffer { STORED proxy_out[]; };
layout(std430, set = 0, binding = kBindUnshaded) writeonly buffer UnshadedBuffer { STORED unshaded_out[]; };
layout(push_constant) uniform Push { ChunkParams chunk; };

#include "laws/circle.glsl"
#include "laws/elementary.glsl"
#include "laws/faceted_bump.glsl"
#include "laws/height_map.glsl"
#define SAMPLED_GRADIENT sampled_map_gradient
#define GRADIENTS map_gradients
#include "laws/sampled_gradient.glsl"
#undef SAMPLED_GRADIENT
#undef GRADIENTS
#define SAMPLED_GRADIENT sampled_texture_gradient
#define GRADIENTS texture_gradients
#include "laws/sampled_gradient.glsl"
#include "laws/column.glsl"
#include "laws/contact.glsl"

// The three reals of two neighbouring samples; `sample_index` is even.
#ifdef FS_PACKED
#define PAIR(a, b) packUint2x32(uvec2(floatBitsToUint(a), floatBitsToUint(b)))
#define STORE_PAIR(buffer, sample_index, a, b) buffer[(sample_index) / 2u] = PAIR(a, b);
#define STORE_VECTORS(buffer, sample_index, a, b)                                                                      \
    {                                                                                                                  \
        uint at = (sample_index) / 2u * 3u;                                                                            \
        buffer[at] = PAIR(a.x, a.y);                                                                                   \
        buffer[at + 1u] = PAIR(a.z, b.x);                                                                              \
        buffer[at + 2u] = PAIR(b.y, b.z);                                                                              \
    }
#else
#define STORE_PAIR(buffer, sample_index, a, b)                                                                         \
    {                                                                                                                  \
        buffer[sample_index] = a;                                                                                      \
        buffer[(sample_index) + 1u] = b;                                                                               \
    }
#define STORE_VECTORS(buffer, sample_index, a, b)                                                                      \
    {                                                                                                                  \
        uint at = (sample_index) * 3u;                                                                                 \
        buffer[at] = a.x;                                                                                              \
        buffer[at + 1u] = a.y;                                                                                         \
        buffer[at + 2u] = a.z;                                                                                         \
        buffer[at + 3u] = b.x;                                                                                         \
        buffer[at + 4u] = b.y;                                                                                         \
        buffer[at + 5u] = b.z;                                                                                         \
    }
#endif

void store(uint sample_index, Contact a, Contact b) {
    if ((CHANNELS & kChannelForce) != 0u)
        STORE_VECTORS(force_out, sample_index, a.force, b.force)
    if ((CHANNELS & kChannelDepth) != 0u)
        STORE_PAIR(depth_out, sample_index, a.depth, b.depth)
    if ((CHANNELS & kChannelFacet) != 0u) {
        facet_out[sample_index] = a.facet;
        facet_out[sample_index + 1u] = b.facet;
    }
    if ((CHANNELS & kChannelProxy) != 0u)
        STORE_VECTORS(proxy_out, sample_index, a.proxy, b.proxy)
    if ((CHANNELS & kChannelUnshaded) != 0u)
        STORE_VECTORS(unshaded_out, sample_index, a.unshaded, b.unshaded)
}

void main() {
    uint x = 2u * gl_GlobalInvocationID.x;
    uint y = gl_GlobalInvocationID.y;
    uint z = gl_WorkGroupID.z * LAYERS;
    if (x >= chunk.x_pitch || y >= chunk.y_count || z >= chunk.z_count)
        return;
    uint layers = min(LAYERS, chunk.z_count - z);
    real y_metres = axes[chunk.y_axis + chunk.y_first + y];
    Column left = column_at(axes[x], y_metres);
    Column right = column_at(axes[x + 1u], y_metres);
    uint sample_index = (z * chunk.y_count + y) * chunk.x_pitch + x;
    uint layer_stride = chunk.y_count * chunk.x_pitch;
    uint z_axis = chunk.z_axis + chunk.z_first + z;
    uint done = 0u;
    for (uint k = 0u; k < layers; ++k) {
        real z_metres = axes[z_axis + k];
        store(sample_index, contact_at(left, z_metres), contact_at(right, z_metres));
        sample_index += layer_stride;
        ++done;
    }
    // A driver that silently ends long loops leaves done behind.
    if (done != layers)
        atomicOr(status, kStatusUnfinished);
}
