#include "host/study/stability/number_findings.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// The range of an axis in which every surface that was tried there keeps the accuracy, and which surfaces end it.
struct Common {
    double low = 0, high = 0;
    std::string low_by, high_by; /* empty: as far as was tried */
    bool nowhere = false;
};

/// Takes an end of a surface's range where it is narrower than what is known, or as narrow and no mere end of trying.
void narrow(double& end, std::string& by, bool narrower, double value, bool tried, const std::string& surface) {
    if (narrower || (value == end && by.empty() && !tried)) {
        end = value;
        by = tried ? std::string() : surface;
    }
}

Common common_range(const Table& promises, const std::string& axis, const std::string& precision, double accuracy) {
    Common common;
    bool any = false;
    for (std::size_t row = 0; row < promises.rows.size(); ++row) {
        if (promises.word(row, "axis") != axis || promises.word(row, "precision") != precision ||
            promises.number(row, "accuracy") != accuracy)
            continue;
        const std::string surface = promises.word(row, "surface");
        const auto low = promises.number(row, "low"), high = promises.number(row, "high");
        if (!low || !high) {
            common.nowhere = true;
            common.low_by = surface;
            return common;
        }
        narrow(common.low, common.low_by, !any || *low > common.low, *low, *low <= promises.needed(row, "tried_low"),
               surface);
        narrow(common.high, common.high_by, !any || *high < common.high, *high,
               *high >= promises.needed(row, "tried_high"), surface);
        any = true;
    }
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
             fmt::format("{} keeps every force to {:g} of the largest for (one parameter varied; in brackets the "
                         "surface that ends the range, without them it was not tried further): {}.",
                         precision, kPromised, fmt::join(ranges, "; "))});
}

/// A row that was evaluated and gave no number where one was due.
bool is_lost(const Table& number, std::size_t row) {
    return number.word(row, "refused").empty() && !number.number(row, "error");
}

/// For each axis the values nearest to the plain one at which f32 is lost, with the condition.
void add_failures(const Table& number, std::vector<Finding>& findings) {
    std::vector<std::string> failures, axes;
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        const std::string axis = number.word(row, "axis");
        if (number.word(row, "precision") != "f32" || std::ranges::count(axes, axis))
            continue;
        axes.push_back(axis);
        const auto counts = [&](std::size_t one) {
            return number.word(one, "precision") == "f32" && number.word(one, "axis") == axis;
        };
        Worst worst = largest(number, "error", counts);
        for (std::size_t one = 0; one < number.rows.size(); ++one)
            if (counts(one) && is_lost(number, one))
                worst = {one, std::numeric_limits<double>::infinity()};
        if (!worst.row || worst.value <= kFine)
            continue;
        const AxisWords words = words_of(axis);
        failures.push_back(fmt::format("by up to {:.1g} over {} ({} at {:g}{}; {})", worst.value, words.name,
                                       number.word(*worst.row, "surface"), number.needed(*worst.row, "value"),
                                       words.unit, number.word(*worst.row, "condition")));
    }
    findings.push_back(
        {"where_f32_fails",
         failures.empty()
             ? fmt::format("Single precision is nowhere off by more than {:g} of the largest force.", kFine)
             : fmt::format("Single precision is off by more than {:g} of the largest force in places: {}.", kFine,
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
    Worst most = largest(number, "of_predicted", [](std::size_t) { return true; });
    for (std::size_t row = 0; row < number.rows.size(); ++row)
        if (is_lost(number, row))
            most = {row, std::numeric_limits<double>::infinity()};
    if (!most.row)
        return;
    const std::string place = fmt::format("{}, {} = {:g}", number.word(*most.row, "series"),
                                          number.word(*most.row, "axis"), number.needed(*most.row, "value"));
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
        const double spacing = number.needed(row, "value");
        if (*step <= kBlurred || std::ranges::count(clear, here) || (blurred && spacing <= *blurred))
            continue;
        blurred = spacing;
        surface = here;
    }
    if (!any)
        return;
    const Worst force = largest(number, "error", [&](std::size_t row) {
        return number.word(row, "axis") == "spacing" && number.word(row, "precision") == "f32" && blurred &&
               number.needed(row, "value") <= *blurred;
    });
    findings.push_back(
        {"steps", blurred
                      ? fmt::format("The difference of two neighbouring samples is off by more than {:g} of itself in "
                                    "single precision up to a spacing of {:g} m ({}), where each force by itself is "
                                    "off by at most {:.1g} of the largest.",
                                    kBlurred, *blurred, surface, force.value)
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
