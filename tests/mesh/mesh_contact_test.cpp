// L6 static with L7 to L9 at single probes, held against the referee; and what every scheme must keep.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/contact.h"
#include "host/reference/elementary.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using brute::MeshShading;
using layout::uint;
using Contact = reference::Contact<double>;

constexpr double kContactStiffness = 700; /* N/m */
constexpr std::pair<uint, MeshShading> kSchemes[] = {{layout::kShadingNone, MeshShading::none},
                                                     {layout::kShadingMorgenbesser, MeshShading::morgenbesser},
                                                     {layout::kShadingBarycentric, MeshShading::barycentric},
                                                     {layout::kShadingMeanValue, MeshShading::mean_value},
                                                     {layout::kShadingTwoPass, MeshShading::two_pass}};

struct Oracle : shapes::MeshLaw<> {
    explicit Oracle(PolygonSoup polygons) : MeshLaw(std::move(polygons), kContactStiffness) {}
    double size = structure.scale; /* m: half the largest extent */
};

glm::dvec3 below_a_triangle(std::mt19937& random, const Mesh& mesh) {
    const std::size_t triangle = random() % mesh.triangles.corners.size();
    glm::dvec3 corners[3];
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = mesh.polygons.vertices[mesh.triangles.corners[triangle][i]];
    const double size = reference::length(glm::dvec3(corners[1] - corners[0]));
    return (corners[0] + corners[1] + corners[2]) / 3.0 -
           0.3 * size * std::abs(shapes::uniform(random)) * mesh.triangles.normals[triangle];
}

glm::dvec3 vector_of(const brute::Vector& v) {
    return glm::dvec3(v);
}

/// Holds probes against the referee; near a medial axis, where the least rounding decides, only the depth.
void hold_against_referee(Oracle& oracle, int count, bool triangles) {
    std::mt19937 random(11);
    int touching = 0;
    for (const auto& [shading, scheme] : kSchemes) {
        if (scheme == MeshShading::barycentric && !triangles)
            continue;
        oracle.law.features.shading = shading;
        brute::MeshLaw law;
        law.stiffness = kContactStiffness;
        law.shading = scheme;
        const brute::MeshReferee referee(oracle.mesh, law);
        for (int i = 0; i < count; ++i) {
            const glm::dvec3 world = i % 2 ? oracle.structure.centre + shapes::anywhere(random, 1.1 * oracle.size)
                                           : below_a_triangle(random, oracle.mesh);
            const brute::MeshPoint nearest = referee.nearest(world);
            const brute::Answer expected = referee.at(world);
            const Contact found = oracle.at(world);
            EXPECT_NEAR(found.depth, double(expected.depth), 1e-12 * oracle.size);
            if (double(nearest.runner_up - nearest.distance) < 1e-9 * oracle.size)
                continue;
            touching += expected.depth > 0;
            EXPECT_EQ(found.facet, expected.facet);
            const glm::dvec3 proxy = origin_of(oracle.structure) + found.proxy;
            EXPECT_LT(reference::length(proxy - vector_of(expected.proxy)), 1e-12 * oracle.size);
            EXPECT_LT(reference::length(found.unshaded - vector_of(expected.unshaded)),
                      1e-12 * kContactStiffness * oracle.size);
            EXPECT_LT(reference::length(found.force - vector_of(expected.force)),
                      1e-11 * kContactStiffness * oracle.size);
        }
    }
    EXPECT_GT(touching, count / 20);
}

TEST(MeshContact, IsTheReferees) {
    const auto cylinder = [](double x, double y) { return x * x - 0.3 * y; };
    for (const auto& [polygons, probes] :
         {std::pair{shapes::icosphere(3), 100},
          {shapes::moved(shapes::icosphere(2), glm::dvec3(0.01), {1e4, -1e4, 1e4}), 100},
          {shapes::spot(), 30},
          {shapes::random_polyhedra(60, 2), 400},
          {shapes::cube(), 300},
          {shapes::patch(shapes::Cells::hexagons, 6, cylinder), 300}}) {
        Oracle oracle(polygons);
        hold_against_referee(oracle, probes, oracle.mesh.triangles.corners.size() == polygons.facets());
    }
}

TEST(MeshContact, TextureAndMapAreTheReferees) {
    Oracle oracle(shapes::icosphere(3));
    layout::MapParams<double>& map = oracle.law.params.map;
    map.slope = 0.7;
    map.inverse_length = 1.3;
    oracle.law.params.texture = map;
    oracle.law.params.texture_stiffness = 90;
    const brute::Slope gaussian = [](brute::Real x, brute::Real y) -> std::array<brute::Real, 2> {
        const brute::Real u = brute::Real(1.3) * x, v = brute::Real(1.3) * y;
        const brute::Real steepness = brute::Real(0.7) * std::exp(-(u * u + v * v));
        return {-steepness * u, -steepness * v};
    };
    for (const bool with_map : {false, true}) {
        oracle.law.features.map = with_map ? layout::kMapGaussian : layout::kMapNone;
        oracle.law.features.texture = layout::kMapGaussian;
        for (const auto& [shading, scheme] : kSchemes) {
            oracle.law.features.shading = shading;
            const brute::MeshReferee referee(oracle.mesh,
                                             {kContactStiffness, 90, scheme, brute::MeshInside::pseudonormal,
                                              with_map ? gaussian : brute::Slope{}, gaussian});
            std::mt19937 random(11);
            for (int i = 0; i < 60; ++i) {
                const glm::dvec3 world = shapes::anywhere(random, 0.9);
                const brute::MeshPoint nearest = referee.nearest(world);
                if (double(nearest.runner_up - nearest.distance) < 1e-9)
                    continue;
                const brute::Answer expected = referee.at(world);
                const Contact found = oracle.at(world);
                EXPECT_LT(reference::length(found.force - vector_of(expected.force)), 1e-11 * kContactStiffness);
                EXPECT_LT(reference::length(found.unshaded - vector_of(expected.unshaded)), 1e-11 * kContactStiffness);
            }
        }
    }
}

TEST(MeshContact, TiesGoToTheLowestFacet) {
    for (const bool triangles : {false, true}) {
        const Oracle oracle(shapes::cube(triangles));
        EXPECT_EQ(oracle.at({0, 0, 0}).facet, 0u);
        EXPECT_EQ(oracle.at({0.5, 0.5, 0}).facet, triangles ? 7u : 3u);
        EXPECT_EQ(oracle.at({0.5, 0.5, 0.5}).facet, triangles ? 2u : 1u);
    }
}

TEST(MeshContact, OnAConcaveEdgeTheLowerFacetHasTheForceOnBothSides) {
    // A valley between two slopes: all over the wedge below it the edge is nearest.
    const Oracle oracle(
        shapes::soup_of({{-1, -1, 0.7}, {0.1, -1, 0}, {1.2, -1, 0.4}, {-1, 1.3, 0.7}, {0.1, 1.3, 0}, {1.2, 1.3, 0.4}},
                        {{1, 2, 5, 4}, {0, 1, 4, 3}}));
    std::mt19937 random(11);
    for (int i = 0; i < 1000; ++i) {
        const double y = 0.9 * shapes::uniform(random);
        EXPECT_EQ(oracle.at({0.1 + 0.05 * shapes::uniform(random), y, -0.5}).facet, 0u);
    }
}

} // namespace
} // namespace forceshade
