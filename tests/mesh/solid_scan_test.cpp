// Plans by scan conversion against the tree at every sample, and their fields against those of the other planner.
#include <cmath>
#include <random>

#include "host/mesh/solid_scan.h"
#include "host/reference/field.h"
#include "tests/mesh/planned.h"

namespace forceshade {
namespace {

using shapes::Samples;
using shapes::samples;
using shapes::tables_of;

struct Counts : shapes::PlanCounts {
    std::size_t grids = 0, scanned = 0;
};

template <typename T> auto scan_of(const MeshTables<T>& tables, const Samples<T>& grid, unsigned threads) {
    const auto& [x, y, z] = grid.axes;
    return SolidScan<T>::make(tables.view(), x, y, z, layout::kInsidePseudonormal, threads);
}

// Whether a scan serves on these samples; and if so, that it lists what is inside, and there what is nearest.
template <typename T> bool hold(const MeshTables<T>& tables, const Samples<T>& grid, Counts& counts) {
    const auto scan = scan_of(tables, grid, 2);
    ++counts.grids;
    if (!scan)
        return false;
    ++counts.scanned;
    const auto more = hold_plan(tables.view(), grid, layout::kInsidePseudonormal, scan->plan(0, grid.axes[2].size()),
                                kMostCandidates);
    counts.samples += more.samples, counts.inside += more.inside, counts.wanted += more.wanted;
    counts.candidates += more.candidates, counts.blocks += more.blocks;
    return true;
}

// The grid of a scene fits about the mesh; others cut it, or are coarser along some axes.
template <typename T> std::vector<Samples<T>> grids(std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto place = [&] { return shapes::anywhere(random, 0.6); };
    const glm::dvec3 centre = place() / 4.0, corner = place();
    return {
        samples<T>({24, 25, 26}, glm::dvec3(-1.05), glm::dvec3(1.05)),
        samples<T>({21, 21, 21}, glm::dvec3(-1.25), glm::dvec3(1.25)), // planes through 0, and through simple places
        samples<T>({17, 33, 9}, glm::dvec3(-1), glm::dvec3(1)),
        samples<T>({40, 12, 7}, centre - glm::dvec3(0.9, 1.3, 1.01), centre + glm::dvec3(1.2, 0.9, 1.4)),
        samples<T>({16, 15, 14}, corner - glm::dvec3(0.3), corner + glm::dvec3(0.3)),
        samples<T>({1, 30, 31}, corner - glm::dvec3(0, 1, 1), corner + glm::dvec3(0, 1, 1))};
}

template <typename T> void hold_on_all(const PolygonSoup& polygons, std::uint32_t seed, Counts& counts) {
    const MeshTables<T> tables = tables_of<T>(polygons);
    for (const Samples<T>& grid : grids<T>(seed))
        hold(tables, grid, counts);
}

// A sphere with bumps, dents and spikes of some size.
PolygonSoup random_solid(std::uint32_t seed) {
    std::mt19937 random(seed);
    PolygonSoup solid = shapes::icosphere(static_cast<unsigned>(random() % 5));
    const double roughness = 0.3 * std::pow(shapes::uniform(random), 2), waves = 0.25 * shapes::uniform(random);
    const glm::dvec3 turns = shapes::anywhere(random, 6),
                     scale(1 + 0.9 * shapes::uniform(random), 1, 1 + 0.9 * shapes::uniform(random));
    for (glm::dvec3& v : solid.vertices)
        v = v * scale *
            (1 + roughness * shapes::uniform(random) +
             waves * std::sin(turns.x * v.x) * std::cos(turns.y * v.y) * std::sin(turns.z * v.z + 1));
    return solid;
}

// A block with a slit of some width, from its middle to its top.
PolygonSoup slit_block(double width, double lean) {
    const double corners[8][2] = {
        {-1, -1}, {1, -1}, {1, 1}, {width / 2 + lean, 1}, {width / 2, 0}, {-width / 2, 0}, {-width / 2 + lean, 1},
        {-1, 1}};
    PolygonSoup block;
    for (const double y : {-0.9, 0.8})
        for (const auto& corner : corners)
            block.vertices.push_back({corner[0], y, corner[1]});
    shapes::add_facet(block, {0, 1, 2, 3, 4, 5, 6, 7});
    shapes::add_facet(block, {15, 14, 13, 12, 11, 10, 9, 8});
    for (std::uint32_t i = 0; i < 8; ++i) {
        const std::uint32_t next = (i + 1) % 8;
        shapes::add_facet(block, {i, i + 8, next + 8, next});
    }
    return block;
}

void report(const char* what, const Counts& counts) {
    std::printf("%s: %zu of %zu grids scanned, %zu samples, %zu inside, %zu wanted, %.2f candidates a block\n", what,
                counts.scanned, counts.grids, counts.samples, counts.inside, counts.wanted,
                static_cast<double>(counts.candidates) / static_cast<double>(counts.blocks));
}

TEST(SolidScan, ListsWhatIsInsideAndNearestOfRandomSolids) {
    Counts counts;
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        const PolygonSoup solid = random_solid(seed);
        hold_on_all<float>(solid, seed, counts);
        hold_on_all<double>(solid, seed, counts);
        ASSERT_FALSE(HasFailure()) << seed;
    }
    report("random", counts);
    EXPECT_GT(counts.scanned, counts.grids / 2);
}

TEST(SolidScan, ListsWhatIsNearestAboutSlits) {
    Counts counts;
    for (const double width : {0.1, 1e-3, 1e-4, 1e-5, 1e-6, 3e-7, 1e-7, 1e-9})
        for (const double lean : {0.0, 0.3, 1e-2}) {
            hold_on_all<float>(slit_block(width, lean), 3, counts);
            hold_on_all<double>(slit_block(width, lean), 3, counts);
            EXPECT_FALSE(HasFailure()) << width << ' ' << lean;
        }
    report("slits", counts);
}

// Where more are as near as a list takes, the tree says which comes first.
TEST(SolidScan, ListsWhatComesFirstOfVeryMany) {
    for (const auto& grid : {samples<float>({9, 9, 9}, glm::dvec3(-0.5), glm::dvec3(0.5)),
                             samples<float>({10, 8, 4}, glm::dvec3(-0.7), glm::dvec3(0.7))}) {
        Counts counts;
        EXPECT_TRUE(hold(tables_of<float>(shapes::double_cone(700, 1)), grid, counts));
    }
}

TEST(SolidScan, ListsWhatIsInsideAndNearestOfShapes) {
    Counts counts;
    int number = 0;
    for (const PolygonSoup& polygons :
         {shapes::cube(true), shapes::cube(), shapes::notched_block(), shapes::plate(0.1), shapes::plate(1e-3),
          shapes::plate(1e-5), shapes::plate(1e-7), shapes::needle_fan(5, 3), shapes::needle_fan(100, 0.3),
          shapes::needle_fan(12, 100), shapes::sliver_box(20, 10), shapes::sliver_box(20, 1e6),
          shapes::many_gon_prism(50), shapes::spot(), shapes::icosphere(0), shapes::icosphere(4),
          shapes::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
          shapes::moved(shapes::icosphere(3), {1, 1e-2, 1}, {5, 0, 0}),
          shapes::moved(shapes::icosphere(3), {1, 1e-4, 1e-2}, {0, 0, 0})}) {
        hold_on_all<float>(polygons, 7, counts);
        hold_on_all<double>(polygons, 7, counts);
        EXPECT_FALSE(HasFailure()) << "shape " << number;
        ++number;
    }
    report("shapes", counts);
}

// All that a field has, row by row.
template <typename T> struct Rows {
    std::vector<T> force, depth, proxy;
    std::vector<layout::uint> facet;

    friend bool operator==(const Rows&, const Rows&) = default;
};

template <typename T>
Rows<T> field_of(const MeshTables<T>& tables, const Samples<T>& grid, unsigned threads, FreeSpace free,
                 std::size_t chunk_bytes) {
    layout::FieldInput<T> input;
    input.law.mesh = tables.view();
    input.law.features.surface = layout::kSurfaceMesh;
    input.law.features.channels =
        layout::kChannelForce | layout::kChannelDepth | layout::kChannelProxy | layout::kChannelFacet;
    input.x = grid.axes[0];
    input.y = grid.axes[1];
    input.z = grid.axes[2];
    const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, layout::kInsidePseudonormal, threads,
                                  free);
    const auto scan = free == FreeSpace::skipped ? scan_of(tables, grid, threads) : nullptr;
    BlockPlan plan;
    Rows<T> rows;
    const auto append = [](auto& to, const auto& values) { to.insert(to.end(), values.begin(), values.end()); };
    reference::evaluate_mesh_field<T>(
        input, {threads, chunk_bytes},
        [&](std::size_t first, std::size_t count) {
            plan = scan ? scan->plan(first, count) : planner.plan(first, count);
            return plan.view();
        },
        [&](const layout::FieldChunk<T>& chunk) {
            append(rows.force, chunk.force.first(3 * chunk.x_count * chunk.y_count * chunk.z_count));
            append(rows.depth, chunk.depth.first(chunk.x_count * chunk.y_count * chunk.z_count));
            append(rows.proxy, chunk.proxy.first(3 * chunk.x_count * chunk.y_count * chunk.z_count));
            append(rows.facet, chunk.facet.first(chunk.x_count * chunk.y_count * chunk.z_count));
        });
    return rows;
}

template <typename T> void hold_fields(const PolygonSoup& polygons) {
    const MeshTables<T> tables = tables_of<T>(polygons);
    const Samples<T> grid = samples<T>({37, 41, 46}, glm::dvec3(-1.04), glm::dvec3(1.04));
    const Rows<T> expected = field_of(tables, grid, 2, FreeSpace::visited, std::size_t(1) << 25);
    EXPECT_TRUE(std::ranges::any_of(expected.depth, [](T depth) { return depth > 0; }));
    for (const std::size_t bytes : {std::size_t(1) << 25, std::size_t(1) << 16, std::size_t(1) << 10})
        EXPECT_TRUE(field_of(tables, grid, 1, FreeSpace::skipped, bytes) == expected) << bytes;
    EXPECT_TRUE(field_of(tables, grid, 5, FreeSpace::skipped, std::size_t(1) << 25) == expected);
}

TEST(SolidScan, GivesTheFieldOfTheOtherPlanner) {
    for (const PolygonSoup& polygons : {shapes::spot(), shapes::notched_block(), random_solid(18), random_solid(49)}) {
        hold_fields<float>(polygons);
        hold_fields<double>(polygons);
    }
    // Of which no scan is made.
    hold_fields<float>(shapes::nested_shells(2, true));
    hold_fields<float>(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), {1, 1, 1}, {3, 0, 0})));
    hold_fields<float>(shapes::random_polyhedra(25, 11));
    hold_fields<float>(shapes::open_cube());
}

// Beams come to slabs from all sides.
bool hold_in_parts(const PolygonSoup& polygons) {
    const MeshTables<float> tables = tables_of<float>(polygons);
    const Samples<float> grid = samples<float>({50, 52, 70}, glm::dvec3(-1.04), glm::dvec3(1.04));
    const auto scan = [&](unsigned threads) { return scan_of(tables, grid, threads); };
    const auto same = [](const layout::MeshBlock& p, const layout::MeshBlock& q) {
        return p.x == q.x && p.y == q.y && p.z == q.z && p.count == q.count;
    };
    const auto whole = scan(1);
    if (!whole)
        return false;
    const BlockPlan one = whole->plan(0, 70);
    BlockPlan slabs;
    for (const unsigned threads : {2u, 5u, 8u}) {
        const BlockPlan many = scan(threads)->plan(0, 70);
        EXPECT_TRUE(std::ranges::equal(one.blocks, many.blocks, same));
        EXPECT_EQ(one.candidates, many.candidates);
        EXPECT_EQ(one.wanted, many.wanted);
    }
    for (std::size_t first = 0; first < 70; first += 6) {
        const BlockPlan part = scan(3)->plan(first, std::min<std::size_t>(6, 70 - first));
        slabs.blocks.insert(slabs.blocks.end(), part.blocks.begin(), part.blocks.end());
        slabs.candidates.insert(slabs.candidates.end(), part.candidates.begin(), part.candidates.end());
        slabs.wanted.insert(slabs.wanted.end(), part.wanted.begin(), part.wanted.end());
    }
    EXPECT_TRUE(std::ranges::equal(one.blocks, slabs.blocks, same));
    EXPECT_EQ(one.candidates, slabs.candidates);
    EXPECT_EQ(one.wanted, slabs.wanted);
    return true;
}

TEST(SolidScan, DoesNotDependOnThreadsNorOnSlabs) {
    EXPECT_TRUE(hold_in_parts(random_solid(18)));
    EXPECT_TRUE(hold_in_parts(shapes::icosphere(4))); // with many ties
    EXPECT_TRUE(hold_in_parts(shapes::cube(true)));
    EXPECT_TRUE(hold_in_parts(shapes::notched_block()));
    std::size_t held = 0;
    for (std::uint32_t seed = 50; seed < 58; ++seed)
        held += hold_in_parts(random_solid(seed)) ? 1 : 0;
    EXPECT_GE(held, 6u);
}

TEST(SolidScan, ServesSolidsThatKeepApartOnEvenGrids) {
    const auto serves = [](const PolygonSoup& polygons, auto change) {
        Samples<float> grid = samples<float>({20, 20, 20}, glm::dvec3(-1), glm::dvec3(1));
        change(grid);
        return scan_of(tables_of<float>(polygons), grid, 1) != nullptr;
    };
    const auto as_it_is = [](Samples<float>&) {};
    EXPECT_TRUE(serves(shapes::icosphere(2), as_it_is));
    EXPECT_TRUE(serves(shapes::spot(), as_it_is));
    EXPECT_TRUE(serves(shapes::notched_block(), as_it_is));
    EXPECT_TRUE(serves(slit_block(1e-3, 0.3), as_it_is));
    EXPECT_FALSE(serves(slit_block(1e-5, 0.3), as_it_is));
    EXPECT_FALSE(serves(slit_block(0, 0), as_it_is));
    EXPECT_FALSE(serves(shapes::plate(1e-5), as_it_is));
    EXPECT_FALSE(serves(shapes::reversed(shapes::icosphere(2)), as_it_is));
    EXPECT_FALSE(serves(shapes::open_cube(), as_it_is));
    EXPECT_FALSE(serves(shapes::nested_shells(1, true), as_it_is));
    EXPECT_FALSE(serves(shapes::random_polyhedra(25, 11), as_it_is));
    EXPECT_FALSE(serves(shapes::icosphere(2), [](Samples<float>& grid) { grid.axes[1][7] += 1e-3f; }));
    EXPECT_FALSE(serves(shapes::icosphere(2), [](Samples<float>& grid) {
        for (float& x : grid.axes[0])
            x *= 1e-4f;
    }));
    EXPECT_FALSE(serves(shapes::icosphere(2), [](Samples<float>& grid) {
        grid = samples<float>({9, 9, 9}, glm::dvec3(-1e4), glm::dvec3(1e4));
    }));
    // Cells of sixteen layers that take 0.5 GB, and more.
    const auto widened_to = [](std::size_t side) {
        return [side](Samples<float>& grid) { grid = samples<float>({side, side, 2}, glm::dvec3(-1), glm::dvec3(1)); };
    };
    EXPECT_TRUE(serves(shapes::icosphere(2), widened_to(2000)));
    EXPECT_FALSE(serves(shapes::icosphere(2), widened_to(2100)));
}

} // namespace
} // namespace forceshade
