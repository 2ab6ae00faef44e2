// L6 to L9 on a mesh, derived differently from the oracle: in the world's metres, in extended precision, by plain loops
// over all triangles, regions of the plane instead of clamped edges, angles instead of tangents, and no topology.
// Shares no code with oracle or kernels.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "host/mesh/mesh.h"
#include "host/referee/referee.h"

namespace forceshade::brute {

/// Which triangles of a mesh the referee looks at.
struct ChosenTriangles {
    std::vector<std::size_t> once;    /* all but those of redundant facets */
    std::vector<std::size_t> touched; /* of these, what has a height beyond rounding; all with an area if none has */
    Real noise = 0;                   /* m: what places may differ by; 0 if all heights are beyond rounding */
};

ChosenTriangles choose_triangles(const Mesh& mesh);

using MeshShading = Shading;
using MeshInside = InsideTest;

/// The gradient of a height map over the world's (x, y) in m.
using Slope = std::function<std::array<Real, 2>(Real, Real)>;

struct MeshLaw {
    Real stiffness = 1000;      /* K, N/m */
    Real texture_stiffness = 0; /* K_t, N/m */
    MeshShading shading = MeshShading::none;
    MeshInside inside = MeshInside::pseudonormal;
    Slope map = {};     /* L9; empty: none */
    Slope texture = {}; /* L8; empty: none */
};

/// The surface point nearest to a probe.
struct MeshPoint {
    Vector offset;       /* m: from the probe */
    Vector point;        /* m */
    Real distance;       /* m */
    std::uint32_t facet; /* lowest of those as near, to 1e-16 of the mesh's size or the noise */
    Vector outward;      /* 1: normals of the triangles there, weighted by the angles they fill round the point */
    Real runner_up;      /* m: distance to the nearest facet that does not hold the point; infinite if all do */
};

class MeshReferee {
public:
    /// The mesh must outlive the referee.
    MeshReferee(const Mesh& mesh, MeshLaw law);

    /// `world` in m. Out of contact the proxy is the probe.
    Answer at(const glm::dvec3& world) const;
    /// The law's possible answers if distances are known to within a tolerance in m: one for each facet that may be
    /// the nearest, and being free of contact where the surface is as near.
    std::vector<Answer> all_at(const glm::dvec3& world, Real tolerance) const;

    MeshPoint nearest(const glm::dvec3& world) const;
    /// Sum of all solid angles over 4 pi.
    Real winding_number(const glm::dvec3& world) const;
    /// How often the surface is left more than entered along a ray in a haphazard direction: the winding number of a
    /// closed mesh.
    int crossings(const glm::dvec3& world) const;
    /// The unit direction that the law's shading and map give at a point of a facet; 0 without one.
    Vector direction(std::uint32_t facet, const Vector& point) const;
    Vector facet_normal(std::uint32_t facet) const;

private:
    /// Relative to a place: the world's origin may be far away.
    std::array<Vector, 3> corners_of(std::size_t triangle, const Vector& place) const;
    bool is_inside(const glm::dvec3& world, const MeshPoint& nearest) const;
    Answer touching(std::uint32_t facet, const Vector& offset, const Vector& point) const;
    Vector interpolated(std::uint32_t facet, const Vector& point) const;

    const Mesh& mesh_;
    MeshLaw law_;
    ChosenTriangles chosen_;
    Real size_; /* m: of the bounding box */
};

} // namespace forceshade::brute
