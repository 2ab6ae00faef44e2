// What stands about a mesh in the device's buffers, as far as the law reads it. Triangles are numbered by (facet, triangle)
// there.

// Vectors a vertex: its place and normal where the law is shaded, its pseudonormal where that tells the inside.
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
