#include "host/study/findings/number_findings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::study {
namespace {

constexpr double kFine = 1e-6;     /* of the largest force */
constexpr double kPromised = 1e-4; /* likewise */
constexpr double kLost = 1e-2;     /* likewise: no longer of use */
constexpr double kBlurred = 0.1;   /* of the difference of two neighbours */

struct Worst {
    std::optional<std::size_t> row;
    double value = -1;
};

/// The row with the largest number in a column, of those that `counts`.
template <typename Counts> Worst largest(const Table& number, const char* column, const Counts& counts) {
    Worst worst;
    for (std::size_t row = 0; row < number.rows.size(); ++row)
        if (const auto value = number.number(row, column); value && counts(row) && *value > worst.value)
            worst = {row, *value};
    return worst;
}

/// The range of an axis in which every surface keeps the accuracy, and which surfaces end it.
struct Common {
    double low = -1, high = -1;  /* below 0: none known */
    std::string low_by, high_by; /* empty: as far as was tried */
    bool nowhere = false;
};

Common common_range(const Table& promises, const std::string& axis, const std::string& precision, double accuracy) {
    Common common;
    double tried_low = -1, tried_high = -1;
    for (std::size_t row = 0; row < promises.rows.size(); ++row) {
        if (promises.word(row, "axis") != axis || promises.word(row, "precision") != precision ||
            promises.number(row, "accuracy") != accuracy)
            continue;
        const std::string surface = promises.word(row, "surface");
        const auto low = promises.number(row, "low"), high = promises.number(row, "high");
        const double least = *promises.number(row, "tried_low"), most = *promises.number(row, "tried_high");
        tried_low = tried_low < 0 ? least : std::min(tried_low, least);
        tried_high = std::max(tried_high, most);
        if (!low || !high) {
            common.nowhere = true;
            common.low_by = surface;
            return common;
        }
        if (*low > least && *low > common.low) {
            common.low = *low;
            common.low_by = surface;
        }
        if (*high < most && (common.high_by.empty() || *high < common.high)) {
            common.high = *high;
            common.high_by = surface;
        }
    }
    common.low = common.low_by.empty() ? tried_low : common.low;
    common.high = common.high_by.empty() ? tried_high : common.high;
    return common;
}

/// An axis as readers call it, with its unit after a space where it has one.
struct AxisWords {
    const char* axis;
    const char* name;
    const char* unit;
};

constexpr AxisWords kAxisWords[] = {{"radius_ratio", "R/a", ""},
                                    {"stiffness", "stiffness", " N/m"},
                                    {"spacing", "spacing", " m"},
                                    {"depth", "depth", " m"},
                                    {"origin", "distance from the origin", " m"}};

AxisWords words_of(const std::string& axis) {
    for (const AxisWords& one : kAxisWords)
        if (axis == one.axis)
            return one;
    return {axis.c_str(), axis.c_str(), ""};
}

std::string text_of(const Common& common, const char* unit) {
    if (common.nowhere)
        return fmt::format("not at the plain value ({})", common.low_by);
    const auto end = [&](double value, const std::string& by) {
        return by.empty() ? fmt::format("{:g}{}", value, unit) : fmt::format("{:g}{} ({})", value, unit, by);
    };
    return fmt::format("{} to {}", end(common.low, common.low_by), end(common.high, common.high_by));
}

/// Ranges of promised accuracy: of one precision.
void add_promise(const StudyData& data, const char* precision, std::vector<Finding>& findings) {
    const Table* promises = data.find("promises");
    if (!promises)
        return;
    std::vector<std::string> ranges, axes;
    for (std::size_t row = 0; row < promises->rows.size(); ++row) {
        const std::string axis = promises->word(row, "axis");
        if (promises->word(row, "precision") != precision || std::ranges::count(axes, axis))
            continue;
        axes.push_back(axis);
        const AxisWords words = words_of(axis);
        ranges.push_back(
            fmt::format("{} {}", words.name, text_of(common_range(*promises, axis, precision, kPromised), words.unit)));
    }
    if (!ranges.empty())
        findings.push_back(
            {fmt::format("promise_{}", precision),
             fmt::format("{} keeps every force to {:g} of the largest for (one parameter varied, in brackets the "
                         "surface that ends the range): {}.",
                         precision, kPromised, fmt::join(ranges, "; "))});
}

/// For each axis the values nearest to the plain one at which f32 is lost, with the condition.
void add_failures(const Table& number, std::vector<Finding>& findings) {
    std::vector<std::string> failures, axes;
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        const std::string axis = number.word(row, "axis");
        if (number.word(row, "precision") != "f32" || std::ranges::count(axes, axis))
            continue;
        axes.push_back(axis);
        const Worst worst = largest(number, "error", [&](std::size_t one) {
            return number.word(one, "precision") == "f32" && number.word(one, "axis") == axis;
        });
        if (!worst.row || worst.value <= kFine)
            continue;
        const AxisWords words = words_of(axis);
        failures.push_back(fmt::format("over {} up to {:.1g} ({} at {:g}{}; {})", words.name, worst.value,
                                       number.word(*worst.row, "surface"), *number.number(*worst.row, "value"),
                                       words.unit, number.word(*worst.row, "condition")));
    }
    findings.push_back(
        {"where_f32_fails",
         failures.empty()
             ? fmt::format("Single precision is nowhere off by more than {:g} of the largest force.", kFine)
             : fmt::format("Single precision is off by more than {:g} of the largest force {}.", kFine,
                           fmt::join(failures, "; "))});
}

void add_refusals(const Table& number, std::vector<Finding>& findings) {
    std::size_t refused = 0, lost = 0;
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        refused += number.word(row, "refused").empty() ? 0 : 1;
        const auto error = number.number(row, "error");
        lost += number.word(row, "refused").empty() && (!error || *error > kLost) ? 1 : 0;
    }
    findings.push_back(
        {"refused", fmt::format("Of {} settings {} are refused with a message since a number leaves the precision; {} "
                                "are evaluated with forces off by more than {:g} of the largest.",
                                number.rows.size(), refused, lost, kLost)});
}

void add_prediction(const Table& number, std::vector<Finding>& findings) {
    const Worst most = largest(number, "of_predicted", [](std::size_t) { return true; });
    if (!most.row)
        return;
    const std::string place = fmt::format("{}, {} = {:g}", number.word(*most.row, "series"),
                                          number.word(*most.row, "axis"), *number.number(*most.row, "value"));
    findings.push_back({"prediction", most.value <= 1
                                          ? fmt::format("The formulas of the conditions explain every error: the "
                                                        "largest is {:.2g} of what they give ({}).",
                                                        most.value, place)
                                          : fmt::format("Not every error is explained by the formulas of the "
                                                        "conditions: the largest is {:.2g} times what they give ({}).",
                                                        most.value, place)});
}

/// From the finest spacing upwards, the last one at which a surface's differences are lost.
void add_steps(const Table& number, std::vector<Finding>& findings) {
    std::optional<double> blurred; /* m */
    std::string surface;
    bool any = false;
    std::vector<std::string> clear; /* surfaces that have come to a spacing at which steps are good */
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        const auto step = number.number(row, "step_error");
        if (number.word(row, "axis") != "spacing" || number.word(row, "precision") != "f32" || !step)
            continue;
        any = true;
        const std::string here = number.word(row, "surface");
        if (*step <= kBlurred)
            clear.push_back(here);
        const double spacing = *number.number(row, "value");
        if (*step <= kBlurred || std::ranges::count(clear, here) || (blurred && spacing <= *blurred))
            continue;
        blurred = spacing;
        surface = here;
    }
    if (!any)
        return;
    findings.push_back(
        {"steps", blurred
                      ? fmt::format("However fine the grid, each force stays good, but the difference of two "
                                    "neighbouring samples is off by more than {:g} of itself in single precision up "
                                    "to a spacing of {:g} m ({}): rounding of place and depth is then as large.",
                                    kBlurred, *blurred, surface)
                      : fmt::format("The difference of two neighbouring samples is good to {:g} of itself in "
                                    "single precision at every spacing tried.",
                                    kBlurred)});
}

} // namespace

std::vector<Finding> number_findings(const StudyData& data) {
    std::vector<Finding> findings;
    const Table* number = data.find("number");
    if (!number || number->rows.empty())
        return findings;
    add_promise(data, "f32", findings);
    add_promise(data, "f64", findings);
    add_failures(*number, findings);
    add_prediction(*number, findings);
    add_steps(*number, findings);
    add_refusals(*number, findings);
    return findings;
}

} // namespace forceshade::study
