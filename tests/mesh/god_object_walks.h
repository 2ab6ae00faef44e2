// Random paths over meshes of every kind, for the tests of the god-object.
#pragma once

#include <cmath>
#include <cstring>
#include <optional>
#include <random>
#include <string>

#include "host/mesh/structure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::walks {

template <typename T> glm::dvec3 wide(const glm::vec<3, T>& v) {
    return {double(v.x), double(v.y), double(v.z)};
}

template <typename T> bool same_bits(const glm::vec<3, T>& one, const glm::vec<3, T>& other) {
    return std::memcmp(&one, &other, sizeof one) == 0;
}

/// Of a proxy from the mesh, in skins: a move ends 7/8 of a skin from a triangle; what is far below that has lost its
/// skin and meets nothing any more.
constexpr double kLeastGap = 0.86;

struct Terrain {
    std::string name;
    PolygonSoup polygons;
    unsigned valence = 6;                 /* the most triangles round a corner, about */
    std::optional<glm::dvec3> focus = {}; /* in metres: where probes are to go, if not everywhere */
};

/// Spheres, acute wedges, saddles, a plate 10 um thick and 20 mm wide, folds that touch themselves, bumps of 16 facets.
std::vector<Terrain> terrains();
/// Pits of 8 to 1000 triangles, smooth and folded, whose corner is the focus.
std::vector<Terrain> pits();

PolygonSoup wedge(double angle);
/// A block with a groove of so many degrees along y, 1 deep.
PolygonSoup grooved_block(double degrees);
/// A sheet folded to and fro, whose folds touch along their edges.
PolygonSoup touching_folds(unsigned folds, double gap);
/// A fan round a corner `depth` below its rim, whose heights are random within `relief`: narrow folds if there are
/// many.
PolygonSoup pit(unsigned valence, double relief, unsigned seed = 7, double depth = 0.3);
/// The bump of G2 on its plane, as quads.
PolygonSoup bump(unsigned facets, unsigned rows);

/// Closed solids whose corners are integers, so that probes lie exactly on faces, edges and corners.
std::vector<Terrain> solids();
/// Closed and open meshes of other kinds, the given files among them.
std::vector<Terrain> meshes(const std::vector<std::string>& files);
/// A few triangles anywhere, through each other.
PolygonSoup soup(unsigned seed);

/// What a contact may be wrong on: wedges of 60 to 1e-10 degrees, poles of 20 to 20 000 facets, needles, grooves, thin
/// shells; closed.
std::vector<Terrain> narrow_solids();
/// Rims of sheets, bow ties, three facets at an edge, doubled facets, saddle corners, crossing and touching facets.
std::vector<Terrain> open_meshes();

/// What the walks below draw their positions from: places of a mesh, in its frame.
class RandomPlaces {
public:
    RandomPlaces(const MeshStructure& structure, std::uint64_t seed) : structure_(structure), random_(seed) {}

protected:
    double random(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    /// Log-uniform.
    double length(double least, double most) { return std::pow(10.0, random(std::log10(least), std::log10(most))); }
    glm::dvec3 direction();
    glm::dvec3 vertex(std::size_t v) const;
    glm::dvec3 corner(std::size_t triangle, std::size_t i) const;
    glm::dvec3 normal(std::size_t triangle) const;
    glm::dvec3 place_on(std::size_t triangle);

    const MeshStructure& structure_;
    std::mt19937_64 random_;
};

/// Probe positions in the mesh's frame: steps of 1 nm to ten facets, some in any direction, some towards a point above
/// or below the surface, some along the surface.
class Wanderer : RandomPlaces {
public:
    Wanderer(const MeshStructure& structure, std::uint64_t seed, std::optional<glm::dvec3> focus = {});
    glm::dvec3 begin();
    glm::dvec3 step(const glm::dvec3& from);

private:
    glm::dvec3 direction(); /* x, y and z in the order in which the compiler draws them */
    glm::dvec3 near_surface();

    std::optional<glm::dvec3> focus_; /* in the mesh's frame */
    double facet_;
    glm::dvec3 goal_{0};
};

/// Probe positions in the mesh's frame that aim at the answer: on the pseudonormals of corners, edges and facets, 1e-12
/// to 2 sizes deep or high, half way to what is opposite (the medial axis), between corners; steps of 1e-12 to 10
/// sizes. A walk is Aimer::kSteps positions.
class Prober : RandomPlaces {
public:
    using RandomPlaces::RandomPlaces;
    glm::dvec3 begin();
    glm::dvec3 step(const glm::dvec3& from);

private:
    glm::dvec3 pseudonormal(std::size_t triangle, std::size_t i) const;
    double half_way_in(const glm::dvec3& place, const glm::dvec3& normal);
    glm::dvec3 target();
};

/// Probe positions in the mesh's frame as a hand moves: from 0.01 sizes above a facet to 1e-4 to 0.1 sizes below it,
/// then steps of as much, anywhere.
class Stroker : RandomPlaces {
public:
    using RandomPlaces::RandomPlaces;
    glm::dvec3 begin();
    glm::dvec3 step(const glm::dvec3& from);

private:
    glm::dvec3 inwards_{0}; /* before the first step */
};

/// Probe positions in the mesh's frame that aim at what a god-object may fall through: from corner to corner within
/// 0 to 1e-4 sizes of the edge, through the middles of edges, along edges and parallel to facets with steps of 1e-12 to
/// 10 sizes, between the places of a lattice, and inwards. A walk is kSteps positions, the first in the open.
class Aimer : RandomPlaces {
public:
    static constexpr unsigned kSteps = 8;

    Aimer(const MeshStructure& structure, std::uint64_t seed);
    glm::dvec3 begin();
    glm::dvec3 step(const glm::dvec3& from);

private:
    glm::dvec3 beside();
    void go_on();

    std::vector<std::vector<std::uint32_t>> around_; /* triangles at each vertex */
    std::size_t triangle_ = 0, corner_ = 0;          /* where the walk is */
    glm::dvec3 offset_{0};                           /* of the probe from the features it aims at */
};

} // namespace forceshade::walks
