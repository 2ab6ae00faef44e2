// A comparison measured.
#include <algorithm>
#include <cstring>

#include "host/cases/case_files.h"
#include "host/clock.h"
#include "host/norm.h"
#include "host/output/exr_volume.h"
#include "host/paths/scene_paths.h"
#include "host/program.h"
#include "host/random.h"
#include "host/study/omission/omission.h"

namespace forceshade::study {
namespace {

// A chunk's channel, by step, to its places by path.
template <typename Value, typename T>
void place(const layout::PathChunk<T>& chunk, const layout::PathInput<T>& input, std::span<const Value> channel,
           std::size_t components, std::vector<Value>& into) {
    if (channel.empty())
        return;
    into.resize(input.paths * input.steps * components);
    for (std::size_t step = 0; step < chunk.step_count; ++step)
        for (std::size_t path = 0; path < chunk.path_count; ++path) {
            const auto from = channel.subspan((step * chunk.pitch + path) * components, components);
            const std::size_t to = (chunk.path_first + path) * input.steps + chunk.step_first + step;
            std::ranges::copy(from, into.begin() + std::ptrdiff_t(to * components));
        }
}

// One side, ready for repeated evaluation, and what its rounds took.
template <typename T> class Side {
public:
    /// `setup` must outlive it; `paths`: those of its scene, not its field.
    Side(const Setup& setup, bool paths) : setup_(setup), scene_(setup.prepared.one.scene), drawn_(setup.prepared) {
        make(paths);
    }

    /// The same scene, its mesh turned, on a grid elsewhere, or with other paths of the same kind.
    void draw(unsigned number) {
        Random random(number, "grids and paths of the study of omissions");
        Scene& scene = drawn_.one.scene;
        for (std::size_t axis = 0; axis < 3; ++axis)
            scene.grid.origin[axis] = scene_.grid.origin[axis] + (random.uniform() - 0.5) * scene_.grid.spacing[axis];
        if (!setup_.turned.empty())
            drawn_.images.mesh = setup_.turned[number % setup_.turned.size()];
        if (paths_)
            scene.paths->seed = scene_.paths->seed + number;
        make(paths_ != nullptr);
    }

    /// Of the grid, or of all paths.
    std::size_t samples() const {
        const auto& size = scene_.grid.size;
        return paths_ ? scene_.paths->count * scene_.paths->steps : size[0] * size[1] * size[2];
    }

    /// Discards the results, unless the setup has the oracle check them.
    Cost measure(Engine& engine) {
        Cost cost;
        const auto receive = [&](const auto&... channels) { cost.received += (channels.size_bytes() + ...); };
        Clock::time_point start{};
        EngineTimes times;
        if (paths_) {
            const layout::PathInput<T> input = path_input(0);
            start = Clock::now();
            times = engine.explore<T>(
                input, [&](const auto& c) { receive(c.position, c.force, c.depth, c.facet, c.proxy); },
                [&](std::size_t, const auto& metrics) { receive(metrics); });
            cost.evaluated = samples();
        } else {
            const layout::FieldInput<T> input = tables_.input();
            start = Clock::now();
            times = study::evaluate<T>(engine, input, setup_.free,
                                       [&](const auto& c) { receive(c.force, c.depth, c.facet, c.proxy, c.unshaded); });
            cost.evaluated =
                times.voxels_evaluated ? times.voxels_evaluated : input.x.size() * input.y.size() * input.z.size();
        }
        cost.whole = seconds_since(start);
        cost.kernel = times.kernel;
        cost.uploaded = times.uploaded;
        return cost;
    }

    void measure_in_round(Engine& engine, bool first) {
        const Cost cost = measured_.cost = measure(engine);
        least_.kernel = first ? cost.kernel : std::min(least_.kernel, cost.kernel);
        least_.whole = first ? cost.whole : std::min(least_.whole, cost.whole);
    }
    void end_round() {
        measured_.kernel.push_back(least_.kernel);
        measured_.whole.push_back(least_.whole);
    }
    MeasuredSide finish(Engine& engine, const std::filesystem::path& folder) {
        measured_.samples = samples();
        measured_.file = volume_bytes(engine, folder);
        return std::move(measured_);
    }

    Captured<T> capture(Engine& engine, std::uint32_t channels) {
        Captured<T> captured;
        if (paths_) {
            const layout::PathInput<T> input = path_input(channels & ~layout::kChannelUnshaded);
            engine.explore<T>(
                input,
                [&](const auto& chunk) {
                    place(chunk, input, chunk.force, 3, captured.force);
                    place(chunk, input, chunk.depth, 1, captured.depth);
                    place(chunk, input, chunk.facet, 1, captured.facet);
                    place(chunk, input, chunk.proxy, 3, captured.proxy);
                    place(chunk, input, chunk.position, 3, captured.position);
                },
                [&](std::size_t, const auto& metrics) {
                    captured.metrics.insert(captured.metrics.end(), metrics.begin(), metrics.end());
                });
            return captured;
        }
        layout::FieldInput<T> input = tables_.input();
        input.law.features.channels |= channels;
        const std::size_t repeats = scene_.grid.size[1] / input.y.size();
        study::evaluate<T>(engine, input, setup_.free, [&](const auto& chunk) { captured.append(chunk, repeats); });
        return captured;
    }

private:
    void make(bool paths) {
        if (paths)
            paths_ = std::make_unique<ScenePaths<T>>(drawn_);
        else
            tables_ = make_tables<T>(drawn_.one.scene, drawn_.images, setup_.extent);
    }

    layout::PathInput<T> path_input(std::uint32_t more_channels) {
        layout::PathInput<T> input = paths_->input();
        input.features.channels = setup_.samples ? input.features.channels | more_channels : 0;
        return input;
    }

    /// Bytes of the volume that a sweep would write; the file is removed. Of paths 0.
    std::uint64_t volume_bytes(Engine& engine, const std::filesystem::path& folder) {
        if (paths_)
            return 0;
        VolumeHeader header;
        header.size = scene_.grid.size;
        header.origin = scene_.grid.origin;
        header.spacing = scene_.grid.spacing;
        header.channels = scene_.output.channels | layout::kChannelForce;
        set_options(header, setup_.prepared, scene_, 2);
        const std::filesystem::path volume = folder / ".volume.exr";
        VolumeWriter writer(volume, header);
        const std::size_t repeats = scene_.grid.size[1] / tables_.y.size();
        engine.evaluate<T>(tables_.input(), [&](const auto& chunk) { writer.write(chunk, repeats); });
        const std::uint64_t bytes = writer.finish().bytes;
        std::error_code ignored;
        std::filesystem::remove(volume, ignored);
        return bytes;
    }

    const Setup& setup_;
    const Scene& scene_;
    PreparedCase drawn_;
    FieldTables<T> tables_{};
    std::unique_ptr<ScenePaths<T>> paths_{};
    MeasuredSide measured_{};
    Cost least_{}; // of the round: disturbances make times longer, never shorter
};

template <typename T>
Measurement measure_in(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                       const std::filesystem::path& folder) {
    constexpr double kLeastRounds = 5, kMostTimes = 64;
    constexpr unsigned kCompared = 3; // of the draws
    Side<T> with(comparison.with, comparison.paths), without(comparison.without, comparison.paths);
    // Also compiles the kernels and warms the caches.
    Agreement agreement =
        compare(comparison, with.capture(engine, comparison.channels), without.capture(engine, comparison.channels));
    const double taken = std::max(1e-6, with.measure(engine).whole + without.measure(engine).whole);
    const auto count = static_cast<unsigned>(std::clamp(rounds.budget / taken, kLeastRounds, double(rounds.count)));
    const auto times = static_cast<unsigned>(std::clamp(rounds.seconds / taken, 1.0, kMostTimes));
    for (unsigned round = 0; round < count; ++round) {
        check_interrupt();
        with.draw(round + 1);
        without.draw(round + 1);
        if (round < kCompared)
            agreement += compare(comparison, with.capture(engine, comparison.channels),
                                 without.capture(engine, comparison.channels));
        for (unsigned i = 0; i < times; ++i) { // each side comes first as often
            const bool turned = ((round + i) & 1) != 0;
            (turned ? with : without).measure_in_round(engine, i == 0);
            (turned ? without : with).measure_in_round(engine, i == 0);
        }
        with.end_round();
        without.end_round();
    }
    with.draw(1), without.draw(1); // files of the same grid, however many rounds there was time for
    return {comparison, with.finish(engine, folder), without.finish(engine, folder), agreement};
}

template <typename Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b, std::size_t at, std::size_t components) {
    const std::size_t end = (at + 1) * components;
    if (a.size() < end || b.size() < end)
        return a.size() == b.size();
    return std::memcmp(&a[at * components], &b[at * components], components * sizeof(Value)) == 0;
}

template <typename T> bool is_nonzero(const std::vector<T>& force, std::size_t at) {
    return norm(double(force[3 * at]), double(force[3 * at + 1]), double(force[3 * at + 2])) > 0;
}

template <typename T> bool same_force(Same same, const std::vector<T>& a, const std::vector<T>& b, std::size_t at) {
    if (same == Same::values)
        return a[3 * at] == b[3 * at] && a[3 * at + 1] == b[3 * at + 1] && a[3 * at + 2] == b[3 * at + 2];
    return same_bits(a, b, at, 3);
}

} // namespace

template <typename T> Captured<T> capture(Engine& engine, const Setup& setup, bool paths, std::uint32_t channels) {
    return Side<T>(setup, paths).capture(engine, channels);
}

template Captured<float> capture<float>(Engine&, const Setup&, bool, std::uint32_t);

template <typename T>
Agreement compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without) {
    Agreement result;
    if (comparison.same == Same::metrics) {
        result.compared = with.metrics.size();
        for (std::size_t i = 0; i < with.metrics.size(); ++i)
            result.differing += !same_bits(with.metrics, without.metrics, i, 1);
        return result;
    }
    const std::size_t samples = std::min(with.force.size(), without.force.size()) / 3;
    result.compared = samples;
    const auto of = [&](std::uint32_t channel) { return (comparison.channels & channel) != 0; };
    for (std::size_t i = 0; i < samples; ++i) {
        const bool same = same_force(comparison.same, with.force, without.force, i) &&
                          (!of(layout::kChannelDepth) || same_bits(with.depth, without.depth, i, 1)) &&
                          (!of(layout::kChannelFacet) || same_bits(with.facet, without.facet, i, 1)) &&
                          (!of(layout::kChannelProxy) || same_bits(with.proxy, without.proxy, i, 3)) &&
                          (!of(layout::kChannelUnshaded) || same_bits(with.unshaded, without.unshaded, i, 3)) &&
                          (!comparison.paths || same_bits(with.position, without.position, i, 3));
        result.differing += !same;
        result.in_contact += is_nonzero(without.force, i);
    }
    // A field of another size is another field.
    result.differing += std::max(with.force.size(), without.force.size()) / 3 - samples;
    return result;
}

template Agreement compare<float>(const Comparison&, const Captured<float>&, const Captured<float>&);
template Agreement compare<double>(const Comparison&, const Captured<double>&, const Captured<double>&);

Measurement measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                    const std::filesystem::path& folder) {
    return in_precision(comparison.with.prepared.one.scene.precision, [&]<typename T>(std::type_identity<T>) {
        return measure_in<T>(engine, comparison, rounds, folder);
    });
}

Touched touched(Engine& engine, const BaseScene& base) {
    const auto count = [&](bool paths) {
        Setup setup{base.prepared, "all"};
        Scene& scene = setup.prepared.one.scene;
        scene.field = !paths;
        return in_precision(scene.precision, [&]<typename T>(std::type_identity<T>) {
            const std::vector<T> force = capture<T>(engine, setup, paths, 0).force;
            std::uint64_t touching = 0;
            for (std::size_t i = 0; i < force.size() / 3; ++i)
                touching += is_nonzero(force, i);
            return touching;
        });
    };
    return {base.field ? count(false) : 0, base.paths ? count(true) : 0};
}

} // namespace forceshade::study
