#include "host/experiment/observer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <nlopt.hpp>

#include "host/error.h"
#include "host/random.h"

namespace forceshade::experiment {
namespace {

constexpr std::array<FreeParameter, 4> kWeberParameters{
    {{"kappa", "jump of the lateral force ratio for an expected edge", &ObserverParameters::edge},
     {"g", "events of a wholly level bump", &ObserverParameters::level_gain},
     {"w", "weight of the path against the force", &ObserverParameters::path_weight},
     {"W", "Weber fraction: just noticeable share of a force", &ObserverParameters::weber}}};
constexpr std::array<FreeParameter, 5> kOlderParameters{
    {kWeberParameters[0],
     kWeberParameters[1],
     kWeberParameters[2],
     {"nu", "noise of the force's direction", &ObserverParameters::weber},
     {"rho", "threshold for level; of base-kinks b, its gain of kinks at the base", &ObserverParameters::level}}};

ObserverParameters with_logarithms(ObserverParameters observer, const std::vector<double>& logarithms) {
    const auto parameters = free_parameters(observer.model);
    for (std::size_t i = 0; i < parameters.size(); ++i)
        observer.*parameters[i].member = std::exp(logarithms[i]);
    return observer;
}

std::vector<double> logarithms_of(const ObserverParameters& observer) {
    std::vector<double> logarithms;
    for (const FreeParameter& one : free_parameters(observer.model))
        logarithms.push_back(std::log(observer.*one.member));
    return logarithms;
}

// Nelder-Mead in logarithms; the deviance that it reached.
double search_from(std::span<const ConditionAnswers> rows, ObserverParameters& observer, double tolerance) {
    std::function<double(const std::vector<double>&)> cost = [&](const std::vector<double>& logarithms) {
        return deviance(rows, with_logarithms(observer, logarithms));
    };
    nlopt::opt search(nlopt::LN_NELDERMEAD, static_cast<unsigned>(free_parameters(observer.model).size()));
    search.set_min_objective(
        [](const std::vector<double>& at, std::vector<double>&, void* data) {
            return (*static_cast<std::function<double(const std::vector<double>&)>*>(data))(at);
        },
        &cost);
    const double low = std::log(1e-4), high = std::log(1e3);
    search.set_lower_bounds(low);
    search.set_upper_bounds(high);
    search.set_xtol_rel(tolerance);
    search.set_maxeval(1500);
    std::vector<double> at = logarithms_of(observer);
    for (double& one : at)
        one = std::clamp(one, low, high);
    double reached = 0;
    search.optimize(at, reached);
    observer = with_logarithms(observer, at);
    return reached;
}

std::vector<std::string> groups_of(std::span<const ConditionAnswers> rows, LeftOut left_out) {
    std::vector<std::string> groups;
    for (const ConditionAnswers& row : rows)
        if (std::ranges::find(groups, row.*left_out) == groups.end())
            groups.push_back(row.*left_out);
    return groups;
}

Prediction predicted(std::span<const ConditionAnswers> rows, LeftOut left_out,
                     const std::function<std::vector<Shares>(const std::string& group)>& without) {
    Prediction prediction;
    prediction.expected.resize(rows.size());
    for (const std::string& group : groups_of(rows, left_out)) {
        const std::vector<Shares> expected = without(group);
        double sum = 0;
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (rows[i].*left_out == group) {
                prediction.expected[i] = expected[i];
                sum += deviance(rows[i], expected[i]);
            }
        prediction.by_group.emplace_back(group, sum);
        prediction.deviance += sum;
    }
    prediction.error = mean_error(rows, prediction.expected);
    return prediction;
}

} // namespace

std::vector<ConditionAnswers> table_2() {
    struct Printed {
        const char* name;
        unsigned facets; // 0: the cylinder
        bool shaded;
        std::array<std::array<double, kPictures>, 3> percent; // 600, 1000, 1400 mil
    };
    static constexpr Printed kRows[] = {
        {"flat_unshaded", 1, false, {{{99, 1, 0, 0}, {96, 1, 1, 3}, {100, 0, 0, 0}}}},
        {"two_poly_unshaded", 2, false, {{{0, 79, 3, 19}, {1, 53, 3, 43}, {8, 47, 1, 44}}}},
        {"three_poly_unshaded", 3, false, {{{0, 3, 92, 6}, {0, 3, 86, 10}, {0, 7, 87, 6}}}},
        {"cylinder", 0, false, {{{0, 7, 19, 75}, {0, 9, 3, 88}, {0, 6, 0, 94}}}},
        {"flat_shaded", 1, true, {{{2, 3, 38, 57}, {3, 11, 29, 57}, {2, 14, 36, 48}}}},
        {"two_poly_shaded", 2, true, {{{0, 35, 16, 48}, {0, 12, 2, 87}, {1, 6, 8, 85}}}},
        {"three_poly_shaded", 3, true, {{{1, 3, 39, 57}, {1, 3, 15, 81}, {0, 7, 8, 86}}}}};
    constexpr int kRadii[] = {600, 1000, 1400}; // mil
    std::vector<ConditionAnswers> rows;
    for (const Printed& printed : kRows)
        for (std::size_t i = 0; i < 3; ++i) {
            ConditionAnswers row{printed.name, std::to_string(kRadii[i]) + " mil",
                                 rigid_signals(kRadii[i] * kMil, 1000 * kMil, printed.facets, printed.shaded),
                                 printed.percent[i], 120};
            double sum = 0;
            for (const double share : row.answered)
                sum += share;
            for (double& share : row.answered)
                share /= sum;
            rows.push_back(std::move(row));
        }
    return rows;
}

double deviance(const ConditionAnswers& row, const Shares& expected) {
    double sum = 0;
    for (std::size_t i = 0; i < kPictures; ++i)
        if (row.answered[i] > 0)
            sum += 2 * row.trials * row.answered[i] * std::log(row.answered[i] / expected[i]);
    return sum;
}

double deviance(std::span<const ConditionAnswers> rows, const ObserverParameters& observer) {
    double sum = 0;
    for (const ConditionAnswers& row : rows)
        sum += deviance(row, shares_of(row.signals, observer));
    return sum;
}

double mean_error(std::span<const ConditionAnswers> rows, const std::vector<Shares>& expected) {
    double sum = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t picture = 0; picture < kPictures; ++picture)
            sum += std::abs(rows[i].answered[picture] - expected[i][picture]);
    return rows.empty() ? 0 : 100 * sum / static_cast<double>(kPictures * rows.size());
}

std::span<const FreeParameter> free_parameters(ObserverModel model) {
    switch (model) {
    case ObserverModel::weber:
        return std::span(kWeberParameters).first(3);
    case ObserverModel::weber_fitted:
        return kWeberParameters;
    default:
        return kOlderParameters;
    }
}

ObserverParameters observer_of(const ObserverParameters& mean, std::string_view subject) {
    Random random(1996, subject);
    ObserverParameters observer = mean;
    for (const FreeParameter& one : free_parameters(mean.model)) {
        const double size = random.uniform(), turn = random.uniform();
        const double normal =
            std::sqrt(-2 * std::log(1 - size)) * std::cos(2 * std::numbers::pi * turn); // Box & Muller 1958
        observer.*one.member *= std::exp(kSubjectSpread * normal);
    }
    return observer;
}

ObserverParameters fitted(std::span<const ConditionAnswers> rows, const ObserverParameters& start) {
    if (rows.empty())
        throw UsageError("there are no answers to fit the observer to");
    constexpr double kTolerance = 1e-6;
    ObserverParameters best;
    double least = INFINITY;
    for (const double factor : {1.0, 0.5, 2.0}) {
        ObserverParameters observer = start;
        bool up = true;
        for (const FreeParameter& one : free_parameters(start.model)) {
            observer.*one.member *= up ? factor : 1 / factor;
            up = !up;
        }
        const double reached = search_from(rows, observer, kTolerance);
        if (reached < least) {
            best = observer;
            least = reached;
        }
    }
    return best;
}

ObserverRange bootstrapped(std::span<const ConditionAnswers> rows, const ObserverParameters& best) {
    constexpr std::size_t kSamples = 200;
    constexpr double kTolerance = 1e-3;
    const auto parameters = free_parameters(best.model);
    const double freedom = double(rows.size() * (kPictures - 1)) - double(parameters.size());
    ObserverRange range{best, best, freedom > 0 ? std::max(1.0, deviance(rows, best) / freedom) : 1};
    Random random(1, "bootstrap of the observer");
    std::vector<std::vector<double>> values(parameters.size());
    for (std::size_t sample = 0; sample < kSamples; ++sample) {
        std::vector<ConditionAnswers> drawn(rows.begin(), rows.end());
        for (ConditionAnswers& row : drawn) {
            const Shares shares = shares_of(row.signals, best);
            row.trials = std::max(1.0, std::round(row.trials / range.dispersion));
            row.answered = {};
            for (double i = 0; i < row.trials; ++i)
                row.answered[random.among(shares)] += 1 / row.trials;
        }
        ObserverParameters observer = best;
        search_from(drawn, observer, kTolerance);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i].push_back(observer.*parameters[i].member);
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::ranges::sort(values[i]);
        range.low.*parameters[i].member = values[i][kSamples / 40];
        range.high.*parameters[i].member = values[i][kSamples - 1 - kSamples / 40];
    }
    return range;
}

Prediction predicted_by_observer(std::span<const ConditionAnswers> rows, const ObserverParameters& start,
                                 LeftOut left_out) {
    return predicted(rows, left_out, [&](const std::string& group) {
        std::vector<ConditionAnswers> others;
        std::ranges::copy_if(rows, std::back_inserter(others),
                             [&](const ConditionAnswers& row) { return row.*left_out != group; });
        const ObserverParameters observer = fitted(others, start);
        std::vector<Shares> expected;
        for (const ConditionAnswers& row : rows)
            expected.push_back(shares_of(row.signals, observer));
        return expected;
    });
}

Prediction predicted_by_means(std::span<const ConditionAnswers> rows) {
    return predicted(rows, &ConditionAnswers::group, [&](const std::string& group) {
        constexpr double kAdded = 0.5; // answers
        std::vector<Shares> expected;
        for (const ConditionAnswers& row : rows) {
            Shares sum;
            sum.fill(kAdded);
            double all = kAdded * kPictures;
            for (const ConditionAnswers& other : rows)
                if (other.name == row.name && other.group != group) {
                    for (std::size_t i = 0; i < kPictures; ++i)
                        sum[i] += other.trials * other.answered[i];
                    all += other.trials;
                }
            for (double& share : sum)
                share /= all;
            expected.push_back(sum);
        }
        return expected;
    });
}

} // namespace forceshade::experiment
