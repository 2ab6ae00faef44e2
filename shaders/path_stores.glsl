// A sample of a path into the channels that are asked for.

#define STORE_VECTOR(buffer, at, value)                                                                                \
    {                                                                                                                  \
        buffer[3u * at] = value.x;                                                                                     \
        buffer[3u * at + 1u] = value.y;                                                                                \
        buffer[3u * at + 2u] = value.z;                                                                                \
    }

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
