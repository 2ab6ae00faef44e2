// What the rare kernels of paths remember of a walk from one dispatch to the next.

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

bool is_finite(real3 v) {
    return largest_of(v) <= LARGEST;
}
