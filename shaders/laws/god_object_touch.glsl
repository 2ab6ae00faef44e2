// L6: triangles that a god-object touches, the half-spaces that they leave free, and the pool of those that it may touch,
// step for step as host/reference/god_object_planes.h and god_object_walk.h. Edges and what follows from them are computed
// where they are needed. The hot kernel's pool is smaller, and leaves what does not fit to the other one.

struct Touch {
    uint feature;
    bool faceless; // its plane was tried from here and led nowhere
    Triangle triangle;
    real3 face; // unit normal, towards the proxy; 0 without area
    real height; // above the face's plane, not below 0
    real3 away; // unit, from the nearest point to the proxy
    real separation; // distance of the proxy
    real3 insides; // of the proxy from each edge, times its length; below 0 beyond it
};

const uint kHoldNone = 0u;
const uint kHoldFace = 1u;
const uint kHoldRounded = 2u;

bool above_face(Touch touch) {
    return touch.feature == kMeshFace;
}

real3 corner_of(Triangle triangle, uint i) {
    return i == 0u ? triangle.a : i == 1u ? triangle.b : triangle.c;
}

// From corner i to the next.
real3 edge_of(Triangle triangle, uint i) {
    return difference(i == 0u ? triangle.b : i == 1u ? triangle.c : triangle.a, corner_of(triangle, i));
}

// In the triangle's plane, square to edge i and as long.
real3 inward_of(Triangle triangle, uint i) {
    return cross_product(triangle.normal, edge_of(triangle, i));
}

// How fast a way leads inwards from each edge.
real3 inward_rates(Triangle triangle, real3 way) {
    return real3(product(inward_of(triangle, 0u), way), product(inward_of(triangle, 1u), way),
                 product(inward_of(triangle, 2u), way));
}

bool is_clear(real inside, real3 edge) {
    const real clear = kWidth * real(0.125LF) * kWidth * real(0.125LF);
    precise real square = inside * inside;
    precise real least = clear * product(edge, edge);
    return inside > ZERO && square > least;
}

// Beside the face, or too near its border to tell at a glance.
void look_closely(inout Touch touch, real3 proxy) {
    TrianglePoint nearest = nearest_on_triangle(proxy, touch.triangle);
    real3 away = -nearest.offset;
    if (nearest.feature < kMeshCorner) {
        real3 edge = normalised(edge_of(touch.triangle, nearest.feature - kMeshEdge));
        away = difference(away, scaled(product(away, edge), edge));
    }
    away = normalised(away);
    precise real size = sqrt(nearest.square);
    touch.feature = nearest.feature;
    if (nearest.feature != kMeshFace) {
        touch.separation = size;
        touch.away = away;
    }
}

// Finds out how the proxy stands to a triangle.
void look(inout Touch touch, real3 proxy) {
    Triangle triangle = touch.triangle;
    real height = product(triangle.normal, difference(proxy, triangle.a));
    touch.face = height < ZERO ? -triangle.normal : triangle.normal;
    touch.height = abs(height);
    touch.separation = touch.height;
    touch.away = touch.face;
    touch.feature = kMeshFace;
    touch.insides = real3(product(inward_of(triangle, 0u), difference(proxy, triangle.a)),
                          product(inward_of(triangle, 1u), difference(proxy, triangle.b)),
                          product(inward_of(triangle, 2u), difference(proxy, triangle.c)));
    bool clear = is_clear(touch.insides.x, edge_of(triangle, 0u)) && is_clear(touch.insides.y, edge_of(triangle, 1u)) &&
                 is_clear(touch.insides.z, edge_of(triangle, 2u));
    if (!clear)
        look_closely(touch, proxy);
}

bool lands_inside(real inside, real rate, real height, real descent) {
    precise real landing = inside * descent + height * rate;
    return landing > ZERO;
}

// Whether a move that descends towards the plane of a triangle, from beside it, reaches the plane on the inner side of
// what is nearest: an edge, or the two edges of a corner.
bool lands_on_face(Touch touch, real3 way, real descent) {
    bool corner = touch.feature >= kMeshCorner;
    uint first = touch.feature - (corner ? kMeshCorner : kMeshEdge);
    uint second = corner ? (first + 2u) % 3u : first;
    real3 rates = inward_rates(touch.triangle, way);
    bvec3 lands = bvec3(lands_inside(touch.insides.x, rates.x, touch.height, descent),
                        lands_inside(touch.insides.y, rates.y, touch.height, descent),
                        lands_inside(touch.insides.z, rates.z, touch.height, descent));
    return (lands.x || (first != 0u && second != 0u)) && (lands.y || (first != 1u && second != 1u)) &&
           (lands.z || (first != 2u && second != 2u));
}

// What of a touched triangle stands against a move.
uint hold_of(Touch touch, real3 way) {
    precise real descent = -product(touch.face, way);
    bool plane = touch.height >= kPlane && !touch.faceless;
    bool descends = descent > kRest;
    bool lands = lands_on_face(touch, way, descent);
    uint hold = touch.separation <= kTangent ? kHoldRounded : kHoldNone;
    if (plane)
        hold = !descends ? kHoldNone : lands ? kHoldFace : hold;
    return above_face(touch) ? kHoldFace : hold;
}

HalfSpace half_space(Touch touch, uint hold, uint source) {
    bool face = hold == kHoldFace;
    precise real slack = kWidth - (face ? touch.height : touch.separation);
    return HalfSpace(face ? touch.face : touch.away, slack, source);
}

// When, and over which edge (3: none), a move along a triangle leaves it.
struct Release {
    real time;
    uint edge;
};

// Whether a whole move along the face's plane ends above the face.
bool stays_above_face(Touch touch, real3 way) {
    precise real3 insides = touch.insides + inward_rates(touch.triangle, way);
    return insides.x > ZERO && insides.y > ZERO && insides.z > ZERO;
}

void leave_over(uint edge, real inside, real rate, real3 along, inout Release release) {
    precise real ahead = inside + rate * release.time;
    precise real way_out = inside + kWidth * sqrt(product(along, along));
    precise real time = way_out / -rate;
    if (ahead < ZERO && rate < ZERO && time < release.time)
        release = Release(time > ZERO ? time : ZERO, edge);
}

// A move along the face's plane leaves it a skin beyond an edge.
Release release_of_face(Touch touch, real3 way, real until) {
    Release release = Release(until, 3u);
    real3 rates = inward_rates(touch.triangle, way);
    leave_over(0u, touch.insides.x, rates.x, edge_of(touch.triangle, 0u), release);
    leave_over(1u, touch.insides.y, rates.y, edge_of(touch.triangle, 1u), release);
    leave_over(2u, touch.insides.z, rates.z, edge_of(touch.triangle, 2u), release);
    return release;
}

#ifdef FS_RARE
void leave_at(real time, inout Release release) {
    if (time < release.time)
        release.time = time > ZERO ? time : ZERO;
}

// A move along the plane of a rounded edge or corner leaves it a skin aside, or beyond the edge's ends. `proxy` is where
// the triangle was looked at from.
Release release_of_rounded(Touch touch, real3 proxy, real3 way, real until) {
    Release release = Release(until, 3u);
    if (touch.feature >= kMeshCorner) {
        precise real time = kWidth / sqrt(product(way, way));
        leave_at(time, release);
        return release;
    }
    uint i = touch.feature - kMeshEdge;
    real3 edge = edge_of(touch.triangle, i);
    precise real size = sqrt(product(edge, edge));
    precise real rate = product(edge, way) / size;
    precise real along = product(edge, difference(proxy, corner_of(touch.triangle, i))) / size;
    precise real share = rate / size;
    real3 aside = difference(way, scaled(share, edge));
    precise real time_aside = kWidth / sqrt(product(aside, aside));
    precise real time_end = (size + kWidth - along) / rate;
    precise real time_begin = (along + kWidth) / -rate;
    leave_at(time_aside, release);
    if (rate > ZERO)
        leave_at(time_end, release);
    else if (rate < ZERO)
        leave_at(time_begin, release);
    return release;
}
#endif

// The pool: POOL triangles.

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
