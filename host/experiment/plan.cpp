#include "host/experiment/plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/experiment/run.h"
#include "host/experiment/statistics.h"
#include "host/random.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade::experiment {
namespace {

constexpr double kPower = 0.8;

// How many of a subject's answers are a certain one: beta-binomial, drawn from its distribution function.
class Counts {
public:
    Counts(double share, unsigned trials) {
        constexpr double kSpread = 1 / kSubjectCorrelation - 1;
        const double a = share * kSpread, b = (1 - share) * kSpread;
        const auto log_beta = [](double x, double y) { return std::lgamma(x) + std::lgamma(y) - std::lgamma(x + y); };
        double below = 0;
        for (unsigned k = 0; k <= trials; ++k) {
            const double ways = -std::log(trials + 1.0) - log_beta(trials - k + 1.0, k + 1.0);
            below += std::exp(ways + log_beta(k + a, trials - k + b) - log_beta(a, b));
            below_.push_back(below);
        }
    }
    /// Of 1.
    double share(Random& random) const {
        const auto count = std::ranges::upper_bound(below_, random.uniform()) - below_.begin();
        const auto trials = static_cast<double>(below_.size() - 1);
        return std::min(static_cast<double>(count), trials) / trials;
    }

private:
    std::vector<double> below_; // the probability of at most so many
};

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
    constexpr double kSignificant = 0.05;
    if (subjects < kLeastSubjects)
        return 0;
    Random random(1, fmt::format("{} {} {} {}", first, second, trials, subjects));
    const Counts of_first(first, trials), of_second(second, trials);
    unsigned found = 0;
    for (unsigned i = 0; i < kExperiments; ++i) {
        std::vector<double> differences;
        for (unsigned subject = 0; subject < subjects; ++subject)
            differences.push_back(of_first.share(random) - of_second.share(random));
        found += sign_flip_p(differences) <= kSignificant;
    }
    return static_cast<double>(found) / kExperiments;
}

Plan planned(const Experiment& experiment, const std::string& first, const std::string& second) {
    if (experiment.spec.task == Task::compare)
        throw UsageError("plan is for task = \"name\"; how many trials a comparison wants, a run with --participant "
                         "observer and its analysis tell");
    make_observer(experiment); // refuses other answers
    const Shares a = expected_answers(condition_named(experiment, first)),
                 b = expected_answers(condition_named(experiment, second));
    std::size_t most = 0;
    for (std::size_t i = 1; i < kPictures; ++i)
        if (std::abs(a[i] - b[i]) > std::abs(a[most] - b[most]))
            most = i;
    Plan plan{first, second, experiment.spec.answers[most].label, a[most], b[most], {}};
    for (const unsigned trials : {6u, 12u, 24u, 48u}) {
        // The fewest: power grows with the subjects but for the noise of its simulation, and few are simulated faster.
        const auto enough = [&](unsigned subjects) { return power_of(a[most], b[most], trials, subjects) >= kPower; };
        unsigned low = kLeastSubjects - 1, high = kLeastSubjects;
        bool any = enough(high);
        for (; !any && high < kMostSubjects; any = enough(high)) {
            low = high;
            high = std::min(2 * high, kMostSubjects);
        }
        while (any && low + 1 < high) {
            const unsigned middle = (low + high) / 2;
            (enough(middle) ? high : low) = middle;
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
