// Adaptive tracks against answers drawn from a known psychometric function.
#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "host/random.h"
#include "host/experiment/threshold.h"

namespace forceshade::experiment {
namespace {

const std::vector<double> kLevels{2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64};
constexpr unsigned kTrials = 60;

struct Truth {
    double threshold, spread, lapse;
    bool rises;

    double right(double level) const {
        const double easier = (std::log(level) - std::log(threshold)) / spread;
        return 0.5 + (0.5 - lapse) / (1 + std::exp(rises ? -easier : easier));
    }
};

using Choice = std::function<std::size_t(const ThresholdTrack&, unsigned trial)>;

Threshold found(const Truth& truth, std::uint64_t run, const Choice& choose) {
    ThresholdTrack track(kLevels, truth.rises);
    Random random(run, "answers");
    for (unsigned trial = 0; trial < kTrials; ++trial) {
        const std::size_t level = choose(track, trial);
        track.add(level, random.uniform() < truth.right(kLevels[level]));
    }
    return track.threshold();
}

std::size_t adaptive(const ThresholdTrack& track, unsigned) {
    return track.next();
}
std::size_t fixed(const ThresholdTrack&, unsigned trial) {
    return trial % kLevels.size();
}

// 200 runs in which the truth differs, within the levels.
Truth truth_of(std::uint64_t run) {
    Random random(run, "truth");
    return {std::exp(std::lerp(std::log(3.0), std::log(45.0), random.uniform())), 0.2 + 0.5 * random.uniform(), 0.02,
            run % 2 == 0};
}

TEST(ThresholdTracks, CoverTheTruthInAbout95PercentAndErrLessThanFixedLevels) {
    constexpr unsigned kRuns = 200;
    unsigned covered = 0;
    double error = 0, fixed_error = 0, width = 0, fixed_width = 0; // of ln threshold
    for (std::uint64_t run = 1; run <= kRuns; ++run) {
        const Truth truth = truth_of(run);
        const Threshold one = found(truth, run, adaptive), other = found(truth, run, fixed);
        covered += one.range.low <= truth.threshold && truth.threshold <= one.range.high;
        error += std::abs(std::log(one.median / truth.threshold)) / kRuns;
        fixed_error += std::abs(std::log(other.median / truth.threshold)) / kRuns;
        width += std::log(one.range.high / one.range.low) / kRuns;
        fixed_width += std::log(other.range.high / other.range.low) / kRuns;
    }
    // Binomial: 190 of 200 expected, standard deviation 3.1.
    EXPECT_GE(covered, 180u);
    EXPECT_LE(covered, 199u) << "an interval that always covers says nothing";
    EXPECT_LT(error, 0.8 * fixed_error) << error << " against " << fixed_error;
    EXPECT_LT(width, 0.9 * fixed_width) << width << " against " << fixed_width;
}

TEST(ThresholdTracks, FollowTheSideOnWhichLevelsAreEasy) {
    for (const bool rises : {true, false}) {
        ThresholdTrack track(kLevels, rises);
        const std::size_t first = track.next();
        for (int i = 0; i < 6; ++i)
            track.add(track.next(), true);
        EXPECT_EQ(track.next() < first, rises) << "all right: on to what is harder";
        EXPECT_EQ(track.share_right(64) > track.share_right(2), rises);
        EXPECT_GT(track.share_right(rises ? 64 : 2), 0.9);
        EXPECT_GT(track.share_right(rises ? 2 : 64), 0.5);
    }
}

} // namespace
} // namespace forceshade::experiment
