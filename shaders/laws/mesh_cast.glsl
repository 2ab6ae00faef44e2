// L6: how closely a straight move approaches a triangle, step for step as host/reference/mesh_cast.h.

// The skin that keeps a god-object off every triangle.
#ifdef FS_F64
const real kWidth = real(9.094947017729282379150390625e-13LF); // 2^-40
const real kFarOff = real(8.0LF); // no displacement is longer
#else
const real kWidth = real(3.0517578125e-05LF); // 2^-15
const real kFarOff = real(4.0LF);
#endif
const real kImpact = kWidth * real(0.875LF);
const real kPlane = kWidth * real(0.90625LF);
const real kCulled = kWidth * real(0.9375LF);
const real kTangent = kWidth * real(1.015625LF);
const real kNear = kWidth * real(2.0LF);
const real kCorner = kWidth * real(8.0LF);
const real kPlace = EPSILON * real(32.0LF);
const real kRest = kWidth * real(0.015625LF);
const uint kNewtonSteps = 40u;

// from + t * displacement for t in [0, until].
struct Move {
    real3 from;
    real3 displacement;
    real until;
};

real3 place_at(Move move, real t) {
    return sum(move.from, scaled(t, move.displacement));
}

// The part of a move that is within kCulled of the triangle's plane; empty if begin > end.
struct Stretch {
    real begin;
    real end;
};

Stretch stretch_near_plane(Move move, real height, real rate) {
    precise real last = height + move.until * rate;
    precise real enter_above = quotient(kCulled - height, rate);
    precise real enter_below = quotient(-kCulled - height, rate);
    real begin = ZERO;
    real end = move.until;
    if (height > kCulled)
        begin = enter_above;
    else if (height < -kCulled)
        begin = enter_below;
    if (last > kCulled)
        end = enter_above;
    else if (last < -kCulled)
        end = enter_below;
    Stretch stretch = Stretch(begin > ZERO ? begin : ZERO, end < move.until ? end : move.until);
    if ((height > kCulled && last > kCulled) || (height < -kCulled && last < -kCulled))
        stretch = Stretch(ONE, ZERO);
    return stretch;
}

bool beyond_edge(real3 start, real3 stop, real3 normal, real3 begin, real3 end) {
    real3 edge = difference(stop, start);
    real3 inward = cross_product(normal, edge);
    real one = product(inward, difference(begin, start));
    real other = product(inward, difference(end, start));
    real nearer = one > other ? one : other;
    precise real square = nearer * nearer;
    precise real reach = kWidth * kWidth * product(edge, edge);
    return nearer < ZERO && square > reach;
}

// Whether both ends of a stretch are further than the skin outside the same edge.
bool beyond_an_edge(Triangle triangle, real3 begin, real3 end) {
    return beyond_edge(triangle.a, triangle.b, triangle.normal, begin, end) ||
           beyond_edge(triangle.b, triangle.c, triangle.normal, begin, end) ||
           beyond_edge(triangle.c, triangle.a, triangle.normal, begin, end);
}

// The part of an offset that is square to an edge.
real3 square_to(real3 edge, real3 offset) {
    precise real share = quotient(product(offset, edge), product(edge, edge));
    return difference(offset, scaled(share, edge));
}

// Whether rounding may take one of two points this far apart for the other, seen from this distance.
bool is_one_place(real3 apart, real distance) {
    precise real square = kPlace * (kPlace + real(2.0LF) * distance);
    return product(apart, apart) <= square;
}

// The rate of approach, times the distance, to an edge that begins at a corner, if a move that is at the corner goes on
// over it and this is more than `approach`.
void approach_edge(real3 edge, real3 to_corner, real distance, real3 displacement, inout real approach) {
    real3 offset = square_to(edge, to_corner);
    real rate = product(offset, displacement);
    if (product(edge, displacement) > ZERO && rate > approach && is_one_place(difference(to_corner, offset), distance))
        approach = rate;
}

// Counts the edges from a corner, and whether the move leads inwards over both, if the nearest point is at that corner.
void approach_at_corner(bool at_corner, real3 to_corner, real distance, real3 edge, real3 edge_before, real3 normal,
                        real3 displacement, inout real approach, inout bool inwards) {
    if (at_corner) {
        approach_edge(edge, to_corner, distance, displacement, approach);
        approach_edge(-edge_before, to_corner, distance, displacement, approach);
        inwards = inwards && product(cross_product(normal, edge), displacement) > ZERO &&
                  product(cross_product(normal, edge_before), displacement) > ZERO;
    }
}

// How fast a move from `place` approaches a triangle, times the distance: by the fastest of the features over which it
// may go on.
real approach_of(TrianglePoint nearest, Triangle triangle, real3 place, real distance, real3 displacement) {
    real approach = product(nearest.offset, displacement);
    if (nearest.feature == kMeshFace)
        return approach;
    real3 edge_0 = difference(triangle.b, triangle.a);
    real3 edge_1 = difference(triangle.c, triangle.b);
    real3 edge_2 = difference(triangle.a, triangle.c);
    bool on_edge = nearest.feature < kMeshCorner;
    uint told = nearest.feature - (on_edge ? kMeshEdge : kMeshCorner);
    real3 edge = told == 0u ? edge_0 : told == 1u ? edge_1 : edge_2;
    bool inwards = true;
    if (on_edge) {
        approach = product(square_to(edge, nearest.offset), displacement);
        inwards = product(cross_product(triangle.normal, edge), displacement) > ZERO;
    }
    real3 to_a = difference(triangle.a, place);
    real3 to_b = difference(triangle.b, place);
    real3 to_c = difference(triangle.c, place);
    bool at_a = on_edge ? told != 1u && is_one_place(difference(to_a, nearest.offset), distance) : told == 0u;
    bool at_b = on_edge ? told != 2u && is_one_place(difference(to_b, nearest.offset), distance) : told == 1u;
    bool at_c = on_edge ? told != 0u && is_one_place(difference(to_c, nearest.offset), distance) : told == 2u;
    approach_at_corner(at_a, to_a, distance, edge_0, edge_2, triangle.normal, displacement, approach,
                       inwards);
    approach_at_corner(at_b, to_b, distance, edge_1, edge_0, triangle.normal, displacement, approach,
                       inwards);
    approach_at_corner(at_c, to_c, distance, edge_2, edge_1, triangle.normal, displacement, approach,
                       inwards);
    real height = product(triangle.normal, nearest.offset);
    precise real rate = height * product(triangle.normal, displacement);
    bool over_face = inwards && is_one_place(difference(nearest.offset, scaled(height, triangle.normal)), distance);
    return over_face && rate > approach ? rate : approach;
}

// The time within the move at which it comes within kImpact of the triangle, approaching; above `move.until` if it
// never does.
real impact_time(Triangle triangle, Move move) {
    precise real never = move.until + ONE;
    real height = product(triangle.normal, difference(move.from, triangle.a));
    Stretch stretch = stretch_near_plane(move, height, product(triangle.normal, move.displacement));
    real t = stretch.begin;
    bool meets = t <= stretch.end && !beyond_an_edge(triangle, place_at(move, t), place_at(move, stretch.end));
    real time = meets ? t : never;
    uint left = meets ? kNewtonSteps : 0u;
    [[dont_unroll]] do {
        real3 place = place_at(move, t);
        TrianglePoint nearest = nearest_on_triangle(place, triangle);
        precise real size = root(nearest.square);
        real approach = approach_of(nearest, triangle, place, size, move.displacement); // times the distance
        precise real excess = size - kImpact;
        precise real next = t + quotient(excess * size, approach);
        bool leaves = !(approach > ZERO);
        bool touches = !(excess > kRest);
        bool late = !(next <= stretch.end);
        if (left > 0u) {
            if (leaves || (!touches && late)) {
                time = never;
                left = 0u;
            } else if (touches) {
                time = t;
                left = 0u;
            } else {
                t = next;
                time = t;
                --left;
            }
        }
        ++spent;
    } while (left > 0u);
    return time;
}

