// L6: the god-object on a mesh: the buffers of the kernel of paths, and its parts in the order in which they build on each
// other. Triangles stand in the tree's order.

layout(std430, set = 0, binding = kMeshPathBindLaw) readonly buffer LawBuffer { MeshLawParams law_params; };
layout(std430, set = 0, binding = kMeshPathBindVectors) readonly buffer VectorBuffer { real4 vectors[]; };
layout(std430, set = 0, binding = kMeshPathBindTriangles) readonly buffer TriangleBuffer { uvec4 triangle_words[]; };
layout(std430, set = 0, binding = kMeshPathBindIndices) readonly buffer IndexBuffer { uint indices[]; };
layout(std430, set = 0, binding = kMeshPathBindWalkWords) buffer WordBuffer { uint walk_words[]; };
layout(std430, set = 0, binding = kMeshPathBindWalkReals) buffer RealBuffer { real walk_reals[]; };
layout(push_constant) uniform Push { MeshPathChunkParams chunk; };

// Zero, and unknown to the compiler where a sign of zero may come of it.
real exact_zero;
// Loops run so far: drivers may end more than some of them in silence.
uint spent;
bool is_left; // the host must find the contact of this step

Triangle triangle_at(uint triangle) {
    real4 a = vectors[3u * triangle];
    real4 b = vectors[3u * triangle + 1u];
    real4 c = vectors[3u * triangle + 2u];
    return Triangle(a.xyz, b.xyz, c.xyz, real3(a.w, b.w, c.w));
}

real3 walk_real3(uint path, uint field) {
    return real3(walk_reals[field * chunk.paths + path], walk_reals[(field + 1u) * chunk.paths + path],
                 walk_reals[(field + 2u) * chunk.paths + path]);
}

void put_walk_real3(uint path, uint field, real3 value) {
    walk_reals[field * chunk.paths + path] = value.x;
    walk_reals[(field + 1u) * chunk.paths + path] = value.y;
    walk_reals[(field + 2u) * chunk.paths + path] = value.z;
}

uint walk_word(uint path, uint field) {
    return walk_words[field * chunk.paths + path];
}

void put_walk_word(uint path, uint field, uint value) {
    walk_words[field * chunk.paths + path] = value;
}

// The path that this invocation takes on; kNoPath for none.
uint listed_path() {
    uint item = gl_GlobalInvocationID.x;
    uint path = kNoPath;
    if (item < chunk.listed)
        path = walk_words[kWalkWordCount * chunk.paths + 1u + chunk.first + item];
    return path;
}

uvec3 walk_triangles(uint path) {
    return uvec3(walk_word(path, kWalkWordTriangles), walk_word(path, kWalkWordTriangles + 1u),
                 walk_word(path, kWalkWordTriangles + 2u));
}

void put_walk_triangles(uint path, uvec3 triangles) {
    put_walk_word(path, kWalkWordTriangles, triangles.x);
    put_walk_word(path, kWalkWordTriangles + 1u, triangles.y);
    put_walk_word(path, kWalkWordTriangles + 2u, triangles.z);
}

#include "mesh_cast.glsl"
#include "god_object_planes.glsl"
#include "god_object_walk.glsl"
#include "god_object_rest.glsl"
