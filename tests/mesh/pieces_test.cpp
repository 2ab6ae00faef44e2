// Pieces that face inward, cavities, facets against the others, and how they are turned.
#include "host/mesh/pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

PolygonSoup box(double middle, double half, bool inward) {
    PolygonSoup result = shapes::cube();
    for (glm::dvec3& vertex : result.vertices)
        vertex = half * vertex + glm::dvec3(middle, 0, 0);
    if (inward)
        for (std::size_t facet = 0; facet < result.facets(); ++facet)
            std::reverse(&result.corners[result.begins[facet]], &result.corners[result.begins[facet + 1]]);
    return result;
}

double volume(const PolygonSoup& polygons) {
    return inspect(polygons).volume;
}

TEST(Pieces, OneThatFacesInwardIsNamedUnlessItIsACavity) {
    const PolygonSoup apart = shapes::merged(box(0, 1, false), box(5, 1, true));
    ASSERT_EQ(inspect(apart).inside_out.size(), 1u);
    EXPECT_EQ(inspect(apart).inside_out[0], "piece 2 of 2 (6 facets, from facet 6 on)");
    const PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(inspect(hollow).inside_out.empty());
    // In the cavity an outward piece is a solid, an inward one is not.
    EXPECT_TRUE(inspect(shapes::merged(hollow, box(0, 0.5, false))).inside_out.empty());
    EXPECT_EQ(inspect(shapes::merged(hollow, box(0, 0.5, true))).inside_out.size(), 1u);
    ASSERT_EQ(inspect(box(0, 1, true)).inside_out.size(), 1u);
    EXPECT_EQ(inspect(box(0, 1, true)).inside_out[0], "the mesh");
}

TEST(Pieces, AreTurnedOutwardAndCavitiesStay) {
    PolygonSoup apart = shapes::merged(box(0, 1, false), box(5, 1, true));
    EXPECT_EQ(orient_outward(apart).size(), 1u);
    EXPECT_DOUBLE_EQ(volume(apart), 16);
    EXPECT_TRUE(orient_outward(apart).empty());
    PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(orient_outward(hollow).empty());
    EXPECT_DOUBLE_EQ(volume(hollow), 64 - 8);
}

TEST(Pieces, OneThatFacesOutwardWithinAnotherIsNamed) {
    const PolygonSoup nested = shapes::merged(box(0, 2, false), box(0, 1, false));
    ASSERT_EQ(inspect(nested).nested.size(), 1u);
    EXPECT_EQ(inspect(nested).nested[0], "piece 2 of 2 (6 facets, from facet 6 on)");
    const PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(inspect(hollow).nested.empty());
    EXPECT_TRUE(inspect(shapes::merged(hollow, box(0, 0.5, false))).nested.empty()); // a solid in the cavity
    EXPECT_TRUE(inspect(shapes::merged(box(0, 1, false), box(5, 1, false))).nested.empty());
}

TEST(Pieces, CavitiesOfWhatFacesInwardAreTurnedWithIt) {
    PolygonSoup inverted = shapes::merged(shapes::merged(box(0, 2, true), box(0, 1, false)), box(0, 0.5, true));
    EXPECT_EQ(orient_outward(inverted).size(), 3u);
    EXPECT_DOUBLE_EQ(volume(inverted), 64 - 8 + 1);
    EXPECT_TRUE(orient_outward(inverted).empty());
    EXPECT_TRUE(inspect(inverted).nested.empty() && inspect(inverted).inside_out.empty());
}

TEST(Pieces, FacetsAgainstTheOthersAreTurned) {
    const PolygonSoup sphere = shapes::icosphere(2);
    PolygonSoup mixed = sphere;
    for (std::size_t facet = 0; facet < mixed.facets(); facet += 3)
        std::reverse(&mixed.corners[mixed.begins[facet]], &mixed.corners[mixed.begins[facet + 1]]);
    const std::vector<std::string> turned = orient_outward(mixed);
    ASSERT_EQ(turned.size(), 1u);
    EXPECT_EQ(turned[0], "turned 107 facets of the mesh, which faced against the others");
    EXPECT_DOUBLE_EQ(volume(mixed), volume(sphere));
    EXPECT_EQ(inspect(mixed).misoriented_edges, 0u);
}

TEST(Pieces, AMoebiusStripHasNoOutside) {
    PolygonSoup strip;
    constexpr std::uint32_t kParts = 12;
    for (std::uint32_t i = 0; i < kParts; ++i) {
        const double angle = 2 * std::numbers::pi * i / kParts;
        for (const double side : {-0.3, 0.3}) {
            const double radius = 1 + side * std::cos(angle / 2);
            strip.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2));
        }
    }
    for (std::uint32_t i = 0; i + 1 < kParts; ++i)
        shapes::add_facet(strip, {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    shapes::add_facet(strip, {2 * kParts - 2, 1, 0, 2 * kParts - 1});
    EXPECT_TRUE(find_pieces(strip).pieces[0].one_sided);
    EXPECT_NE(testing::message_of<UsageError>([&] { orient_outward(strip); }).find("no outside"), std::string::npos);
}

} // namespace
} // namespace forceshade
