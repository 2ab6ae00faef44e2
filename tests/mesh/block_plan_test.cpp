// The planner against loops over all triangles: what is inside is listed, and so is what is nearest to it.
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/block_plan.h"
#include "host/mesh/findings.h"
#include "host/mesh/solid_scan.h"
#include "host/mesh/structure.h"
#include "host/reference/mesh_contact.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using reference::Vector;

template <typename T> std::vector<T> axis(std::size_t samples, double from, double to) {
    std::vector<T> result;
    for (std::size_t i = 0; i < samples; ++i)
        result.push_back(
            static_cast<T>(from + (to - from) * static_cast<double>(i) / static_cast<double>(samples - 1)));
    return result;
}

template <typename T> struct Grid { std::vector<T> x, y, z; };

// Every triangle as near as the nearest is a candidate: whichever of them a kernel prefers is there.
template <typename T>
bool lists_all_nearest(const layout::MeshView<T>& mesh, std::span<const layout::uint> candidates,
                       const Vector<T>& probe) {
    const T least = reference::nearest(mesh, probe).square;
    for (layout::uint t = 0; t < mesh.params.triangles; ++t)
        if (reference::nearest_on_triangle(probe, reference::triangle_at(mesh, t)).square == least &&
            std::find(candidates.begin(), candidates.end(), t) == candidates.end())
            return false;
    return true;
}

template <typename T>
void hold(const layout::MeshView<T>& mesh, const Grid<T>& grid, layout::uint inside, FreeSpace free,
          const BlockPlan& plan) {
    std::map<std::array<std::size_t, 3>, std::size_t> blocks;
    for (std::size_t b = 0; b < plan.blocks.size(); ++b) {
        const layout::MeshBlock& block = plan.blocks[b];
        EXPECT_TRUE(blocks.try_emplace({block.x, block.y, block.z}, b).second);
        EXPECT_GT(block.count, 0u);
        EXPECT_LE(block.count, kMostCandidates);
        EXPECT_TRUE(b == 0 || plan.blocks[b - 1].z <= block.z);
    }
    std::uint64_t evaluated = 0;
    for (std::size_t z = 0; z < grid.z.size(); ++z)
        for (std::size_t y = 0; y < grid.y.size(); ++y)
            for (std::size_t x = 0; x < grid.x.size(); ++x) {
                const Vector<T> probe{grid.x[x], grid.y[y], grid.z[z]};
                const bool is_inside = inside == layout::kInsideWinding
                                           ? reference::inside_by_winding(mesh, probe)
                                           : reference::inside_by_pseudonormal(mesh, reference::nearest(mesh, probe));
                const auto at = blocks.find({x / 2 * 2, y / 2 * 2, z / 2 * 2});
                if (at == blocks.end()) {
                    ASSERT_FALSE(is_inside) << x << ' ' << y << ' ' << z;
                    continue;
                }
                const std::size_t bit = (z % 2 * 2 + y % 2) * 2 + x % 2;
                if (!plan.wanted.empty() && (plan.wanted[at->second] >> bit & 1u) == 0) {
                    ASSERT_FALSE(is_inside) << x << ' ' << y << ' ' << z;
                    continue;
                }
                ++evaluated;
                const layout::MeshBlock& block = plan.blocks[at->second];
                if (inside == layout::kInsideWinding) {
                    ASSERT_EQ(plan.inside[at->second] >> bit & 1u, is_inside ? 1u : 0u);
                }
                // By the planner's own choice of the nearest, one of equals is enough.
                const std::span<const layout::uint> candidates(&plan.candidates[block.first], block.count);
                const layout::uint nearest = reference::nearest(mesh, probe).triangle;
                ASSERT_NE(std::find(candidates.begin(), candidates.end(), nearest), candidates.end());
                if (block.count > 8) {
                    ASSERT_TRUE(lists_all_nearest(mesh, candidates, probe)) << x << ' ' << y << ' ' << z;
                }
            }
    EXPECT_EQ(evaluated, plan.voxels_evaluated);
    if (free == FreeSpace::visited) {
        EXPECT_EQ(evaluated, grid.x.size() * grid.y.size() * grid.z.size());
    }
}

// As planned, and by scan conversion where that serves.
template <typename T>
void hold(const PolygonSoup& polygons, const Grid<T>& grid, layout::uint inside = layout::kInsidePseudonormal,
          FreeSpace free = FreeSpace::skipped) {
    StructureOptions options;
    options.winding = true;
    MeshStructure structure = build_structure(shapes::mesh_of(polygons), options);
    if (is_solid(inspect(polygons)))
        assume_solid(structure);
    const MeshTables<T> tables = make_mesh_tables<T>(structure, 1000);
    const layout::MeshView<T> mesh = tables.view();
    const auto& [x, y, z] = grid;
    hold(mesh, grid, inside, free, plan_blocks<T>(mesh, x, y, z, inside, 0, free));
    const auto scan = free == FreeSpace::skipped ? SolidScan<T>::make(mesh, x, y, z, inside, 0) : nullptr;
    if (scan)
        hold(mesh, grid, inside, free, scan->plan(0, z.size()));
}

template <typename T> Grid<T> cubic(std::size_t side, double reach) {
    return {axis<T>(side, -reach, reach), axis<T>(side + 1, -reach, reach), axis<T>(side + 2, -reach, reach)};
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
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::icosphere(3)));
    const MeshTables<float> tables = make_mesh_tables<float>(structure, 1000);
    const Grid<float> grid = cubic<float>(64, 1.2);
    const BlockPlan plan = plan_blocks<float>(tables.view(), grid.x, grid.y, grid.z, layout::kInsidePseudonormal);
    const double share = static_cast<double>(plan.voxels_evaluated) / (64. * 65 * 66);
    const double sphere = 4.18879 / (2.4 * 2.4 * 2.4);
    EXPECT_GT(share, 0.98 * sphere);
    EXPECT_LT(share, 1.25 * sphere);
}

// Far from a coarse mesh many triangles are nearly as near as the nearest, and planes alone tell little.
TEST(BlockPlan, SkipsWhatIsFarOutsideOfASolid) {
    const PolygonSoup cube = shapes::cube(true);
    const Grid<float> grid = cubic<float>(64, 4);
    const auto evaluated = [&](bool solid) {
        MeshStructure structure = build_structure(shapes::mesh_of(cube));
        if (solid)
            assume_solid(structure);
        const MeshTables<float> tables = make_mesh_tables<float>(structure, 1000);
        return plan_blocks<float>(tables.view(), grid.x, grid.y, grid.z, layout::kInsidePseudonormal).voxels_evaluated;
    };
    EXPECT_LT(evaluated(true), 24u * 24 * 24);
    EXPECT_GT(evaluated(false), 3 * evaluated(true));
    hold<float>(cube, cubic<float>(31, 4));
    hold<double>(shapes::icosphere(1), cubic<double>(31, 4));
}

// What a scan plans says which voxels are wanted.
template <typename T>
bool is_scanned(const PolygonSoup& polygons, std::size_t side, Evaluator evaluator = Evaluator::processor) {
    MeshStructure structure = build_structure(shapes::mesh_of(polygons));
    if (is_solid(inspect(polygons)))
        assume_solid(structure);
    const MeshTables<T> tables = make_mesh_tables<T>(structure, 1000);
    const Grid<T> grid = cubic<T>(side, 1.1);
    const BlockPlanner<T> planner(tables.view(), grid.x, grid.y, grid.z, layout::kInsidePseudonormal, 0,
                                  FreeSpace::skipped, evaluator);
    return !planner.plan(0, grid.z.size()).wanted.empty();
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
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::random_polyhedra(50, 3)));
    const MeshTables<float> tables = make_mesh_tables<float>(structure, 1000);
    const Grid<float> grid = cubic<float>(70, 1.1);
    const auto planner = [&](unsigned threads) {
        return BlockPlanner<float>(tables.view(), grid.x, grid.y, grid.z, layout::kInsidePseudonormal, threads);
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
