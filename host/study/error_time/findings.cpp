// What error against time says, in at most five sentences.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {
namespace {

constexpr const char* kBootstrap = "95 % bootstrap interval of paired rounds";
constexpr double kLoopPeriod = 1e-3; // s

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
    const std::vector<std::size_t> lookups = measured.find([](const Way& way) {
        return way.family == "look-up, trilinear" && way.precision == "f32" && way.variant->shading != "none";
    });
    const auto finest = std::ranges::min_element(lookups, {}, [&](std::size_t i) { return *measured.ways[i].spacing; });
    if (finest == lookups.end())
        return;
    const Way& way = measured.ways[*finest];
    const WayErrors& errors = *measured.errors[*finest];
    const ForceErrors *boundary = errors.of(Kind::boundary), *rim = errors.of(Kind::rim);
    if (!errors.shared.typical || !boundary || !boundary->local)
        return;
    const std::string at_rim =
        rim && rim->direction ? fmt::format(", and its direction by {:.2g} deg RMS at the rim", rim->direction->rms)
                              : "";
    findings.push_back(
        {"lookup",
         fmt::format(
             "A trilinear look-up volume of {:.2g} mm errs by {} of the root mean square force, but by {} of the "
             "force there, or more, at one in twenty places less than {:.2g} mm deep{}.",
             1e3 * *way.spacing, percent(errors.shared.typical->rms), percent(boundary->local->p95),
             1e3 * way.subject->scale.skin(), at_rim),
         "look-up-" + measured.subjects.front().name, law_name(way), touched_depths(*way.subject),
         fmt::format("{} places, {} of them shallow", errors.shared.places, boundary->places)});
}

// What shading of a mesh buys, and what it costs.
void add_shading(std::vector<Finding>& findings, const Measured& measured) {
    const Subject& subject = measured.subjects.back();
    const auto elements = std::ranges::find_if(subject.variants, [](const Variant& one) { return one.thorough; });
    const auto find = [&](const char* shading) {
        return measured.find([&](const Way& way) {
            return way.subject == &subject && way.family == "god-object" && way.precision == "f64" &&
                   way.variant->shading == shading &&
                   (elements == subject.variants.end() || way.variant->elements == elements->elements);
        });
    };
    const std::vector<std::size_t> plain = find("none"), shaded = find("barycentric");
    if (plain.empty() || shaded.empty() || subject.against != kSmoothShape)
        return;
    const ForceErrors &without = measured.errors[plain[0]]->shared, &with = measured.errors[shaded[0]]->shared;
    if (!without.direction || !with.direction)
        return;
    const Interval cost = measured.times.ratio(shaded[0], plain[0]);
    findings.push_back(
        {"shading",
         fmt::format("Barycentric shading of a mesh (on triangles mean_value is the same) takes the direction's RMS "
                     "error from {:.2g} to {:.2g} deg; a god-object's update then takes {:.2f} times as long.",
                     without.direction->rms, with.direction->rms, cost.median),
         "error-time-" + subject.name, law_name(measured.ways[shaded[0]]), touched_depths(subject),
         fmt::format("{:.2f} to {:.2f} times, {}; {} places", cost.low, cost.high, kBootstrap, with.places)});
}

// Of the first surface: of the others the table tells.
void add_cheapest(std::vector<Finding>& findings, const Measured& measured) {
    for (const Subject& subject : measured.subjects) {
        std::vector<std::size_t> within =
            measured.find([&](const Way& way) { return way.subject == &subject && way.use == Use::live; });
        std::erase_if(within, [&](std::size_t i) {
            const ForceErrors& errors = measured.errors[i]->shared;
            return !(errors.bounded_direction() <= 1 && errors.bounded_local() <= 0.1);
        });
        if (within.empty() || subject.against != kSmoothShape)
            continue;
        const auto [cheapest, ties] = cheapest_of(measured.times, within);
        const Interval time = measured.times.seconds(cheapest);
        findings.push_back(
            {"cheapest_" + subject.name,
             fmt::format("Of {} ways that keep within 1 deg RMS and, at 95 % of the places, within 10 % of the force "
                         "there, the cheapest takes {:.2g} ns: {}{}.",
                         within.size(), 1e9 * time.median, measured.ways[cheapest].name,
                         ties.empty()
                             ? std::string(", alone")
                             : fmt::format(", tied with {} other{}", ties.size(), ties.size() == 1 ? "" : "s")),
             "error-time-" + subject.name, subject.name, touched_depths(subject) + ", one place after the other",
             fmt::format("{:.2g} to {:.2g} ns, {}", 1e9 * time.low, 1e9 * time.high, kBootstrap)});
        return;
    }
}

// Single precision: what it saves on the laws that all is done with, and the worst place of any law.
void add_precision(std::vector<Finding>& findings, const Measured& measured) {
    double largest = 0;
    std::size_t places = 0;
    std::vector<double> costs;
    std::vector<std::string> intervals, names;
    const std::vector<std::size_t> single =
        measured.find([](const Way& way) { return way.family == "direct" && way.precision == "f32"; });
    for (const std::size_t i : single) {
        const Way& way = measured.ways[i];
        const WayErrors& errors = *measured.errors[i];
        places = std::max(places, errors.shared.places);
        largest = std::max(largest, errors.precision->largest);
        if (!way.variant->thorough)
            continue;
        const Interval cost = measured.times.ratio(i, measured.find([&](const Way& other) {
            return other.variant == way.variant && other.family == "direct" && other.precision == "f64";
        })[0]);
        names.push_back(law_name(way));
        costs.push_back(cost.median);
        intervals.push_back(fmt::format("{:.2f} to {:.2f}", cost.low, cost.high));
    }
    if (costs.empty())
        return;
    const auto [least, most] = std::ranges::minmax(costs);
    findings.push_back(
        {"precision",
         fmt::format("As compiled here single precision takes {} of the time of double{}, and differs by up to {} of "
                     "the root mean "
                     "square force at random places.",
                     costs.size() == 1 ? fmt::format("{:.2f}", least) : fmt::format("{:.2f} to {:.2f}", least, most),
                     costs.size() == 1 ? "" : ", by the law", percent(largest)),
         "", fmt::format("{}", fmt::join(names, "; ")),
         fmt::format("direct evaluation on one thread; the difference is the largest of {} laws", single.size()),
         fmt::format("{}: {}; {} places a law", kBootstrap, fmt::join(intervals, ", "), places)});
}

// The slowest way that a loop may take: does it fit?
void add_budget(std::vector<Finding>& findings, const Measured& measured) {
    const std::vector<std::size_t> live = measured.find([](const Way& way) { return way.use == Use::live; });
    const auto slowest =
        std::ranges::max_element(live, {}, [&](std::size_t i) { return measured.times.seconds(i).median; });
    const Way& way = measured.ways[*slowest];
    const Interval time = measured.times.seconds(*slowest);
    findings.push_back({"budget",
                        fmt::format("The slowest live way takes {:.2g} us, {} of the period of a 1 kHz loop.",
                                    1e6 * time.median, percent(time.median / kLoopPeriod)),
                        "error-time-" + way.subject->name, way.name,
                        "mean of an evaluation on one thread; a single one may take longer",
                        fmt::format("{:.3g} to {:.3g} us, {}", 1e6 * time.low, 1e6 * time.high, kBootstrap)});
}

} // namespace

std::vector<Finding> findings_of(const Measured& measured) {
    std::vector<Finding> findings;
    for (const auto add : {add_lookup, add_shading, add_cheapest, add_precision, add_budget})
        add(findings, measured);
    return findings;
}

} // namespace forceshade::study::error_time
