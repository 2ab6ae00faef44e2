// L6: which of a block's candidates is nearest to each of its eight probes, and what stands about it in the buffers of the
// kernel of meshes. Only squared distances are computed, each with the operations of mesh_triangle.glsl in their order; what
// the probes share of them is computed once. The corners of a record are sorted by (x, y, z), which is how edges are walked,
// so that no edge needs to be turned.

// Two coordinates along each axis: eight points. Of a corner relative to the probes, or of the probes.
struct Points {
    real2 x;
    real2 y;
    real2 z;
};

// A number for each of the eight: the first z, the second z; in each x runs fastest.
struct Eight {
    real4 first;
    real4 second;
};

struct EdgeSquares {
    Eight square;
    bvec4 first_within; // strictly between the ends
    bvec4 second_within;
};

struct Winners {
    Eight square;
    uvec4 first; // candidates
    uvec4 second;
};

Points relative(real3 corner, Points probes) {
    precise real2 x = corner.x - probes.x;
    precise real2 y = corner.y - probes.y;
    precise real2 z = corner.z - probes.z;
    return Points(x, y, z);
}

Points chosen(bool other, Points points, Points others) {
    return Points(other ? others.x : points.x, other ? others.y : points.y, other ? others.z : points.z);
}

Eight sums(real2 x, real2 y, real2 z) {
    precise real4 plane = x.xyxy + y.xxyy;
    precise real4 first = plane + z.x;
    precise real4 second = plane + z.y;
    return Eight(first, second);
}

Eight products(Points points, real3 v) {
    precise real2 x = points.x * real2(v.x);
    precise real2 y = points.y * real2(v.y);
    precise real2 z = points.z * real2(v.z);
    return sums(x, y, z);
}

Eight squares(Points points) {
    precise real2 x = points.x * points.x;
    precise real2 y = points.y * points.y;
    precise real2 z = points.z * points.z;
    return sums(x, y, z);
}

// Of four probes of one z. `ahead` is start . side: how far back the probe lies, so that its foot is at -ahead.
real4 edge_square(real4 ahead, Points start, real z, real3 side, real length_square, real4 start_square,
                  real4 end_square, out bvec4 within) {
    precise real4 along = -ahead;
    precise real4 share = quotient(along, length_square);
    precise real4 foot_x = start.x.xyxy + share * real4(side.x);
    precise real4 foot_y = start.y.xxyy + share * real4(side.y);
    precise real4 foot_z = z + share * real4(side.z);
    precise real4 square = foot_x * foot_x + foot_y * foot_y + foot_z * foot_z;
    bvec4 behind_end = lessThan(along, real4(length_square));
    bvec4 past_start = greaterThan(along, real4(ZERO));
    within = bvec4(uvec4(behind_end) & uvec4(past_start));
    return mix(start_square, mix(end_square, square, behind_end), past_start);
}

EdgeSquares edge_squares(Points start, real3 side, real length_square, Eight start_square, Eight end_square) {
    Eight ahead = products(start, side);
    EdgeSquares edge;
    edge.square.first = edge_square(ahead.first, start, start.z.x, side, length_square, start_square.first,
                                    end_square.first, edge.first_within);
    edge.square.second = edge_square(ahead.second, start, start.z.y, side, length_square, start_square.second,
                                     end_square.second, edge.second_within);
    return edge;
}

bvec4 all_of(bvec4 a, bvec4 b) {
    return bvec4(uvec4(a) & uvec4(b));
}

bvec4 any_of(bvec4 a, bvec4 b) {
    return bvec4(uvec4(a) | uvec4(b));
}

real4 least(real4 a, real4 b, real4 c) {
    real4 less = mix(a, b, lessThan(b, a));
    return mix(less, c, lessThan(c, less));
}

void keep(inout real4 best, inout uvec4 winner, real4 square, uint candidate) {
    bvec4 ahead = all_of(equal(square, best), lessThan(uvec4(candidate), winner));
    bvec4 nearer = any_of(lessThan(square, best), ahead);
    best = mix(best, square, nearer);
    winner = mix(winner, uvec4(candidate), nearer);
}

// The candidate's squared distances, kept where they are the least, of equals the lowest candidate.
void consider(uint candidate, real4 row_0, real4 row_1, real4 row_2, Points probes, inout Winners winners) {
    bool turned = (candidate & kMeshCandidateTurned) != 0u;
    uint origin = candidate >> kMeshCandidateFirst & 3u;
    uint longest = candidate >> kMeshCandidateLongest & 3u;
    real3 normal = real3(row_0.w, row_1.w, row_2.w); // the other way round where the corners are turned
    real3 way_0 = difference(row_1.xyz, row_0.xyz);
    real3 way_1 = difference(row_2.xyz, row_1.xyz);
    real3 way_2 = difference(row_2.xyz, row_0.xyz);
    Points low = relative(row_0.xyz, probes);
    Points middle = relative(row_1.xyz, probes);
    Points high = relative(row_2.xyz, probes);
    Eight low_square = squares(low);
    Eight middle_square = squares(middle);
    Eight high_square = squares(high);
    EdgeSquares edge_0 = edge_squares(low, way_0, product(way_0, way_0), low_square, middle_square);
    EdgeSquares edge_1 = edge_squares(middle, way_1, product(way_1, way_1), middle_square, high_square);
    EdgeSquares edge_2 = edge_squares(low, way_2, product(way_2, way_2), low_square, high_square);
    // Where an edge begins as the triangle's corners go round.
    Eight side_0 = products(chosen(turned, low, middle), cross_product(normal, way_0));
    Eight side_1 = products(chosen(turned, middle, high), cross_product(normal, way_1));
    Eight side_2 = products(chosen(turned, high, low), cross_product(normal, way_2));
    Eight height = products(chosen(origin == 2u, chosen(origin == 1u, low, middle), high), normal);
    bool has_normal = !(normal.x == ZERO && normal.y == ZERO && normal.z == ZERO);

    bvec4 on_face = longest == 0u   ? edge_0.first_within
                    : longest == 1u ? edge_1.first_within
                                    : edge_2.first_within;
    on_face = all_of(all_of(all_of(on_face, bvec4(has_normal)), lessThanEqual(side_0.first, real4(ZERO))),
                     all_of(lessThanEqual(side_1.first, real4(ZERO)), greaterThanEqual(side_2.first, real4(ZERO))));
    precise real4 face_square = height.first * height.first;
    real4 square = least(edge_0.square.first, edge_1.square.first, edge_2.square.first);
    keep(winners.square.first, winners.first, mix(square, face_square, on_face), candidate);

    on_face = longest == 0u   ? edge_0.second_within
              : longest == 1u ? edge_1.second_within
                              : edge_2.second_within;
    on_face = all_of(all_of(all_of(on_face, bvec4(has_normal)), lessThanEqual(side_0.second, real4(ZERO))),
                     all_of(lessThanEqual(side_1.second, real4(ZERO)), greaterThanEqual(side_2.second, real4(ZERO))));
    face_square = height.second * height.second;
    square = least(edge_0.square.second, edge_1.square.second, edge_2.square.second);
    keep(winners.square.second, winners.second, mix(square, face_square, on_face), candidate);
}

// What stands about a mesh in the device's buffers, as far as the law reads it. Triangles are numbered by (facet, triangle)
// there.

// Vectors a vertex: its place and normal where the law is shaded, its pseudonormal where that decides the inside.
const uint kShadedVectors = SHADING != kShadingNone ? 2u : 0u;
const uint kVertexVectors = kShadedVectors + (INSIDE == kInsidePseudonormal ? 1u : 0u);
const bool kFacetNormals = SHADING != kShadingNone || MAP != kMapNone || TEXTURE != kMapNone;

struct MeshTriangle {
    uvec3 corners;
    uint facet;
    uvec3 neighbours;
};

// The normal of a triangle across an edge: twice its number, and whether its record is turned.
real3 neighbour_normal(uint across) {
    uint at = 3u * (across >> 1);
    real3 normal = real3(records[at].w, records[at + 1u].w, records[at + 2u].w);
    if ((across & 1u) != 0u)
        return -normal;
    return normal;
}

MeshTriangle mesh_triangle(uint triangle) {
    if (INSIDE != kInsidePseudonormal)
        return MeshTriangle(uvec3(0u), triangle_words[triangle >> 2][triangle & 3u], uvec3(0u));
    uvec4 low = triangle_words[2u * triangle];
    uvec4 high = triangle_words[2u * triangle + 1u];
    return MeshTriangle(low.xyz, low.w, high.xyz);
}

// A candidate as its facet has it, from the record's sorted corners.
Triangle triangle_shape(uint candidate) {
    uint at = 3u * (candidate >> kMeshCandidateShift);
    real4 low = records[at];
    real4 middle = records[at + 1u];
    real4 high = records[at + 2u];
    bool turned = (candidate & kMeshCandidateTurned) != 0u;
    uint first = candidate >> kMeshCandidateFirst & 3u;
    // Round from low: low, middle, high, or turned: low, high, middle.
    real3 second = turned ? high.xyz : middle.xyz;
    real3 third = turned ? middle.xyz : high.xyz;
    bool from_second = first == (turned ? 2u : 1u);
    bool from_third = first == (turned ? 1u : 2u);
    Triangle triangle;
    triangle.a = from_second ? second : from_third ? third : low.xyz;
    triangle.b = from_second ? third : from_third ? low.xyz : second;
    triangle.c = from_second ? low.xyz : from_third ? second : third;
    triangle.normal = real3(low.w, middle.w, high.w);
    if (turned)
        triangle.normal = -triangle.normal;
    return triangle;
}

real3 vertex_position(uint vertex) {
    return vertices[kVertexVectors * vertex].xyz;
}

real3 vertex_normal(uint vertex) {
    return vertices[kVertexVectors * vertex + 1u].xyz;
}

real3 vertex_pseudonormal(uint vertex) {
    return vertices[kVertexVectors * vertex + kShadedVectors].xyz;
}

real3 facet_normal(uint facet) {
    return normals[facet].xyz;
}

real3 edge_pseudonormal(uint edge) {
    return normals[(kFacetNormals ? mesh.facets : 0u) + edge].xyz;
}
