// The mesh's own structure: how fast it is built and how large it is, and how many nearest points two threads find a
// second, and one beside a peer.
#include "host/random.h"
#include "tests/bench/cgal_tree.h"
#include "tests/bench/tree_queries.h"

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

template <typename T> void nearest(benchmark::State& state) {
    const FieldTables<T> field = field_of_fine_spot<T>();
    const double voxels = voxels_of(field);
    std::vector<double> times;
    for (auto _ : state) {
        times.push_back(query_seconds(field));
        state.SetIterationTime(times.back());
    }
    state.counters["triangles"] = double(field.mesh->params.triangles);
    state.counters["voxels"] = voxels;
    state.counters["queries_per_s"] = voxels / median(times);
    state.counters["of_wanted"] = voxels / median(times) / kQueries;
}
/// One thread beside a peer's tree: along a grid, where each query begins with the last one's triangle and the peer has
/// a hint of its own, and at places anywhere in its box.
template <bool kAnywhere> void nearest_against_cgal(benchmark::State& state) {
    const FieldTables<double> field = field_of_fine_spot<double>();
    const layout::MeshView<double> mesh = field.mesh->view();
    const CgalTree peer(mesh.vertices, mesh.triangle_corners);
    Random draw(1);
    const auto anywhere = [&](const std::vector<double>& axis) { return draw(axis.front(), axis.back()); };
    std::vector<glm::dvec3> places;
    for (std::size_t z = 0; z < field.z.size(); z += 8)
        for (std::size_t y = 0; y < field.y.size(); y += 4)
            for (const double x : field.x)
                places.push_back(kAnywhere ? glm::dvec3(anywhere(field.x), anywhere(field.y), anywhere(field.z))
                                           : glm::dvec3(x, field.y[y], field.z[z]));
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
    state.counters["triangles"] = double(mesh.params.triangles);
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
