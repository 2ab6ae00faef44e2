#include "host/study/error_time/findings.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::study::error_time {
namespace {

constexpr const char* kBootstrap = "95 % bootstrap interval of paired rounds";
constexpr double kLoopPeriod = 1e-3; // s

const ForceErrors* errors_of(const Measured& measured, std::size_t way, Kind kind) {
    const auto& errors = measured.errors[way];
    const auto& of_kind = errors->by_kind[static_cast<std::size_t>(kind)];
    return of_kind ? &*of_kind : nullptr;
}

template <typename Condition>
std::optional<std::size_t> find_way(const Measured& measured, const Condition& condition) {
    for (std::size_t i = 0; i < measured.ways.size(); ++i)
        if (measured.errors[i] && condition(measured.ways[i]))
            return i;
    return std::nullopt;
}

std::string percent(double share) {
    if (share < 1e-4)
        return fmt::format("{:.1e} %", 100 * share);
    return fmt::format("{:.{}f} %", 100 * share, share < 0.001 ? 3 : share < 0.01 ? 2 : share < 0.1 ? 1 : 0);
}

std::string law_name(const Way& way) {
    return fmt::format("{}, {}", way.subject->name, way.variant->name);
}

std::string touched_depths(const Subject& subject) {
    return fmt::format("probe {:.3g} to {:.3g} mm under the surface, log-uniform", 1e3 * subject.scale.shallowest(),
                       1e3 * subject.scale.deepest);
}

// A look-up volume is good where nobody feels, and bad where contact begins: that of the finest volume.
void add_lookup(std::vector<Finding>& findings, const Measured& measured) {
    std::optional<std::size_t> finest;
    for (std::size_t i = 0; i < measured.ways.size(); ++i) {
        const Way& way = measured.ways[i];
        if (measured.errors[i] && way.family == "look-up, trilinear" && way.precision == "f32" &&
            way.variant->shading != "none" && (!finest || *way.spacing < *measured.ways[*finest].spacing))
            finest = i;
    }
    if (!finest)
        return;
    const Way& way = measured.ways[*finest];
    const ForceErrors& shared = measured.errors[*finest]->shared;
    const ForceErrors* boundary = errors_of(measured, *finest, Kind::boundary);
    const ForceErrors* rim = errors_of(measured, *finest, Kind::rim);
    if (!shared.typical || !boundary || !boundary->local)
        return;
    Finding finding{"lookup", "", "look-up-" + measured.subjects.front().name, law_name(way), {}, {}};
    finding.text =
        fmt::format("A trilinear look-up volume of {:.2g} mm errs by {} of the root mean square force, but by "
                    "more than {} of the force there at one in twenty places less than {:.2g} mm deep",
                    1e3 * *way.spacing, percent(shared.typical->rms), percent(boundary->local->p95),
                    1e3 * way.subject->scale.skin());
    if (rim && rim->direction)
        finding.text += fmt::format(", and its direction by {:.2g} deg RMS at the rim", rim->direction->rms);
    finding.text += ".";
    finding.condition = touched_depths(*way.subject);
    finding.interval = fmt::format("{} places, {} of them shallow", shared.places, boundary->places);
    findings.push_back(std::move(finding));
}

// What shading of a mesh buys, and what it costs.
void add_shading(std::vector<Finding>& findings, const Measured& measured) {
    const auto find = [&](const Subject& subject, const std::string& shading) {
        return find_way(measured, [&](const Way& way) {
            return way.subject == &subject && way.family == "god-object" && way.precision == "f32" &&
                   way.variant->shading == shading && (!way.variant->elements || way.variant->thorough);
        });
    };
    const Subject& subject = measured.subjects.back();
    const auto plain = find(subject, "none"), shaded = find(subject, "mean_value");
    if (!plain || !shaded || subject.against != kSmoothShape)
        return;
    const ForceErrors &without = measured.errors[*plain]->shared, &with = measured.errors[*shaded]->shared;
    if (!without.direction || !with.direction)
        return;
    const Interval cost = measured.times.ratio(*shaded, *plain);
    findings.push_back(
        {"shading",
         fmt::format(
             "Mean-value shading of a mesh takes the direction's RMS error from {:.2g} to {:.2g} deg and the time of "
             "a god-object's update to {:.2f} times.",
             without.direction->rms, with.direction->rms, cost.median),
         "error-time-" + subject.name, law_name(measured.ways[*shaded]), touched_depths(subject),
         fmt::format("{:.2f} to {:.2f} times, {}; {} places", cost.low, cost.high, kBootstrap, with.places)});
}

void add_cheapest(std::vector<Finding>& findings, const Measured& measured) {
    for (const Subject& subject : measured.subjects) {
        if (subject.against != kSmoothShape)
            continue;
        std::vector<std::size_t> within;
        for (std::size_t i = 0; i < measured.ways.size(); ++i)
            if (measured.ways[i].subject == &subject && measured.ways[i].use == Use::live && measured.errors[i] &&
                direction_error(measured.errors[i]->shared) <= 1 && local_error(measured.errors[i]->shared) <= 0.1)
                within.push_back(i);
        if (within.empty())
            continue;
        const Cheapest cheapest = cheapest_of(measured.times, within);
        const Interval time = measured.times.seconds(cheapest.way);
        const Way& way = measured.ways[cheapest.way];
        findings.push_back(
            {"cheapest_" + subject.name,
             fmt::format("Of {} ways that keep within 1 deg RMS and, at 95 % of the places, within 10 % of the force "
                         "there, the cheapest takes {:.2g} ns: {}{}.",
                         within.size(), 1e9 * time.median, way.name,
                         cheapest.ties.empty() ? std::string(", alone")
                                               : fmt::format(", tied with {} other{}", cheapest.ties.size(),
                                                             cheapest.ties.size() == 1 ? "" : "s")),
             "error-time-" + subject.name, subject.name, touched_depths(subject) + ", one place after the other",
             fmt::format("{:.2g} to {:.2g} ns, {}", 1e9 * time.low, 1e9 * time.high, kBootstrap)});
        return; // of the first surface: of the others the table tells
    }
}

// Single precision: what it saves on the laws that all is done with, and the worst place of any law.
void add_precision(std::vector<Finding>& findings, const Measured& measured) {
    double largest = 0;
    std::size_t laws = 0, places = 0;
    std::vector<double> costs;
    std::vector<std::string> intervals, names;
    for (std::size_t i = 0; i < measured.ways.size(); ++i) {
        const Way& way = measured.ways[i];
        if (!measured.errors[i] || !measured.errors[i]->precision || way.family != "direct" || way.precision != "f32")
            continue;
        ++laws;
        places = std::max(places, measured.errors[i]->shared.places);
        largest = std::max(largest, measured.errors[i]->precision->largest);
        const auto twin = find_way(measured, [&](const Way& other) {
            return other.variant == way.variant && other.family == "direct" && other.precision == "f64";
        });
        if (!way.variant->thorough || !twin)
            continue;
        const Interval cost = measured.times.ratio(i, *twin);
        names.push_back(law_name(way));
        costs.push_back(cost.median);
        intervals.push_back(fmt::format("{:.2f} to {:.2f}", cost.low, cost.high));
    }
    if (costs.empty())
        return;
    const auto [least, most] = std::ranges::minmax(costs);
    findings.push_back(
        {"precision",
         fmt::format("Single precision takes {} of the time of double{}, and differs by up to {} of the root "
                     "mean square force at random places.",
                     costs.size() == 1 ? fmt::format("{:.2f}", least) : fmt::format("{:.2f} to {:.2f}", least, most),
                     costs.size() == 1 ? "" : ", by the law", percent(largest)),
         "", fmt::format("{}", fmt::join(names, "; ")),
         fmt::format("direct evaluation on one thread; the difference is the largest of {} laws", laws),
         fmt::format("{}: {}; {} places a law", kBootstrap, fmt::join(intervals, ", "), places)});
}

// The slowest way that a loop may take: does it fit?
void add_budget(std::vector<Finding>& findings, const Measured& measured) {
    std::optional<std::size_t> slowest;
    for (std::size_t i = 0; i < measured.ways.size(); ++i)
        if (measured.ways[i].use == Use::live &&
            (!slowest || measured.times.seconds(i).median > measured.times.seconds(*slowest).median))
            slowest = i;
    if (!slowest)
        return;
    const Interval time = measured.times.seconds(*slowest);
    findings.push_back({"budget",
                        fmt::format("The slowest live way takes {:.2g} us, {} of the period of a 1 kHz loop.",
                                    1e6 * time.median, percent(time.median / kLoopPeriod)),
                        "error-time-" + measured.ways[*slowest].subject->name, measured.ways[*slowest].name,
                        "mean of an evaluation on one thread; a single one may take longer",
                        fmt::format("{:.2g} to {:.2g} us, {}", 1e6 * time.low, 1e6 * time.high, kBootstrap)});
}

} // namespace

std::vector<Finding> findings_of(const Measured& measured) {
    std::vector<Finding> findings;
    add_lookup(findings, measured);
    add_shading(findings, measured);
    add_cheapest(findings, measured);
    add_precision(findings, measured);
    add_budget(findings, measured);
    return findings;
}

} // namespace forceshade::study::error_time
