#include "host/referee/reading.h"

#include <cmath>

#include <fmt/format.h>

#include "host/norm.h"

namespace forceshade {

namespace {

double distance(const Triple& a, const Triple& b) {
    return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double length(const Triple& a) {
    return norm(a[0], a[1], a[2]);
}

} // namespace

Reading reading_of(const brute::Answer& answer) {
    const auto triple = [](const std::array<brute::Real, 3>& value) {
        return Triple{double(value[0]), double(value[1]), double(value[2])};
    };
    return {triple(answer.force), triple(answer.unshaded), triple(answer.proxy), double(answer.depth), answer.facet};
}

Bound operator+(const Bound& a, const Bound& b) {
    return {a.force + b.force, a.magnitude + b.magnitude, a.unshaded + b.unshaded, a.depth + b.depth,
            a.proxy + b.proxy};
}

Bound operator*(double factor, const Bound& bound) {
    return {factor * bound.force, factor * bound.magnitude, factor * bound.unshaded, factor * bound.depth,
            factor * bound.proxy};
}

double force_error(const Reading& computed, const Reading& truth) {
    return distance(computed.force, truth.force);
}

layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels) {
    // Written so that no number is a misfit.
    if (channels & layout::kChannelForce &&
        !(force_error(computed, truth) <= allowed.force &&
          std::abs(length(computed.force) - length(truth.force)) <= allowed.magnitude))
        return layout::kChannelForce;
    if (channels & layout::kChannelDepth && !(std::abs(computed.depth - truth.depth) <= allowed.depth))
        return layout::kChannelDepth;
    if (channels & layout::kChannelFacet && computed.facet != truth.facet)
        return layout::kChannelFacet;
    if (channels & layout::kChannelProxy && !(distance(computed.proxy, truth.proxy) <= allowed.proxy))
        return layout::kChannelProxy;
    if (channels & layout::kChannelUnshaded && !(distance(computed.unshaded, truth.unshaded) <= allowed.unshaded))
        return layout::kChannelUnshaded;
    return 0;
}

std::string describe(const Reading& reading, layout::uint channel) {
    const auto triple = [](const char* name, const Triple& value, const char* unit) {
        return fmt::format("{} ({}, {}, {}) {}", name, value[0], value[1], value[2], unit);
    };
    switch (channel) {
    case layout::kChannelDepth:
        return fmt::format("depth {} m", reading.depth);
    case layout::kChannelFacet:
        return fmt::format("facet {}", reading.facet);
    case layout::kChannelProxy:
        return triple("proxy", reading.proxy, "m");
    case layout::kChannelUnshaded:
        return triple("unshaded", reading.unshaded, "N");
    default:
        return triple("force", reading.force, "N");
    }
}

} // namespace forceshade
