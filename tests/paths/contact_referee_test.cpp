// The referee of contacts sees what no god-object may do, in the rows of a path alone, and nothing else.
#include "host/referee/contact_surface.h"

#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/cases/path_comparison.h"
#include "host/field/prepared_case.h"
#include "host/mesh/mesh_file.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

constexpr layout::uint kFree = layout::kNoFacet;

struct Row {
    glm::dvec3 probe, proxy; // m
    layout::uint facet = 0;
};

// A probe out of contact.
Row free_at(const glm::dvec3& place) {
    return {place, place, kFree};
}

// What is to be counted.
struct Wrong {
    std::uint64_t grew = 0, unbalanced = 0, dropped = 0, phantoms = 0, other = 0;
};

class ContactReferee : public ::testing::Test {
protected:
    PreparedCase prepared(const PolygonSoup& polygons, const std::string& more = "") const {
        folder_.write("mesh.obj", as_obj(polygons));
        return CasePreparation().prepare(
            parse_scene("[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n" + more, "scene", folder_.path()));
    }

    // One path, in windows of two samples.
    /// `samples`: of many, loops look at a few.
    template <typename T>
    static ContactCount count_of(const PreparedCase& one, const std::vector<Row>& path, std::uint64_t samples = 0) {
        forceshade::ContactReferee<T> contacts(one, std::max<std::uint64_t>(samples, path.size()), false);
        const layout::uint steps = static_cast<layout::uint>(path.size());
        for (std::size_t first = 0; first < path.size(); first += 2) {
            PathRows<T> rows;
            std::vector<T> position, proxy;
            std::vector<layout::uint> facet;
            for (std::size_t i = first; i < std::min(first + 2, path.size()); ++i) {
                for (int axis = 0; axis < 3; ++axis) {
                    position.push_back(T(path[i].probe[axis]));
                    proxy.push_back(T(path[i].proxy[axis]));
                }
                facet.push_back(path[i].facet);
            }
            rows.path_count = 1;
            rows.pitch = facet.size();
            rows.steps = {&steps, 1};
            rows.position = position;
            rows.proxy = proxy;
            rows.facet = facet;
            rows.step_first = first;
            contacts.check(rows);
        }
        return contacts.count();
    }

    // In both precisions.
    static void expect(const PreparedCase& one, const std::vector<Row>& path, const Wrong& wrong) {
        for (const ContactCount& count : {count_of<float>(one, path), count_of<double>(one, path)}) {
            EXPECT_EQ(count.samples, path.size());
            EXPECT_EQ(count.grew, wrong.grew) << count.first;
            EXPECT_EQ(count.unbalanced, wrong.unbalanced) << count.first;
            EXPECT_EQ(count.dropped, wrong.dropped) << count.first;
            EXPECT_EQ(count.phantoms, wrong.phantoms) << count.first;
            EXPECT_EQ(count.other, wrong.other) << count.first;
            EXPECT_EQ(count.first.empty(), count.wrong() == 0);
        }
    }

    Folder folder_;
};

TEST_F(ContactReferee, FindsNothingInAnOrdinaryPath) {
    const PreparedCase one = prepared(shapes::cube());
    expect(one,
           {free_at({0, 0, 1.5}),
            {{0, 0, 0.5}, {0, 0, 1}, 5},
            {{0.5, 0.2, -5}, {0.5, 0.2, 1}, 5}, // out again on the other side, and held all the same
            {{0.9, 0.9, 0.5}, {0.9, 0.9, 1}, 5},
            free_at({1.1, 0, 1.1}),
            free_at({1.1, 0, 0})},
           {});
    const ContactCount count =
        count_of<double>(one, {free_at({0, 0, 1.5}), {{0, 0, 0.5}, {0, 0, 1}, 5}, free_at({0, 0, 1.2})});
    EXPECT_TRUE(count.mesh);
    EXPECT_TRUE(count.closed);
    EXPECT_EQ(count.near, 0u);
}

TEST_F(ContactReferee, SeesAProxyThatFellThrough) {
    const PreparedCase one = prepared(shapes::cube());
    const std::vector<Row> path{free_at({0, 0, 1.5}),
                                {{0, 0, 0.5}, {0, 0, 1}},
                                free_at({0, 0, 0.4}),
                                free_at({0, 0.3, -0.4}),
                                {{0, 0, -1.5}, {0, 0, -1}}}; // held from within
    expect(one, path, {.dropped = 2, .other = 1});
    EXPECT_TRUE(says(count_of<double>(one, path).first, "path 0, step 2"));
    // From within to the outside: of a cube that is turned inside out, so that its inside is free.
    expect(prepared(shapes::reversed(shapes::cube())), {free_at({0, 0, 0}), {{0, 0, 2}, {0, 0, 1}}, free_at({0, 0, 2})},
           {.dropped = 1});
}

TEST_F(ContactReferee, LetsAPathThatBeginsBehindTheSurfaceGoOnInFrontOfIt) {
    const PreparedCase one = prepared(shapes::cube());
    expect(one, {{{0, 0, 0.9}, {0, 0, 1}}, {{0, 0, 0.8}, {0, 0, 1}}, free_at({0, 0, 1.1})}, {});
    expect(one, {free_at({0, 0, 0.9}), free_at({0, 0, 0.8}), free_at({0, 0, 1.1})}, {.dropped = 2});
}

TEST_F(ContactReferee, TellsSidesAmongShellsAndSolidsThatOverlap) {
    const PreparedCase hollow = prepared(shapes::nested_shells(3, true));
    const glm::dvec3 wall = [&] {
        for (double x = 0; x < 1; x += 0.01)
            if (brute::MeshReferee(hollow.images.mesh->mesh, {}).winding_number({x, 0.01, 0.02}) > 0.5)
                return glm::dvec3(x + 0.1, 0.01, 0.02);
        return glm::dvec3(0);
    }();
    expect(hollow, {free_at({0, 0, 0}), free_at({0.1, 0, 0})}, {});
    expect(hollow, {free_at({0, 0, 0}), free_at(wall)}, {.dropped = 1});
    expect(hollow, {free_at({2, 0, 0}), free_at(wall)}, {.dropped = 1});
    const PreparedCase both = prepared(shapes::nested_shells(3, false));
    expect(both, {free_at({2, 0, 0}), free_at(wall)}, {.dropped = 1});
    expect(both, {free_at({2, 0, 0}), free_at({0, 0, 0})}, {.dropped = 1});
    // Two cubes that overlap in x = [0.5, 1]: who begins there goes on within the other.
    const PreparedCase two =
        prepared(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {1.5, 0, 0})));
    expect(two, {free_at({-2, 0, 0}), {{-0.5, 0, 0}, {-1, 0, 0}}, free_at({0.75, 0, 0})}, {.dropped = 1});
    expect(two, {{{0.95, 0, 0}, {1, 0, 0}}, {{0.6, 0, 0}, {1, 0, 0}}, free_at({1.2, 0, 0})}, {});
    expect(two, {{{0.95, 0, 0}, {1, 0, 0}}, free_at({3, 0, 0})}, {.dropped = 1});
}

TEST_F(ContactReferee, DoesNotGuessOnTheSurfaceNorInNarrowCorners) {
    const PreparedCase one = prepared(shapes::cube());
    const std::vector<Row> grazing{free_at({0, 0, 1.5}), free_at({0, 0, 1 - 1e-13}), {{0, 0, 1 - 1e-13}, {0, 0, 1}}};
    EXPECT_EQ(count_of<double>(one, grazing).near, 2u);
    expect(one, grazing, {});
    // A notch, pressed hard against its one wall and a little against the other.
    const PreparedCase notch = prepared(shapes::notched_block());
    expect(notch, {free_at({0, 0, 1}), {{-0.3, 0, -0.1}, {0, 0, 0}}, {{0.3, 0, -0.1}, {0, 0, 0}}}, {});
    // An open mesh has no sides.
    const ContactCount open = count_of<double>(prepared(shapes::open_cube()), {free_at({0, 0, 2}), free_at({0, 0, 0})});
    EXPECT_FALSE(open.closed);
    EXPECT_EQ(open.windings, 0u);
    EXPECT_EQ(open.wrong(), 0u);
}

// A wedge that stands through a box's top: next to it, within the box, the force on a proxy in the acute groove between
// both points out of the groove.
TEST_F(ContactReferee, TellsTheSectorsWhereSolidsCross) {
    const PolygonSoup wedge =
        shapes::soup_of({{-7, -6, -2}, {-3, -6, -2}, {-5, -6, 3}, {-7, 6, -2}, {-3, 6, -2}, {-5, 6, 3}},
                        {{0, 1, 2}, {5, 4, 3}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}});
    const PreparedCase one = prepared(shapes::merged(shapes::moved(shapes::cube(), {10, 8, 3}, {0, 0, -3}), wedge));
    const Row start{{-6.55, 0, -1}, {-6.55 - 1.25 / 29, 0, -1 + 0.5 / 29}}; // in the wedge: goes on before it
    const Row groove{{-2.94, 1, -0.92}, {-6.2, 1, 0}};
    expect(one, {start, free_at({-8, 0, -1}), groove, groove, free_at({-8, 1, -1})}, {});
    expect(one, {start, groove, free_at({-8, 1, 1})}, {.dropped = 1});
    // Of solids that do not cross the side is known: one that holds its proxy from within, at an edge.
    const PreparedCase apart =
        prepared(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {5, 0, 0})));
    expect(apart, {free_at({0, 0, 2}), {{1.5, 0, 1.5}, {1, 0, 1}}}, {.phantoms = 1, .other = 1});
}

// A path that begins nearer to the surface than single precision can tell, and is then held at a corner whose facets
// face away from each other: off that corner, along the force, is inside of the solid.
TEST_F(ContactReferee, DoesNotGuessTheSideWhereAPathBeginsOnTheSurface) {
    const PreparedCase crags = prepared(read_polygons(in_source("tests/mutation/scenes/crags.obj")).polygons);
    const ContactCount count =
        count_of<float>(crags, {free_at({-1.08045751, 3.757253062, -1.953447213}),
                                {{-0.6775809059, 2.778047212, -5.349276368}, {-0.59428293, 4.58441023, -3.3751202}},
                                free_at({-1.0804527, 3.7572603, -1.9534428}),
                                free_at({-1, 4, 2})});
    EXPECT_EQ(count.wrong(), 0u) << count.first;
    // Held by a corner, then free behind the surface by less than single precision tells: on no side either.
    const ContactCount behind =
        count_of<float>(crags,
                        {free_at({2.711719, 3.2252767, 0.011901337}),
                         {{1.6408337, -1.6331661, 1.1539733}, {2.1887212, -0.32979157, 2.066181}},
                         {{1.0687532, -0.70161803, 0.2048418}, {2.5367772, 0.09902357, 1.244436}},
                         {{0.03125, 1.34375, -7.84375}, {4.1226195, 2.05283, -2.4996703}},
                         free_at({-1.3415677, -5.846151, 0.34929544}),
                         free_at({-1.3417532, -5.8461567, 0.34909605}),
                         free_at({-1, 4, 2})},
                        1'000'000);
    EXPECT_EQ(behind.wrong(), 0u) << behind.first;
}

TEST_F(ContactReferee, SeesAProxyThatGoesAwayFromTheProbe) {
    for (const PolygonSoup& polygons : {shapes::cube(), shapes::open_cube()}) {
        const PreparedCase one = prepared(polygons);
        // On the face x = 1, and down it although the probe does not move.
        const Row held{{0.5, 0, 0}, {1, 0, 0}};
        expect(one, {free_at({1.5, 0, 0}), held, {{0.5, 0, 0}, {1, 0.5, 0}}, held}, {.grew = 1, .unbalanced = 1});
        expect(one, {free_at({1.5, 0, 0}), held, {{-0.5, 0.1, 0}, {1, 0.1, 0}}, held}, {});
        // Over the cube's edge, where the other face is further off.
        expect(one, {free_at({1.5, 0, 0}), {{0.9, 0.7, 0}, {1, 0.7, 0}}, {{0.9, 0.7, 0}, {0.9, 1, 0}}}, {.grew = 1});
    }
}

TEST_F(ContactReferee, SeesAForceInNoDirectionOfTheFacets) {
    for (const PolygonSoup& polygons : {shapes::cube(), shapes::open_cube()}) {
        const PreparedCase one = prepared(polygons);
        expect(one, {free_at({1.5, 0, 0}), {{0.5, 0, 0}, {1, 0.1, 0}}}, {.unbalanced = 1});
        expect(one, {free_at({1.5, 0, 0}), {{0.5, 0, 0}, {1, 0.005, 0}}}, {});
        // In the air, and off the edge that the proxy slides over.
        expect(one, {free_at({1.5, 0, 0}), {{0.5, 0, 0}, {1.1, 0, 0}}}, {.unbalanced = 1});
        expect(one, {free_at({1.5, 0, 0}), {{0.5, 0.9, 0.1}, {1, 1, 0}}}, {.unbalanced = 1});
    }
}

TEST_F(ContactReferee, SeesAForceWhereNothingIsInBetween) {
    for (const PolygonSoup& polygons : {shapes::cube(), shapes::open_cube()}) {
        const PreparedCase one = prepared(polygons);
        // From the open into the open; and over an edge into the open, where the facets bear no such force.
        const bool closed = polygons.facets() == 6; // so that the proxy is seen to pull from within
        expect(one, {free_at({1.5, 0, 0}), {{1.5, 0.5, 0}, {1, 0.5, 0}}}, {.phantoms = 1, .other = closed ? 1u : 0u});
        expect(one, {free_at({0.5, 1.5, 0}), {{1.5, 0.5, 0}, {1, 1, 0}}}, {.phantoms = 1});
    }
}

// The force at the tip of a cone of many facets: along their normals, or off them all.
TEST_F(ContactReferee, SeesAForceOffTheFacetsOfAPole) {
    for (const unsigned facets : {20U, 400U}) {
        const PreparedCase one = prepared(shapes::needle_fan(facets, 0.5));
        const Row above = free_at({0, 0, 1}), tip{{0.05, 0, 0.3}, {0, 0, 0.5}};
        expect(one, {above, tip, {{0.08, 0.02, 0.3}, {0, 0, 0.5}}}, {});
        expect(one, {above, tip, {{0.15, 0.02, 0.3}, {0, 0, 0.5}}}, {.unbalanced = 1});
    }
}

// Where many facets are around the last proxy: on a plane of hundreds, at a pole, and in a pit of a solid.
TEST_F(ContactReferee, SeesGrowthAmongManyFacets) {
    PolygonSoup fine = shapes::cube(true);
    for (int i = 0; i < 3; ++i)
        fine = shapes::subdivided(fine);
    expect(prepared(fine), {free_at({1.5, 0, 0}), {{0.5, 0, 0}, {1, 0, 0}}, {{0.5, 0, 0}, {1, 0.9, 0}}},
           {.grew = 1, .unbalanced = 1});
    const Row tip{{0, 0, 0.3}, {0, 0, 0.5}};
    expect(prepared(shapes::needle_fan(400, 0.5)), {free_at({0, 0, 1}), tip, {{0, 0, 0.3}, {0, 0, 0}}}, {.grew = 1});
    EXPECT_DOUBLE_EQ(distance_of_offset_planes(std::vector<glm::dvec3>(100, {0, 0.6, 0.8})), 1);
    EXPECT_TRUE(std::isinf(distance_of_offset_planes(std::vector<glm::dvec3>{{0, 0, 1}, {0, 0, -1}})));
}

// In time linear in their number: what trying all triples gives.
TEST(Cones, AreAsFarWhicheverWay) {
    std::mt19937_64 random(5);
    const auto direction = [&] {
        std::normal_distribution<double> one;
        const glm::dvec3 v(one(random), one(random), one(random));
        return v / norm(v);
    };
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 axis = direction(), force = 3.0 * direction();
        const double width = std::pow(10.0, -(i % 7) / 2.0);
        std::vector<glm::dvec3> normals;
        for (int k = 0; k < 1 + i % 30; ++k) {
            const glm::dvec3 v = axis + width * direction();
            normals.push_back(v / norm(v));
        }
        const double all = distance_from_cone(force, normals, [](std::size_t, std::size_t) { return true; });
        EXPECT_NEAR(distance_from_cone(force, normals), all, 1e-9 / width) << i;
        // The nearest place in front of all planes is the nearest on one, two or three of them that is.
        double least = std::numeric_limits<double>::infinity();
        const auto try_place = [&](const glm::dvec3& x) {
            if (norm(x) < least &&
                std::ranges::all_of(normals, [&](const glm::dvec3& n) { return glm::dot(n, x) > 1 - 1e-9; }))
                least = norm(x);
        };
        for (const glm::dvec3& u : normals)
            for (const glm::dvec3& v : normals)
                for (const glm::dvec3& w : normals) {
                    const glm::dvec3 corner = glm::cross(u, v) + glm::cross(v, w) + glm::cross(w, u);
                    try_place(u == v ? u : v == w ? (u + v) / (1 + glm::dot(u, v)) : corner / glm::dot(corner, u));
                }
        const double found = distance_of_offset_planes(normals);
        EXPECT_TRUE(found == least || std::abs(found / least - 1) < 1e-6) << found << " " << least;
    }
}

// In single precision it is thinner than the skin.
TEST_F(ContactReferee, SeesAProxyAtTheFarEndOfAThinWedge) {
    const PreparedCase one = prepared(shapes::sharp_wedge(0.001));
    const glm::dvec3 end(1.0000133813354597, 1.0000072313490214, -1.4504776647443512e-05);
    const std::vector<Row> right{free_at({0.9033547430225982, 1.0863647407898338, 0.05290819690751334}),
                                 free_at({0.9999999999999994, 0.9999999999999994, -8.726646259605142e-06}),
                                 free_at(end)};
    expect(one, right, {});
    std::vector<Row> wrong = right;
    wrong[2] = {end, {0, 1.0000072313490214, 0}, 0};
    for (const ContactCount& count : {count_of<float>(one, wrong), count_of<double>(one, wrong)}) {
        EXPECT_EQ(count.grew, 1u);
        EXPECT_TRUE(says(count.first, "path 0, step 2"));
    }
}

TEST_F(ContactReferee, FillsColumnsOfTheTableOfValidate) {
    const PreparedCase one = prepared(shapes::icosphere(2), "[paths]\ncount = 20\nsteps = 300\ndepth = \"300 mm\"\n");
    EngineOptions options;
    options.cpu = true;
    const auto engine = make_engine(options);
    PathComparison comparison = compare_paths(*engine, one, Precision::f32);
    EXPECT_TRUE(comparison.passed);
    EXPECT_EQ(comparison.contacts.samples, 6000u);
    EXPECT_GT(comparison.contacts.brute, 1000u);
    EXPECT_LT(comparison.contacts.near, 1000u);
    EXPECT_EQ(comparison.contacts.wrong(), 0u);
    EXPECT_TRUE(says(path_comparison_table({comparison}), "judged at 6000 samples"));
    EXPECT_TRUE(says(path_comparison_json({comparison}), "\"on_other_side\": 0", "\"phantoms\": 0"));
}

// The sign of tiny volumes, and of lines that graze an edge.
TEST(ContactSurface, TellsWhatALineMeetsOrThatItCannot) {
    const std::array<glm::dvec3, 3> triangle{glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
    EXPECT_EQ(segment_meets({0.2, 0.2, 1}, {0.2, 0.2, -1}, triangle), Meets::yes);
    EXPECT_EQ(segment_meets({0.2, 0.2, 1}, {0.2, 0.2, 1e-300}, triangle), Meets::unsure);
    EXPECT_EQ(segment_meets({0.2, 0.2, 1}, {0.2, 0.2, 1e-15}, triangle), Meets::no);
    EXPECT_EQ(segment_meets({0.2, 0.2, 1}, {0.9, 0.9, -1}, triangle), Meets::no);
    EXPECT_EQ(segment_meets({0.5, 0, 1}, {0.5, 0, -1}, triangle), Meets::unsure);
    EXPECT_EQ(segment_meets({0.5, -1e-15, 1}, {0.5, -1e-15, -1}, triangle), Meets::no);
    EXPECT_EQ(volume_sign({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}), 1);
    EXPECT_EQ(volume_sign({1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0}), 0);
}

} // namespace
} // namespace forceshade::testing
