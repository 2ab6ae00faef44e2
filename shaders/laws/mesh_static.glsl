// L6 static: whether a probe is inside, and its contact, once the nearest triangle is known; step for step as
// host/reference/mesh_contact.h.

// The pseudonormal of the feature points away from the probe.
bool inside_by_pseudonormal(MeshTriangle triangle, real3 normal, TrianglePoint point) {
    real3 outward = normal;
    if (point.feature >= kMeshCorner)
        outward = vertex_pseudonormal(triangle.corners[point.feature - kMeshCorner]);
    else if (point.feature >= kMeshEdge) {
        uint across = triangle.neighbours[point.feature - kMeshEdge];
        if (across != kMeshBorder && (across & kMeshManyBit) != 0u)
            outward = edge_pseudonormal(across & ~kMeshManyBit);
        else if (across != kMeshBorder)
            outward = sum(normal, neighbour_normal(across));
    }
    return product(point.offset, outward) > ZERO;
}

// The contact with the nearest of the candidates; `inside` by the winding number.
Contact contact_at(real3 probe, uint candidate, bool inside) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), to_world(probe), kNoFacet);
    if (candidate == kNoCandidate)
        return contact;
    MeshTriangle triangle = mesh_triangle(candidate >> kMeshCandidateShift);
    Triangle shape = triangle_shape(candidate);
    TrianglePoint point = nearest_on_triangle(probe, shape);
    if (INSIDE == kInsidePseudonormal)
        inside = inside_by_pseudonormal(triangle, shape.normal, point);
    if (!inside)
        return contact;
    precise real size = sqrt(point.square);
    return touching_contact(MeshTouch(triangle.facet, point.offset, sum(probe, point.offset), size));
}
