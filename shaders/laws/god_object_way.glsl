// L6: the way that a pool of triangles leaves a god-object, step for step as host/reference/god_object_walk.h.

struct Worst {
    HalfSpace space;
    real most;
    uint holds; // 2 bits for each hold found on the way
    bool found;
};

void consider(Touch touch, uint i, real3 way, bool relaxed, inout Worst worst) {
    uint hold = hold_of(touch, way);
    HalfSpace space = half_space(touch, hold, i);
    if (relaxed && space.slack > ZERO)
        space.slack = ZERO;
    real violation = miss_of(space, way);
    if (hold != kHoldNone && violation > worst.most) {
        worst.most = violation;
        worst.space = space;
        worst.holds |= hold << (2u * i);
        worst.found = true;
    }
}

// The worst violated half-space: those of faces below the proxy first, since the others depend on where it goes.
bool find_worst(real3 way, bool relaxed, real tolerance, inout HalfSpace space) {
    Worst faces = Worst(kNoHalfSpace, tolerance, 0u, false);
    Worst others = faces;
    uint i = 0u;
    [[dont_unroll]] do {
        Touch touch = touch_at(i);
        Worst worst = others;
        if (above_face(touch))
            worst = faces;
        if (i < pool_count)
            consider(touch, i, way, relaxed, worst);
        if (above_face(touch))
            faces = worst;
        else
            others = worst;
        ++i;
        ++spent;
    } while (i < pool_count);
    if (!faces.found)
        faces = others;
    uint changed = ((faces.holds | faces.holds >> 1) & 0x55555555u) * 3u; // both bits of each hold that was found
    pool_holds = (pool_holds & ~changed) | faces.holds;
    if (faces.found)
        space = faces.space;
    return faces.found;
}

// The way to the point nearest to the probe that the touched triangles allow. For a probe far off, of whose way into the
// planes little may be left along them, the point itself is found: what rounding makes of it stays the same wherever the
// proxy is.
void find_way(real3 proxy, real3 probe) {
    const real rounding = real(8.0LF) * EPSILON;
    real3 wish = difference(probe, proxy);
    real reach = largest_of(wish);
    precise real near_tolerance = kRest + rounding * reach;
    pool_shortened = false;
    pool_tolerance = near_tolerance;
    Tolerance tolerance = one_tolerance(near_tolerance);
#ifdef FS_RARE
    bool far = reach > kFarWay;
    precise real push = kRest + rounding * largest_of(probe);
    if (far) {
        tolerance = Tolerance(push, kRest + rounding, push);
        wish = probe;
    }
#else
    const bool far = false;
    is_rare = is_rare || reach > kFarWay;
#endif
    bool one_face = !far && pool_count == 1u && is_above(0u);
    HalfSpace violated = half_space(touch_at(0u), kHoldFace, 0u);
    Projection found = free_projection(wish);
    if (one_face) { // the most common case
        if (miss_of(violated, wish) > near_tolerance)
            found = onto_plane(wish, violated);
        pool_holds = with_bits(pool_holds, 0u, 2u, kHoldFace);
    }
    bool relaxed = false;
    bool seeking = !one_face;
    bool succeeded = one_face;
    uint left = kProjectionRounds;
    [[dont_unroll]] do {
        real3 way = found.vector;
        real least = near_tolerance;
#ifdef FS_RARE
        if (far) {
            way = difference(way, proxy);
            least = height_tolerance(tolerance, found.vector);
        }
#endif
        if (seeking) {
            succeeded = !find_worst(way, relaxed, least, violated);
#ifdef FS_RARE
            precise real slack = violated.slack + product(violated.normal, proxy);
            if (far)
                violated.slack = slack;
#endif
            --left;
            bool fits = true;
            if (!succeeded)
                fits = hold_also(wish, violated, tolerance, found);
            bool failed = !succeeded && (!fits || left == 0u);
            seeking = !succeeded && !(failed && relaxed);
            if (failed && !relaxed) { // once more
                relaxed = true;
                left = kProjectionRounds;
                found = free_projection(wish);
            }
        }
    } while (seeking);
#ifdef FS_RARE
    if (far && succeeded)
        found.vector = difference(found.vector, proxy);
#endif
    if (!succeeded)
        found.vector = real3(ZERO);
#ifdef FS_RARE
    real length_left = largest_of(found.vector);
    pool_shortened = far && length_left > kFarWay;
    precise real share = kFarWay / length_left;
    if (pool_shortened)
        found.vector = scaled(share, found.vector);
    precise real far_tolerance = kRest + rounding * (pool_shortened ? kFarWay : ONE + length_left);
    if (far)
        pool_tolerance = far_tolerance;
#endif
    resting = found;
}

// Whether a move keeps to the half-space of a triangle in the pool, so that it cannot cross it. The plane of a rounded
// edge or corner tells that of short moves alone, unless it holds the move.
bool keeps_off(uint triangle, real3 way) {
    uint place = place_of(triangle);
    Touch touch = touch_at(place == POOL ? 0u : place);
    uint hold = hold_of(touch, way);
    HalfSpace space = half_space(touch, hold, place);
    precise real least = space.slack - pool_tolerance;
    bool tells = hold == kHoldFace || (hold == kHoldRounded && largest_of(way) <= kWidth);
    bool off = tells && product(space.normal, way) >= least;
    return place != POOL && (holds(resting, place) || off);
}

// The first corner of a triangle whose plane the move keeps a skin in front of.
struct Cover {
    real3 corner;
    bool holding;
};
Cover covers[3];

bool is_under(HalfSpace space, Cover cover, Triangle triangle) {
    return cover.holding && product(space.normal, difference(triangle.a, cover.corner)) <= kFlush &&
           product(space.normal, difference(triangle.b, cover.corner)) <= kFlush &&
           product(space.normal, difference(triangle.c, cover.corner)) <= kFlush;
}

// Whether a triangle is behind a plane that the move keeps a skin in front of.
bool lies_below(Triangle triangle) {
    return is_under(resting.one, covers[0], triangle) || is_under(resting.two, covers[1], triangle) ||
           is_under(resting.three, covers[2], triangle);
}
