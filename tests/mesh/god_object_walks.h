// Random paths over meshes of every kind, for the tests of the god-object.
#pragma once

#include <random>
#include <string>

#include "host/mesh/structure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::walks {

struct Terrain {
    std::string name;
    PolygonSoup polygons;
};

/// Spheres, acute wedges, saddles, a plate 10 um thick and 20 mm wide, folds that touch themselves, bumps of 16 facets.
std::vector<Terrain> terrains();

PolygonSoup wedge(double angle);
/// A sheet folded to and fro, whose folds touch along their edges.
PolygonSoup touching_folds(unsigned folds, double gap);
/// The bump of G2 on its plane, as quads.
PolygonSoup bump(unsigned facets, unsigned rows);

/// Probe positions in the mesh's frame: steps of 1 nm to ten facets, some in any direction, some towards a point above
/// or below the surface, some along the surface.
class Wanderer {
public:
    Wanderer(const MeshStructure& structure, std::uint64_t seed);
    glm::dvec3 begin();
    glm::dvec3 step(const glm::dvec3& from);

private:
    double random(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    glm::dvec3 direction();
    glm::dvec3 near_surface();

    const MeshStructure& structure_;
    std::mt19937_64 random_;
    double facet_;
    glm::dvec3 goal_{0};
};

} // namespace forceshade::walks
