#include "host/referee/reading.h"

#include <cmath>

#include <fmt/format.h>

#include "host/norm.h"

namespace forceshade {

Bound operator+(const Bound& a, const Bound& b) {
    return {a.force + b.force, a.magnitude + b.magnitude, a.unshaded + b.unshaded, a.depth + b.depth,
            a.proxy + b.proxy};
}

Bound operator*(double factor, const Bound& bound) {
    return {factor * bound.force, factor * bound.magnitude, factor * bound.unshaded, factor * bound.depth,
            factor * bound.proxy};
}

layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels) {
    // Written so that no number is a misfit.
    if (channels & layout::kChannelForce && !(norm(computed.force - truth.force) <= allowed.force &&
                                              std::abs(norm(computed.force) - norm(truth.force)) <= allowed.magnitude))
        return layout::kChannelForce;
    if (channels & layout::kChannelDepth && !(std::abs(computed.depth - truth.depth) <= allowed.depth))
        return layout::kChannelDepth;
    if (channels & layout::kChannelFacet && computed.facet != truth.facet)
        return layout::kChannelFacet;
    if (channels & layout::kChannelProxy && !(norm(computed.proxy - truth.proxy) <= allowed.proxy))
        return layout::kChannelProxy;
    if (channels & layout::kChannelUnshaded && !(norm(computed.unshaded - truth.unshaded) <= allowed.unshaded))
        return layout::kChannelUnshaded;
    return 0;
}

std::string describe(const Reading& reading, layout::uint channel) {
    const auto vector = [](const char* name, const glm::dvec3& value, const char* unit) {
        return fmt::format("{} ({}, {}, {}) {}", name, value.x, value.y, value.z, unit);
    };
    switch (channel) {
    case layout::kChannelDepth:
        return fmt::format("depth {} m", reading.depth);
    case layout::kChannelFacet:
        return fmt::format("facet {}", reading.facet);
    case layout::kChannelProxy:
        return vector("proxy", reading.proxy, "m");
    case layout::kChannelUnshaded:
        return vector("unshaded", reading.unshaded, "N");
    default:
        return vector("force", reading.force, "N");
    }
}

} // namespace forceshade
