// L6: the walk of a god-object towards the probe, until it can come no closer, over the pool of triangles that
// it may touch; step for step as host/reference/god_object_walk.h, as far as most steps go. What needs more is left to
// the host (is_left): more triangles than the pool holds, a third plane, edges, corners, what the host did not list
// beforehand, proxies and probes far off.

const uint kProjectionRounds = 64u;
const real kFlush = kRest * real(0.25LF);
const real kRegion = real(2.0LF); // half the side of the box in which a proxy minds the mesh
const real kStride = kWidth * real(32.0LF);
const uint kSubsteps = 20000u;
const uint kPatience = 16u;
const uint kPool = 3u;

Touch pool[kPool];
uint pool_index[kPool]; // triangles
uint pool_count;
uint pool_constraints; // 2 bits each
uint pool_tried; // 1 bit each: its plane was tried from here without success
uint pool_features; // 3 bits each
Projection resting; // the displacement found last, and what constrains it
real pool_tolerance; // shorter moves are none

// Of one update. Every move keeps to the half-spaces of the triangles in the pool and is cast against all others.
real3 walk_proxy;
real3 walk_probe;
uint walk_substeps;
uint walk_trail; // hash of every place where it has been, and of how it stood to the pool there
bool walk_rests; // what constrained the proxy last is what constrains it
bool walk_corner; // halted where a line between two faces ended
bool walk_runs; // has not ended
real3 tread_place; // where the proxy was
uint tread_substeps; // number of substeps since then

// No triangle is nearer to this place than free_distance.
real3 free_place;
real free_distance;

uint bits_at(uint word, uint i, uint width) {
    return word >> (width * i) & ((1u << width) - 1u);
}

uint with_bits(uint word, uint i, uint width, uint bits) {
    return (word & ~(((1u << width) - 1u) << (width * i))) | bits << (width * i);
}

uint constraint_at(uint i) {
    return bits_at(pool_constraints, i, 2u);
}

bool is_above(uint i) {
    return bits_at(pool_features, i, 3u) == kMeshFace;
}

// Chosen rather than indexed, so that the pool stays in registers.
Touch touch_at(uint i) {
    Touch touch = pool[0];
    [[unroll]] for (uint j = 1u; j < kPool; ++j)
        if (i == j)
            touch = pool[j];
    touch.feature = bits_at(pool_features, i, 3u);
    touch.face_tried = bits_at(pool_tried, i, 1u) != 0u;
    return touch;
}

uint index_at(uint i) {
    uint index = pool_index[0];
    [[unroll]] for (uint j = 1u; j < kPool; ++j)
        index = i == j ? pool_index[j] : index;
    return index;
}

void put_triangle(uint i, uint index, Triangle triangle) {
    [[unroll]] for (uint j = 0u; j < kPool; ++j)
        if (i == j) {
            pool_index[j] = index;
            pool[j].triangle = triangle;
        }
}

void put_touch(uint i, uint index, Touch touch) {
    [[unroll]] for (uint j = 0u; j < kPool; ++j)
        if (i == j) {
            pool_index[j] = index;
            pool[j] = touch;
        }
}

void forget_all() {
    pool_count = 0u;
    pool_constraints = 0u;
    pool_tried = 0u;
    pool_features = 0u;
    resting.count = 0u;
}

// Where a triangle is in the pool; kPool if it is not.
uint place_of(uint triangle) {
    uint place = kPool;
    [[unroll]] for (uint i = 0u; i < kPool; ++i)
        if (i < pool_count && pool_index[i] == triangle)
            place = i;
    return place;
}

// Adds a candidate triangle. It is tested when the next displacement is sought. `instead` of
// one that is known, or as one more (kPool).
void remember(uint triangle, Triangle shape, uint instead) {
    bool known = place_of(triangle) != kPool;
    bool replaces = !known && instead < kPool;
    bool added = !known && instead == kPool && pool_count < kPool;
    is_left = is_left || (!known && !replaces && !added);
    uint place = replaces ? instead : pool_count;
    if (replaces || added) {
        put_triangle(place, triangle, shape);
        pool_tried = with_bits(pool_tried, place, 1u, 0u);
    }
    if (added) {
        pool_constraints = with_bits(pool_constraints, place, 2u, kConstraintNone);
        ++pool_count;
    }
}

// Looks at all from where the proxy is, and forgets what is far.
void update_pool(real3 proxy) {
    uint kept = 0u;
    uint i = 0u;
    [[dont_unroll]] do {
        Touch touch = touch_at(i);
        update_touch(touch, proxy);
        if (i < pool_count) {
            put_touch(kept, index_at(i), touch);
            pool_features = with_bits(pool_features, kept, 3u, touch.feature);
            pool_tried = with_bits(pool_tried, kept, 1u, touch.face_tried ? 1u : 0u);
            bool near = touch.separation <= kNear;
            kept += near ? 1u : 0u;
            walk_trail = near ? hashed(walk_trail, digest_of(touch, index_at(i))) : walk_trail;
        }
        ++i;
        ++spent;
    } while (i < pool_count);
    pool_count = kept;
}

// The displacement that the pool leaves the proxy.

struct Worst {
    HalfSpace space;
    real most;
    uint constraints; // 2 bits for each that was found on the way
    bool found;
};

void consider(Touch touch, uint i, real3 displacement, bool relaxed, inout Worst worst) {
    uint constraint = constraint_of(touch, displacement);
    HalfSpace space = half_space(touch, constraint, i);
    if (relaxed && space.slack > ZERO)
        space.slack = ZERO;
    real violation = miss_of(space, displacement);
    if (constraint != kConstraintNone && violation > worst.most) {
        worst.most = violation;
        worst.space = space;
        worst.constraints |= constraint << (2u * i);
        worst.found = true;
    }
}

// The worst violated half-space: those of faces below the proxy first, since the others depend on where it goes.
bool find_worst(real3 displacement, bool relaxed, inout HalfSpace space) {
    Worst faces = Worst(kNoHalfSpace, pool_tolerance, 0u, false);
    Worst others = faces;
    uint i = 0u;
    [[dont_unroll]] do {
        Touch touch = touch_at(i);
        Worst worst = others;
        if (above_face(touch))
            worst = faces;
        if (i < pool_count)
            consider(touch, i, displacement, relaxed, worst);
        if (above_face(touch))
            faces = worst;
        else
            others = worst;
        ++i;
        ++spent;
    } while (i < pool_count);
    if (!faces.found)
        faces = others;
    uint changed = ((faces.constraints | faces.constraints >> 1) & 0x55555555u) * 3u; // both bits of each that was found
    pool_constraints = (pool_constraints & ~changed) | faces.constraints;
    if (faces.found)
        space = faces.space;
    return faces.found;
}

// The displacement to the point nearest to the probe that the touched triangles allow.
void find_displacement(real3 proxy, real3 probe) {
    real3 wish = difference(probe, proxy);
    real reach = largest_of(wish);
    precise real tolerance = kRest + real(8.0LF) * EPSILON * reach;
    pool_tolerance = tolerance;
    walk_trail = hashed(walk_trail, folded(tolerance));
    is_left = is_left || reach > kFarOff;
    bool one_face = pool_count == 1u && is_above(0u);
    HalfSpace violated = half_space(touch_at(0u), kConstraintFace, 0u);
    Projection found = free_projection(wish);
    if (one_face) { // the most common case
        if (miss_of(violated, wish) > tolerance)
            found = onto_plane(wish, violated);
        pool_constraints = with_bits(pool_constraints, 0u, 2u, kConstraintFace);
    }
    bool relaxed = false;
    bool seeking = !one_face;
    bool succeeded = one_face;
    uint left = kProjectionRounds;
    [[dont_unroll]] do {
        if (seeking) {
            succeeded = !find_worst(found.vector, relaxed, violated);
            --left;
            bool fits = true;
            if (!succeeded)
                fits = add_half_space(wish, violated, tolerance, found);
            bool failed = !succeeded && (!fits || left == 0u);
            seeking = !succeeded && !(failed && relaxed);
            if (failed && !relaxed) { // once more
                relaxed = true;
                left = kProjectionRounds;
                found = free_projection(wish);
            }
        }
    } while (seeking);
    is_left = is_left || !succeeded;
    resting = found;
}

// Whether a move keeps to the half-space of a triangle in the pool, so that it cannot cross it. The plane of a rounded
// edge or corner decides that for short moves alone, unless it constrains the move.
bool keeps_off(uint triangle, real3 displacement) {
    uint place = place_of(triangle);
    Touch touch = touch_at(place == kPool ? 0u : place);
    uint constraint = constraint_of(touch, displacement);
    HalfSpace space = half_space(touch, constraint, place);
    precise real least = space.slack - pool_tolerance;
    bool tells = constraint == kConstraintFace ||
                 (constraint == kConstraintRounded && largest_of(displacement) <= kWidth);
    bool off = tells && product(space.normal, displacement) >= least;
    return place != kPool && (is_active(resting, place) || off);
}

// The first corner of a triangle whose plane the move keeps a skin in front of.
struct Cover {
    real3 corner;
    bool constrains;
};
Cover covers[2];

bool is_under(HalfSpace space, Cover cover, Triangle triangle) {
    return cover.constrains && product(space.normal, difference(triangle.a, cover.corner)) <= kFlush &&
           product(space.normal, difference(triangle.b, cover.corner)) <= kFlush &&
           product(space.normal, difference(triangle.c, cover.corner)) <= kFlush;
}

// Whether a triangle is behind a plane that the move keeps a skin in front of.
bool lies_below(Triangle triangle) {
    return is_under(resting.one, covers[0], triangle) || is_under(resting.two, covers[1], triangle);
}

// Moves.

struct Impact {
    real time;
    uint triangle;
};

bool comes_before(uint one, uint other) {
    uint first = triangle_words[2u * one].x;
    uint second = triangle_words[2u * other].x;
    return first < second || (first == second && one < other);
}

// By how much closer to the probe the proxy is than that place. Of a probe far off, what counts is the direction.
real gain_since(real3 place) {
    real3 both = sum(difference(walk_probe, place), difference(walk_probe, walk_proxy));
    precise real size = root(product(both, both));
    const real most = real(2.0LF) * kFarOff;
    precise real gain = quotient(product(difference(walk_proxy, place), both), size < most ? size : most);
    return gain;
}

// Whether rounding makes the walk tread on the spot.
bool treads_since(real3 place) {
    bool far = largest_of(difference(walk_probe, walk_proxy)) > kFarOff;
    bool stays = largest_of(difference(walk_proxy, place)) <= kWidth * real(4.0LF);
    bool gains = gain_since(place) > kWidth * real(0.0625LF);
    return far ? stays : !gains;
}

// Keeps the impact with a triangle if it comes before what was found so far.
void hit(uint index, inout Move move, inout Impact first) {
    Triangle triangle = triangle_at(index);
    bool minded = !keeps_off(index, move.displacement) && !lies_below(triangle);
    real time = impact_time(triangle, move);
    bool later = time > move.until || (time == first.time && !comes_before(index, first.triangle));
    if (minded && !later) {
        first = Impact(time, index);
        move.until = time;
    }
}

bool is_free(real3 place) {
    real3 off = difference(place, free_place);
    precise real least = free_distance * free_distance;
    return product(off, off) < least;
}

// The first impact of a move along a face, with what was found beforehand to stand above that face's plane around it; or
// through free space.
Impact first_impact(Move move) {
    Impact first = Impact(real(2.0LF), 0u);
    bool one = resting.count > 0u && constraint_at(resting.one.source) == kConstraintFace;
    bool two = resting.count > 1u && constraint_at(resting.two.source) == kConstraintFace;
    uint source = one ? resting.one.source : resting.two.source;
    source = one || two ? source : 0u;
    Touch touch = touch_at(source);
    uvec4 words = triangle_words[2u * index_at(source) + 1u];
    bool front = product(touch.face, touch.triangle.normal) > ZERO;
    uint begin = front ? words.x : words.y;
    uint end = front ? words.y : words.z;
    bool listed = (one || two) && (words.w & kTriangleCrowded) == 0u;
    bool free = resting.count == 0u && is_free(move.from) && is_free(place_at(move, move.until));
    is_left = is_left || !(listed || free);
    if (is_left || free)
        end = begin;
    [[dont_unroll]] do {
        if (begin < end)
            hit(indices[begin], move, first);
        ++begin;
        ++spent;
    } while (begin < end);
    return first;
}

real clipped(real from, real displacement, real until, real clip) {
    real edge = displacement < ZERO ? -kRegion : kRegion;
    precise real there = from + until * displacement;
    precise real time = quotient(edge - from, displacement);
    return abs(there) > kRegion && time < clip ? time : clip;
}

// A move that leaves the region ends in the open.
Impact clipped_cast(Move move) {
    if (largest_of(place_at(move, move.until)) > kRegion) {
        real until = clipped(move.from.x, move.displacement.x, move.until, move.until);
        until = clipped(move.from.y, move.displacement.y, move.until, until);
        until = clipped(move.from.z, move.displacement.z, move.until, until);
        move.until = until > ZERO ? until : ZERO;
    }
    return first_impact(move);
}

// The triangle across the edge comes next, most likely: known already, it need not be hit first. If all of the one that
// was left lies below its plane, that one is out of the way. Takes in the triangle that was hit, as well.
void take_in(bool was_hit, uint triangle, uint released, uint edge) {
    uint left = index_at(released);
    uvec4 words = triangle_words[2u * left];
    uint across = edge == 0u ? words.y : edge == 1u ? words.z : words.w;
    bool hands_over = !was_hit && edge <= 2u && (across & kMeshManyBit) == 0u;
    uint incoming = was_hit ? triangle : hands_over ? across : left;
    Triangle shape = triangle_at(incoming);
    real height = product(shape.normal, difference(walk_proxy, shape.a));
    real3 corner = corner_of(touch_at(released).triangle, (edge + 2u) % 3u);
    real apex = product(shape.normal, difference(corner, shape.a));
    precise real sides = height * apex;
    if (was_hit || hands_over)
        remember(incoming, shape, was_hit || sides > ZERO ? kPool : released);
}

void finish_substep(Move move, uint released, uint edge) {
    Impact impact = clipped_cast(move);
    if (is_left)
        return;
    bool was_hit = impact.time <= move.until;
    bool was_released = released != kPool;
    real time = was_hit ? impact.time : move.until;
    precise real size = time * largest_of(move.displacement);
    bool moves = size > kRest;
    bool one_face = pool_count == 1u && resting.count == 1u && is_above(0u) &&
                    stays_above_face(touch_at(0u), move.displacement);
    walk_corner = (was_hit || was_released) && resting.count == 2u && size > kStride;
    if (moves)
        pool_tried = 0u;
    if (!was_hit && was_released)
        pool_tried = with_bits(pool_tried, released, 1u, moves ? 0u : 1u);
    bool arrives = !was_hit && !was_released;
    // No triangle in the way: without a plane to keep to, that is the probe itself.
    walk_proxy = arrives && resting.count == 0u ? walk_probe : place_at(move, arrives ? ONE : time);
    walk_trail = hashed(walk_trail, walk_proxy);
    walk_rests = arrives && (resting.count == 0u || one_face);
    if (!arrives)
        take_in(was_hit, impact.triangle, was_released ? released : 0u, edge);
}

// When the move leaves the face that constrains it. Also sets what covers it.
void consider_release(HalfSpace space, bool constrains, uint i, real3 displacement, inout Release release,
                      inout uint released) {
    Touch touch = touch_at(constrains ? space.source : 0u);
    bool face = constraint_at(space.source) == kConstraintFace;
    Release one = release_of_face(touch, displacement, release.time);
    is_left = is_left || (constrains && !face);
    if (constrains && one.time < release.time) {
        release = one;
        released = space.source;
    }
    covers[i] = Cover(touch.triangle.a, constrains && face);
}

// One piece of the walk; afterwards it runs on, or has come to rest, to a corner, or treads on the spot.
void walk_on() {
    update_pool(walk_proxy);
    find_displacement(walk_proxy, walk_probe);
    real3 displacement = resting.vector;
    walk_rests = largest_of(displacement) <= pool_tolerance && resting.count > 0u;
    Release release = Release(ONE, 3u);
    uint released = kPool;
    consider_release(resting.one, resting.count > 0u, 0u, displacement, release, released);
    consider_release(resting.two, resting.count > 1u, 1u, displacement, release, released);
    if (!walk_rests)
        finish_substep(Move(walk_proxy, displacement, release.time), released, release.edge);
    if (is_left)
        return;
    if (!walk_rests)
        ++walk_substeps;
    walk_runs = !walk_rests && !walk_corner && walk_substeps < kSubsteps;
    if (walk_runs && walk_substeps >= tread_substeps + kPatience) {
        walk_runs = !treads_since(tread_place);
        tread_place = walk_proxy;
        tread_substeps = walk_substeps;
    }
}

void begin_walk(real3 probe) {
    walk_probe = probe;
    walk_substeps = 0u;
    walk_trail = 0u;
    walk_corner = false;
    walk_rests = false;
    walk_runs = true;
    is_left = is_left || largest_of(walk_proxy) > kRegion;
    tread_place = walk_proxy;
    tread_substeps = 0u;
}

// An update begins where a path's god-object was left, with the triangles that constrained it.
void begin_update(real3 proxy, real3 probe, uint count, uvec3 triangles) {
    walk_proxy = proxy;
    forget_all();
    uint i = 0u;
    [[dont_unroll]] do {
        uint triangle = i == 0u ? triangles.x : i == 1u ? triangles.y : triangles.z;
        if (i < count)
            remember(triangle, triangle_at(triangle), kPool);
        ++i;
        ++spent;
    } while (i < count);
    begin_walk(probe);
}

// The next update begins with `count` triangles of the pool.
void go_on(uint count, uvec2 sources, real3 probe) {
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
    begin_walk(probe);
}
