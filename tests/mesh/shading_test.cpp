// L7 on facets: exact at corners, linear along edges, continuous hardly off them, the referee's angles; and answers
// that are known by hand.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "host/touch/force_errors.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using layout::uint;

/// A polygon with its vertex normals all different.
struct OneFacet : shapes::MeshLaw<> {
    explicit OneFacet(const std::vector<glm::dvec3>& corners) : MeshLaw(make(corners)) {}

    static Mesh make(const std::vector<glm::dvec3>& corners) {
        Mesh result = shapes::mesh_of(shapes::polygon(corners));
        for (std::size_t i = 0; i < result.vertex_normals.size(); ++i)
            result.vertex_normals[i] =
                reference::normalised(glm::dvec3(std::cos(2.0 * double(i)), std::sin(3.0 * double(i)), 1.5));
        return result;
    }
    glm::dvec3 direction(uint shading, const glm::dvec3& world) const {
        return reference::shading_direction(view, shading, 0, local(world));
    }
};

const std::vector<glm::dvec3> kTriangle{{0, 0, 0}, {3, 0, 0}, {1, 2, 0}};
const std::vector<glm::dvec3> kPentagon{{0, 0, 0}, {2, -1, 0}, {3, 1, 0}, {1.5, 2.5, 0}, {-0.5, 1, 0}};
const std::vector<glm::dvec3> kArrow{{0, 0, 0}, {3, 1, 0}, {0, 2, 0}, {1, 1, 0}};

TEST(Shading, IsExactAtCornersAndLinearAlongEdges) {
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const std::size_t next = (i + 1) % corners.size();
            EXPECT_LT(
                angle_between(facet.direction(layout::kShadingMeanValue, corners[i]), facet.mesh.vertex_normals[i]),
                1e-13);
            for (const double share : {1e-15, 1e-9, 0.2, 0.5, 0.77, 1 - 1e-12}) {
                const glm::dvec3 expected =
                    (1 - share) * facet.mesh.vertex_normals[i] + share * facet.mesh.vertex_normals[next];
                const glm::dvec3 at = corners[i] + share * (corners[next] - corners[i]);
                EXPECT_LT(angle_between(facet.direction(layout::kShadingMeanValue, at), expected), 1e-12)
                    << i << ' ' << share;
            }
        }
    }
}

TEST(Shading, HardlyOffAnEdgeOrCornerItIsWhatItIsOnIt) {
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 way = corners[(i + 1) % corners.size()] - corners[i];
            const glm::dvec3 inwards = reference::normalised(glm::dvec3(-way.y, way.x, 0));
            for (const double share : {0.0, 1e-12, 0.3, 0.9})
                for (double off = 1e-18; off < 1e-9; off *= 3) {
                    const glm::dvec3 on = corners[i] + share * way;
                    const glm::dvec3 expected = facet.direction(layout::kShadingMeanValue, on);
                    for (const double side : {-1.0, 1.0})
                        EXPECT_LT(angle_between(facet.direction(layout::kShadingMeanValue, on + side * off * inwards),
                                                expected),
                                  1e-12 + 20 * off)
                            << i << ' ' << share << ' ' << off;
                }
        }
    }
}

TEST(Shading, EqualsTheRefereesAngles) {
    using brute::MeshShading;
    const std::pair<uint, MeshShading> schemes[] = {{layout::kShadingMorgenbesser, MeshShading::morgenbesser},
                                                    {layout::kShadingBarycentric, MeshShading::barycentric},
                                                    {layout::kShadingMeanValue, MeshShading::mean_value}};
    std::mt19937 random(4);
    for (const auto& corners : {kTriangle, kPentagon, kArrow}) {
        const OneFacet facet(corners);
        for (const auto& [shading, scheme] : schemes) {
            if (scheme == MeshShading::barycentric && corners.size() != 3)
                continue;
            const brute::MeshReferee referee(facet.mesh, {.shading = scheme});
            for (int i = 0; i < 300; ++i) {
                const glm::dvec3 at(double(random()) / 4294967296.0 * 1.4 + 0.6,
                                    double(random()) / 4294967296.0 * 0.2 + 0.8, 0);
                const brute::Vector expected = referee.direction(0, {at.x, at.y, at.z});
                const glm::dvec3 found = facet.direction(shading, at);
                for (int axis = 0; axis < 3; ++axis)
                    EXPECT_NEAR(found[axis], double(expected[axis]), 2e-14);
            }
        }
    }
}

TEST(Shading, NormalsThatCancelGiveNoDirection) {
    Mesh mesh = OneFacet::make(kTriangle);
    for (glm::dvec3& normal : mesh.vertex_normals)
        normal = glm::dvec3(0);
    const shapes::MeshLaw<> facet(mesh);
    for (const uint shading : {layout::kShadingMorgenbesser, layout::kShadingBarycentric, layout::kShadingMeanValue})
        EXPECT_EQ(reference::shading_direction(facet.view, shading, 0, glm::dvec3(0.1, 0, 0)), glm::dvec3(0.0));
}

// Coordinates of a polygon take a linear function's values at the corners to its value anywhere on the facet.
TEST(Shading, ByCoordinatesALinearFunctionIsExact) {
    const auto linear = [](const glm::dvec3& at) {
        return glm::dvec3(0.3 * at.x - 0.1 * at.y, 0.2 * at.x + 0.4 * at.y, 1 + 0.1 * at.z);
    };
    const auto plane = [](double x, double y) { return 0.3 * x - 0.7 * y; };
    std::mt19937 random(5);
    for (const PolygonSoup& polygons :
         {shapes::patch(shapes::Cells::triangles, 4, plane), shapes::patch(shapes::Cells::quads, 4, plane),
          shapes::patch(shapes::Cells::hexagons, 4, plane), shapes::polygon(kArrow)}) {
        Mesh mesh = shapes::mesh_of(polygons);
        for (std::size_t i = 0; i < mesh.vertex_normals.size(); ++i)
            mesh.vertex_normals[i] = linear(mesh.polygons.vertices[i]);
        const shapes::MeshLaw<> law(mesh);
        for (uint facet = 0; facet < polygons.facets(); ++facet)
            for (int i = 0; i < 20; ++i) {
                glm::dvec3 at(0);
                double shares = 0;
                for (const std::uint32_t corner : polygons.outline(facet)) {
                    const double share = 1 + shapes::uniform(random);
                    at += share * polygons.vertices[corner];
                    shares += share;
                }
                at /= shares;
                const auto off = [&](uint shading) {
                    return angle_between(reference::shading_direction(law.view, shading, facet, law.local(at)),
                                         linear(at));
                };
                EXPECT_LT(off(layout::kShadingMeanValue), 1e-13);
                if (polygons.outline(facet).size() == 3) {
                    EXPECT_LT(off(layout::kShadingBarycentric), 1e-13);
                }
            }
    }
}

TEST(Shading, MorgenbesserWeighsANormalByTheDistancesToTheOtherCorners) {
    const OneFacet facet({{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}});
    const auto& normals = facet.mesh.vertex_normals; // at the first corner: 0, 4, 5 and 3 away
    EXPECT_LT(angle_between(facet.direction(layout::kShadingMorgenbesser, {0, 0, 0}),
                            12.0 * normals[0] + 8.0 * normals[1] + 7.0 * normals[2] + 9.0 * normals[3]),
              1e-14);
}

} // namespace
} // namespace forceshade
