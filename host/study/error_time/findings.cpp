// Findings of error against time.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {
namespace {

constexpr const char* kBootstrap = "95 % bootstrap interval of paired rounds, a tenth wider for reruns";

std::string percent(double share) {
    if (share == 0)
        return "0 %";
    if (share < 1e-4)
        return fmt::format("{:.1e} %", 100 * share);
    return fmt::format("{:.{}f} %", 100 * share, share < 0.001 ? 3 : share < 0.01 ? 2 : share < 0.1 ? 1 : 0);
}

std::string law_name(const Method& method) {
    return fmt::format("{}, {}", method.subject->name, method.variant->name);
}

std::string touched_depths(const Subject& subject) {
    return fmt::format("probe {:.3g} to {:.3g} mm under the surface, log-uniform", 1e3 * subject.scale.shallowest(),
                       1e3 * subject.scale.deepest);
}

// How far a look-up errs over the draws of its grid.
struct LookUpErrors {
    Interval rms;                /* 1: of the RMS force */
    std::optional<Interval> rim; /* deg */
    Interval phantom;            /* 1: of the places just above the surface */
    double phantom_largest;      /* 1: of the RMS force, median of the draws */
};

std::optional<LookUpErrors> lookup_errors(const MethodErrors& errors) {
    const auto rms = rms_over_draws(errors, &ForceErrors::typical);
    const auto rim = over_draws(errors, [](const MethodErrors& one) { return one.of(Kind::rim).direction.rms; });
    const auto phantom = over_draws(errors, [](const MethodErrors& one) {
        const ForceErrors& near = one.of(Kind::boundary);
        return near.places > 0 && near.above == 0 ? 0 : near.phantom_share();
    });
    const auto largest =
        over_draws(errors, [](const MethodErrors& one) { return one.of(Kind::boundary).phantom_largest; });
    return rms && phantom && largest ? std::optional(LookUpErrors{*rms, rim, *phantom, largest->median}) : std::nullopt;
}

std::string percents(const Interval& share) {
    return fmt::format("{} ({} to {})", percent(share.median), percent(share.low), percent(share.high));
}

// "16 deg (15 to 18)".
std::string degrees(const Interval& angle) {
    return fmt::format("{:.0f} deg ({:.0f} to {:.0f})", angle.median, angle.low, angle.high);
}

// "1.8 % (0.90 % to 3.1 %), at the rim 16 deg (15 to 18)".
std::string error_text(const LookUpErrors& errors) {
    return percents(errors.rms) + (errors.rim ? ", at the rim " + degrees(*errors.rim) : "");
}

// Of the finest volume, wherever its grid lies; and of one that holds depth and direction in place of the force.
void add_lookup(std::vector<Finding>& findings, const Measured& measured) {
    const auto of_family = [&](const std::string& family) {
        return measured.find([&](const Method& method) {
            return method.family == family && method.precision == "f32" && method.variant->shading != "none";
        });
    };
    const std::vector<std::size_t> lookups = of_family("look-up, trilinear");
    const auto finest =
        std::ranges::min_element(lookups, {}, [&](std::size_t i) { return *measured.methods[i].spacing; });
    if (finest == lookups.end())
        return;
    const Method& method = measured.methods[*finest];
    const auto errors = lookup_errors(*measured.methods[*finest].errors);
    if (!errors)
        return;
    std::string text = fmt::format("Forces read from a trilinear volume of {:.2g} mm samples have an RMS error of {} "
                                   "of the RMS force{}.",
                                   1e3 * *method.spacing, percents(errors->rms),
                                   errors->rim ? "; at the rim their direction errs by " + degrees(*errors->rim) : "");
    text +=
        fmt::format(" Up to {:.2g} mm above the surface, where there is no force, the volume has one at {} of the "
                    "places, of up to {} of the RMS force.",
                    1e3 * method.subject->scale.skin(), percents(errors->phantom), percent(errors->phantom_largest));
    const auto same = [&](const std::string& family) {
        std::vector<std::size_t> found = of_family(family);
        std::erase_if(found, [&](std::size_t i) {
            return measured.methods[i].variant != method.variant || measured.methods[i].spacing != method.spacing;
        });
        return found;
    };
    bool cured = false; // by a half
    const auto see = [&](const LookUpErrors& other) {
        cured = cured || (errors->rim && other.rim && other.rim->median < errors->rim->median / 2);
    };
    for (const std::size_t i : same("look-up, depth and direction"))
        if (const auto of_depth = lookup_errors(*measured.methods[i].errors)) {
            see(*of_depth);
            text += fmt::format(
                " With signed depth and direction in place of forces, {:.1f} times the bytes: {}, "
                "and {} above the surface.",
                double(measured.methods[i].built().bytes) / double(method.built().bytes), error_text(*of_depth),
                of_depth->phantom.median == 0 ? "no force" : "a force at " + percent(of_depth->phantom.median));
        }
    for (const std::size_t i : same("look-up, adaptive")) // how long it takes differs by 1.6 from run to run
        if (const auto adaptive = lookup_errors(*measured.methods[i].errors)) {
            see(*adaptive);
            text += fmt::format(" In an octree of as many bytes, finer where it errs most: {}.", error_text(*adaptive));
        }
    if (!cured && errors->rim)
        text += " None of these cures the rim.";
    findings.push_back({"lookup", text, "look-up-" + measured.subjects.front().name, law_name(method),
                        touched_depths(*method.subject),
                        fmt::format("in round brackets the least and largest of {} draws, each of {} places and of the "
                                    "volume's offset and orientation",
                                    measured.methods[*finest].errors->by_draw.size(),
                                    measured.methods[*finest].errors->shared.places)});
}

// Benefit and cost of shading a mesh.
void add_shading(std::vector<Finding>& findings, const Measured& measured) {
    const Subject& subject = measured.subjects.back();
    const auto elements = std::ranges::find_if(subject.variants, [](const Variant& one) { return one.thorough; });
    const auto find = [&](const char* shading) {
        return measured.find([&](const Method& method) {
            return method.subject == &subject && method.family == "god-object" && method.precision == "f64" &&
                   method.variant->shading == shading &&
                   (elements == subject.variants.end() || method.variant->elements == elements->elements);
        });
    };
    const std::vector<std::size_t> plain = find("none"), shaded = find("barycentric");
    if (plain.empty() || shaded.empty() || subject.against != kSmoothShape)
        return;
    const ForceErrors &without = measured.methods[plain[0]].errors->shared,
                      &with = measured.methods[shaded[0]].errors->shared;
    if (std::isnan(without.direction.rms) || std::isnan(with.direction.rms))
        return;
    const Interval cost = measured.times.ratio(shaded[0], plain[0]);
    const std::optional<double> cells = measured.methods[shaded[0]].variant->elements;
    const auto degrees = [&](std::size_t i) {
        const MethodErrors& errors = *measured.methods[i].errors;
        const auto spread = rms_over_draws(errors, &ForceErrors::direction);
        return spread ? fmt::format("{:.2g} ({:.2g} to {:.2g})", spread->median, spread->low, spread->high)
                      : fmt::format("{:.2g}", errors.shared.direction.rms);
    };
    const auto size = [&](std::size_t i) {
        const MethodErrors& errors = *measured.methods[i].errors;
        return percent(errors.shared.size.median);
    };
    const std::size_t draws = measured.methods[shaded[0]].errors->by_draw.size();
    findings.push_back(
        {"shading",
         fmt::format(
             "Barycentric shading of a mesh{} (on triangles mean_value is the same) changes the direction's RMS error "
             "from {} to {} deg; the median error of its size is {} of the force there unshaded and {} shaded{}.",
             cells ? fmt::format(" of {0:.0f} x {0:.0f} cells", *cells) : "", degrees(plain[0]), degrees(shaded[0]),
             size(plain[0]), size(shaded[0]),
             measured.steady() ? "; a god-object's update " + times_as_long(cost, "unshaded") : ""),
         "error-time-" + subject.name, law_name(measured.methods[shaded[0]]), touched_depths(subject),
         fmt::format("{}; in round brackets the least and largest of {} draws, each of {} places and a tessellation",
                     kBootstrap, draws, with.places)});
}

// Of the first surface; the table has the others.
void add_cheapest(std::vector<Finding>& findings, const Measured& measured) {
    for (const Subject& subject : measured.subjects) {
        std::vector<std::size_t> within =
            measured.find([&](const Method& method) { return method.subject == &subject && method.use == Use::live; });
        std::erase_if(within, [&](std::size_t i) {
            const ForceErrors& errors = measured.methods[i].errors->shared;
            return !(errors.bounded_direction() <= 1 && errors.bounded_local() <= 0.1);
        });
        if (within.empty() || subject.against != kSmoothShape || !measured.steady())
            continue;
        // Of ties the one with the fewest elements, so that chance does not choose.
        auto [cheapest, ties] = cheapest_of(measured.times, within);
        ties.push_back(cheapest);
        const std::size_t named = *std::ranges::min_element(
            ties, {}, [&](std::size_t i) { return std::pair(measured.methods[i].variant->elements.value_or(0), i); });
        findings.push_back({"cheapest_" + subject.name,
                            fmt::format("Of {} methods within 1 deg RMS and, at 95 % of the places, within 10 % of the "
                                        "force there, none is significantly cheaper than {}.",
                                        within.size(), measured.methods[named].name),
                            "error-time-" + subject.name, subject.name,
                            touched_depths(subject) + ", one place after the other",
                            fmt::format("cheaper: {} of their ratio below 1", kBootstrap)});
        return;
    }
}

// Single precision: time saved on the thorough laws, and the worst place of any law.
void add_precision(std::vector<Finding>& findings, const Measured& measured) {
    double largest = 0;
    std::size_t places = 0;
    std::string worst;
    std::size_t less = 0, thorough = 0;
    const std::vector<std::size_t> single =
        measured.find([](const Method& method) { return method.family == "direct" && method.precision == "f32"; });
    for (const std::size_t i : single) {
        const Method& method = measured.methods[i];
        const MethodErrors& errors = *measured.methods[i].errors;
        places = std::max(places, errors.shared.places);
        if (errors.precision.largest > largest) {
            largest = errors.precision.largest;
            worst = law_name(method);
        }
        if (!method.variant->thorough)
            continue;
        const Interval cost = measured.times.ratio(i, measured.find([&](const Method& other) {
            return other.variant == method.variant && other.family == "direct" && other.precision == "f64";
        })[0]);
        ++thorough;
        less += cost.high < 1;
    }
    if (thorough == 0)
        return;
    const std::string times = measured.steady()
                                  ? fmt::format("it takes significantly less time with {} of the {} laws that are also "
                                                "read from volumes, by a share that differs from run to run",
                                                less, thorough)
                                  : "times are not compared: the machine was busy";
    findings.push_back(
        {"precision",
         fmt::format("Single precision differs from double by up to {} of the RMS force at random places, where "
                     "rounding chooses another facet (at its worst by far more: study stability); as compiled here {}.",
                     percent(largest), times),
         "", fmt::format("{} laws, the largest of {}", single.size(), worst), "direct evaluation on one thread",
         fmt::format("{}; {} places a law", kBootstrap, places)});
}

// The same law evaluated in two ways, one over the other: of each surface the thorough law that is shaded, in double.
std::optional<std::pair<Interval, const Method*>> between(const Measured& measured, const Subject& subject,
                                                          const std::string& family, const std::string& other) {
    const auto find = [&](const std::string& name) {
        const auto found = std::ranges::find_if(measured.methods, [&](const Method& method) {
            return method.subject == &subject && method.family == name && method.precision == "f64" &&
                   method.variant->is_main();
        });
        return static_cast<std::size_t>(found - measured.methods.begin());
    };
    const std::size_t one = find(family), two = find(other);
    if (one == measured.methods.size() || two == measured.methods.size())
        return std::nullopt;
    return std::pair(measured.times.ratio(one, two), &measured.methods[one]);
}

// What a hint saves, and what threads do.
void add_ways_to_run(std::vector<Finding>& findings, const Measured& measured) {
    if (!measured.steady())
        return;
    const Subject& subject = measured.subjects.back();
    if (const auto proxy = between(measured, subject, "god-object, without a hint", "god-object"))
        findings.push_back(
            {"hints",
             fmt::format(
                 "Without the triangles that the update before found about the proxy, a god-object's update {}.",
                 times_as_long(proxy->first, "with them")),
             "", law_name(*proxy->second), touched_depths(subject) + ", approached from above, one thread",
             kBootstrap});
    // s: of a batch; what a shorter one takes depends on how soon threads begin, which machines differ in from day to
    // day.
    constexpr double kLong = 10e-3;
    std::vector<std::string> batches;
    const Method* of = nullptr;
    for (const Subject& one : measured.subjects)
        if (const auto batch = between(measured, one, "direct, a batch on all threads", "direct")) {
            const double seconds =
                double(kBatch) *
                measured.times.seconds(static_cast<std::size_t>(batch->second - measured.methods.data())).median;
            if (seconds < kLong)
                continue;
            batches.push_back(fmt::format("of the {} it {}", one.name, times_as_long(batch->first, "one alone")));
            of = batch->second;
        }
    if (of)
        findings.push_back(
            {"batches", fmt::format("A place in a batch of {} on all threads: {}.", kBatch, fmt::join(batches, ", ")),
             "", "the shaded laws that are also read from volumes", "direct evaluation in double", kBootstrap});
}

} // namespace

std::vector<Finding> findings_of(const Measured& measured) {
    std::vector<Finding> findings;
    for (const auto add : {add_lookup, add_shading, add_cheapest, add_ways_to_run, add_precision})
        add(findings, measured);
    return findings;
}

} // namespace forceshade::study::error_time
