// Exploration paths over a mesh, drawn at random, for the device and for the oracle.
#pragma once

#include <memory>
#include <optional>

#include "compute/kernels.h"
#include "host/reference/god_object.h"
#include "host/reference/path_step.h"
#include "tests/gpu/path_case.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"
#include "tests/unit/laws.h"

namespace forceshade::test {

/// Where the probes of recorded paths come from: a PathCase, or walks about the mesh.
enum class Probes { of_case, wandering, aimed };

/// The paths of a PathCase over a mesh; or recorded ones that wander about it, with a terrain's focus or none, or that
/// aim at its corners and edges.
template <typename T> class MeshPathCase final : public layout::PathSource<T> {
public:
    MeshPathCase(const MeshStructure& structure, const PathShape& shape, Probes probes = Probes::of_case,
                 std::optional<glm::dvec3> focus = {})
        : tables_(make_mesh_tables<T>(structure, 1000.0)), paths_(bump(kRadii[0], 1), shape), shape_(shape) {
        law.features.surface = layout::kSurfaceMesh;
        law.mesh = tables_.view();
        if (probes == Probes::wandering)
            wander(structure, [&](std::uint64_t seed) { return walks::Wanderer(structure, seed, focus); });
        if (probes == Probes::aimed) {
            walks::Aimer aimer(structure, shape.seed);
            wander(structure, [&](std::uint64_t) -> walks::Aimer& { return aimer; });
        }
    }

    layout::PathInput<T> input() {
        layout::PathInput<T> input = paths_.input();
        input.law = law;
        input.source = this;
        return input;
    }

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        layout::PathBatch<T> batch = paths_.batch(first, count);
        first_ = first;
        count_ = count;
        proxies_.clear();
        const layout::PathInput<T> input = this->input();
        for (std::size_t path = 0; path < count; ++path) {
            const layout::HandParams<T> hand =
                input.hands.empty() ? layout::HandParams<T>{} : input.hands[input.hands.size() > 1 ? first + path : 0];
            const bool recorded = batch.motions.empty();
            const reference::Vector<T> place = recorded
                                                   ? reference::vector_at(positions(0, 1), path)
                                                   : reference::motion_at(input.law, input.features, batch, path, 0U);
            const auto state = reference::begin_state(input.features, hand, place);
            proxies_.push_back(reference::proxy_start(
                law, around_,
                reference::to_mesh_frame(law.mesh.params, reference::Vector<T>(state.x, state.y, state.z))));
        }
        batch.proxies = proxies_;
        return batch;
    }

    std::span<const T> positions(std::size_t step, std::size_t steps) override {
        if (wandered_.empty())
            return paths_.positions(step, steps);
        window_.clear();
        for (std::size_t s = step; s < step + steps; ++s)
            for (std::size_t i = 0; i < 3 * count_; ++i)
                window_.push_back(wandered_[3 * (s * shape_.paths + first_) + i]);
        return window_;
    }

    std::size_t length(std::size_t path) const { return paths_.length(path); }

    /// A sample of a recorded path, m.
    void place(std::size_t step, std::size_t path, const std::array<T, 3>& at) { paths_.place(step, path, at); }

    layout::Law<T> law{};

private:
    template <typename WalkerOf> void wander(const MeshStructure& structure, const WalkerOf& walker_of) {
        wandered_.resize(3 * shape_.paths * shape_.steps);
        for (std::size_t path = 0; path < shape_.paths; ++path) {
            auto&& walker = walker_of(shape_.seed * 1000 + path);
            glm::dvec3 at = walker.begin();
            for (std::size_t step = 0; step < shape_.steps; ++step) {
                const glm::dvec3 place = structure.centre - origin_of(structure) + structure.scale * at;
                for (int axis = 0; axis < 3; ++axis)
                    wandered_[3 * (step * shape_.paths + path) + static_cast<std::size_t>(axis)] = T(place[axis]);
                at = walker.step(at);
            }
        }
    }

    MeshTables<T> tables_;
    PathCase<T> paths_;
    PathShape shape_;
    reference::Neighbourhood<T> around_;
    std::vector<layout::ProxyStart<T>> proxies_;
    std::vector<T> wandered_, window_;
    std::size_t first_ = 0, count_ = 0;
};

/// How many recorded paths cross the mesh on the oracle's way along them: every piece is checked in exact arithmetic.
template <typename T> std::uint64_t crossings(MeshPathCase<T>& one, std::size_t paths, std::size_t steps) {
    const layout::MeshView<T>& mesh = one.law.mesh;
    const brute::Triangles triangles = brute::Triangles::of(mesh.vertices, mesh.triangle_corners);
    const brute::TriangleGrid grid(triangles);
    const auto wide = [](const reference::Vector<T>& v) { return glm::dvec3(v); };
    const layout::PathBatch<T> batch = one.batch(0, paths);
    const std::span<const T> positions = one.positions(0, steps);
    auto around = std::make_unique<reference::Neighbourhood<T>>();
    std::uint64_t count = 0;
    for (std::size_t path = 0; path < paths; ++path) {
        reference::GodObject<T> state = reference::god_object_at(batch.proxies[path]);
        bool crossed = false;
        const auto watch = [&](const reference::Vector<T>& from, const reference::Vector<T>& to) {
            crossed = crossed || grid.touches(wide(from), wide(to));
        };
        for (std::size_t step = 0; step < steps; ++step)
            reference::update(
                mesh, state, *around,
                reference::to_mesh_frame(mesh.params, reference::vector_at(positions, step * paths + path)), watch);
        count += crossed;
    }
    return count;
}

/// Lets a kernel of paths on meshes take a run, corners and edges done by the oracle.
struct MeshPathRunner {
    compute::MeshPathKernel& kernel;
    compute::MeshPathTimes times{};

    template <typename T>
    void explore(const layout::PathInput<T>& input, const compute::TakePaths<T>& take,
                 const compute::TakeMetrics<T>& take_metrics) {
        const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> updates) {
            reference::finish_updates(input.law.mesh, updates, 2);
        };
        times = kernel.explore<T>(input, finish, take, take_metrics);
    }
};

} // namespace forceshade::test
