#include "host/study/energy/loops.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "host/field/case_law.h"
#include "host/random.h"
#include "host/reference/motion.h"

namespace forceshade::study {
namespace {

constexpr std::size_t kCasts = 64; // along a stroke over a mesh; heights are straight in between

// m: the height at which a probe that comes from above at (x, y) enters a mesh; empty: it never does.
std::optional<double> cast(const EnergyLaw& law, const CaseLaw<double>& direct, double x, double y) {
    constexpr int kDown = 256, kHalvings = 50;
    const auto box = bounding_box(law.prepared->images.mesh->mesh.polygons);
    layout::uint hint = 0;
    const auto inside = [&](double z) { return direct.at({x, y, z}, hint).facet != layout::kNoFacet; };
    const double step = (box.high[2] - box.low[2]) / kDown;
    double high = box.high[2];
    for (int i = 0; i < kDown; ++i, high -= step) {
        if (!inside(high - step))
            continue;
        double low = high - step;
        for (int halving = 0; halving < kHalvings; ++halving) {
            const double middle = 0.5 * (low + high);
            (inside(middle) ? low : high) = middle;
        }
        return low;
    }
    return std::nullopt;
}

// Heights of the facets above a stroke, m, at equal shares; straight in between.
std::optional<std::vector<double>> heights_along(const EnergyLaw& law, const Stroke& stroke, std::size_t steps) {
    const CaseLaw<double> direct(*law.prepared);
    std::vector<double> heights;
    if (!law.prepared->images.mesh) {
        for (std::size_t i = 0; i <= steps; ++i)
            heights.push_back(reference::nominal_height(
                direct.law(), std::lerp(stroke.from.x, stroke.to.x, double(i) / double(steps))));
        return heights;
    }
    std::vector<double> some;
    for (std::size_t i = 0; i <= kCasts; ++i) {
        const glm::dvec2 at = glm::mix(stroke.from, stroke.to, double(i) / double(kCasts));
        const std::optional<double> height = cast(law, direct, at.x, at.y);
        if (!height)
            return std::nullopt;
        some.push_back(*height);
    }
    for (std::size_t i = 0; i <= steps; ++i) {
        const double place = double(i) / double(steps) * double(kCasts);
        const auto cell = std::min(static_cast<std::size_t>(place), kCasts - 1);
        heights.push_back(std::lerp(some[cell], some[cell + 1], place - double(cell)));
    }
    return heights;
}

// Adds the work between two places whose forces are known.
template <typename ForceAt>
void add_between(LoopWork& sum, ForceAt& force, const glm::dvec3& from, const glm::dvec3& one, const glm::dvec3& to,
                 const glm::dvec3& two, int halvings) {
    constexpr double kSame = 1e-3; // of the force: less is straight in between
    if (halvings > 0 && glm::length(two - one) > kSame * (glm::length(one) + glm::length(two))) {
        const glm::dvec3 middle = 0.5 * (from + to), half = force(middle);
        add_between(sum, force, from, one, middle, half, halvings - 1);
        add_between(sum, force, middle, half, to, two, halvings - 1);
        return;
    }
    const double work = glm::dot(0.5 * (one + two), to - from);
    sum.work += work;
    sum.effort += std::abs(work);
}

} // namespace

std::vector<Stroke> drawn_strokes(const StrokeRegion& region, std::size_t count) {
    const glm::dvec2 size = region.high - region.low;
    const double least = 0.25 * std::max(size.x, size.y);
    Random draw(3);
    const auto place = [&] {
        const double x = draw(region.low.x, region.high.x); // in this order
        return glm::dvec2(x, draw(region.low.y, region.high.y));
    };
    const auto depth = [&] { return region.deepest * std::pow(10, -draw(0, 1)); };
    std::vector<Stroke> strokes;
    while (strokes.size() < count) {
        Stroke stroke;
        stroke.from = place();
        stroke.to = place();
        stroke.out = depth();
        stroke.back = depth();
        if (glm::length(stroke.to - stroke.from) >= least)
            strokes.push_back(stroke);
    }
    return strokes;
}

std::optional<std::vector<glm::dvec3>> places_of_loop(const EnergyLaw& law, const Stroke& stroke, std::size_t steps) {
    const auto heights = heights_along(law, stroke, steps);
    if (!heights)
        return std::nullopt;
    std::vector<glm::dvec3> places;
    const auto add = [&](std::size_t i, double depth) {
        const glm::dvec2 at = glm::mix(stroke.from, stroke.to, double(i) / double(steps));
        places.emplace_back(at.x, at.y, (*heights)[i] - depth);
    };
    const std::size_t upright = std::max<std::size_t>(1, steps / 8);
    for (std::size_t i = 0; i <= steps; ++i)
        add(i, stroke.out);
    for (std::size_t i = 1; i <= upright; ++i)
        add(steps, std::lerp(stroke.out, stroke.back, double(i) / double(upright)));
    for (std::size_t i = steps; i-- > 0;)
        add(i, stroke.back);
    for (std::size_t i = 1; i <= upright; ++i)
        add(0, std::lerp(stroke.back, stroke.out, double(i) / double(upright)));
    return places;
}

std::optional<LoopWork> work_by_place(const EnergyLaw& law, const std::vector<glm::dvec3>& places) {
    constexpr int kHalvings = 24; // of a step: the error of a jump is a ten-millionth of its force times the step
    const CaseLaw<double> direct(*law.prepared);
    layout::uint hint = 0;
    bool touches = true;
    auto force = [&](const glm::dvec3& at) {
        const reference::Contact<double> contact = direct.at(at, hint);
        touches = touches && contact.facet != layout::kNoFacet;
        return glm::dvec3(contact.force);
    };
    LoopWork sum;
    glm::dvec3 before = force(places.front());
    for (std::size_t i = 1; i < places.size(); ++i) {
        const glm::dvec3 now = force(places[i]);
        add_between(sum, force, places[i - 1], before, places[i], now, kHalvings);
        before = now;
    }
    return touches ? std::optional(sum) : std::nullopt;
}

std::optional<LoopWork> work_by_history(const EnergyLaw& law, const std::vector<glm::dvec3>& places) {
    constexpr std::size_t kDescent = 16;
    CaseProbe<double> probe(*law.prepared);
    const auto box = bounding_box(law.prepared->images.mesh->mesh.polygons);
    const glm::dvec3 above(places.front().x, places.front().y, box.high[2] + (box.high[2] - box.low[2]) / 100);
    std::vector<glm::dvec3> way;
    for (std::size_t i = 0; i < kDescent; ++i)
        way.push_back(glm::mix(above, places.front(), double(i) / kDescent));
    for (int round = 0; round < 2; ++round)
        way.insert(way.end(), places.begin() + (round > 0), places.end());
    LoopWork sum;
    bool touches = true;
    const std::size_t second = kDescent + places.size(); // the step after which the loop begins again
    glm::dvec3 before(0);
    for (std::size_t i = 0; i < way.size(); ++i) {
        const auto contact = probe.at(way[i]).contact;
        const glm::dvec3 now(contact.force);
        if (i >= second) {
            const double work = glm::dot(0.5 * (before + now), way[i] - way[i - 1]);
            sum.work += work;
            sum.effort += std::abs(work);
            touches = touches && contact.facet != layout::kNoFacet;
        }
        before = now;
    }
    return touches ? std::optional(sum) : std::nullopt;
}

} // namespace forceshade::study
