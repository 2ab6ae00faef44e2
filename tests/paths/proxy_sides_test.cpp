// The referee of sides sees a proxy that came through a closed mesh, whichever way it is written, and no other.
#include "host/referee/proxy_sides.h"

#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/path_run.h"
#include "host/prepare/prepared_case.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"

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

class ProxySides : public ::testing::Test {
protected:
    PreparedCase prepared(const PolygonSoup& polygons, const std::string& more = "") const {
        std::ofstream file(folder_ / "mesh.obj");
        for (const glm::dvec3& v : polygons.vertices)
            file << fmt::format("v {} {} {}\n", v.x, v.y, v.z);
        for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
            file << "f";
            for (std::uint32_t i = polygons.begins[facet]; i < polygons.begins[facet + 1]; ++i)
                file << ' ' << polygons.corners[i] + 1;
            file << "\n";
        }
        file.close();
        return CasePreparation().prepare(
            parse_scene("[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n" + more, "scene", folder_.path()));
    }

    // One path, in windows of two samples.
    template <typename T> static SideCount count_of(const PreparedCase& one, const std::vector<Row>& path) {
        forceshade::ProxySides<T> sides(one, path.size(), false);
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
            sides.check(rows);
        }
        return sides.count();
    }

    static void expect_others(const PreparedCase& one, const std::vector<Row>& path, std::uint64_t others) {
        for (const SideCount& count : {count_of<float>(one, path), count_of<double>(one, path)}) {
            EXPECT_TRUE(count.closed);
            EXPECT_EQ(count.samples, path.size());
            EXPECT_EQ(count.other, others) << count.first;
            EXPECT_EQ(count.first.empty(), others == 0);
        }
    }

    Folder folder_;
};

TEST_F(ProxySides, are_kept_by_an_ordinary_path) {
    const PreparedCase one = prepared(shapes::cube());
    expect_others(one,
                  {free_at({0, 0, 1.5}),
                   {{0, 0, 0.5}, {0, 0, 1}},
                   {{0.5, 0.2, -5}, {0.5, 0.2, 1}}, // out again on the other side, and held all the same
                   {{1.2, 1.2, 0.5}, {1, 1, 1}},    // over an edge and a corner
                   {{0.9, 0.9, 0.5}, {1, 1, 0.5}},
                   free_at({1.1, 0, 0})},
                  0);
}

TEST_F(ProxySides, of_a_proxy_that_fell_through_are_counted) {
    const PreparedCase one = prepared(shapes::cube());
    const std::vector<Row> path{free_at({0, 0, 1.5}),
                                {{0, 0, 0.5}, {0, 0, 1}},
                                free_at({0, 0, 0.4}),
                                free_at({0, 0.3, -0.4}),
                                {{0, 0, -1.5}, {0, 0, -1}}}; // held from within
    expect_others(one, path, 3);
    EXPECT_NE(count_of<double>(one, path).first.find("path 0, step 2"), std::string::npos);
    // From within to the outside: of a cube that is turned inside out, so that its inside is free.
    PolygonSoup room = shapes::cube();
    for (std::size_t facet = 0; facet < room.facets(); ++facet)
        std::reverse(&room.corners[room.begins[facet]], &room.corners[room.begins[facet + 1]]);
    expect_others(prepared(room), {free_at({0, 0, 0}), {{0, 0, 2}, {0, 0, 1}}, free_at({0, 0, 2})}, 1);
}

TEST_F(ProxySides, of_a_path_that_begins_behind_the_surface_are_in_front_of_it) {
    const PreparedCase one = prepared(shapes::cube());
    expect_others(one, {{{0, 0, 0.9}, {0, 0, 1}}, {{0, 0, 0.8}, {0, 0, 1}}, free_at({0, 0, 1.1})}, 0);
    expect_others(one, {free_at({0, 0, 0.9}), free_at({0, 0, 0.8}), free_at({0, 0, 1.1})}, 2);
}

TEST_F(ProxySides, are_told_among_shells_and_solids_that_overlap) {
    const PreparedCase hollow = prepared(shapes::nested_shells(3, true));
    const glm::dvec3 wall = [&] {
        for (double x = 0; x < 1; x += 0.01)
            if (brute::MeshReferee(hollow.images.mesh->mesh, {}).winding_number({x, 0.01, 0.02}) > 0.5)
                return glm::dvec3(x + 0.1, 0.01, 0.02);
        return glm::dvec3(0);
    }();
    expect_others(hollow, {free_at({0, 0, 0}), free_at({0.1, 0, 0})}, 0);
    expect_others(hollow, {free_at({0, 0, 0}), free_at(wall)}, 1);
    expect_others(hollow, {free_at({2, 0, 0}), free_at(wall)}, 1);
    const PreparedCase both = prepared(shapes::nested_shells(3, false));
    expect_others(both, {free_at({2, 0, 0}), free_at(wall)}, 1);
    expect_others(both, {free_at({2, 0, 0}), free_at({0, 0, 0})}, 1);
    // Two cubes that overlap in x = [0.5, 1]: who begins there goes on within the other.
    const PreparedCase two =
        prepared(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {1.5, 0, 0})));
    expect_others(two, {free_at({-2, 0, 0}), {{-0.5, 0, 0}, {-1, 0, 0}}, free_at({0.75, 0, 0})}, 1);
    expect_others(two, {{{0.95, 0, 0}, {1, 0, 0}}, {{0.6, 0, 0}, {1, 0, 0}}, free_at({1.2, 0, 0})}, 0);
    expect_others(two, {{{0.95, 0, 0}, {1, 0, 0}}, free_at({3, 0, 0})}, 1);
}

TEST_F(ProxySides, are_not_guessed_on_the_surface_nor_in_narrow_corners) {
    const PreparedCase one = prepared(shapes::cube());
    const std::vector<Row> grazing{free_at({0, 0, 1.5}), free_at({0, 0, 1 - 1e-13}), {{0, 0, 1 - 1e-13}, {0, 0, 1}}};
    EXPECT_EQ(count_of<double>(one, grazing).near, 2u);
    expect_others(one, grazing, 0);
    // A notch of 20 degrees, pressed hard against its one wall and a little against the other.
    PolygonSoup block;
    const double w = 0.5 * std::tan(0.17453292519943295);
    const std::vector<glm::dvec3> outline{{-1, 0, -1}, {1, 0, -1},   {1, 0, 0.5}, {w, 0, 0.5},
                                          {0, 0, 0},   {-w, 0, 0.5}, {-1, 0, 0.5}};
    const auto corners = static_cast<std::uint32_t>(outline.size());
    for (const double y : {-1.0, 1.0})
        for (const glm::dvec3& at : outline)
            block.vertices.push_back({at.x, y, at.z});
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t next = (i + 1) % corners;
        shapes::add_facet(block, {next, i, corners + i, corners + next});
    }
    shapes::add_facet(block, {0, 1, 2, 3, 4, 5, 6});
    shapes::add_facet(block, {13, 12, 11, 10, 9, 8, 7});
    const PreparedCase notch = prepared(block);
    expect_others(notch, {free_at({0, 0, 1}), {{-0.3, 0, -0.02}, {0, 0, 0}}, {{0.3, 0, -0.02}, {0, 0, 0}}}, 0);
    // An open mesh has no sides.
    const SideCount open = count_of<double>(prepared(shapes::open_cube()), {free_at({0, 0, 2}), free_at({0, 0, 0})});
    EXPECT_FALSE(open.closed);
    EXPECT_EQ(open.samples, 0u);
}

TEST_F(ProxySides, stand_in_the_table_of_validate) {
    const PreparedCase one = prepared(shapes::icosphere(2), "[paths]\ncount = 20\nsteps = 300\ndepth = \"300 mm\"\n");
    EngineOptions options;
    options.cpu = true;
    const auto engine = make_engine(options);
    PathComparison comparison = compare_paths(*engine, one, Precision::f32);
    EXPECT_TRUE(comparison.passed);
    EXPECT_EQ(comparison.sides.samples, 6000u);
    EXPECT_GT(comparison.sides.brute, 1000u);
    EXPECT_LT(comparison.sides.near, 1000u);
    EXPECT_EQ(comparison.sides.other, 0u);
    EXPECT_NE(path_comparison_table({comparison}).find("at 6000 samples"), std::string::npos);
    EXPECT_NE(path_comparison_json({comparison}).find("\"on_other_side\": 0"), std::string::npos);
}

} // namespace
} // namespace forceshade::testing
