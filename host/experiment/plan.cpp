#include "host/experiment/plan.h"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/experiment/random.h"
#include "host/experiment/run.h"
#include "host/scene/value.h"

namespace forceshade::experiment {
namespace {

constexpr double kPower = 0.8;

// A subject's share of an answer in so many trials.
double drawn_share(double share, unsigned trials, Random& random) {
    constexpr double kSpread = 1 / kSubjectCorrelation - 1;
    const double leaning =
        boost::math::quantile(boost::math::beta_distribution<>(share * kSpread, (1 - share) * kSpread),
                              std::clamp(random.uniform(), 1e-9, 1 - 1e-9));
    unsigned count = 0;
    for (unsigned i = 0; i < trials; ++i)
        count += random.uniform() < leaning;
    return static_cast<double>(count) / trials;
}

const Case& condition_named(const Experiment& experiment, const std::string& name) {
    std::vector<std::string> names;
    for (const Case& one : experiment.study.cases) {
        if (one.name == name)
            return one;
        names.push_back(one.name);
    }
    throw UsageError(fmt::format("--compare: no condition \"{}\"{}; there are {}", name, did_you_mean(name, names),
                                 fmt::join(names, ", ")));
}

Shares expected_answers(const Case& stimulus) {
    const PreparedCase prepared = CasePreparation().prepare(stimulus);
    return answer_shares(passes_over(feature_of(prepared), stroke(prepared, manner_of(stimulus.scene))), {});
}

} // namespace

double power_of(double first, double second, unsigned trials, unsigned subjects) {
    constexpr unsigned kExperiments = 1000;
    constexpr double kSides = 0.025;
    if (subjects < 2)
        return 0;
    Random random(1, fmt::format("{} {} {} {}", first, second, trials, subjects));
    const double limit =
        boost::math::quantile(boost::math::complement(boost::math::students_t(subjects - 1.0), kSides));
    unsigned found = 0;
    for (unsigned i = 0; i < kExperiments; ++i) {
        double sum = 0, squares = 0;
        for (unsigned subject = 0; subject < subjects; ++subject) {
            const double d = drawn_share(first, trials, random) - drawn_share(second, trials, random);
            sum += d;
            squares += d * d;
        }
        const double mean = sum / subjects, variance = std::max(0.0, squares / subjects - mean * mean);
        found += std::abs(mean) > limit * std::sqrt(variance / (subjects - 1)) && mean != 0;
    }
    return static_cast<double>(found) / kExperiments;
}

Plan planned(const Experiment& experiment, const std::string& first, const std::string& second) {
    make_observer(experiment); // refuses other answers
    const Shares a = expected_answers(condition_named(experiment, first)),
                 b = expected_answers(condition_named(experiment, second));
    std::size_t most = 0;
    for (std::size_t i = 1; i < kPictures; ++i)
        if (std::abs(a[i] - b[i]) > std::abs(a[most] - b[most]))
            most = i;
    Plan plan{first, second, experiment.spec.answers[most].label, a[most], b[most], {}};
    for (const unsigned trials : {6u, 12u, 24u, 48u}) {
        // The fewest: power grows with the subjects but for the noise of its simulation.
        unsigned low = 1, high = kMostSubjects;
        const bool any = power_of(a[most], b[most], trials, high) >= kPower;
        while (any && low + 1 < high) {
            const unsigned middle = (low + high) / 2;
            (power_of(a[most], b[most], trials, middle) >= kPower ? high : low) = middle;
        }
        plan.needed.push_back({trials, any ? std::optional(high) : std::nullopt});
    }
    return plan;
}

std::vector<std::pair<std::string, std::string>> natural_pairs(const Experiment& experiment) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const Case& shaded : experiment.study.cases) {
        Scene bare = shaded.scene;
        bare.force.shading = Shading::none;
        for (const Case& other : experiment.study.cases)
            if (shaded.scene.force.shading != Shading::none && other.scene == bare)
                pairs.emplace_back(shaded.name, other.name);
    }
    return pairs;
}

} // namespace forceshade::experiment
