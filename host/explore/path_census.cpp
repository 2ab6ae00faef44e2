#include "host/explore/path_census.h"

#include <cmath>

#include <fmt/format.h>

namespace forceshade {
namespace {

constexpr double kTolerance = 0.01; // of the period

} // namespace

std::size_t PathCensus::add(const PathSample& sample) {
    if (ids_.empty() || ids_[last_] != sample.path) { // most samples go on with the same path
        const auto [known, added] = numbers_.try_emplace(sample.path, ids_.size());
        last_ = known->second;
        if (added) {
            ids_.push_back(sample.path);
            times_.push_back(sample.time);
            return last_;
        }
        if (!first_return_)
            first_return_ = sample.line;
    }
    check_time(sample, times_[last_]);
    times_[last_] = sample.time;
    return last_;
}

void PathCensus::check_time(const PathSample& sample, double before) const {
    const double passed = sample.time - before;
    if (!(passed > 0))
        fail(source_, {sample.line, 1},
             fmt::format("t: {} s comes after {} s on path {}: times of a path must increase", sample.time, before,
                         sample.path));
    if (period_ > 0 && !(std::abs(passed - period_) <= kTolerance * period_))
        fail(source_, {sample.line, 1},
             fmt::format("t: {} s is {:.4g} s after the sample before it on path {}; a hand moves the probe in steps "
                         "of {:.4g} s (paths.rate): give that rate, or resample",
                         sample.time, passed, sample.path, period_));
}

} // namespace forceshade
