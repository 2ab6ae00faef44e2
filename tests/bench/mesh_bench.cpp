// The mesh's own structure: how fast it is built and how large it is, and how many nearest points two threads find a
// second, and one beside a peer.
#include <thread>

#include <benchmark/benchmark.h>

#include "host/mesh/mesh_file.h"
#include "host/mesh/structure.h"
#include "host/random.h"
#include "host/reference/mesh_nearest.h"
#include "tests/bench/cgal_tree.h"
#include "tests/bench/measure.h"
#include "tests/mesh/shapes.h"

namespace forceshade::bench {
namespace {

constexpr unsigned kThreads = 2;
constexpr double kBuildSeconds = 1;     // wanted at most, for a million triangles
constexpr double kBytesATriangle = 200; // likewise
constexpr double kQueries = 0.5e6;      // 1/s, wanted at least

/// A sphere of 1 310 720 triangles.
void build(benchmark::State& state) {
    const Mesh mesh = shapes::mesh_of(shapes::icosphere(8));
    const double millions = double(mesh.triangles.corners.size()) * 1e-6;
    std::vector<double> times;
    std::size_t bytes = 0;
    for (auto _ : state) {
        times.push_back(seconds([&] { bytes = build_structure(mesh, {.threads = kThreads}).bytes(); }));
        state.SetIterationTime(times.back());
    }
    state.counters["s_per_million"] = median(times) / millions;
    state.counters["of_allowed"] = median(times) / millions / kBuildSeconds;
    state.counters["bytes_a_triangle"] = double(bytes) * 1e-6 / millions;
    state.counters["of_allowed_bytes"] = double(bytes) * 1e-6 / millions / kBytesATriangle;
}
BENCHMARK(build)->UseManualTime()->Iterations(5)->Unit(benchmark::kMillisecond);

/// Spot, each triangle cut into four twice: 93 696 triangles.
const MeshStructure& spot() {
    static const MeshStructure structure = [] {
        const PolygonSoup coarse = read_polygons(FORCESHADE_DATA "/spot.obj").polygons;
        return build_structure(shapes::mesh_of(shapes::subdivided(shapes::subdivided(coarse))));
    }();
    return structure;
}

/// Voxels of a grid over the box and 5 % of its longest side, 128 along that side.
struct Grid {
    glm::dvec3 origin;
    double spacing;
    std::array<std::size_t, 3> size;
};

Grid grid_over(const MeshStructure& structure) {
    glm::dvec3 high(0);
    const std::vector<double>& vertices = structure.reals->vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        high[int(i % 3)] = std::max(high[int(i % 3)], vertices[i]);
    const double longest = 2 * std::max({high.x, high.y, high.z}), margin = 0.025 * longest;
    Grid grid{-high - margin, (longest + 2 * margin) / 127, {}};
    for (int axis = 0; axis < 3; ++axis)
        grid.size[std::size_t(axis)] = std::size_t(2 * (high[axis] + margin) / grid.spacing * (1 + 1e-9)) + 1;
    return grid;
}

/// One query a voxel, each beginning with the triangle of the one before. Returns a sum, so that nothing is left out.
template <typename T> double all_nearest(const layout::MeshView<T>& mesh, const Grid& grid) {
    std::array<double, kThreads> sums{};
    std::vector<std::jthread> threads;
    for (unsigned thread = 0; thread < kThreads; ++thread)
        threads.emplace_back([&, thread] {
            layout::uint hint = 0;
            double sum = 0;
            for (std::size_t z = thread; z < grid.size[2]; z += kThreads)
                for (std::size_t y = 0; y < grid.size[1]; ++y)
                    for (std::size_t x = 0; x < grid.size[0]; ++x) {
                        const glm::dvec3 at = grid.origin + grid.spacing * glm::dvec3(double(x), double(y), double(z));
                        const reference::Nearest<T> found = reference::nearest(mesh, reference::Vector<T>(at), hint);
                        hint = found.triangle;
                        sum += double(found.square);
                    }
            sums[thread] = sum;
        });
    threads.clear();
    return sums[0] + sums[1];
}

template <typename T> void nearest(benchmark::State& state) {
    const MeshTables<T> tables = make_mesh_tables<T>(spot(), 1000);
    const Grid grid = grid_over(spot());
    const double voxels = double(grid.size[0]) * double(grid.size[1]) * double(grid.size[2]);
    std::vector<double> times;
    for (auto _ : state) {
        times.push_back(seconds([&] { benchmark::DoNotOptimize(all_nearest(tables.view(), grid)); }));
        state.SetIterationTime(times.back());
    }
    state.counters["triangles"] = double(spot().triangles());
    state.counters["voxels"] = voxels;
    state.counters["queries_per_s"] = voxels / median(times);
    state.counters["of_wanted"] = voxels / median(times) / kQueries;
}
/// One thread beside a peer's tree: along a grid, where each query begins with the last one's triangle and the peer has
/// a hint of its own, and at places anywhere in its box.
template <bool kAnywhere> void nearest_against_cgal(benchmark::State& state) {
    const MeshTables<double> tables = make_mesh_tables<double>(spot(), 1000);
    const layout::MeshView<double> mesh = tables.view();
    const CgalTree peer(mesh.vertices, mesh.triangle_corners);
    const Grid grid = grid_over(spot());
    Random draw(1);
    std::vector<glm::dvec3> places;
    for (std::size_t z = 0; z < grid.size[2]; z += 8)
        for (std::size_t y = 0; y < grid.size[1]; y += 4)
            for (std::size_t x = 0; x < grid.size[0]; ++x) {
                const glm::dvec3 at = kAnywhere ? glm::dvec3(draw(0, 1), draw(0, 1), draw(0, 1)) *
                                                      glm::dvec3(grid.size[0], grid.size[1], grid.size[2])
                                                : glm::dvec3(x, y, z);
                places.push_back(grid.origin + grid.spacing * at);
            }
    std::vector<double> ratios, ours;
    std::vector<double> squares(places.size()), theirs(places.size());
    for (auto _ : state) {
        const double mine = seconds([&] {
            layout::uint hint = 0;
            for (std::size_t i = 0; i < places.size(); ++i) {
                const auto found = reference::nearest(mesh, places[i], hint);
                hint = found.triangle;
                squares[i] = found.square;
            }
        });
        const double other = seconds([&] {
            for (std::size_t i = 0; i < places.size(); ++i)
                theirs[i] = peer.nearest(places[i]).square;
        });
        ours.push_back(mine);
        ratios.push_back(other / mine);
        state.SetIterationTime(mine);
    }
    double apart = 0; // of the distances
    for (std::size_t i = 0; i < places.size(); ++i)
        apart = std::max(apart, std::abs(std::sqrt(squares[i]) - std::sqrt(theirs[i])));
    state.counters["triangles"] = double(spot().triangles());
    state.counters["queries_per_s"] = double(places.size()) / median(ours);
    state.counters["times_as_fast"] = median(ratios);
    state.counters["least"] = *std::ranges::min_element(ratios);
    state.counters["most"] = *std::ranges::max_element(ratios);
    state.counters["distances_apart"] = apart;
}
BENCHMARK(nearest_against_cgal<false>)->UseManualTime()->Iterations(7)->Unit(benchmark::kMillisecond);
BENCHMARK(nearest_against_cgal<true>)->UseManualTime()->Iterations(7)->Unit(benchmark::kMillisecond);
BENCHMARK(nearest<double>)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(nearest<float>)->UseManualTime()->Iterations(3)->Unit(benchmark::kMillisecond);

} // namespace
} // namespace forceshade::bench
