// The results of LANES neighbouring samples, each channel as vectors of four words. On a software device every store is a
// loop over the lanes: four words share its cost, and with FS_PACKED a word of 64 bits holds two reals.

#ifdef FS_PACKED
#define LANES kLanesPacked
#define PER_VECTOR 8u
#define REALS u64vec4
#define UINTS u64vec4
#define BITS uint
#define BITS_OF floatBitsToUint
#define PAIR(bits, i) packUint2x32(uvec2(bits[i], bits[(i) + 1u]))
#define VECTOR_OF(bits, i) u64vec4(PAIR(bits, i), PAIR(bits, (i) + 2u), PAIR(bits, (i) + 4u), PAIR(bits, (i) + 6u))
#define REALS_OF VECTOR_OF
#define UINTS_OF VECTOR_OF
#else
#define LANES kLanes
#define PER_VECTOR 4u
#define REALS real4
#define UINTS uvec4
#define BITS real
#define BITS_OF(value) value
#define REALS_OF(bits, i) real4(bits[i], bits[(i) + 1u], bits[(i) + 2u], bits[(i) + 3u])
#define UINTS_OF(bits, i) uvec4(bits[i], bits[(i) + 1u], bits[(i) + 2u], bits[(i) + 3u])
#endif

layout(std430, set = 0, binding = kBindForce) writeonly buffer ForceBuffer { REALS force_out[]; };
layout(std430, set = 0, binding = kBindDepth) writeonly buffer DepthBuffer { REALS depth_out[]; };
layout(std430, set = 0, binding = kBindFacet) writeonly buffer FacetIdBuffer { UINTS facet_out[]; };
layout(std430, set = 0, binding = kBindProxy) writeonly buffer ProxyBuffer { REALS proxy_out[]; };
layout(std430, set = 0, binding = kBindUnshaded) writeonly buffer UnshadedBuffer { REALS unshaded_out[]; };

#define STORE_VECTORS(buffer, at, contacts, member)                                                                    \
    {                                                                                                                  \
        BITS bits[3u * LANES];                                                                                       \
        for (uint i = 0u; i < LANES; ++i) {                                                                          \
            bits[3u * i] = BITS_OF(contacts[i].member.x);                                                              \
            bits[3u * i + 1u] = BITS_OF(contacts[i].member.y);                                                         \
            bits[3u * i + 2u] = BITS_OF(contacts[i].member.z);                                                         \
        }                                                                                                              \
        buffer[3u * at] = REALS_OF(bits, 0u);                                                                          \
        buffer[3u * at + 1u] = REALS_OF(bits, PER_VECTOR);                                                             \
        buffer[3u * at + 2u] = REALS_OF(bits, 2u * PER_VECTOR);                                                        \
    }

// `at` counts groups of LANES samples.
void store(uint at, Contact contacts[LANES]) {
    if ((CHANNELS & kChannelForce) != 0u)
        STORE_VECTORS(force_out, at, contacts, force)
    if ((CHANNELS & kChannelDepth) != 0u) {
        BITS bits[LANES];
        for (uint i = 0u; i < LANES; ++i)
            bits[i] = BITS_OF(contacts[i].depth);
        depth_out[at] = REALS_OF(bits, 0u);
    }
    if ((CHANNELS & kChannelFacet) != 0u) {
        uint bits[LANES];
        for (uint i = 0u; i < LANES; ++i)
            bits[i] = contacts[i].facet;
        facet_out[at] = UINTS_OF(bits, 0u);
    }
    if ((CHANNELS & kChannelProxy) != 0u)
        STORE_VECTORS(proxy_out, at, contacts, proxy)
    if ((CHANNELS & kChannelUnshaded) != 0u)
        STORE_VECTORS(unshaded_out, at, contacts, unshaded)
}
