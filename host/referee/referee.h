// What an engine or a referee says of one probe position, channel by channel; how far two of them are apart; and the
// referees: closed forms, and of a mesh loops over all triangles.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/mesh/mesh.h"
#include "host/reference/contact.h"
#include "host/scene/scene.h"

namespace forceshade {

struct Reading {
    glm::dvec3 force{0}, unshaded{0}; /* N */
    glm::dvec3 proxy{0};              /* m */
    double depth = 0;                 /* m */
    layout::uint facet = layout::kNoFacet;
};

/// Of a reference::Contact or a brute::Answer.
template <typename Contact> Reading reading_of(const Contact& contact) {
    return {glm::dvec3(contact.force), glm::dvec3(contact.unshaded), glm::dvec3(contact.proxy), double(contact.depth),
            contact.facet};
}

/// Channels that the chunk lacks stay empty.
template <typename T> Reading reading_of(const layout::FieldChunk<T>& chunk, std::size_t sample) {
    const auto vector = [&](std::span<const T> channel) {
        return channel.empty() ? glm::dvec3(0) : glm::dvec3(reference::vector_at(channel, sample));
    };
    return {vector(chunk.force), vector(chunk.unshaded), vector(chunk.proxy),
            chunk.depth.empty() ? 0 : double(chunk.depth[sample]),
            chunk.facet.empty() ? layout::kNoFacet : chunk.facet[sample]};
}

/// How far each channel of a voxel may be off.
struct Bound {
    double force = 0;     /* N: |F - F_exact| */
    double magnitude = 0; /* N: | |F| - |F_exact| |; says more than `force` where the direction is ill conditioned */
    double unshaded = 0;  /* N */
    double depth = 0;     /* m */
    double proxy = 0;     /* m */
};

/// The sum of the bounds.
Bound operator+(const Bound& a, const Bound& b);
Bound operator*(double factor, const Bound& bound);

/// The first of `channels` (layout::kChannel... bits) in which a reading is further from the truth than the bound
/// allows, or 0. A facet must be the very same.
layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels);

/// One channel in words, as "depth 0.001 m".
std::string describe(const Reading& reading, layout::uint channel);

/// How many representable numbers lie between a and b, counting one end; +0 and -0 are one apart. NaN is far from
/// everything, itself too.
template <typename T> std::uint64_t ulp_distance(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    if (a != a || b != b)
        return UINT64_MAX;
    // Numbers in order, so that their places subtract: negative ones count down from the middle.
    const auto place = [](T value) {
        constexpr Bits kSign = Bits(1) << (8 * sizeof(T) - 1);
        const Bits bits = std::bit_cast<Bits>(value);
        return bits & kSign ? kSign - 1 - (bits & ~kSign) : bits + kSign;
    };
    const Bits first = place(a), second = place(b);
    return first > second ? first - second : second - first;
}

namespace brute {

using Real = long double;
using Vector = glm::vec<3, Real>;

struct Answer {
    Vector force{0}, unshaded{0}; /* N */
    Vector proxy{0};              /* m */
    Real depth = 0;               /* m */
    std::uint32_t facet = 0xFFFFFFFFu;
};

// The closed forms of L1 to L5 and L8, derived differently from the oracle: angles instead of chords, plain loops
// instead of bisection, extended precision instead of care against cancellation. Referees reference and kernels alike.
// Shares no code with either.

/// What depends on the probe's (x, y) alone; finding it loops over all facets.
struct Column {
    Real x, y;
    bool on_bump = false;
    std::uint32_t facet = 0;
    Real height = 0;               /* m: nominal surface */
    Real facet_angle = 0;          /* rad: of the facet's normal from z towards x */
    Vector smooth{0, 0, 1};        /* unit normal of the smooth shape above the probe */
    std::array<Real, 2> texture{}; /* gradient of the texture */
};

/// The gradient of a height map at (x, y) in m; `image` that of a map from a file.
std::array<Real, 2> map_slope(const HeightMapSpec& map, const HeightImage* image, Real x, Real y);

class Referee {
public:
    /// The scene and images must outlive the referee.
    Referee(const Scene& scene, const SceneImages& images);

    Column column(double x, double y) const;
    Answer at(const Column& column, double z) const;

private:
    Answer cylinder_bump(const Column& column, Real z) const;
    Answer facets(const Column& column, Real z) const;
    Real texture_stiffness() const;

    const Scene& scene_;
    const SceneImages& images_;
    Real half_width_, radius_, edge_angle_, axis_depth_, top_;
};

// L6 to L9 on a mesh, derived differently from the oracle: in the world's metres, in extended precision, by plain loops
// over all triangles but those in boxes too far away, regions of the plane instead of clamped edges, angles instead of
// tangents, and no topology. Shares no code with oracle or kernels.

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

    struct Box {
        Vector low, high; /* m */
        /// m: of a place from the box, no more than from what it holds.
        Real distance(const Vector& place) const;
    };

    const Mesh& mesh_;
    MeshLaw law_;
    ChosenTriangles chosen_;
    std::vector<Box> boxes_; /* round the triangles of chosen_.touched */
    Real size_;              /* m: of the bounding box */
};

} // namespace brute

} // namespace forceshade
