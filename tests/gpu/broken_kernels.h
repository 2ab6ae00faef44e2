// Kernels broken on purpose, in the place of the program's own: shaders/kernels.h gives these where a break is chosen,
// so that the whole program runs them.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace forceshade::test {

enum class Break {
    none,       /* the program's own kernels */
    sign,       /* L3: a facet climbs where it should descend */
    component,  /* L2: the cylinder pushes along x with the z component */
    edge,       /* G2: a facet loses its left vertex to its neighbour */
    channel,    /* the unshaded force is the shaded one */
    beyond,     /* rows are written behind a chunk's last */
    first,      /* a dispatch of a field begins at the first layer */
    restart,    /* a dispatch of paths begins where the motions do */
    undeclared, /* a capability that the device was not opened with */
    tie,        /* L6: of triangles equally near, the last wins */
    outward,    /* L6: of an edge's two normals the pseudonormal takes the difference */
    tangent,    /* L7: half angles are measured wrongly */
    friction,   /* a hand's friction drives it */
    kahan,      /* a metric's sum loses more to rounding */
    late,       /* a device without delay is late, and the other way round */
    lap,        /* open loop: rounds are counted a step early */
    adrift,     /* turns are counted from where contact began */
    forgetful,  /* G2: a facet keeps the vertex at its right */
    tunnel,     /* paths on meshes: a move goes past what it hits */
    slip,       /* likewise: a triangle is left before its edge */
    behind,     /* likewise: what is held from behind is shaded as if from the front */
    imprecise,  /* no `precise`: compilers reassociate */
};

/// What every kernel made from now on runs.
void choose_break(Break chosen);

/// A kernel of a break, "f32", "mesh_path_f64", ... None if it is not broken that way.
std::span<const std::uint32_t> broken_words(Break broken, std::string_view variant);

} // namespace forceshade::test
