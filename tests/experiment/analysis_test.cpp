// Intervals, tests, adaptive tracks, and the analysis of simulated subjects.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/experiment/run.h"
#include "host/experiment/statistics.h"
#include "host/random.h"
#include "host/study/study_data.h"
#include "tests/io/folder.h"

namespace forceshade::experiment {
namespace {

using forceshade::testing::Folder;
using forceshade::testing::says;

// Brown, Cai & DasGupta 2001, table 5: Jeffreys intervals of 0, 1, 2 and 5 of 10.
TEST(Statistics, JeffreysIntervals) {
    EXPECT_EQ(jeffreys(0, 10).low, 0);
    EXPECT_NEAR(jeffreys(0, 10).high, 0.217, 5e-4);
    EXPECT_NEAR(jeffreys(1, 10).low, 0.011, 5e-4);
    EXPECT_NEAR(jeffreys(1, 10).high, 0.381, 5e-4);
    EXPECT_NEAR(jeffreys(5, 10).low, 0.224, 5e-4);
    EXPECT_NEAR(jeffreys(5, 10).high, 0.776, 5e-4);
    EXPECT_EQ(jeffreys(10, 10).high, 1);
}

TEST(Statistics, SignFlipsAreExactForFewSubjects) {
    EXPECT_EQ(sign_flip_p({1, 2, 3, 4, 5}), 2.0 / 32);
    EXPECT_EQ(sign_flip_p({1, -1}), 1);
    EXPECT_EQ(sign_flip_p({}), 1);
    EXPECT_LT(sign_flip_p(std::vector<double>(40, 1.0)), 1e-3);
}

// As R's t.test(1:9) and p.adjust(c(0.01, 0.04, 0.03, 0.5), "holm") say.
TEST(Statistics, IntervalsOfMeansAndCorrections) {
    EXPECT_TRUE(std::isnan(mean_interval({3}).low));
    const Range range = mean_interval({1, 2, 3, 4, 5, 6, 7, 8, 9});
    EXPECT_NEAR(range.low, 2.894916, 1e-6);
    EXPECT_NEAR(range.high, 7.105084, 1e-6);
    const std::vector<double> corrected = holm({0.01, 0.04, 0.03, 0.5});
    const std::vector<double> expected{0.04, 0.09, 0.09, 0.5};
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_NEAR(corrected[i], expected[i], 1e-12) << i;
}

// Subjects differ: the share of a subject is drawn from a beta distribution, the answers from a binomial one.
double share_of_subject(double share, unsigned trials, std::mt19937_64& random) {
    const double spread = 1 / kSubjectCorrelation - 1;
    std::gamma_distribution<> first(share * spread), second((1 - share) * spread);
    const double a = first(random), own = a / (a + second(random));
    return std::binomial_distribution<unsigned>(trials, own)(random) / double(trials);
}

TEST(Statistics, CoverAndErrAsTheySayIn2000Experiments) {
    std::mt19937_64 random(9);
    constexpr int kExperiments = 2000; // two standard errors are 1 %
    for (const unsigned subjects : {5u, 12u, 20u}) {
        int covered = 0, wrong = 0;
        for (int i = 0; i < kExperiments; ++i) {
            std::vector<double> shares, differences;
            for (unsigned one = 0; one < subjects; ++one) {
                shares.push_back(share_of_subject(0.6, 24, random));
                differences.push_back(shares.back() - share_of_subject(0.6, 24, random));
            }
            const Range range = mean_interval(shares);
            covered += range.low <= 0.6 && 0.6 <= range.high;
            wrong += sign_flip_p(differences) <= 0.05;
        }
        EXPECT_GE(covered, 0.93 * kExperiments) << subjects;
        EXPECT_LE(covered, 0.97 * kExperiments) << subjects;
        EXPECT_LE(wrong, 0.06 * kExperiments) << subjects;
        if (subjects < kLeastSubjects) {
            EXPECT_EQ(wrong, 0) << "no p of so few is small";
        } else {
            EXPECT_GE(wrong, 0.04 * kExperiments) << subjects;
        }
    }
}

// What plan promises, by the test that analyse makes: of simulated experiments of its size 80 % find the difference.
TEST(Statistics, PowerIsThatOfTheAnalysis) {
    std::mt19937_64 random(10);
    for (const unsigned subjects : {8u, 20u}) {
        const double power = power_of(0.7, 0.5, 24, subjects);
        int found = 0;
        for (int i = 0; i < 1000; ++i) {
            std::vector<double> differences;
            for (unsigned one = 0; one < subjects; ++one)
                differences.push_back(share_of_subject(0.7, 24, random) - share_of_subject(0.5, 24, random));
            found += sign_flip_p(differences) <= 0.05;
        }
        EXPECT_NEAR(power, found / 1000.0, 0.07) << subjects;
    }
    EXPECT_EQ(power_of(0.9, 0.1, 24, 5), 0) << "five subjects cannot be significant";
}

// Subjects who do not differ: the ratio is that of a table of two by two, 2 sum O ln(O / E), of one degree of freedom.
TEST(Statistics, LikelihoodRatiosAreThoseOfATableWhereSubjectsAreAlike) {
    EXPECT_EQ(likelihood_ratio_p({}), 1);
    for (const double more : {12.0, 13.0, 14.0, 15.0}) {
        const double less = 24 - more, n = 10;
        const double ratio = 4 * n * (more * std::log(more / 12) + less * std::log(less / 12));
        const double p = std::erfc(std::sqrt(ratio / 2)); // of chi^2, one degree of freedom
        EXPECT_NEAR(likelihood_ratio_p(std::vector<SubjectCounts>(10, {more, 24, less, 24})), p, 0.03) << more;
    }
    // One subject of many leans far: who differ that much say little.
    std::vector<SubjectCounts> lone(6, {12, 24, 12, 24});
    lone[0] = {24, 24, 0, 24};
    EXPECT_GT(likelihood_ratio_p(lone), 0.1) << "0.005 if answers were all independent";
}

TEST(Statistics, LikelihoodRatiosErrAsTheySay) {
    std::mt19937_64 random(4);
    const bool is_long = std::getenv("FORCESHADE_LONG") != nullptr;
    const int experiments = is_long ? 1000 : 120; // two standard errors: 1.4 %; 4 %
    const unsigned bootstraps = is_long ? 199 : 99;
    for (const unsigned subjects : {5u, 12u}) {
        int wrong = 0, found = 0;
        for (int i = 0; i < experiments; ++i) {
            std::vector<SubjectCounts> alike, different;
            for (unsigned one = 0; one < subjects; ++one) {
                alike.push_back(
                    {24 * share_of_subject(0.6, 24, random), 24, 24 * share_of_subject(0.6, 24, random), 24});
                different.push_back(
                    {24 * share_of_subject(0.85, 24, random), 24, 24 * share_of_subject(0.4, 24, random), 24});
            }
            wrong += likelihood_ratio_p(alike, bootstraps) <= 0.05;
            found += likelihood_ratio_p(different, bootstraps) <= 0.05;
        }
        EXPECT_GE(wrong, (is_long ? 0.036 : 0.005) * experiments) << subjects;
        EXPECT_LE(wrong, (is_long ? 0.064 : 0.1) * experiments) << subjects;
        EXPECT_GE(found, 0.9 * experiments) << subjects << ": five are enough for this";
    }
}

TEST(Analysis, OfSimulatedSubjectsFindsTheObserver) {
    const Folder folder;
    const Experiment paper = read_experiment({});
    const auto observer = make_observer(paper);
    for (const char* subject : {"01", "02", "03"})
        run_session(paper, *observer, {folder.path(), {subject, 1, "observer", "simulated"}, false});
    const Answers answers = read_answers({folder.path()});
    EXPECT_EQ(answers.rows.size(), 3u * 504);
    EXPECT_THROW(read_answers({folder.path(), folder.path()}), UsageError) << "the same session twice";
    const study::StudyData data = analyse(answers);
    const study::Table& table = data.table("answers");
    ASSERT_EQ(table.rows.size(), 4u * 21);
    EXPECT_EQ(table.word(0, "condition"), "bump_radius-600mil_facets-1_shading-none") << "as in the paper's Table 2";
    EXPECT_EQ(table.needed(0, "trials"), 72);
    EXPECT_GT(table.needed(0, "flat_percent"), 94);
    // Fitted to answers that it gave itself, each row is within its binomial noise: 63 degrees of freedom less 5.
    const study::Table& parameters = data.table("parameters");
    for (std::size_t row = 0; row < parameters.rows.size(); ++row)
        if (parameters.word(row, "data") == "measured" && parameters.word(row, "model") == "observer" &&
            parameters.word(row, "parameter") == "kappa") {
            EXPECT_LT(parameters.needed(row, "from"), 0.7347);
            EXPECT_GT(parameters.needed(row, "to"), 0.7347);
        }
    const study::Table& fits = data.table("observer");
    for (std::size_t row = 0; row < fits.rows.size(); ++row)
        if (fits.word(row, "data") == "measured" && fits.word(row, "model") == "observer") {
            EXPECT_LT(fits.needed(row, "deviance"), 58 + 4 * std::sqrt(2.0 * 58));
        }
    const study::Table& wide = data.table("wide");
    ASSERT_EQ(wide.rows.size(), 3u * 21);
    double counted = 0;
    for (std::size_t row = 0; row < wide.rows.size(); ++row)
        for (const char* answer : kPictureNames)
            counted += wide.needed(row, std::string("answered_") + answer);
    EXPECT_EQ(counted, 3 * 504);
    EXPECT_FALSE(says(analysis_script(answers), "@")) << "every place is filled in";
    const std::vector<study::TextFile> figures = study::figure_files(data);
    ASSERT_EQ(figures.size(), 2u);
    EXPECT_EQ(figures[0].name, "shares.svg") << "a map over words";
    ASSERT_EQ(data.findings.size(), 3u);
    EXPECT_EQ(data.findings[0].name, "shading");
}

Answers simulated_comparisons(const std::string& more) {
    const Folder folder;
    const Experiment one = parse_experiment("[experiment]\ntask = \"compare\"\nstandard = \"cylinder_bump\"\n" + more +
                                                "[surface]\nradius = \"1000 mil\"\n[[variant]]\nsurface.kind = "
                                                "\"cylinder_bump\"\n[[variant]]\nsurface.kind "
                                                "= \"bump\"\nsurface.facets = [3, 5, 7, 9, 13, 17, 25]\n",
                                            "e.toml");
    const auto observer = make_observer(one);
    for (const char* subject : {"01", "02"})
        run_session(one, *observer, {folder.path(), {subject, 1, "observer", "simulated"}, false});
    return read_answers({folder.path()});
}

// Few facets are told from the cylinder, many are not.
TEST(Analysis, OfComparisonsHasSharesOfRightAnswers) {
    const study::StudyData data = analyse(simulated_comparisons("trials = 40\n"));
    const study::Table& table = data.table("comparisons");
    ASSERT_EQ(table.rows.size(), 3u * 7);
    EXPECT_EQ(table.word(0, "subject"), "all");
    EXPECT_EQ(table.needed(0, "trials"), 80);
    EXPECT_GT(table.needed(0, "right_from_percent"), 75) << "three facets";
    EXPECT_LT(table.needed(6, "right_percent"), table.needed(0, "right_from_percent")) << "25";
    EXPECT_NEAR(table.needed(0, "right_percent") + table.needed(0, "stimulus_percent"), 100, 1e-9)
        << "the standard is right";
    EXPECT_EQ(study::figure_files(data).size(), 1u);
    EXPECT_EQ(data.findings.at(0).name, "right");
}

TEST(Analysis, OfTracksHasThresholds) {
    const study::StudyData data = analyse(simulated_comparisons("trials = 60\ntrack = \"facets\"\n"));
    const study::Table& thresholds = data.table("thresholds");
    ASSERT_EQ(thresholds.rows.size(), 3u);
    for (std::size_t row = 0; row < 3; ++row) {
        EXPECT_EQ(thresholds.needed(row, "trials"), row == 0 ? 120 : 60);
        EXPECT_LT(thresholds.needed(row, "from"), thresholds.needed(row, "threshold"));
        EXPECT_LT(thresholds.needed(row, "threshold"), thresholds.needed(row, "to"));
    }
    EXPECT_GT(thresholds.needed(0, "threshold"), 3) << "as the observer's shares of right answers say: 9 in 10 at 3";
    EXPECT_LT(thresholds.needed(0, "threshold"), 20);
    const auto ratio = [&](std::size_t row) { return thresholds.needed(row, "to") / thresholds.needed(row, "from"); };
    EXPECT_LT(ratio(0), std::max(ratio(1), ratio(2))) << "of twice as many trials";
    EXPECT_EQ(data.table("tracks").rows.size(), 120u);
    EXPECT_EQ(study::figure_files(data).size(), 3u);
    ASSERT_EQ(data.findings.size(), 1u);
    EXPECT_EQ(data.findings[0].text.find("Threshold of surface.facets: "), 0u) << data.findings[0].text;
}

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

// Truths a little beyond the levels on either side: the answers favour the end of the prior, which is widened.
TEST(ThresholdTracks, CoverTheTruthBeyondTheLevels) {
    constexpr unsigned kRuns = 200;
    const double span = std::log(kLevels.back() / kLevels.front());
    unsigned covered = 0, inside = 0;
    for (std::uint64_t run = 1; run <= kRuns; ++run) {
        Truth truth = truth_of(run);
        Random random(run, "beyond");
        const double off = span * (0.1 + 0.3 * random.uniform());
        truth.threshold = run % 4 < 2 ? kLevels.front() * std::exp(-off) : kLevels.back() * std::exp(off);
        const Threshold one = found(truth, run, adaptive);
        covered += one.range.low <= truth.threshold && truth.threshold <= one.range.high;
        inside += one.median > kLevels.front() && one.median < kLevels.back();
    }
    EXPECT_GE(covered, 180u);
    EXPECT_LE(inside, 20u) << "are said to be within the levels";
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
