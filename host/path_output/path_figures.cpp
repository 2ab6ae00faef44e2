#include "host/path_output/path_figures.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forceshade {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

// A sum whose second term keeps what rounding took from the first.
template <typename T> double whole(T sum, T rest) {
    return double(sum) - double(rest);
}

// From the square of the chord between two unit vectors.
double angle_of(double square) {
    return 2 * std::asin(std::min(std::sqrt(square) / 2, 1.0)) * kDegrees;
}

template <typename T> void add_depths(PathFigures& figures, const layout::PathMetrics<T>& metrics) {
    if (metrics.contact_samples == 0)
        return;
    const double samples = metrics.contact_samples;
    const double mean = whole(metrics.depth, metrics.depth_rest) / samples;
    const double square = whole(metrics.depth_square, metrics.depth_square_rest) / samples;
    figures.least_depth = double(metrics.least_depth);
    figures.mean_depth = mean;
    figures.largest_depth = double(metrics.largest_depth);
    figures.depth_deviation = std::sqrt(std::max(square - mean * mean, 0.0));
}

// All rounds together have done the work up to where the next one began.
template <typename T> void add_rounds(PathFigures& figures, const layout::PathMetrics<T>& metrics) {
    figures.rounds = metrics.rounds;
    if (metrics.rounds == 0)
        return;
    figures.least_round = double(metrics.least_round);
    figures.mean_round = whole(metrics.round_begin, metrics.round_begin_rest) / double(metrics.rounds);
    figures.largest_round = double(metrics.largest_round);
}

} // namespace

template <typename T> PathFigures figures_of(const layout::PathMetrics<T>& metrics, const PathFacts& facts) {
    constexpr double kMillimetres = 1000; // in a metre
    const bool unstable = metrics.unstable_step != layout::kNever;
    const std::uint64_t felt = unstable ? metrics.unstable_step : facts.steps;
    PathFigures figures;
    figures.steps = facts.steps;
    figures.contact_time = facts.times ? facts.times->contact : double(metrics.contact_samples) / facts.rate;
    figures.largest_force = double(metrics.largest_force);
    if (felt > 0)
        figures.rms_force =
            std::sqrt(std::max(whole(metrics.force_square, metrics.force_square_rest), 0.0) / double(felt));
    figures.largest_turn = angle_of(double(metrics.largest_turn));
    figures.steepest_turn =
        angle_of(double(metrics.steepest_turn)) / (std::sqrt(double(metrics.steepest_way)) * kMillimetres);
    figures.work = whole(metrics.work, metrics.work_rest);
    figures.effort = whole(metrics.effort, metrics.effort_rest);
    if (figures.effort > 0)
        figures.eta = figures.work / figures.effort;
    add_rounds(figures, metrics);
    add_depths(figures, metrics);
    if (unstable)
        figures.unstable_time = facts.times ? facts.times->unstable : double(metrics.unstable_step) / facts.rate;
    figures.fell = metrics.fell != 0;
    if (facts.closed && metrics.early_speed > 0)
        figures.speed_ratio = double(metrics.late_speed) / double(metrics.early_speed);
    figures.began_inside = facts.began_inside;
    figures.unfinished = metrics.unfinished;
    return figures;
}

template PathFigures figures_of<float>(const layout::PathMetrics<float>&, const PathFacts&);
template PathFigures figures_of<double>(const layout::PathMetrics<double>&, const PathFacts&);

} // namespace forceshade
