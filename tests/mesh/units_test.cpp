// Units do not matter: the same mesh in another unit, with the stiffness to match, has the same forces.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using layout::uint;

/// Forces at places given in the file's unit.
std::vector<glm::dvec3> forces(const PolygonSoup& polygons, double unit, uint shading, uint inside) {
    shapes::MeshLaw<> scaled(
        prepare_mesh(polygons, {.unit = unit, .scale = 1, .rotate = {}, .translate = {}}, VertexNormals::plain),
        1 / unit); // 1 N a unit
    scaled.law.features.shading = shading;
    scaled.law.features.inside = inside;
    std::mt19937 random(1);
    std::vector<glm::dvec3> result;
    for (int i = 0; i < 3000; ++i)
        result.push_back(scaled.at(unit * shapes::anywhere(random, 1.1)).force);
    return result;
}

/// Probes whose nearest point is hardly nearer than another facet's may fall to either; they are few.
void expect_alike(const std::vector<glm::dvec3>& one, const std::vector<glm::dvec3>& other) {
    int touching = 0, apart = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        const glm::dvec3 difference = one[i] - other[i];
        const double strength = std::sqrt(reference::dot(one[i], one[i]));
        touching += strength > 0;
        apart += std::sqrt(reference::dot(difference, difference)) > 1e-9 * strength + 1e-14;
    }
    EXPECT_GT(touching, 150);
    EXPECT_EQ(apart, 0);
}

TEST(Units, ForcesDoNotDependOnThem) {
    const PolygonSoup spot = shapes::spot(), sphere = shapes::icosphere(3),
                      many = shapes::icosphere(6); // 81 920 triangles
    const std::vector<double> usual{1e-6, 1e-3, 1e3}, atoms_and_galaxies{1e-30, 1e-12, 1e12, 1e30};
    for (const auto& [polygons, shading, inside, units] :
         {std::tuple{spot, layout::kShadingNone, layout::kInsidePseudonormal, usual},
          {spot, layout::kShadingMeanValue, layout::kInsidePseudonormal, usual},
          {spot, layout::kShadingMorgenbesser, layout::kInsideWinding, usual},
          {many, layout::kShadingBarycentric, layout::kInsidePseudonormal, usual},
          {sphere, layout::kShadingMeanValue, layout::kInsidePseudonormal, atoms_and_galaxies}}) {
        const std::vector<glm::dvec3> metres = forces(polygons, 1, shading, inside);
        for (const double unit : units)
            expect_alike(metres, forces(polygons, unit, shading, inside));
    }
}

TEST(Units, PowersOfTwoChangeNoBit) {
    const PolygonSoup sphere = shapes::icosphere(3);
    EXPECT_EQ(forces(sphere, 1, layout::kShadingMeanValue, layout::kInsidePseudonormal),
              forces(sphere, 1024, layout::kShadingMeanValue, layout::kInsidePseudonormal));
}

} // namespace
} // namespace forceshade
