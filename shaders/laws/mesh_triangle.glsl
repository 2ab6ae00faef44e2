// L6: the point of one triangle nearest to a probe, step for step as host/reference/mesh_nearest.h.

struct Triangle {
    real3 a;
    real3 b;
    real3 c;
    real3 normal;
};

struct TrianglePoint {
    real3 offset; // 1: nearest point - probe
    real square;
    uint feature; // kMeshFace, kMeshEdge + i, kMeshCorner + i
};

const uint kWithin = 0u;
const uint kStart = 1u;
const uint kEnd = 2u;

struct EdgePoint {
    real3 offset;
    real square;
    uint place;
};

bool walked_backwards(real3 edge) {
    return edge.x < ZERO || (edge.x == ZERO && (edge.y < ZERO || (edge.y == ZERO && edge.z < ZERO)));
}

EdgePoint nearest_on_edge(real3 start, real3 end, real3 edge, real length_square) {
    bool backwards = walked_backwards(edge);
    real3 from = backwards ? end : start;
    real3 to = backwards ? start : end;
    real3 directed = backwards ? -edge : edge;
    precise real along = -product(from, directed);
    if (!(along > ZERO))
        return EdgePoint(from, product(from, from), backwards ? kEnd : kStart);
    if (!(along < length_square))
        return EdgePoint(to, product(to, to), backwards ? kStart : kEnd);
    precise real share = quotient(along, length_square);
    real3 offset = sum(from, scaled(share, directed));
    return EdgePoint(offset, product(offset, offset), kWithin);
}

TrianglePoint nearest_on_triangle(real3 probe, Triangle triangle) {
    real3 start = difference(triangle.a, probe);
    real3 middle = difference(triangle.b, probe);
    real3 end = difference(triangle.c, probe);
    real3 edge_0 = difference(triangle.b, triangle.a);
    real3 edge_1 = difference(triangle.c, triangle.b);
    real3 edge_2 = difference(triangle.a, triangle.c);
    real square_0 = product(edge_0, edge_0);
    real square_1 = product(edge_1, edge_1);
    real square_2 = product(edge_2, edge_2);
    EdgePoint first = nearest_on_edge(start, middle, edge_0, square_0);
    EdgePoint second = nearest_on_edge(middle, end, edge_1, square_1);
    EdgePoint third = nearest_on_edge(end, start, edge_2, square_2);
    bool longest_within = first.place == kWithin;
    real longest = square_0 > ZERO ? square_0 : ZERO;
    if (square_1 > longest) {
        longest = square_1;
        longest_within = second.place == kWithin;
    }
    if (square_2 > longest)
        longest_within = third.place == kWithin;
    real3 normal = triangle.normal;
    bool inside = !(normal.x == ZERO && normal.y == ZERO && normal.z == ZERO) && longest_within &&
                  product(cross_product(normal, edge_0), start) <= ZERO &&
                  product(cross_product(normal, edge_1), middle) <= ZERO &&
                  product(cross_product(normal, edge_2), end) <= ZERO;
    if (inside) {
        real height = product(normal, start);
        precise real square = height * height;
        return TrianglePoint(scaled(height, normal), square, kMeshFace);
    }
    uint nearest = 0u;
    if (second.square < first.square) {
        first = second;
        nearest = 1u;
    }
    if (third.square < first.square) {
        first = third;
        nearest = 2u;
    }
    uint corner = first.place == kStart ? nearest : (nearest + 1u) % 3u;
    return TrianglePoint(first.offset, first.square,
                         first.place == kWithin ? kMeshEdge + nearest : kMeshCorner + corner);
}
