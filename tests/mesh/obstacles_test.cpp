// What a god-object may meet on its way over a triangle: with the lists and without, every update is the same bit for
// bit.
#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"

namespace forceshade {
namespace {

using walks::same_bits;

/// Walks with and without lists. `contacts` grows by the updates in contact.
template <typename T, typename Walker>
void expect_same(const walks::Terrain& terrain, unsigned length, unsigned steps, std::uint64_t& contacts) {
    walks::Run<T> without(terrain.polygons), with(terrain.polygons);
    find_obstacles(with.tables);
    with.mesh = with.tables.view();
    ASSERT_EQ(with.mesh.obstacle_begins.size(), with.structure.triangles() + 1);
    Walker walker = [&] {
        if constexpr (std::is_same_v<Walker, walks::Wanderer>)
            return walks::Wanderer(with.structure, 3, terrain.focus);
        else
            return walks::Aimer(with.structure, 3);
    }();
    const auto follow = [](walks::Run<T>& run, const glm::vec<3, T>& probe) {
        return reference::update(run.mesh, run.state, *run.around, probe);
    };
    glm::dvec3 at(0);
    for (unsigned i = 0; i < steps; ++i) {
        at = i % length == 0 ? walker.begin() : walker.step(at);
        if (i % length == 0)
            without.state = with.state = {};
        const glm::vec<3, T> probe(at);
        const auto one = follow(without, probe), other = follow(with, probe);
        ASSERT_TRUE(same_bits(one.proxy, other.proxy) && same_bits(without.state.proxy, with.state.proxy))
            << terrain.name << ", step " << i;
        ASSERT_TRUE(one.substeps == other.substeps && one.count == other.count &&
                    without.state.count == with.state.count && without.state.cornered == with.state.cornered)
            << terrain.name << ", step " << i;
        for (layout::uint j = 0; j < one.count; ++j)
            ASSERT_EQ(one.triangles[j], other.triangles[j]) << terrain.name << ", step " << i;
        contacts += one.touching;
    }
}

template <typename T> void expect_same_everywhere(unsigned steps) {
    std::vector<walks::Terrain> all = walks::terrains();
    for (auto more : {walks::pits(), walks::solids(), walks::meshes({})})
        all.insert(all.end(), more.begin(), more.end());
    for (unsigned seed = 1; seed <= 10; ++seed)
        all.push_back({"soup", walks::soup(seed)});
    std::uint64_t contacts = 0;
    for (const walks::Terrain& terrain : all) {
        expect_same<T, walks::Wanderer>(terrain, 200, steps, contacts);
        expect_same<T, walks::Aimer>(terrain, walks::Aimer::kSteps, steps, contacts);
    }
    EXPECT_GT(contacts, steps * all.size() / 4);
}

TEST(Obstacles, ListsChangeNothing) {
    expect_same_everywhere<double>(600);
    expect_same_everywhere<float>(600);
}

TEST(Obstacles, NothingStandsOnAConvexSurface) {
    MeshTables<double> tables = make_mesh_tables<double>(build_structure(shapes::mesh_of(shapes::icosphere(3))), 1.0);
    find_obstacles(tables);
    EXPECT_TRUE(tables.obstacles->triangles.empty());
}

TEST(Obstacles, AValleyIsKnownFromBothSides) {
    const PolygonSoup valley = shapes::soup_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 1}, {-1, 0, 1}}, {{0, 2, 1}, {0, 1, 3}});
    MeshTables<float> tables = make_mesh_tables<float>(build_structure(shapes::mesh_of(valley)), 1.0);
    find_obstacles(tables);
    EXPECT_EQ(tables.obstacles->triangles, (std::vector<layout::uint>{1, 0}));
}

} // namespace
} // namespace forceshade
