#include "host/study/omission/measurement.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/norm.h"
#include "host/output/exr_volume.h"
#include "host/program.h"

namespace forceshade::study {
namespace {

// Of the volume that a sweep would write; nothing of it stays.
template <typename T>
std::uint64_t volume_bytes(Engine& engine, const Setup& setup, const std::filesystem::path& folder) {
    const Scene& scene = setup.prepared.one.scene;
    VolumeHeader header;
    header.size = scene.grid.size;
    header.origin = scene.grid.origin;
    header.spacing = scene.grid.spacing;
    header.channels = scene.output.channels | layout::kChannelForce;
    header.compression = scene.output.compression;
    header.pixel = scene.output.pixel;
    header.scene = setup.prepared.scene;
    header.version = version();
    header.threads = 2;
    const FieldTables<T> tables = make_tables<T>(scene, setup.prepared.images, setup.extent);
    const std::filesystem::path file = folder / ".volume.exr";
    struct Removed {
        const std::filesystem::path& file;
        ~Removed() {
            std::error_code ignored;
            std::filesystem::remove(file, ignored);
        }
    } removed{file};
    VolumeWriter writer(file, header);
    const std::size_t repeats = scene.grid.size[1] / tables.y.size();
    engine.evaluate(tables.input(), [&](const layout::FieldChunk<T>& chunk) { writer.write(chunk, repeats); });
    return writer.finish().bytes;
}

template <typename T> struct Measuring {
    std::unique_ptr<Side<T>> side;
    MeasuredSide measured{};
    std::vector<double> kernel{}, whole{}; // of the round

    void measure(Engine& engine) {
        measured.cost = side->measure(engine);
        kernel.push_back(measured.cost.kernel);
        whole.push_back(measured.cost.whole);
    }
    // The least of the round: what comes between makes times longer, never shorter.
    void end_round() {
        measured.kernel.push_back(std::ranges::min(std::exchange(kernel, {})));
        measured.whole.push_back(std::ranges::min(std::exchange(whole, {})));
    }
};

template <typename T>
Measurement measure_in(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                       const std::filesystem::path& folder) {
    constexpr double kLeastRounds = 5, kMostTimes = 64;
    Measuring<T> with{make_side<T>(comparison.with, comparison.paths)};
    Measuring<T> without{make_side<T>(comparison.without, comparison.paths)};
    Measurement result;
    // Also compiles the kernels and warms the caches.
    result.agreement = compare(comparison, with.side->capture(engine, comparison.channels),
                               without.side->capture(engine, comparison.channels));
    const double taken = std::max(1e-6, with.side->measure(engine).whole + without.side->measure(engine).whole);
    const auto count = static_cast<unsigned>(std::clamp(rounds.budget / taken, kLeastRounds, double(rounds.count)));
    const auto times = static_cast<unsigned>(std::clamp(rounds.seconds / taken, 1.0, kMostTimes));
    for (unsigned round = 0; round < count; ++round) {
        check_interrupt();
        for (unsigned i = 0; i < times; ++i) { // each side comes first as often
            const bool turned = ((round + i) & 1) != 0;
            (turned ? with : without).measure(engine);
            (turned ? without : with).measure(engine);
        }
        with.end_round();
        without.end_round();
    }
    result.with = std::move(with.measured);
    result.without = std::move(without.measured);
    result.with.samples = with.side->samples();
    result.without.samples = without.side->samples();
    if (!comparison.paths) {
        result.with.file = volume_bytes<T>(engine, comparison.with, folder);
        result.without.file = volume_bytes<T>(engine, comparison.without, folder);
    }
    return result;
}

template <typename Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b, std::size_t at, std::size_t components) {
    const std::size_t end = (at + 1) * components;
    if (a.size() < end || b.size() < end)
        return a.size() == b.size();
    return std::memcmp(&a[at * components], &b[at * components], components * sizeof(Value)) == 0;
}

template <typename T> bool is_felt(const std::vector<T>& force, std::size_t at) {
    return norm(double(force[3 * at]), double(force[3 * at + 1]), double(force[3 * at + 2])) > 0;
}

template <typename T> bool same_force(Same same, const std::vector<T>& a, const std::vector<T>& b, std::size_t at) {
    if (same == Same::values)
        return a[3 * at] == b[3 * at] && a[3 * at + 1] == b[3 * at + 1] && a[3 * at + 2] == b[3 * at + 2];
    return same_bits(a, b, at, 3);
}

template <typename T> std::uint64_t with_force(Engine& engine, const Setup& setup, bool paths) {
    const std::vector<T> force = make_side<T>(setup, paths)->capture(engine, 0).force;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < force.size() / 3; ++i)
        count += is_felt(force, i);
    return count;
}

} // namespace

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
        result.in_contact += is_felt(without.force, i);
    }
    // A field of another size is another field.
    result.differing += std::max(with.force.size(), without.force.size()) / 3 - samples;
    return result;
}

template Agreement compare<float>(const Comparison&, const Captured<float>&, const Captured<float>&);
template Agreement compare<double>(const Comparison&, const Captured<double>&, const Captured<double>&);

Measurement measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                    const std::filesystem::path& folder) {
    if (comparison.with.prepared.one.scene.precision == Precision::f32)
        return measure_in<float>(engine, comparison, rounds, folder);
    return measure_in<double>(engine, comparison, rounds, folder);
}

Touched touched(Engine& engine, const BaseScene& base) {
    const auto count = [&](bool paths) {
        Setup setup{base.prepared, "all"};
        Scene& scene = setup.prepared.one.scene;
        scene.field = !paths;
        return scene.precision == Precision::f32 ? with_force<float>(engine, setup, paths)
                                                 : with_force<double>(engine, setup, paths);
    };
    return {base.field ? count(false) : 0, base.paths ? count(true) : 0};
}

} // namespace forceshade::study
