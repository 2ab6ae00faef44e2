// Meshes that break lesser code: slivers, nothing, doubles, needles, cancelling normals, far away, huge facets. Always
// finite, and right where right means something.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/contact.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using layout::uint;

constexpr double kStiffness = 1000; /* N/m */
constexpr uint kShadings[] = {layout::kShadingNone, layout::kShadingMorgenbesser, layout::kShadingBarycentric,
                              layout::kShadingMeanValue, layout::kShadingTwoPass};

template <typename T> double length(const reference::Vector<T>& v) {
    return std::sqrt(double(v.x) * double(v.x) + double(v.y) * double(v.y) + double(v.z) * double(v.z));
}

/// Every scheme at probes all over, on corners and in the middle of triangles: finite, as strong as unshaded.
template <typename T> void expect_sane(const Mesh& mesh) {
    shapes::MeshLaw<T> meshed(mesh, kStiffness);
    layout::Law<T>& law = meshed.law;
    bool triangles = true;
    for (uint facet = 0; facet < law.mesh.params.facets; ++facet)
        triangles = triangles && law.mesh.facet_begins[facet + 1] - law.mesh.facet_begins[facet] == 3;
    std::mt19937 random(1);
    for (int i = 0; i < 600; ++i) {
        reference::Vector<T> probe(T(1.1 * shapes::uniform(random)), T(1.1 * shapes::uniform(random)),
                                   T(1.1 * shapes::uniform(random)));
        const std::size_t triangle = random() % meshed.structure.triangles();
        const auto corner = [&](std::size_t j) {
            return reference::vector_at(law.mesh.vertices, law.mesh.triangle_corners[3 * triangle + j]);
        };
        const reference::Vector<T> normal = reference::vector_at(law.mesh.triangle_normals, triangle);
        if (i % 4 == 1)
            probe = corner(random() % 3);
        if (i % 4 == 2)
            probe = (corner(0) + corner(1) + corner(2)) / T(3) -
                    T(std::pow(10, -12 * std::abs(shapes::uniform(random)))) * normal;
        if (i % 4 == 3)
            probe = corner(random() % 3) - T(std::pow(10, -12 * std::abs(shapes::uniform(random)))) * normal;
        for (const uint shading : kShadings) {
            if (shading == layout::kShadingBarycentric && !triangles)
                continue;
            law.features.shading = shading;
            const reference::Contact<T> contact = reference::evaluate(law, probe);
            ASSERT_TRUE(std::isfinite(length(contact.force)) && std::isfinite(length(contact.proxy)));
            ASSERT_TRUE(std::isfinite(contact.depth) && contact.depth >= 0);
            ASSERT_TRUE(contact.facet == layout::kNoFacet || contact.facet < law.mesh.params.facets);
            const double unshaded = length(contact.unshaded),
                         tolerance = 50 * double(std::numeric_limits<T>::epsilon());
            if (shading == layout::kShadingTwoPass) {
                ASSERT_GE(length(contact.force), unshaded * (1 - tolerance));
            } else {
                ASSERT_NEAR(length(contact.force), unshaded, unshaded * tolerance + 1e-30);
            }
        }
    }
}

/// Depth and direction by the referee, wherever rounding does not decide.
void expect_right(const Mesh& mesh, double tolerance = 1e-12) {
    const shapes::MeshLaw<> law(mesh, kStiffness);
    const double scale = law.structure.scale;
    const brute::MeshReferee referee(mesh, {});
    std::mt19937 random(2);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 world = law.structure.centre + shapes::anywhere(random, scale);
        const brute::Answer expected = referee.at(world);
        const reference::Contact<double> found = law.at(world);
        EXPECT_NEAR(found.depth / scale, double(expected.depth) / scale, tolerance);
        EXPECT_EQ(found.facet == layout::kNoFacet, expected.facet == layout::kNoFacet);
    }
}

/// Finite, and where `referee` says so right.
void hold(const PolygonSoup& polygons, bool referee = true) {
    const Mesh mesh = shapes::mesh_of(polygons);
    expect_sane<double>(mesh);
    expect_sane<float>(mesh);
    if (referee)
        expect_right(mesh);
}

PolygonSoup with_facets(PolygonSoup polygons, std::initializer_list<std::initializer_list<std::uint32_t>> facets) {
    for (const std::initializer_list<std::uint32_t>& facet : facets)
        shapes::add_facet(polygons, facet);
    return polygons;
}

PolygonSoup with_vertices(PolygonSoup polygons, std::initializer_list<glm::dvec3> vertices) {
    polygons.vertices.insert(polygons.vertices.end(), vertices);
    return polygons;
}

TEST(Extremes, FacetsThinOrWithoutAreaOrDouble) {
    hold(shapes::sliver_box(50, 1e8));
    // A cube one of whose faces is cut into slivers.
    hold(with_facets(with_vertices(shapes::cube(true), {{1, 1, 1 - 2e-8}}), {{7, 8, 5}}));
    const PolygonSoup sphere = shapes::icosphere(1), twice = shapes::merged(sphere, sphere);
    hold(with_facets(with_vertices(twice, {(twice.vertices[0] + twice.vertices[1]) / 2.0}),
                     {{0, 0, 5}, {3, 3, 3}, {0, std::uint32_t(twice.vertices.size()), 1}}));
    // Each facet once more, of the same vertices.
    PolygonSoup again = twice;
    again.vertices = sphere.vertices;
    std::copy(sphere.corners.begin(), sphere.corners.end(), again.corners.begin() + std::ssize(sphere.corners));
    hold(again);
    hold(shapes::subdivided(shapes::subdivided(shapes::cube()))); // coplanar neighbours
    hold(shapes::single_triangle());
}

TEST(Extremes, ShapesThatAreFarNarrowOrNested) {
    hold(shapes::needle_fan(1000, 30));
    hold(shapes::needle_fan(1000, 1e-7));
    hold(shapes::moved(shapes::icosphere(3), glm::dvec3(1), {1e6, -1e6, 1e6}));
    hold(shapes::nested_shells(3, true));
    hold(shapes::nested_shells(3, false));
    hold(shapes::plate(1e-5));
    hold(shapes::plate(1e-12));
    // Two cubes that share an edge: four triangles meet there.
    hold(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {2, 2, 0})));
}

TEST(Extremes, NormalsThatCancelOrOpposeEachOther) {
    // A two-sided sheet: every vertex normal is 0.
    const PolygonSoup sheet = with_facets(shapes::single_triangle(), {{0, 2, 1}});
    EXPECT_EQ(shapes::mesh_of(sheet).vertex_normals[0], glm::dvec3(0));
    hold(sheet, false);
    PolygonSoup sphere = shapes::icosphere(2); // with one facet turned round
    std::swap(sphere.corners[0], sphere.corners[1]);
    hold(sphere, false);
    PolygonSoup fan;
    fan.vertices = {{0, 0, -1}, {0, 0, 1}};
    for (std::uint32_t i = 0; i < 7; ++i) {
        fan.vertices.push_back({std::cos(0.9 * i), std::sin(0.9 * i), 0.1 * i});
        shapes::add_facet(fan, {0, 1, 2 + i});
    }
    hold(fan, false);
}

TEST(Extremes, TwoPassWhereTheDirectionLiesInTheFacetIsUnshaded) {
    Mesh mesh = shapes::mesh_of(shapes::single_triangle());
    for (glm::dvec3& normal : mesh.vertex_normals)
        normal = {0.6, 0.8, 0};
    shapes::MeshLaw<> flat(mesh, kStiffness);
    flat.law.features.shading = layout::kShadingTwoPass;
    const auto contact = flat.at({0.2, 0.2, -0.1});
    EXPECT_EQ(contact.force, contact.unshaded);
    EXPECT_NEAR(contact.force.z, 0.1 * kStiffness, 1e-12);
}

TEST(Extremes, AFacetOf65537Corners) {
    shapes::MeshLaw<> prism(shapes::many_gon_prism(65537), kStiffness);
    for (const uint shading : {layout::kShadingMorgenbesser, layout::kShadingMeanValue, layout::kShadingTwoPass}) {
        prism.law.features.shading = shading;
        for (const glm::dvec3& world :
             {glm::dvec3(0.1, 0.2, 0.9), {0, 0, 0.95}, {0.9999, 0, 0.99999}, {0.5, 0.5, 1 - 1e-12}}) {
            const auto contact = prism.at(world);
            EXPECT_NEAR(contact.depth, std::min(1 - world.z, 1 - std::hypot(world.x, world.y)), 1e-8);
            EXPECT_NEAR(length(contact.unshaded), kStiffness * contact.depth, 1e-9);
            EXPECT_TRUE(std::isfinite(length(contact.force)));
            if (shading != layout::kShadingTwoPass) {
                EXPECT_NEAR(length(contact.force), kStiffness * contact.depth, 1e-9 * contact.depth * kStiffness);
            }
        }
    }
}

TEST(Extremes, CapsThatContradictEachOtherAreCutOnce) {
    // Coordinates so far apart that all lie on one line but for rounding: each facet says that a corner of its own lies
    // on its longest side, and which that is depends on the axis.
    const PolygonSoup soup = shapes::soup_of({{0, 0, -3.6966219001423567e-159},
                                              {0, 0, 1.6188018890408547e-316},
                                              {0, 0, 0},
                                              {0, 0, 0},
                                              {1.3535544878853416e+82, 7.0428167507783998e-310, 0},
                                              {0, 5.5626846462680035e-309, 0}},
                                             {{4, 1, 2, 1}, {2, 1, 4, 5, 5, 3}, {4, 0, 2}});
    const MeshStructure structure = build_structure(shapes::mesh_of(soup));
    EXPECT_GT(structure.triangles(), 0u);
}

TEST(Extremes, MixedMagnitudesArePreparedOrRefused) {
    std::mt19937 random(11);
    const auto coordinate = [&] {
        const double size = std::pow(10, 200 * shapes::uniform(random) - 120);
        return random() % 3 != 0 ? 0.0 : std::copysign(size < 1e99 ? size : 1e99, shapes::uniform(random));
    };
    int prepared = 0;
    for (int i = 0; i < 6000; ++i) {
        PolygonSoup soup;
        for (auto vertices = 3 + random() % 6; vertices > 0; --vertices)
            soup.vertices.push_back({coordinate(), coordinate(), coordinate()});
        for (auto facets = 1 + random() % 16; facets > 0; --facets) {
            for (auto corners = 3 + random() % 4; corners > 0; --corners)
                soup.corners.push_back(std::uint32_t(random() % soup.vertices.size()));
            soup.begins.push_back(std::uint32_t(soup.corners.size()));
        }
        try {
            prepared += build_structure(shapes::mesh_of(soup)).triangles() > 0;
        } catch (const UsageError&) { // nothing with an area
        }
    }
    EXPECT_GT(prepared, 1000);
}

TEST(Extremes, FacetsThatAreCutTooOftenAreRefused) {
    // The pages of a book whose spine is cut by facets without area, thousands by thousands.
    constexpr std::uint32_t kPages = 1500;
    PolygonSoup book;
    for (std::uint32_t i = 0; i <= kPages; ++i)
        book.vertices.push_back({0, 0, double(i)});
    for (std::uint32_t i = 0; i < kPages; ++i) {
        book.vertices.push_back({std::cos(i * 1e-3), std::sin(i * 1e-3), 0});
        shapes::add_facet(book, {0, kPages, kPages + 1 + i});
        if (i + 1 < kPages)
            shapes::add_facet(book, {i, i + 1, kPages});
    }
    const Mesh mesh = shapes::mesh_of(book);
    EXPECT_THROW(build_structure(mesh), UsageError);
}

TEST(Extremes, ReentrantEdgesSharperThanARightAngle) {
    // Below the notch the edge is nearest, and which side is in must not hang on one facet.
    const PolygonSoup block = shapes::notched_block();
    hold(block);
    // As single triangles, too: no vertex in common, all edges found by place.
    const Mesh cut = shapes::mesh_of(block);
    PolygonSoup heap;
    heap.vertices = cut.polygons.vertices;
    for (const auto& triangle : cut.triangles.corners)
        shapes::add_facet(heap, {triangle[0], triangle[1], triangle[2]});
    hold(shapes::split(heap));
}

} // namespace
} // namespace forceshade
