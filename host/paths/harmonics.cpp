#include "host/paths/harmonics.h"

#include <cmath>
#include <numbers>

#include "host/paths/motions.h"

namespace forceshade {
namespace {

constexpr std::uint32_t kWalk = 16, kTremor = 4;
constexpr double kSpread = 0.2; // of the tremor's frequency, either way

bool trembles(const Spread& amplitude) {
    if (amplitude.shape == Spread::Shape::uniform)
        return amplitude.high > 0;
    return amplitude.value > 0 || amplitude.sd > 0;
}

// A random walk's band: root mean squares, m, frequencies as shares of the edge, and the edge.
struct Band {
    std::array<double, 2> sizes{};
    std::array<std::array<double, kWalk>, 2> shares{};
    double edge = 0; /* turns a sample */
};

// The shares are drawn first; the edge is where the speed comes out.
Band walk_band(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    Band band;
    band.sizes = {region.length / std::sqrt(8.0), region.width / std::sqrt(8.0)};
    const double speed = draws.value(paths.speed, Draw::speed, true);
    double square = 0; /* m^2: of the speed over the edge's angular frequency */
    for (std::uint32_t i = 0; i < kWalk; ++i)
        for (std::uint32_t axis = 0; axis < 2; ++axis) {
            band.shares[axis][i] = (i + draws.uniform(Draw::walk_frequency, 2 * i + axis)) / kWalk;
            square += std::pow(band.sizes[axis] * band.shares[axis][i], 2) / kWalk;
        }
    band.edge = square > 0 ? speed / (2 * std::numbers::pi * std::sqrt(square) * paths.rate) : 0;
    return band;
}

Harmonics random_walk(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    const Band band = walk_band(paths, region, draws);
    Harmonics harmonics(kWalk);
    for (std::uint32_t i = 0; i < kWalk; ++i)
        for (std::uint32_t axis = 0; axis < 2; ++axis)
            harmonics[i][axis] = {band.sizes[axis] * std::sqrt(2.0 / kWalk), draws.word(Draw::walk_phase, 2 * i + axis),
                                  phase_of_turns(band.edge * band.shares[axis][i])};
    return harmonics;
}

Harmonics tremor(const PathsSpec& paths, const PathDraws& draws) {
    const double size = draws.value(paths.tremor_amplitude, Draw::tremor_amplitude, true); /* m, rms */
    Harmonics harmonics(kTremor);
    for (std::uint32_t i = 0; i < kTremor; ++i)
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const double share = (i + draws.uniform(Draw::tremor_frequency, 3 * i + axis)) / kTremor;
            const double frequency = paths.tremor_frequency * (1 + kSpread * (2 * share - 1));
            harmonics[i][axis] = {size * std::sqrt(2.0 / kTremor), draws.word(Draw::tremor_phase, 3 * i + axis),
                                  phase_of_turns(frequency / paths.rate)};
        }
    return harmonics;
}

} // namespace

std::uint32_t harmonic_count(const PathsSpec& paths) {
    if (paths.kind == PathKind::random_walk)
        return kWalk;
    return paths.kind != PathKind::recorded && trembles(paths.tremor_amplitude) ? kTremor : 0;
}

double highest_tremor(const PathsSpec& paths) {
    return (1 + kSpread) * paths.tremor_frequency;
}

double walk_edge(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    return walk_band(paths, region, draws).edge;
}

Harmonics path_harmonics(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws) {
    if (paths.kind == PathKind::random_walk)
        return random_walk(paths, region, draws);
    return harmonic_count(paths) > 0 ? tremor(paths, draws) : Harmonics{};
}

} // namespace forceshade
