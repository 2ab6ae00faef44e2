// L6: the half-spaces that constrain a god-object: the projection onto those that up to two planes allow, and the
// half-space that a touched triangle leaves free; step for step as host/reference/god_object_planes.h. A third plane is
// the host's.

// normal . v >= slack.
struct HalfSpace {
    real3 normal; // unit
    real slack;
    uint source; // whose it is
};

// The vector nearest to a wish among those that the half-spaces allow, and the half-spaces active there.
struct Projection {
    real3 vector;
    HalfSpace one;
    HalfSpace two;
    real2 multipliers; // vector - wish = sum multipliers * normals
    uint count;
};

const HalfSpace kNoHalfSpace = HalfSpace(real3(ZERO), ZERO, 0u);

real largest_of(real3 v) {
    real x = abs(v.x);
    real y = abs(v.y);
    real z = abs(v.z);
    real xy = x > y ? x : y;
    return xy > z ? xy : z;
}

bool is_finite(real3 v) {
    return largest_of(v) <= LARGEST;
}

Projection free_projection(real3 wish) {
    return Projection(wish, kNoHalfSpace, kNoHalfSpace, real2(ZERO), 0u);
}

// Whether the half-space of `source` is active.
bool is_active(Projection projection, uint source) {
    return (projection.count > 0u && projection.one.source == source) ||
           (projection.count > 1u && projection.two.source == source);
}

real miss_of(HalfSpace space, real3 vector) {
    precise real miss = space.slack - product(space.normal, vector);
    return miss;
}

Projection onto_plane(real3 wish, HalfSpace one) {
    real multiplier = miss_of(one, wish);
    real3 vector = sum(wish, scaled(multiplier, one.normal));
    vector = sum(vector, scaled(miss_of(one, vector), one.normal));
    return Projection(vector, one, kNoHalfSpace, real2(multiplier, ZERO), 1u);
}

// Onto the line where two planes meet; count stays 0 if they are parallel.
Projection onto_line(real3 wish, HalfSpace one, HalfSpace other) {
    const real parallel = EPSILON * EPSILON * real(256.0LF);
    real3 line = cross_product(one.normal, other.normal);
    real square = product(line, line);
    real3 to_one = divided(cross_product(other.normal, line), square);
    real3 to_other = divided(cross_product(line, one.normal), square);
    precise real along = quotient(product(line, wish), square);
    real3 vector = sum(sum(scaled(along, line), scaled(one.slack, to_one)), scaled(other.slack, to_other));
    vector = sum(vector, sum(scaled(miss_of(one, vector), to_one), scaled(miss_of(other, vector), to_other)));
    real3 shift = difference(vector, wish);
    return Projection(vector, one, other, real2(product(shift, to_one), product(shift, to_other)),
                      square > parallel ? 2u : 0u);
}

bool stays_within(HalfSpace space, real3 vector, real below) {
    precise real least = space.slack - below;
    return product(space.normal, vector) >= least;
}

// Whether a projection pushes only off its planes and stays within those of another.
bool is_nearest(Projection result, Projection others, real tolerance) {
    bool pushes = result.multipliers.x >= -tolerance && (result.count < 2u || result.multipliers.y >= -tolerance);
    bool within = (others.count < 1u || stays_within(others.one, result.vector, tolerance)) &&
                  (others.count < 2u || stays_within(others.two, result.vector, tolerance));
    return result.count > 0u && pushes && within;
}

// Adds a half-space that `now` violates. False, and `now` unchanged, if no plane or line satisfies them all.
bool add_half_space(real3 wish, HalfSpace added, real tolerance, inout Projection now) {
    uint tried = 0u;
    uint last = now.count + 1u;
    bool found = false;
    [[dont_unroll]] do {
        Projection next = onto_plane(wish, added);
        if (tried > 0u) {
            HalfSpace other = now.one;
            if (tried > 1u)
                other = now.two;
            next = onto_line(wish, added, other);
        }
        found = is_nearest(next, now, tolerance);
        if (found)
            now = next;
        ++tried;
        ++spent;
    } while (!found && tried < last);
    is_left = is_left || (!found && now.count > 1u);
    return found;
}

// A triangle near the proxy. Edges and what follows from them are computed where they are needed.
struct Touch {
    uint feature;
    bool face_tried; // its plane was tried from here without success
    Triangle triangle;
    real3 face; // unit normal, towards the proxy; 0 without area
    real height; // above the face's plane, not below 0
    real3 away; // unit, from the nearest point to the proxy
    real separation; // distance of the proxy
    real3 insides; // of the proxy from each edge, times its length; below 0 beyond it
};

// What a hash of the walk takes in of a touch.
uint digest_of(Touch touch, uint triangle) {
    uint stands = triangle << 4 | touch.feature << 1 | (touch.face_tried ? 1u : 0u);
    return stands * 2654435761u + folded(touch.height) * 2246822519u + folded(touch.separation) * 3266489917u +
           folded(touch.insides.x) * 668265263u + folded(touch.insides.y) * 374761393u +
           folded(touch.insides.z) * 2869860233u;
}

const uint kConstraintNone = 0u;
const uint kConstraintFace = 1u;
const uint kConstraintRounded = 2u;

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

// How fast a displacement leads inwards from each edge.
real3 inward_rates(Triangle triangle, real3 displacement) {
    return real3(product(inward_of(triangle, 0u), displacement), product(inward_of(triangle, 1u), displacement),
                 product(inward_of(triangle, 2u), displacement));
}

bool is_clear(real inside, real3 edge) {
    const real clear = kWidth * real(0.125LF) * kWidth * real(0.125LF);
    precise real square = inside * inside;
    precise real least = clear * product(edge, edge);
    return inside > ZERO && square > least;
}

// Outside of the face, or too near its border for the quick test.
void update_touch_beside_face(inout Touch touch, real3 proxy) {
    TrianglePoint nearest = nearest_on_triangle(proxy, touch.triangle);
    real3 away = -nearest.offset;
    if (nearest.feature < kMeshCorner) {
        real3 edge = normalised(edge_of(touch.triangle, nearest.feature - kMeshEdge));
        away = difference(away, scaled(product(away, edge), edge));
    }
    away = normalised(away);
    precise real size = root(nearest.square);
    touch.feature = nearest.feature;
    if (nearest.feature != kMeshFace) {
        touch.separation = size;
        touch.away = away;
    }
}

// Finds out how the proxy stands to a triangle.
void update_touch(inout Touch touch, real3 proxy) {
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
        update_touch_beside_face(touch, proxy);
}

bool lands_inside(real inside, real rate, real height, real descent) {
    precise real landing = inside * descent + height * rate;
    return landing > ZERO;
}

// Whether a move that descends towards the plane of a triangle, from outside of its face, reaches the plane on the inner side of
// what is nearest: an edge, or the two edges of a corner.
bool lands_on_face(Touch touch, real3 displacement, real descent) {
    bool corner = touch.feature >= kMeshCorner;
    uint first = touch.feature - (corner ? kMeshCorner : kMeshEdge);
    uint second = corner ? (first + 2u) % 3u : first;
    real3 rates = inward_rates(touch.triangle, displacement);
    bvec3 lands = bvec3(lands_inside(touch.insides.x, rates.x, touch.height, descent),
                        lands_inside(touch.insides.y, rates.y, touch.height, descent),
                        lands_inside(touch.insides.z, rates.z, touch.height, descent));
    return (lands.x || (first != 0u && second != 0u)) && (lands.y || (first != 1u && second != 1u)) &&
           (lands.z || (first != 2u && second != 2u));
}

// The part of a touched triangle that constrains a move.
uint constraint_of(Touch touch, real3 displacement) {
    precise real descent = -product(touch.face, displacement);
    bool plane = touch.height >= kPlane && !touch.face_tried;
    bool descends = descent > kRest;
    bool lands = lands_on_face(touch, displacement, descent);
    uint constraint = touch.separation <= kTangent ? kConstraintRounded : kConstraintNone;
    if (plane)
        constraint = !descends ? kConstraintNone : lands ? kConstraintFace : constraint;
    return above_face(touch) ? kConstraintFace : constraint;
}

HalfSpace half_space(Touch touch, uint constraint, uint source) {
    bool face = constraint == kConstraintFace;
    precise real slack = kWidth - (face ? touch.height : touch.separation);
    return HalfSpace(face ? touch.face : touch.away, slack, source);
}

// When, and over which edge (3: none), a move along a face's plane leaves it.
struct Release {
    real time;
    uint edge;
};

// Whether a whole move along the face's plane ends above the face.
bool stays_above_face(Touch touch, real3 displacement) {
    precise real3 insides = touch.insides + inward_rates(touch.triangle, displacement);
    return insides.x > ZERO && insides.y > ZERO && insides.z > ZERO;
}

void leave_over(uint edge, real inside, real rate, real3 along, inout Release release) {
    precise real ahead = inside + rate * release.time;
    precise real outside = inside + kWidth * root(product(along, along));
    precise real time = quotient(outside, -rate);
    if (ahead < ZERO && rate < ZERO && time < release.time)
        release = Release(time > ZERO ? time : ZERO, edge);
}

// A move along the face's plane leaves it a skin beyond an edge.
Release release_of_face(Touch touch, real3 displacement, real until) {
    Release release = Release(until, 3u);
    real3 rates = inward_rates(touch.triangle, displacement);
    leave_over(0u, touch.insides.x, rates.x, edge_of(touch.triangle, 0u), release);
    leave_over(1u, touch.insides.y, rates.y, edge_of(touch.triangle, 1u), release);
    leave_over(2u, touch.insides.z, rates.z, edge_of(touch.triangle, 2u), release);
    return release;
}
