// L6: where the walks of a god-object begin.

// A walk begins where a path's god-object was left, with the triangles that held it.
void begin_update(real3 proxy, real3 probe, uint held, uvec3 triangles) {
    uint count = held & kHeldCount;
    walk_probe = probe;
    walk_substeps = 0u;
    walk_proxy = proxy;
    forget_all();
    uint i = 0u;
    [[dont_unroll]] do {
        uint triangle = i == 0u ? triangles.x : i == 1u ? triangles.y : triangles.z;
        if (i < count)
            remember(triangle, triangle_at(triangle), POOL);
        ++i;
        ++spent;
    } while (i < count);
    begin_walk();
}

#ifndef FS_RARE
// The next update begins with `count` triangles of the pool.
void go_on(uint count, uvec3 sources, real3 probe) {
    Touch first = touch_at(sources.x);
    Touch second = touch_at(sources.y);
    uint first_index = index_at(sources.x);
    uint second_index = index_at(sources.y);
    if (count == 1u || count == 2u)
        put_touch(0u, first_index, first);
    if (count == 2u)
        put_touch(1u, second_index, second);
    forget_all();
    pool_count = count;
    walk_probe = probe;
    walk_substeps = 0u;
    begin_walk();
}
#endif
