#include "host/study/omission/measurement.h"

#include <algorithm>
#include <random>
#include <utility>

#include "host/output/exr_volume.h"
#include "host/program.h"
#include "host/study/omission/unchanged.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

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

template <typename T> struct Measured {
    std::unique_ptr<Side<T>> side;
    Engine& engine;
    std::vector<double> kernel{}, whole{}, round_kernel{}, round_whole{};
    Cost cost{};

    void measure() {
        cost = side->measure(engine);
        round_kernel.push_back(cost.kernel);
        round_whole.push_back(cost.whole);
    }
    // The least of the round: what comes between makes times longer, never shorter.
    void end_round() {
        kernel.push_back(std::ranges::min(std::exchange(round_kernel, {})));
        whole.push_back(std::ranges::min(std::exchange(round_whole, {})));
    }
    Json json() const {
        return {{"kernel_s", kernel},          {"whole_s", whole},
                {"uploaded", cost.uploaded},   {"received", cost.received},
                {"evaluated", cost.evaluated}, {"samples", side->samples()}};
    }
};

// Channels that both sides are looked at with. Where those that are written do not suffice, all of them, so that few
// kernels are compiled for it.
std::uint32_t looked_at(const Comparison& one) {
    const std::uint32_t needed =
        one.channels | (one.unshaded_is_force ? std::uint32_t(layout::kChannelUnshaded) : std::uint32_t(0));
    if ((needed & ~one.without.prepared.one.scene.output.channels) == 0)
        return needed;
    return needed | layout::kChannelDepth | layout::kChannelFacet | layout::kChannelUnshaded;
}

template <typename T>
Json measure_in(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                const std::filesystem::path& folder) {
    Measured<T> with{make_side<T>(comparison.with, comparison.paths), engine};
    Measured<T> without{make_side<T>(comparison.without, comparison.paths), engine};
    const std::uint32_t channels = looked_at(comparison);
    // Also compiles the kernels and warms the caches.
    const Captured<T> with_result = with.side->capture(with.engine, channels);
    const Captured<T> without_result = without.side->capture(without.engine, channels);
    const Unchanged unchanged = compare(comparison, with_result, without_result);
    const double taken = std::max(1e-6, with.side->measure(with.engine).whole + without.side->measure(engine).whole);
    constexpr double kLeastRounds = 5, kMostTimes = 64;
    const auto count = static_cast<unsigned>(std::clamp(rounds.budget / taken, kLeastRounds, double(rounds.count)));
    const auto times = static_cast<unsigned>(std::clamp(rounds.seconds / taken, 1.0, kMostTimes));
    std::mt19937_64 random(rounds.seed);
    for (unsigned round = 0; round < count; ++round) {
        check_interrupt();
        for (unsigned i = 0; i < times; ++i) {
            const bool turned = random() & 1;
            (turned ? with : without).measure();
            (turned ? without : with).measure();
        }
        with.end_round();
        without.end_round();
    }
    Json result{{"with", with.json()},
                {"without", without.json()},
                {"compared", unchanged.compared},
                {"in_contact", unchanged.in_contact},
                {"differing", unchanged.differing},
                {"largest", unchanged.largest}};
    if (!comparison.paths) {
        result["with"]["file"] = volume_bytes<T>(engine, comparison.with, folder);
        result["without"]["file"] = volume_bytes<T>(engine, comparison.without, folder);
    }
    return result;
}

} // namespace

Json measure(Engine& engine, const Comparison& comparison, const Rounds& rounds, const std::filesystem::path& folder) {
    if (comparison.with.prepared.one.scene.precision == Precision::f32)
        return measure_in<float>(engine, comparison, rounds, folder);
    return measure_in<double>(engine, comparison, rounds, folder);
}

} // namespace forceshade::study
