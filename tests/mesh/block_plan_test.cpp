// The planner against loops over all triangles: what is inside is listed, and so is what is nearest to it.
#include <cmath>
#include <random>

#include "host/mesh/solid_scan.h"
#include "tests/mesh/planned.h"

namespace forceshade {
namespace {

using shapes::hold_plan;
using shapes::Samples;

template <typename T> Samples<T> cubic(std::size_t side, double reach) {
    return shapes::samples<T>({side, side + 1, side + 2}, glm::dvec3(-reach), glm::dvec3(reach));
}

// As planned, and by scan conversion where that serves.
template <typename T>
void hold(const PolygonSoup& polygons, const Samples<T>& grid, layout::uint inside = layout::kInsidePseudonormal,
          FreeSpace free = FreeSpace::skipped) {
    const MeshTables<T> tables = shapes::tables_of<T>(polygons, true);
    const layout::MeshView<T> mesh = tables.view();
    const auto& [x, y, z] = grid.axes;
    const auto counts = hold_plan(mesh, grid, inside, plan_blocks<T>(mesh, x, y, z, inside, 0, free));
    EXPECT_TRUE(free == FreeSpace::skipped || counts.wanted == counts.samples);
    const auto scan = free == FreeSpace::skipped ? SolidScan<T>::make(mesh, x, y, z, inside, 0) : nullptr;
    if (scan)
        hold_plan(mesh, grid, inside, scan->plan(0, z.size()));
}

TEST(BlockPlan, ListsWhatIsInsideAndNearest) {
    for (const PolygonSoup& polygons :
         {shapes::icosphere(2), shapes::cube(true), shapes::nested_shells(1, false), shapes::random_polyhedra(25, 11),
          shapes::needle_fan(100, 0.3), shapes::sliver_box(20, 1e6), shapes::single_triangle()})
        for (const layout::uint inside : {layout::kInsidePseudonormal, layout::kInsideWinding}) {
            hold<float>(polygons, cubic<float>(21, 1.1), inside);
            hold<double>(polygons, cubic<double>(21, 1.1), inside);
            hold<float>(polygons, cubic<float>(13, 1.6), inside, FreeSpace::visited);
            hold<double>(polygons, cubic<double>(13, 1.6), inside, FreeSpace::visited);
        }
    for (const double reach : {0.01, 1e-9}) { // about the centre of a sphere
        hold<float>(shapes::icosphere(3), cubic<float>(9, reach));
        hold<double>(shapes::icosphere(3), cubic<double>(9, reach));
    }
}

// Slivers a thousand times as long as wide, all through the middle of a tiny grid: their circles are ill conditioned.
TEST(BlockPlan, ListsWhatIsNearestAmongSlivers) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&](double size) {
        const double x = uniform(random), y = uniform(random), z = uniform(random);
        return size * glm::dvec3(x, y, z);
    };
    const double spread = 1e-3;
    for (const double width : {1e-3, 5e-4, 2e-4})
        for (int repeat = 0; repeat < 15; ++repeat) {
            PolygonSoup slivers;
            for (std::uint32_t i = 0; i < 40; ++i) {
                glm::dvec3 way = vector(1);
                way = way * (1 / std::max({std::abs(way.x), std::abs(way.y), std::abs(way.z)}));
                const glm::dvec3 middle = vector(spread), aside = vector(1);
                const glm::dvec3 half(width * (way.y * aside.z - way.z * aside.y),
                                      width * (way.z * aside.x - way.x * aside.z),
                                      width * (way.x * aside.y - way.y * aside.x));
                slivers.vertices.insert(slivers.vertices.end(),
                                        {middle - way, middle + way + half, middle + way - half});
                slivers.corners.insert(slivers.corners.end(), {3 * i, 3 * i + 1, 3 * i + 2});
                slivers.begins.push_back(3 * (i + 1));
            }
            hold<float>(slivers, cubic<float>(14, spread));
        }
}

// So many triangles to a tile that samples are asked one by one.
TEST(BlockPlan, ListsWhatIsNearestOfFarMoreTrianglesThanSamples) {
    const PolygonSoup sphere = shapes::icosphere(6);
    for (const layout::uint inside : {layout::kInsidePseudonormal, layout::kInsideWinding}) {
        hold<float>(sphere, cubic<float>(19, 1.05), inside);
        hold<double>(sphere, cubic<double>(14, 0.4), inside);
    }
    hold<float>(sphere, cubic<float>(9, 1.3), layout::kInsidePseudonormal, FreeSpace::visited);
}

TEST(BlockPlan, SkipsWhatIsOutside) {
    const MeshTables<float> tables =
        make_mesh_tables<float>(build_structure(shapes::mesh_of(shapes::icosphere(3))), 1000);
    const auto [x, y, z] = cubic<float>(64, 1.2).axes;
    const BlockPlan plan = plan_blocks<float>(tables.view(), x, y, z, layout::kInsidePseudonormal);
    const double share = static_cast<double>(plan.voxels_evaluated) / (64. * 65 * 66);
    const double sphere = 4.18879 / (2.4 * 2.4 * 2.4);
    EXPECT_GT(share, 0.98 * sphere);
    EXPECT_LT(share, 1.25 * sphere);
}

// Far from a coarse mesh many triangles are nearly as near as the nearest, and planes alone tell little.
TEST(BlockPlan, SkipsWhatIsFarOutsideOfASolid) {
    const PolygonSoup cube = shapes::cube(true);
    const auto [x, y, z] = cubic<float>(64, 4).axes;
    const auto evaluated = [&, &x = x, &y = y, &z = z](bool solid) {
        MeshStructure structure = build_structure(shapes::mesh_of(cube));
        if (solid)
            assume_solid(structure);
        const MeshTables<float> tables = make_mesh_tables<float>(structure, 1000);
        return plan_blocks<float>(tables.view(), x, y, z, layout::kInsidePseudonormal).voxels_evaluated;
    };
    EXPECT_LT(evaluated(true), 24u * 24 * 24);
    EXPECT_GT(evaluated(false), 3 * evaluated(true));
    hold<float>(cube, cubic<float>(31, 4));
    hold<double>(shapes::icosphere(1), cubic<double>(31, 4));
}

// What a scan plans says which voxels are wanted.
template <typename T>
bool is_scanned(const PolygonSoup& polygons, std::size_t side, Evaluator evaluator = Evaluator::processor) {
    const MeshTables<T> tables = shapes::tables_of<T>(polygons);
    const auto [x, y, z] = cubic<T>(side, 1.1).axes;
    const BlockPlanner<T> planner(tables.view(), x, y, z, layout::kInsidePseudonormal, 0, FreeSpace::skipped,
                                  evaluator);
    return !planner.plan(0, z.size()).wanted.empty();
}

TEST(BlockPlan, IsByScanConversionWhereThatIsFaster) {
    EXPECT_TRUE(is_scanned<float>(shapes::icosphere(5), 40));
    EXPECT_TRUE(is_scanned<double>(shapes::icosphere(5), 40, Evaluator::hardware));
    // Triangles much larger than voxels.
    EXPECT_FALSE(is_scanned<float>(shapes::icosphere(2), 40));
    EXPECT_FALSE(is_scanned<double>(shapes::icosphere(2), 40, Evaluator::hardware));
    EXPECT_TRUE(is_scanned<double>(shapes::icosphere(2), 40));
    // More triangles than voxels.
    EXPECT_FALSE(is_scanned<double>(shapes::icosphere(5), 21));
    // Rough.
    PolygonSoup rough = shapes::icosphere(5);
    std::mt19937 random(3);
    for (glm::dvec3& vertex : rough.vertices)
        vertex = vertex * (1 + 0.02 * shapes::uniform(random));
    EXPECT_FALSE(is_scanned<float>(rough, 40));
    EXPECT_TRUE(is_scanned<double>(rough, 40));
    EXPECT_FALSE(is_scanned<double>(shapes::nested_shells(1, true), 40));
}

TEST(BlockPlan, KnowsASolid) {
    EXPECT_TRUE(is_solid(inspect(shapes::icosphere(2))));
    EXPECT_TRUE(is_solid(inspect(shapes::cube(true))));
    EXPECT_FALSE(is_solid(inspect(shapes::nested_shells(1, false))));
    EXPECT_FALSE(is_solid(inspect(shapes::single_triangle())));
    EXPECT_FALSE(is_solid(inspect(shapes::random_polyhedra(25, 11))));
    PolygonSoup turned = shapes::icosphere(1);
    std::swap(turned.corners[0], turned.corners[1]);
    EXPECT_FALSE(is_solid(inspect(turned)));
}

TEST(BlockPlan, DoesNotDependOnThreadsNorOnSlabs) {
    const MeshTables<float> tables = shapes::tables_of<float>(shapes::random_polyhedra(50, 3));
    const Samples<float> grid = cubic<float>(70, 1.1);
    const auto planner = [&](unsigned threads) {
        const auto& [x, y, z] = grid.axes;
        return BlockPlanner<float>(tables.view(), x, y, z, layout::kInsidePseudonormal, threads);
    };
    const BlockPlan one = planner(1).plan(0, 72), many = planner(5).plan(0, 72);
    const auto same = [](const layout::MeshBlock& p, const layout::MeshBlock& q) {
        return p.x == q.x && p.y == q.y && p.z == q.z && p.first == q.first && p.count == q.count;
    };
    EXPECT_TRUE(std::ranges::equal(one.blocks, many.blocks, same));
    EXPECT_EQ(one.candidates, many.candidates);
    std::uint64_t evaluated = 0;
    for (std::size_t z = 0; z < 72; z += 6)
        evaluated += planner(2).plan(z, 6).voxels_evaluated;
    const auto whole = static_cast<double>(one.voxels_evaluated);
    EXPECT_NEAR(static_cast<double>(evaluated), whole, 0.02 * whole);
}

} // namespace
} // namespace forceshade
