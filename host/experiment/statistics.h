// Intervals and tests of answers: shares of trials, differences between conditions with subjects as clusters, and a
// threshold looked for adaptively.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/random.h"

namespace forceshade::experiment {

struct Range {
    double low = 0, high = 0;
};

/// 95 % of a share of `count` of `all` trials (Jeffreys; Brown, Cai & DasGupta 2001): 0 or 1 where all are alike.
Range jeffreys(double count, double all);

/// 95 % interval of the mean of values, one a subject (Student's t); no numbers for less than two.
Range mean_interval(const std::vector<double>& values);

/// The share of all changes of signs with a mean as far from 0 as that of the values, one a subject, or farther: two
/// sides. All 2^n of up to 14 subjects, else 16 384 drawn. 1 without values.
double sign_flip_p(const std::vector<double>& values);

/// The fewest subjects of whom changes of signs can be significant (5 %): p is no less than 2^(1 - n).
inline constexpr unsigned kLeastSubjects = 6;

/// How many of a subject's answers are a certain one, where subjects differ: drawn from its distribution function.
class BetaBinomial {
public:
    /// `share`: of 1, the mean over subjects; `correlation`: of two answers of a subject.
    BetaBinomial(double share, double correlation, unsigned trials);
    unsigned operator()(Random& random) const;

private:
    std::vector<double> below_; // by count: the probability of that many or fewer
};

/// A subject's answers to two groups of conditions: how many of how many are a certain one.
struct SubjectCounts {
    double more = 0, of_more = 0, less = 0, of_less = 0;
};

/// Of a beta-binomial model (a Dirichlet-multinomial one of two answers), whose parameters are the share in each group
/// and the correlation of a subject's answers to one: p of the likelihood ratio of different shares against equal
/// ones, by maximum likelihood, among the ratios of `bootstraps` experiments that are drawn from the fit of equal ones.
/// A subject's shares in both groups are taken for independent: where subjects lean to one side in both, the test finds
/// less than there is, where they lean to opposite sides more. 1 without answers.
double likelihood_ratio_p(const std::vector<SubjectCounts>& subjects, unsigned bootstraps = 999);

/// What the tests' p become where any of them may be the one that is reported (Holm 1979), in the same order.
std::vector<double> holm(const std::vector<double>& p);

/// What the trials so far say, in the unit of the levels.
struct Threshold {
    double median = 0; /* of the posterior: the level half way between chance and what lapses leave */
    Range range;       /* 95 %, credible */
    int beyond = 0;    /* -1: likely below all thresholds that are considered, 1: above them, and so without a bound */
};

/// The posterior over a grid of psychometric functions, logistic in the logarithm of the level: right with the
/// probability 1/2 + (1/2 - lapse) / (1 + exp(-(ln level - ln threshold) / spread)), mirrored where it falls. Prior:
/// ln threshold uniform from a quarter of the levels' range below them to as much above; ln spread uniform from 1/30 to
/// 1/3 of the range; lapse 0 to 6 %. Where the answers favour a threshold at the end of that, it is widened there, to
/// one and a half ranges beyond the levels at most.
class ThresholdTrack {
public:
    /// `levels`: positive, ascending, at least two. `rises`: whether higher levels are easier.
    ThresholdTrack(const std::vector<double>& levels, bool rises);

    /// The answer to a trial at a level (its index).
    void add(std::size_t level, bool right);

    /// The index of the level whose answer leaves the least entropy to be expected.
    std::size_t next() const;

    Threshold threshold() const;

    /// The posterior's mean share of right answers at any level.
    double share_right(double level) const;

private:
    void lay_grid();
    void learn(std::size_t level, bool right);
    bool is_informed() const;
    bool favours(bool high) const;
    double weight_of(std::size_t threshold) const;
    double right(std::size_t parameters, double x) const;

    struct Answers {
        unsigned right = 0, wrong = 0;
    };
    std::vector<double> x_;        // ln level
    std::vector<Answers> answers_; // by level
    double below_, above_;         // of the levels' range, beyond it: thresholds
    bool rises_;
    std::vector<double> thresholds_, spreads_; // ln level
    std::vector<double> weights_;              // by threshold, spread, lapse; their sum is 1
    std::vector<std::vector<double>> right_;   // by level and weight
    std::vector<std::vector<double>> entropy_; // likewise: of the answer
};

} // namespace forceshade::experiment
