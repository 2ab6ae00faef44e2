#include "host/study/omission/unchanged.h"

#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "host/norm.h"

namespace forceshade::study {
namespace {

// A unit vector and a product are a few roundings away from |F|.
template <typename T> constexpr double kMagnitudeRounding = 8.0 * double(std::numeric_limits<T>::epsilon());

template <typename Value>
bool same_bits(const std::vector<Value>& a, const std::vector<Value>& b, std::size_t at, std::size_t components) {
    const std::size_t end = (at + 1) * components;
    if (a.size() < end || b.size() < end)
        return a.size() == b.size();
    return std::memcmp(&a[at * components], &b[at * components], components * sizeof(Value)) == 0;
}

template <typename T> double magnitude(const std::vector<T>& force, std::size_t at) {
    return norm(double(force[3 * at]), double(force[3 * at + 1]), double(force[3 * at + 2]));
}

template <typename T>
bool agree(Agreement agreement, const std::vector<T>& a, const std::vector<T>& b, std::size_t at, double& largest) {
    switch (agreement) {
    case Agreement::bits:
        return same_bits(a, b, at, 3);
    case Agreement::values:
        return a[3 * at] == b[3 * at] && a[3 * at + 1] == b[3 * at + 1] && a[3 * at + 2] == b[3 * at + 2];
    case Agreement::along_z:
        return std::memcmp(&a[3 * at + 2], &b[3 * at + 2], sizeof(T)) == 0;
    case Agreement::contact:
        return (magnitude(a, at) > 0) == (magnitude(b, at) > 0);
    case Agreement::magnitude: {
        const double one = magnitude(a, at), other = magnitude(b, at);
        const double off = other > 0 ? std::abs(one / other - 1) : one > 0 ? 1 : 0;
        largest = std::max(largest, off);
        return off <= kMagnitudeRounding<T>;
    }
    case Agreement::none:
    case Agreement::nothing:
        return true;
    }
    return false;
}

} // namespace

template <typename T>
Unchanged compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without) {
    Unchanged result;
    if (comparison.force == Agreement::nothing)
        return result;
    const std::size_t samples = std::min(with.force.size(), without.force.size()) / 3;
    result.compared = samples;
    const auto of = [&](std::uint32_t channel) { return (comparison.channels & channel) != 0; };
    for (std::size_t i = 0; i < samples; ++i) {
        const bool same = agree(comparison.force, with.force, without.force, i, result.largest) &&
                          (!of(layout::kChannelDepth) || same_bits(with.depth, without.depth, i, 1)) &&
                          (!of(layout::kChannelFacet) || same_bits(with.facet, without.facet, i, 1)) &&
                          (!of(layout::kChannelProxy) || same_bits(with.proxy, without.proxy, i, 3)) &&
                          (!of(layout::kChannelUnshaded) || same_bits(with.unshaded, without.unshaded, i, 3)) &&
                          (!comparison.paths || same_bits(with.position, without.position, i, 3)) &&
                          (!comparison.unshaded_is_force || same_bits(with.unshaded, without.force, i, 3));
        result.differing += !same;
        result.in_contact += magnitude(without.force, i) > 0;
    }
    // What a path adds up to is the same whatever is written of it.
    if (!with.metrics.empty() && (comparison.force == Agreement::bits || comparison.force == Agreement::none)) {
        result.compared += with.metrics.size();
        for (std::size_t i = 0; i < with.metrics.size(); ++i)
            result.differing += !same_bits(with.metrics, without.metrics, i, 1);
    }
    if (comparison.force == Agreement::none)
        return result;
    // A field of another size is another field.
    result.differing += std::max(with.force.size(), without.force.size()) / 3 - samples;
    return result;
}

std::string what_is_compared(const Comparison& comparison) {
    const auto force = [&]() -> std::string {
        switch (comparison.force) {
        case Agreement::bits:
            return "force";
        case Agreement::values:
            return "force as numbers";
        case Agreement::magnitude:
            return "magnitude of the force to rounding";
        case Agreement::along_z:
            return "force along z";
        case Agreement::contact:
            return "whether there is a force";
        case Agreement::none:
            return "what each path adds up to";
        case Agreement::nothing:
            return "";
        }
        return "";
    };
    std::vector<std::string> parts;
    if (const std::string text = force(); !text.empty())
        parts.push_back(text);
    constexpr std::pair<std::uint32_t, const char*> kNames[] = {{layout::kChannelDepth, "depth"},
                                                                {layout::kChannelFacet, "facet"},
                                                                {layout::kChannelProxy, "proxy"},
                                                                {layout::kChannelUnshaded, "unshaded force"}};
    for (const auto& [channel, name] : kNames)
        if (comparison.channels & channel)
            parts.push_back(name);
    if (comparison.force == Agreement::nothing)
        return fmt::format("nothing: {}", comparison.why_nothing);
    if (comparison.paths && comparison.force != Agreement::none)
        parts.push_back("positions");
    if (comparison.unshaded_is_force)
        parts.push_back("unshaded force against the force without");
    return fmt::format("{}", fmt::join(parts, ", "));
}

template Unchanged compare<float>(const Comparison&, const Captured<float>&, const Captured<float>&);
template Unchanged compare<double>(const Comparison&, const Captured<double>&, const Captured<double>&);

} // namespace forceshade::study
