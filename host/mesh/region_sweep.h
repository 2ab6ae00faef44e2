// The closest-point transform of a closed surface (Mauch, Efficient algorithms for solving static Hamilton-Jacobi
// equations, 2003, ch. 3), on its inner side: what is nearest to the samples of a grid is found by sweeping the prism
// of each face, the wedge of each edge and the cone of each corner over the samples in it. All in single precision,
// whatever the law's, with bounds of what rounding makes of it.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// A closed surface, in the mesh's frame.
struct SweptSurface {
    std::vector<float> vertices;                  /* 3 a vertex */
    std::vector<float> normals;                   /* 3 a triangle: unit, across its corners as they are */
    std::vector<float> pseudonormals;             /* 3 a vertex */
    std::span<const layout::uint> corners;        /* 3 a triangle */
    std::span<const layout::uint> neighbours;     /* 3 a triangle, none without */
    std::vector<layout::uint> star_begins, stars; /* the edges that leave each vertex, 3 * triangle + its start */
    float longest = 0;                            /* 1: edge */
    float deepest = 0;                            /* 1: no place inside is further from it */

    std::size_t triangles() const { return corners.size() / 3; }
    std::size_t count_vertices() const { return vertices.size() / 3; }
    glm::dvec3 vertex(std::size_t index) const {
        return {vertices[3 * index], vertices[3 * index + 1], vertices[3 * index + 2]};
    }
    glm::dvec3 normal(std::size_t triangle) const {
        return {normals[3 * triangle], normals[3 * triangle + 1], normals[3 * triangle + 2]};
    }
    std::array<reference::Vector<float>, 3> triangle_corners(std::size_t triangle) const {
        const auto corner = [&](std::size_t i) {
            return reference::vector_at(std::span<const float>(vertices), corners[3 * triangle + i]);
        };
        return {corner(0), corner(1), corner(2)};
    }
};

/// By how much a distance as computed may be above the least one where the nearest triangle is still possible: share *
/// distance + base, in units of the mesh's frame.
struct DistanceSlack {
    float share, base;

    float at(float distance) const { return share * distance + base; }
    /// The square of the largest such distance, of the square of the least.
    float limit(float square) const {
        const float distance = std::sqrt(square), reach = distance + at(distance);
        return reach * reach;
    }
};

/// A slab of an even grid: all samples along x and y, [z_first, z_end) along z. Its cells stand block by block of
/// layout::kMeshBlock^3 samples: the parts of a sample's number along the axes add up.
struct SweptGrid {
    std::array<std::vector<float>, 3> at;           /* coordinates of the samples, of the whole grid */
    std::array<double, 3> origin, spacing;          /* 1: at[axis][i] is near origin + i spacing */
    std::array<std::vector<std::uint32_t>, 3> part; /* along z from z_first on, which is even */
    int z_first = 0, z_end = 0;

    int first(int axis) const { return axis == 2 ? z_first : 0; }
    int end(int axis) const { return axis == 2 ? z_end : static_cast<int>(at[std::size_t(axis)].size()); }
    std::size_t cell(int x, int y, int z) const {
        return std::size_t(part[0][std::size_t(x)]) + part[1][std::size_t(y)] + part[2][std::size_t(z - z_first)];
    }
};

/// What is known of a sample: the bits of a squared distance above those of the triangle at it. 0 outside.
constexpr std::uint64_t kOutsideCell = 0;
constexpr std::uint64_t kOpenCell = std::uint64_t(0x7F7FFFFF) << 32 | 0xFFFFFFFFu;
constexpr layout::uint kNoTriangle = 0xFFFFFFFFu;

inline float square_of(std::uint64_t cell) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(cell >> 32));
}
inline layout::uint triangle_of(std::uint64_t cell) {
    return static_cast<layout::uint>(cell);
}
inline std::uint64_t cell_of(float square, layout::uint triangle) {
    return std::uint64_t(std::bit_cast<std::uint32_t>(square)) << 32 | triangle;
}

/// A triangle that may be as near to a sample as what its cell says.
struct SweptTie {
    std::uint32_t cell;
    layout::uint triangle;
    float square;
};

/// A vertex that is near to each brick of samples: an upper bound of distances that ends sweeps where they are hidden.
class NearVertices {
public:
    NearVertices(const SweptSurface& surface, const SweptGrid& grid);

    /// Of a sample's brick.
    reference::Vector<float> at(const std::array<int, 3>& sample) const {
        std::size_t brick = 0;
        for (std::size_t axis = 3; axis-- > 0;)
            brick = brick * bricks_[axis] + std::size_t(sample[axis] >> shift_);
        return reference::vector_at(std::span<const float>(vertices_), brick);
    }

private:
    int shift_ = 2; // bricks of 2^shift samples a side
    std::array<std::size_t, 3> bricks_;
    std::vector<float> vertices_;
};

/// What threads that sweep share, and what each finds.
struct SweepInput {
    const SweptSurface& surface;
    const SweptGrid& grid;
    const NearVertices& near_vertices;
    DistanceSlack slack;
    double margin; /* samples: how far sections reach beyond the regions, for rounding */
    double near;   /* 1: outside and no further than this, samples are ties of what is there */
    std::span<std::uint64_t> cells;

    std::uint64_t known(std::size_t cell) const {
        return std::atomic_ref<std::uint64_t>(cells[cell]).load(std::memory_order_relaxed);
    }
};
struct SweepOutput {
    std::vector<SweptTie> ties;    /* of samples inside */
    std::vector<SweptTie> outside; /* no further than SweepInput::near */
};

/// The triangles first to end - 1 with the edges that they come first of.
void sweep_triangles(const SweepInput& input, std::size_t first, std::size_t end, SweepOutput& output);
/// The vertices first to end - 1.
void sweep_vertices(const SweepInput& input, std::size_t first, std::size_t end, SweepOutput& output);

} // namespace forceshade
