// L6: the ways that lead from a corner or an edge of a mesh over its faces and along its edges, step for step as
// host/reference/god_object_ways.h.

#ifdef FS_F64
const real kFold = kWidth * real(4096.0LF);
#else
const real kFold = kWidth * real(32.0LF); // how near a corner a proxy may be kept off it by narrower folds
#endif

// A way over a triangle's face, or along its edge.
struct Way {
    real gain; // towards the probe, a length of way
    uint triangle;
    uint edge; // 3: over the face
};

// Where ways begin: a corner of the mesh, or a place on or near its surface. What is within reach of it is at it.
struct Crossing {
    real3 place;
    real reach;
    real3 out_way; // unit, away from the surface, on the proxy's side; 0 if not known
    bool corner;
    uint vertex; // of a corner
};

real reach_of(bool corner) {
    return corner ? kWidth * real(0.5LF) : kCorner * real(0.5LF);
}

// Keeps the nearest corner of the mesh within reach.
void consider_corner(uint vertex, real3 corner, inout Crossing crossing, inout real nearest) {
    real3 off = difference(corner, crossing.place);
    real square = product(off, off);
    if (square < nearest || (!(square > nearest) && crossing.corner && vertex < crossing.vertex)) {
        nearest = square;
        crossing.vertex = vertex;
        crossing.corner = true;
    }
}

// The steepest way found so far of those that gain less than `below`.
struct WaySearch {
    real3 pull; // to the probe
    real below;
    Way best;
    bool found;
};

void offer_way(bool offered, real3 direction, uint index, uint edge, inout WaySearch search) {
    real gain = product(direction, search.pull);
    bool taken = offered && gain < search.below && gain >= search.best.gain;
    if (search.found && gain == search.best.gain)
        taken = taken && comes_before(index, search.best.triangle);
    if (taken) {
        search.best = Way(gain, index, edge);
        search.found = true;
    }
}

real3 way_over_face(Triangle triangle, real3 pull) {
    return difference(pull, scaled(product(pull, triangle.normal), triangle.normal));
}

bool leads_in(Triangle triangle, uint i, Crossing from, real3 way) {
    real3 edge = edge_of(triangle, i);
    real3 inward = cross_product(triangle.normal, edge);
    real inside = product(inward, difference(from.place, corner_of(triangle, i)));
    precise real most = from.reach * sqrt(product(edge, edge));
    return !(inside <= most) || product(inward, way) > ZERO;
}

// Over the face, away from the edges that the crossing is on.
void offer_face(Triangle triangle, uint index, Crossing from, inout WaySearch search) {
    real3 way = way_over_face(triangle, search.pull);
    bool leads = leads_in(triangle, 0u, from, way) && leads_in(triangle, 1u, from, way) && leads_in(triangle, 2u, from, way);
    offer_way(leads, normalised(way), index, 3u, search);
}

// Along an edge that the crossing is on, to the end that is nearer to the probe.
void offer_edge(Triangle triangle, uint index, uint i, Crossing from, inout WaySearch search) {
    real3 start = corner_of(triangle, i);
    real3 edge = edge_of(triangle, i);
    real3 stop = corner_of(triangle, (i + 1u) % 3u);
    real rate = product(edge, search.pull);
    // Both of the edge's triangles walk it the same way.
    precise real steepness = rate * rate;
    precise real least = search.best.gain * search.best.gain * product(edge, edge) * real(0.99LF);
    real3 way = normalised(edge);
    real along = product(way, difference(from.place, start));
    real3 off = difference(difference(from.place, start), scaled(along, way));
    precise real reach = from.reach * from.reach;
    precise real longest = real(16.0LF) * from.reach * from.reach;
    bool forwards = product(way, search.pull) > ZERO;
    real3 ahead = difference(forwards ? stop : start, from.place);
    bool leads = steepness >= least && product(off, off) <= reach && product(ahead, ahead) > longest;
    offer_way(leads, forwards ? way : -way, index, i, search);
}

// The place so far along a way towards the probe, a skin off the surface there, in front of the way's triangle or behind.
real3 place_along(Crossing from, Way way, real3 pull, real size, bool front) {
    Triangle triangle = triangle_at(way.triangle);
    real3 normal = front ? triangle.normal : -triangle.normal;
    real3 along = normalised(edge_of(triangle, way.edge % 3u));
    real3 direction = product(along, pull) > ZERO ? along : -along;
    if (way.edge == 3u)
        direction = normalised(way_over_face(triangle, pull));
    uvec4 words = triangle_words[2u * way.triangle];
    uvec3 corners = triangle_corners(way.triangle);
    real3 still = real3(exact_zero);
    real3 there = sum(from.place, scaled(size, direction));
    real3 corner = corner_of(triangle, way.edge % 3u);
    precise real slack = kWidth - product(normal, difference(there, corner));
    HalfSpace one = HalfSpace(normal, slack, 0u);
    real3 off_plane = onto_plane(still, one).vector;
    uint across = way.edge == 0u ? words.y : way.edge == 1u ? words.z : way.edge == 2u ? words.w : kMeshBorder;
    bool alone = (across & kMeshManyBit) != 0u;
    // The edge's other triangle, whose corner off the edge tells which way it folds.
    uint other_index = alone ? way.triangle : across;
    Triangle other = triangle_at(other_index);
    uvec3 others = triangle_corners(other_index);
    uint begin = way.edge == 0u ? corners.x : way.edge == 1u ? corners.y : corners.z;
    uint end = way.edge == 0u ? corners.y : way.edge == 1u ? corners.z : corners.x;
    uint i = others.x != begin && others.x != end ? 0u : others.y != begin && others.y != end ? 1u : 2u;
    bool turned = (i == 0u ? others.y : i == 1u ? others.z : others.x) == begin;
    bool reversed = product(normal, triangle.normal) < ZERO;
    real3 beyond = turned == reversed ? other.normal : -other.normal;
    real3 apex = corner_of(other, i);
    precise real other_slack = kWidth - product(beyond, difference(there, corner));
    Projection valley = onto_line(still, one, HalfSpace(beyond, other_slack, 1u));
    bool folds_up = product(normal, difference(apex, corner)) > ZERO;
    real3 off_ridge = scaled(kWidth, normalised(sum(normal, beyond)));
    real3 off_valley = valley.count > 0u ? valley.vector : off_plane;
    return sum(there, alone ? off_plane : folds_up ? off_valley : off_ridge);
}
