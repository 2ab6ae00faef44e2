#include "compute/path_plan.h"

#include <algorithm>
#include <bit>

namespace forceshade::compute {
namespace {

// Software drivers end the loops of an invocation after 65 535 iterations, in silence; this is far from there.
constexpr std::uint64_t kMostIterations = 24000;
// Steps, weighed by their cost: a second's on a device ten times slower than two cores of software.
constexpr std::uint64_t kMostCost = std::uint64_t(1) << 24;
constexpr std::uint64_t kPhiloxRounds = 10;

} // namespace

std::uint64_t path_sample_bytes(layout::uint channels, std::size_t real_size) {
    const auto of = [&](layout::uint channel, std::uint64_t bytes) { return channels & channel ? bytes : 0; };
    return of(layout::kChannelPosition, 3 * real_size) + of(layout::kChannelForce, 3 * real_size) +
           of(layout::kChannelDepth, real_size) + of(layout::kChannelFacet, sizeof(layout::uint)) +
           of(layout::kChannelProxy, 3 * real_size);
}

StepWork step_work(const layout::Features& law, const layout::PathFeatures& features, std::uint64_t facets,
                   std::size_t real_size) {
    const bool closed = features.loop == layout::kLoopClosed;
    StepWork work;
    work.iterations = 2 + features.harmonics; // a path that has left its bound takes its steps in a loop of their own
    if (law.surface == layout::kSurfaceBump)  // the probe's facet, and that of the motion's place
        work.iterations += 2 * (1 + std::uint64_t(std::bit_width(facets)));
    if (features.motion == layout::kMotionMinimumJerk)
        work.iterations += 1 + 2 * kPhiloxRounds;
    work.cost = 1 + (closed ? 1 : 0) + features.harmonics;
    if (law.map == layout::kMapSamples || law.texture == layout::kMapSamples)
        work.cost += 1;
    work.cost *= real_size / sizeof(float);
    work.bytes = path_sample_bytes(features.channels, real_size);
    if (features.motion == layout::kMotionRecorded)
        work.bytes += 3 * real_size;
    return work;
}

std::uint32_t steps_of_dispatch(const StepWork& work, std::uint64_t paths, std::uint64_t steps,
                                std::uint64_t chunk_bytes) {
    std::uint64_t most = std::min(kMostIterations / work.iterations, kMostCost / (work.cost * paths));
    if (work.bytes != 0)
        most = std::min(most, chunk_bytes / (work.bytes * paths));
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(most, 1, std::max<std::uint64_t>(1, steps)));
}

} // namespace forceshade::compute
