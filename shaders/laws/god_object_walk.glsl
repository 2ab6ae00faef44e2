// L6: the walk of a god-object towards the probe, until nothing near lets it come closer, step for step as
// host/reference/god_object_walk.h.

#ifdef FS_RARE
// Where a god-object that comes from far off enters the region in which it minds the mesh: in double in every precision.

void cut(double near_end, double far_end, inout double begin, inout double end, inout bool crosses) {
    const double side = 1.5LF;
    precise double way = far_end - near_end;
    precise double low = (-side - near_end) / way;
    precise double high = (side - near_end) / way;
    double first = high < low ? high : low;
    double last = low < high ? high : low;
    bool finite_way = abs(way) <= 1.7976931348623157e308LF;
    crosses = crosses && finite_way;
    if (way == 0.0LF)
        end = abs(near_end) > side ? -1.0LF : end;
    else {
        begin = begin < first ? first : begin;
        end = last < end ? last : end;
    }
}

real entered(double near_end, double far_end, double time) {
    const double side = 1.5LF;
    precise double there = near_end + time * (far_end - near_end);
    return real(there < -side ? -side : side < there ? side : there);
}

real on_side(real coordinate) {
    return coordinate < ZERO ? real(-1.5LF) : real(1.5LF);
}

// False if a straight way from a proxy outside of the region does not enter it.
bool find_entry(real3 proxy, real3 probe, out real3 place) {
    bool back = largest_of(probe) < largest_of(proxy);
    dvec3 near_end = dvec3(back ? probe : proxy);
    dvec3 far_end = dvec3(back ? proxy : probe);
    double begin = 0.0LF;
    double end = 1.0LF;
    bool crosses = true;
    cut(near_end.x, far_end.x, begin, end, crosses);
    cut(near_end.y, far_end.y, begin, end, crosses);
    cut(near_end.z, far_end.z, begin, end, crosses);
    double time = back ? end : begin;
    place = real3(entered(near_end.x, far_end.x, time), entered(near_end.y, far_end.y, time),
                  entered(near_end.z, far_end.z, time));
    // On the region's border to the last bit, so that it is outside of the mesh.
    uint side = abs(place.x) < abs(place.y) ? 1u : 0u;
    side = (side == 1u ? abs(place.y) : abs(place.x)) < abs(place.z) ? 2u : side;
    if (side == 0u)
        place.x = on_side(place.x);
    else if (side == 1u)
        place.y = on_side(place.y);
    else
        place.z = on_side(place.z);
    return crosses && begin <= end;
}
#endif

const real kRegion = real(2.0LF); // half the side of the box in which a proxy minds the mesh
const real kStride = kWidth * real(32.0LF);
const uint kSubsteps = 20000u;
const uint kPatience = 16u;

// Of one update. Every move keeps to the half-spaces of the triangles in the pool and is cast against all others.
real3 walk_proxy;
real3 walk_probe;
uint walk_substeps;
bool walk_rests; // what held the proxy last is what holds it
bool walk_corner; // halted where a line between two faces ended
bool walk_runs; // has not come to an end
real3 tread_place; // where the proxy was
uint tread_substeps; // so many substeps ago

struct Impact {
    real time;
    uint triangle;
};

bool comes_before(uint one, uint other) {
    uint first = triangle_words[2u * one].x;
    uint second = triangle_words[2u * other].x;
    return first < second || (first == second && one < other);
}

// By how much closer to the probe the proxy is than that place. Of a probe far off, what counts is the way.
real gain_since(real3 place) {
    real3 both = sum(difference(walk_probe, place), difference(walk_probe, walk_proxy));
    precise real size = sqrt(product(both, both));
    const real most = real(2.0LF) * kFarWay;
    precise real gain = product(difference(walk_proxy, place), both) / (size < most ? size : most);
    return gain;
}

// Whether rounding makes the walk tread on the spot.
bool treads_since(real3 place) {
    bool far = largest_of(difference(walk_probe, walk_proxy)) > kFarWay;
    bool stays = largest_of(difference(walk_proxy, place)) <= kWidth * real(4.0LF);
    bool gains = gain_since(place) > kWidth * real(0.0625LF);
    return far ? stays : !gains;
}

// Keeps the impact with a triangle if it comes before what was found so far.
void hit(uint index, inout Move move, inout Impact first) {
    Triangle triangle = triangle_at(index);
    bool minded = !keeps_off(index, move.way) && !lies_below(triangle);
    real time = impact_time(triangle, move);
    bool later = time > move.until || (time == first.time && !comes_before(index, first.triangle));
    if (minded && !later) {
        first = Impact(time, index);
        move.until = time;
    }
}

#ifdef FS_RARE
const uint kListed = 24u;

// The first impact of a move, out of the tree. Triangles whose planes the move does not come near are sifted out first.
Impact first_impact(Move move) {
    Impact first = Impact(real(2.0LF), 0u);
    uint listed[kListed];
    uint count = 0u;
    begin_search();
    RunCursor cursor = first_of_runs();
    bool listing = true;
    [[dont_unroll]] do {
        if (listing) {
            search_on(move);
            cursor = first_of_runs();
        }
        listing = true;
        [[dont_unroll]] do {
            uint triangle;
            bool found = next_of_runs(cursor, triangle);
            Triangle shape = triangle_at(triangle);
            precise real begin = product(shape.normal, difference(move.from, shape.a));
            precise real end = begin + move.until * product(shape.normal, move.way);
            bool apart = (begin > kCulled && end > kCulled) || (begin < -kCulled && end < -kCulled);
            if (found && !apart)
                listed[count++] = triangle;
            ++spent;
            listing = found && count < kListed;
        } while (listing);
        listing = run_count == 0u; // else the rest of the runs comes next
        uint i = 0u;
        [[dont_unroll]] do {
            if (i < count)
                hit(listed[i], move, first);
            ++i;
            ++spent;
        } while (i < count);
        count = 0u;
    } while ((search_goes_on() || !listing) && !overrun);
    return first;
}
#else
// Nothing is nearer to this place.
real3 free_place;
real free_distance;

bool is_free(real3 place) {
    real3 off = difference(place, free_place);
    precise real least = free_distance * free_distance;
    return product(off, off) < least;
}

// The first impact of a move along a face, with what was found beforehand to stand above that face's plane around it; or
// through free space.
Impact first_impact(Move move) {
    Impact first = Impact(real(2.0LF), 0u);
    bool one = resting.count > 0u && hold_at(resting.one.source) == kHoldFace;
    bool two = resting.count > 1u && hold_at(resting.two.source) == kHoldFace;
    uint source = one ? resting.one.source : resting.two.source;
    source = one || two ? source : 0u;
    Touch touch = touch_at(source);
    uvec4 words = triangle_words[2u * index_at(source) + 1u];
    bool front = product(touch.face, touch.triangle.normal) > ZERO;
    uint begin = front ? words.x : words.y;
    uint end = front ? words.y : words.z;
    bool listed = (one || two) && (words.w & kTriangleCrowded) == 0u;
    bool free = resting.count == 0u && is_free(move.from) && is_free(place_at(move, move.until));
    is_rare = is_rare || !(listed || free);
    if (is_rare || free)
        end = begin;
    [[dont_unroll]] do {
        if (begin < end)
            hit(indices[begin], move, first);
        ++begin;
        ++spent;
    } while (begin < end);
    return first;
}
#endif

real clipped(real from, real way, real until, real clip) {
    real edge = way < ZERO ? -kRegion : kRegion;
    precise real there = from + until * way;
    precise real time = (edge - from) / way;
    return abs(there) > kRegion && time < clip ? time : clip;
}

// A move that leaves the region ends in the open.
Impact clipped_cast(Move move) {
    if (largest_of(place_at(move, move.until)) > kRegion) {
        real until = clipped(move.from.x, move.way.x, move.until, move.until);
        until = clipped(move.from.y, move.way.y, move.until, until);
        until = clipped(move.from.z, move.way.z, move.until, until);
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
        remember(incoming, shape, was_hit || sides > ZERO ? POOL : released);
}

void finish_substep(Move move, uint released, uint edge) {
    Impact impact = clipped_cast(move);
    if (overrun || is_rare)
        return;
    bool was_hit = impact.time <= move.until;
    bool was_released = released != POOL;
    real time = was_hit ? impact.time : move.until;
    precise real size = time * largest_of(move.way);
    bool moves = size > kRest;
    bool one_face = pool_count == 1u && resting.count == 1u && is_above(0u) && !pool_shortened &&
                    stays_above_face(touch_at(0u), move.way);
    walk_corner = (was_hit || was_released) && resting.count == 2u && size > kStride;
    if (moves)
        pool_faceless = 0u;
    if (!was_hit && was_released)
        pool_faceless = with_bits(pool_faceless, released, 1u, moves ? 0u : 1u);
    bool arrives = !was_hit && !was_released;
    // Nothing in the way: without a plane to keep to, that is the probe itself.
    walk_proxy = arrives && resting.count == 0u ? walk_probe : place_at(move, arrives ? ONE : time);
    walk_rests = arrives && (resting.count == 0u || one_face);
    if (!arrives)
        take_in(was_hit, impact.triangle, was_released ? released : 0u, edge);
}

// When the move leaves what holds it. Tells also what covers it.
void consider_release(HalfSpace held, bool holding, uint i, real3 way, inout Release release, inout uint released) {
    Touch touch = touch_at(holding ? held.source : 0u);
    bool face = hold_at(held.source) == kHoldFace;
    Release one = release_of_face(touch, way, release.time);
#ifdef FS_RARE
    if (!face)
        one = release_of_rounded(touch, walk_proxy, way, release.time);
#else
    is_rare = is_rare || (holding && !face);
#endif
    if (holding && one.time < release.time) {
        release = one;
        released = held.source;
    }
    covers[i] = Cover(touch.triangle.a, holding && face);
}

void substep() {
    look_again(walk_proxy);
    find_way(walk_proxy, walk_probe);
    real3 way = resting.vector;
    walk_rests = largest_of(way) <= pool_tolerance && resting.count > 0u;
    Release release = Release(ONE, 3u);
    uint released = POOL;
#ifdef FS_RARE
    uint i = 0u;
    [[dont_unroll]] do {
        consider_release(held_at(resting, i), i < resting.count, i, way, release, released);
        ++i;
        ++spent;
    } while (i < 3u);
#else
    consider_release(resting.one, resting.count > 0u, 0u, way, release, released);
    consider_release(resting.two, resting.count > 1u, 1u, way, release, released);
    covers[2] = Cover(real3(ZERO), false);
    is_rare = is_rare || resting.count > 2u;
#endif
    if (!walk_rests)
        finish_substep(Move(walk_proxy, way, release.time), released, release.edge);
}

// One piece of the walk; afterwards it runs on, or has come to rest, to a corner, or treads on the spot.
void walk_on() {
    substep();
    if (overrun || is_rare)
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

// Begins to walk; a proxy out of the region flies straight to it first, or to the probe if its way does not cross it.
void begin_walk() {
    walk_corner = false;
    walk_rests = false;
    walk_runs = true;
#ifdef FS_RARE
    if (largest_of(walk_proxy) > kRegion) {
        real3 place = walk_proxy;
        bool enters = find_entry(walk_proxy, walk_probe, place);
        walk_proxy = enters ? place : walk_probe;
        walk_rests = !enters;
        walk_runs = enters;
    }
#else
    is_rare = is_rare || largest_of(walk_proxy) > kRegion;
#endif
    tread_place = walk_proxy;
    tread_substeps = walk_substeps;
}

// Where walks begin.

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
