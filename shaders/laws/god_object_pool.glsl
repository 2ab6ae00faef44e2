// L6: the triangles that a god-object may touch, as host/reference/god_object_pool.h keeps them: POOL of them. The hot
// kernel's pool is smaller, and leaves what does not fit to the other one.

const real kFarWay = real(8.0LF);
const uint kProjectionRounds = 64u;
const real kFlush = kRest * real(0.25LF);

Touch pool[POOL];
uint pool_index[POOL]; // triangles
uint pool_count;
uint pool_holds; // 2 bits each
uint pool_faceless; // 1 bit each: its plane was tried from here and led nowhere
uint pool_features; // 3 bits each
Projection resting; // the way found last, and what holds it to that
real pool_tolerance; // shorter moves are none
bool pool_shortened; // the way found last ends before the point it is for

uint bits_at(uint word, uint i, uint width) {
    return word >> (width * i) & ((1u << width) - 1u);
}

uint with_bits(uint word, uint i, uint width, uint bits) {
    return (word & ~(((1u << width) - 1u) << (width * i))) | bits << (width * i);
}

uint hold_at(uint i) {
    return bits_at(pool_holds, i, 2u);
}

bool is_above(uint i) {
    return bits_at(pool_features, i, 3u) == kMeshFace;
}

#ifdef FS_RARE
Touch touch_at(uint i) {
    Touch touch = pool[i];
    touch.feature = bits_at(pool_features, i, 3u);
    touch.faceless = bits_at(pool_faceless, i, 1u) != 0u;
    return touch;
}

uint index_at(uint i) {
    return pool_index[i];
}

void put_triangle(uint i, uint index, Triangle triangle) {
    pool_index[i] = index;
    pool[i].triangle = triangle;
}

void put_touch(uint i, uint index, Touch touch) {
    pool_index[i] = index;
    pool[i] = touch;
}
#else
// Chosen rather than indexed, so that the pool stays in registers.
Touch touch_at(uint i) {
    Touch touch = pool[0];
    [[unroll]] for (uint j = 1u; j < POOL; ++j)
        if (i == j)
            touch = pool[j];
    touch.feature = bits_at(pool_features, i, 3u);
    touch.faceless = bits_at(pool_faceless, i, 1u) != 0u;
    return touch;
}

uint index_at(uint i) {
    uint index = pool_index[0];
    [[unroll]] for (uint j = 1u; j < POOL; ++j)
        index = i == j ? pool_index[j] : index;
    return index;
}

void put_triangle(uint i, uint index, Triangle triangle) {
    [[unroll]] for (uint j = 0u; j < POOL; ++j)
        if (i == j) {
            pool_index[j] = index;
            pool[j].triangle = triangle;
        }
}

void put_touch(uint i, uint index, Touch touch) {
    [[unroll]] for (uint j = 0u; j < POOL; ++j)
        if (i == j) {
            pool_index[j] = index;
            pool[j] = touch;
        }
}
#endif

void forget_all() {
    pool_count = 0u;
    pool_holds = 0u;
    pool_faceless = 0u;
    pool_features = 0u;
    resting.count = 0u;
}

// Where a triangle is in the pool; POOL if it is not.
uint place_of(uint triangle) {
    uint place = POOL;
    [[unroll]] for (uint i = 0u; i < POOL; ++i)
        if (i < pool_count && pool_index[i] == triangle)
            place = i;
    return place;
}

#ifdef FS_RARE
uint without_bits(uint word, uint i, uint width) {
    uint below = (1u << (width * i)) - 1u;
    return (word & below) | (word >> width & ~below);
}

// Makes room: forgets the first that does not hold. False if all do.
bool forget_one() {
    uint place = POOL;
    [[unroll]] for (uint i = POOL; i-- > 0u;)
        if (!holds(resting, i))
            place = i;
    if (place == POOL)
        return false;
    resting.one.source -= resting.one.source > place ? 1u : 0u;
    resting.two.source -= resting.two.source > place ? 1u : 0u;
    resting.three.source -= resting.three.source > place ? 1u : 0u;
    pool_holds = without_bits(pool_holds, place, 2u);
    pool_faceless = without_bits(pool_faceless, place, 1u);
    pool_features = without_bits(pool_features, place, 3u);
    --pool_count;
    [[dont_unroll]] do {
        if (place < pool_count) {
            Touch touch = pool[place + 1u];
            put_touch(place, pool_index[place + 1u], touch);
        }
        ++place;
        ++spent;
    } while (place < pool_count);
    return true;
}
#endif

// Room for one more; false if the pool is full of what holds. Of the hot kernel, if it is full.
bool has_room() {
#ifdef FS_RARE
    if (pool_count == POOL)
        return forget_one();
#endif
    return pool_count < POOL;
}

// What the proxy may touch; no harm if it does not. It is looked at when the next way is sought. `instead` of one that
// is known, or as one more (POOL).
void remember(uint triangle, Triangle shape, uint instead) {
    bool known = place_of(triangle) != POOL;
    bool replaces = !known && instead < POOL;
    bool added = !known && instead == POOL;
    if (added)
        added = has_room();
#ifndef FS_RARE
    is_rare = is_rare || (!known && !replaces && !added);
#endif
    uint place = replaces ? instead : pool_count;
    if (replaces || added) {
        put_triangle(place, triangle, shape);
        pool_faceless = with_bits(pool_faceless, place, 1u, 0u);
    }
    if (added) {
        pool_holds = with_bits(pool_holds, place, 2u, kHoldNone);
        ++pool_count;
    }
}

// Looks at all from where the proxy is, and forgets what is far.
void look_again(real3 proxy) {
    uint kept = 0u;
    uint i = 0u;
    [[dont_unroll]] do {
        Touch touch = touch_at(i);
        look(touch, proxy);
        if (i < pool_count) {
            put_touch(kept, index_at(i), touch);
            pool_features = with_bits(pool_features, kept, 3u, touch.feature);
            pool_faceless = with_bits(pool_faceless, kept, 1u, touch.faceless ? 1u : 0u);
            kept += touch.separation <= kNear ? 1u : 0u;
        }
        ++i;
        ++spent;
    } while (i < pool_count);
    pool_count = kept;
}
