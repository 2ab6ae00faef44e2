// L6: how close a straight move comes to a triangle, step for step as host/reference/mesh_cast.h.

// The skin that keeps a god-object off every triangle.
#ifdef FS_F64
const real kWidth = real(9.094947017729282379150390625e-13LF); // 2^-40
#else
const real kWidth = real(6.103515625e-05LF); // 2^-14
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

// from + t * way for t in [0, until].
struct Move {
    real3 from;
    real3 way;
    real until;
};

real3 place_at(Move move, real t) {
    return sum(move.from, scaled(t, move.way));
}

// The part of a move that is within kCulled of the triangle's plane; empty if begin > end.
struct Stretch {
    real begin;
    real end;
};

Stretch stretch_near_plane(Move move, real height, real rate) {
    precise real last = height + move.until * rate;
    precise real enter_above = (kCulled - height) / rate;
    precise real enter_below = (-kCulled - height) / rate;
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
    precise real share = product(offset, edge) / product(edge, edge);
    return difference(offset, scaled(share, edge));
}

// Whether two points this far apart may be one, by what rounding makes of a place.
bool is_one_place(real3 apart) {
    return product(apart, apart) <= kPlace * kPlace;
}

// The rate of approach, times the distance, to an edge that begins at a corner, if a move that is at the corner goes on
// over it and this is more than `approach`.
void approach_edge(real3 edge, real3 to_corner, real3 way, inout real approach) {
    real3 offset = square_to(edge, to_corner);
    real rate = product(offset, way);
    if (product(edge, way) > ZERO && rate > approach && is_one_place(difference(to_corner, offset)))
        approach = rate;
}

// Counts the edges from a corner, and whether the move leads inwards over both, if the nearest point is at that corner.
void approach_at_corner(bool at_corner, real3 to_corner, real3 edge, real3 edge_before, real3 normal, real3 way,
                        inout real approach, inout bool inwards) {
    if (at_corner) {
        approach_edge(edge, to_corner, way, approach);
        approach_edge(-edge_before, to_corner, way, approach);
        inwards = inwards && product(cross_product(normal, edge), way) > ZERO &&
                  product(cross_product(normal, edge_before), way) > ZERO;
    }
}

// How fast a move from `place` approaches a triangle, times the distance: by the fastest of the features over which it
// may go on.
real approach_of(TrianglePoint nearest, Triangle triangle, real3 place, real3 way) {
    real approach = product(nearest.offset, way);
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
        approach = product(square_to(edge, nearest.offset), way);
        inwards = product(cross_product(triangle.normal, edge), way) > ZERO;
    }
    real3 to_a = difference(triangle.a, place);
    real3 to_b = difference(triangle.b, place);
    real3 to_c = difference(triangle.c, place);
    bool at_a = on_edge ? told != 1u && is_one_place(difference(to_a, nearest.offset)) : told == 0u;
    bool at_b = on_edge ? told != 2u && is_one_place(difference(to_b, nearest.offset)) : told == 1u;
    bool at_c = on_edge ? told != 0u && is_one_place(difference(to_c, nearest.offset)) : told == 2u;
    approach_at_corner(at_a, to_a, edge_0, edge_2, triangle.normal, way, approach, inwards);
    approach_at_corner(at_b, to_b, edge_1, edge_0, triangle.normal, way, approach, inwards);
    approach_at_corner(at_c, to_c, edge_2, edge_1, triangle.normal, way, approach, inwards);
    real height = product(triangle.normal, nearest.offset);
    precise real rate = height * product(triangle.normal, way);
    bool over_face = inwards && is_one_place(difference(nearest.offset, scaled(height, triangle.normal)));
    return over_face && rate > approach ? rate : approach;
}

// The time within the move at which it comes within kImpact of the triangle, approaching; above `move.until` if it
// never does.
real impact_time(Triangle triangle, Move move) {
    precise real never = move.until + ONE;
    real t = ZERO;
    real until = move.until;
    bool meets = true;
    if (product(triangle.normal, triangle.normal) > ZERO) {
        real height = product(triangle.normal, difference(move.from, triangle.a));
        Stretch stretch = stretch_near_plane(move, height, product(triangle.normal, move.way));
        t = stretch.begin;
        until = stretch.end;
        meets = t <= until && !beyond_an_edge(triangle, place_at(move, t), place_at(move, until));
    }
    real time = meets ? t : never;
    uint left = meets ? kNewtonSteps : 0u;
    [[dont_unroll]] do {
        real3 place = place_at(move, t);
        TrianglePoint nearest = nearest_on_triangle(place, triangle);
        precise real size = sqrt(nearest.square);
        real approach = approach_of(nearest, triangle, place, move.way); // times the distance
        precise real excess = size - kImpact;
        precise real next = t + excess * size / approach;
        bool leaves = !(approach > ZERO);
        bool touches = !(excess > kRest);
        bool late = !(next <= until);
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

#ifdef FS_RARE
// The triangles that a move may come close to, out of the tree. A search goes on in pieces: runs of triangles are
// collected until there is no room for more, looked at, and so on.

const uint kMeshStack = 145u; // 3 siblings a node of the longest path to a leaf, and the root
const uint kRuns = 16u;
#ifdef FS_F64
const real kSteep = real(1e30LF);
#else
const real kSteep = real(1e15LF);
#endif
const real kBoxMargin = kCorner + real(9.5367431640625e-07LF); // 2^-20

uint stack[kMeshStack];
uint runs[kRuns]; // as leaves are written
uint stack_height;
uint run_count;

real steepness(real way) {
    precise real inverse = ONE / way;
    precise real steep = abs(way) * kSteep;
    return steep > ONE ? inverse : kSteep;
}

real4 lesser(real4 one, real4 other) {
    return mix(one, other, lessThan(other, one));
}

real4 greater(real4 one, real4 other) {
    return mix(one, other, greaterThan(other, one));
}

// The interval of times at which a move is between two bounds.
void clip(real4 low, real4 high, real from, real inverse, inout real4 begin, inout real4 end) {
    precise real4 one = (low - real4(kBoxMargin + from)) * real4(inverse);
    precise real4 other = (high + real4(kBoxMargin - from)) * real4(inverse);
    begin = greater(begin, lesser(one, other));
    end = lesser(end, greater(one, other));
}

void begin_search() {
    stack[0] = 0u;
    stack_height = 1u;
    run_count = 0u;
}

// Goes on until the runs are full or the tree is done.
void search_on(Move move) {
    real3 inverse = real3(steepness(move.way.x), steepness(move.way.y), steepness(move.way.z));
    bool going = stack_height > 0u && run_count + kMeshChildren <= kRuns;
    [[dont_unroll]] do {
        if (going) {
            MeshNode4 node = nodes[stack[--stack_height]];
            real4 begin = real4(ZERO);
            real4 end = real4(move.until);
            clip(real4(node.low_x), real4(node.high_x), move.from.x, inverse.x, begin, end);
            clip(real4(node.low_y), real4(node.high_y), move.from.y, inverse.y, begin, end);
            clip(real4(node.low_z), real4(node.high_z), move.from.z, inverse.z, begin, end);
            [[unroll]] for (uint i = 0u; i < kMeshChildren; ++i)
                if (node.child[i] != kMeshNoChild && begin[i] <= end[i]) {
                    if ((node.child[i] & kMeshLeaf) == 0u)
                        stack[stack_height++] = node.child[i];
                    else
                        runs[run_count++] = node.child[i];
                }
        }
        ++spent;
        going = going && stack_height > 0u && run_count + kMeshChildren <= kRuns && spent < spent_limit;
    } while (going);
    if (stack_height > 0u && spent >= spent_limit)
        overrun = true;
}

bool search_goes_on() {
    return stack_height > 0u && !overrun;
}

// Goes through the triangles of the runs that were collected.
struct RunCursor {
    uint run;
    uint next;
    uint end;
};

RunCursor first_of_runs() {
    return RunCursor(0u, 0u, 0u);
}

// The next triangle; false if there is none, and then the runs are empty.
bool next_of_runs(inout RunCursor cursor, out uint triangle) {
    if (cursor.next == cursor.end && cursor.run < run_count) {
        uint leaf = runs[cursor.run++];
        cursor.next = (leaf & ~kMeshLeaf) / kMeshLeafTriangles;
        cursor.end = cursor.next + leaf % kMeshLeafTriangles + 1u;
    }
    bool found = cursor.next < cursor.end;
    triangle = found ? cursor.next : 0u;
    if (found)
        ++cursor.next;
    else
        run_count = 0u;
    return found;
}

real4 beyond(real4 low, real4 high, real at) {
    precise real4 below = low - at;
    precise real4 above = at - high;
    return greater(greater(below, above), real4(ZERO));
}

// How far each of the four boxes of a node is from a place, squared.
real4 box_squares(MeshNode4 node, real3 place) {
    real4 x = beyond(real4(node.low_x), real4(node.high_x), place.x);
    real4 y = beyond(real4(node.low_y), real4(node.high_y), place.y);
    real4 z = beyond(real4(node.low_z), real4(node.high_z), place.z);
    precise real4 squares = x * x + y * y + z * z;
    return squares;
}

// A distance within which there is nothing about a place, up to half the mesh's frame: that of the
// nearest leaf's box, less what rounding and the skin make of it.
real free_reach(real3 place) {
    const real most = real(0.5LF);
    real nearest = most * most;
    stack[0] = 0u;
    stack_height = 1u;
    [[dont_unroll]] do {
        MeshNode4 node = nodes[stack[--stack_height]];
        real4 squares = box_squares(node, place);
        [[unroll]] for (uint i = 0u; i < kMeshChildren; ++i)
            if (node.child[i] != kMeshNoChild && squares[i] < nearest) {
                if ((node.child[i] & kMeshLeaf) == 0u)
                    stack[stack_height++] = node.child[i];
                else
                    nearest = squares[i];
            }
        ++spent;
    } while (stack_height > 0u && spent < spent_limit);
    precise real reach = sqrt(nearest) - real(2.0LF) * kBoxMargin;
    return stack_height == 0u && reach > ZERO ? reach : ZERO;
}
#endif
