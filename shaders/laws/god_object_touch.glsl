// L6: a triangle that a god-object touches, and the half-space that it leaves free, step for step as
// host/reference/god_object_touch.h. Edges and what follows from them are computed where they are needed.

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
