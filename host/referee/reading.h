// What an engine or a referee says of one voxel, channel by channel.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host/norm.h"
#include "host/referee/referee.h"
#include "host/referee/rounding_bound.h"
#include "host/reference/contact.h"

namespace forceshade {

using Triple = std::array<double, 3>;

struct Reading {
    Triple force{}, unshaded{}; /* N */
    Triple proxy{};             /* m */
    double depth = 0;           /* m */
    layout::uint facet = layout::kNoFacet;
};

template <typename T> Reading reading_of(const reference::Contact<T>& contact) {
    const auto triple = [](const reference::Vector<T>& value) {
        return Triple{double(value.x), double(value.y), double(value.z)};
    };
    return {triple(contact.force), triple(contact.unshaded), triple(contact.proxy), double(contact.depth),
            contact.facet};
}

Reading reading_of(const brute::Answer& answer);

/// Channels that the chunk lacks stay empty.
template <typename T> Reading reading_of(const layout::FieldChunk<T>& chunk, std::size_t sample) {
    const auto triple = [&](std::span<const T> channel) {
        return channel.empty() ? Triple{}
                               : Triple{double(channel[3 * sample]), double(channel[3 * sample + 1]),
                                        double(channel[3 * sample + 2])};
    };
    return {triple(chunk.force), triple(chunk.unshaded), triple(chunk.proxy),
            chunk.depth.empty() ? 0 : double(chunk.depth[sample]),
            chunk.facet.empty() ? layout::kNoFacet : chunk.facet[sample]};
}

/// N: |F - F_truth|.
double force_error(const Reading& computed, const Reading& truth);

/// The first of `channels` (layout::kChannel... bits) in which a reading is further from the truth than the bound
/// allows; 0 if there is none. A facet must be the very same.
layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels);

/// One channel in words, as "depth 0.001 m".
std::string describe(const Reading& reading, layout::uint channel);

// Edges: where another rounding may rightly say something else.

/// A law as a referee in precision T.
template <typename T> struct OracleReferee {
    layout::Law<T> law;

    reference::Column<T> column(double x, double y) const {
        return reference::column_at(law, static_cast<T>(x), static_cast<T>(y));
    }
    Reading at(const reference::Column<T>& column, double z) const {
        return reading_of(reference::contact_at(law, column, static_cast<T>(z)));
    }
    static layout::uint facet(const reference::Column<T>& column) { return column.facet.id; }
};

/// The closed form as a referee.
struct ClosedFormReferee {
    const brute::Referee& referee;

    brute::Column column(double x, double y) const { return referee.column(x, y); }
    Reading at(const brute::Column& column, double z) const { return reading_of(referee.at(column, z)); }
    static layout::uint facet(const brute::Column& column) { return column.facet; }
};

/// Whether force(place) jumps between two places a rounding apart: however often the way is halved, one half of it
/// keeps most of the difference.
template <typename Force> bool jumps_between(Triple from, Triple to, const Force& force) {
    const auto apart = [](const Triple& a, const Triple& b) { return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]); };
    Triple at_from = force(from), at_to = force(to);
    const double whole = apart(at_from, at_to);
    for (int i = 0; i < 8; ++i) {
        Triple middle;
        for (std::size_t axis = 0; axis < 3; ++axis)
            middle[axis] = from[axis] + (to[axis] - from[axis]) / 2;
        const Triple at_middle = force(middle);
        const bool in_first = apart(at_from, at_middle) > apart(at_middle, at_to);
        (in_first ? to : from) = middle;
        (in_first ? at_to : at_from) = at_middle;
    }
    return apart(at_from, at_to) > whole / 2;
}

/// The number that many steps of T beyond `value`.
template <typename T> double stepped(double value, int steps) {
    const T towards = steps < 0 ? -std::numeric_limits<T>::infinity() : std::numeric_limits<T>::infinity();
    T result = static_cast<T>(value);
    for (int i = 0; i < std::abs(steps); ++i)
        result = std::nextafter(result, towards);
    return static_cast<double>(result);
}

/// L2: the other of two solids that are equally deep but for `tolerance`, m: which of them a voxel names is a matter of
/// rounding, and its proxy lies on the one that it names.
inline std::optional<Reading> other_solid(const Reading& reading, const layout::Law<double>& law, const Triple& probe,
                                          double tolerance) {
    if (law.features.surface != layout::kSurfaceCylinderBump || reading.facet == layout::kNoFacet)
        return std::nullopt;
    const layout::LawParams<double>& params = law.params;
    const auto [x, y, z] = probe;
    const reference::Radial<double> radial = reference::radial_at(params, x, z);
    const double power = (params.half_width - x) * (params.half_width + x) - z * (z + 2 * params.centre_depth);
    const double cylinder = power / (params.radius + radial.distance);
    if (!(std::abs(cylinder + z) <= tolerance))
        return std::nullopt;
    Reading other = reading;
    other.facet = 1 - reading.facet;
    other.proxy = {x, y, 0};
    if (other.facet == 0)
        other.proxy = {x + cylinder * radial.direction.x, y, z + cylinder * radial.direction.z};
    return other;
}

/// True if a bump's facets within a few steps of T of x include this one; vertices may coincide in T.
template <typename T, typename Referee>
bool is_facet_near(layout::uint facet, const layout::Law<double>& law, const Referee& referee, double x, double y) {
    const layout::uint plane = law.params.facets;
    const layout::uint low = referee.facet(referee.column(stepped<T>(x, -4), y));
    const layout::uint high = referee.facet(referee.column(stepped<T>(x, 4), y));
    if (facet == plane || (low == plane && high == plane))
        return low == plane || high == plane;
    return facet >= (low == plane ? 0 : low) && facet <= (high == plane ? plane - 1 : high);
}

/// True if the referee gives a reading at a point so near to the probe that rounding may have moved it there: a few
/// steps of T away, or as far up or down as the depth may be off. `sides` is how many of the two round.
template <typename T, typename Referee>
bool is_on_edge(const Reading& computed, const Triple& probe, const Referee& referee, const RoundingBound& bound,
                double sides, layout::uint channels) {
    const auto [x, y, z] = probe;
    const layout::Law<double> law = bound.law();
    const Bound here = bound.at(x, y, z);
    const double reach = 1.01 * sides * here.depth; /* m */
    std::vector<double> across{stepped<T>(x, 0)};
    for (const int steps : {-1, 1, -2, 2, -4, 4})
        across.push_back(stepped<T>(x, steps));
    if (std::abs(x) < static_cast<double>(std::numeric_limits<T>::min()))
        across.push_back(0); // as hardware may read it
    const bool near_facet = law.features.surface == layout::kSurfaceBump && channels & layout::kChannelFacet &&
                            computed.facet != layout::kNoFacet && is_facet_near<T>(computed.facet, law, referee, x, y);
    for (const double near_x : across)
        for (const double near_y : {y, stepped<T>(y, -2), stepped<T>(y, 2)}) {
            const auto column = referee.column(near_x, near_y);
            for (const double near_z : {z, stepped<T>(z, -2), stepped<T>(z, 2), z - reach, z + reach}) {
                Reading truth = referee.at(column, near_z);
                if (near_facet && truth.facet != layout::kNoFacet)
                    truth.facet = computed.facet;
                const double moved = std::hypot(std::hypot(near_x - x, near_y - y), near_z - z); /* m */
                const Bound allowed = sides * (here + bound.at(near_x, near_y, near_z)) + bound.over(moved);
                if (!first_misfit(computed, truth, allowed, channels))
                    return true;
                const auto other = other_solid(truth, law, {near_x, near_y, near_z}, 2 * sides * here.depth + moved);
                if (other && !first_misfit(computed, *other, allowed, channels))
                    return true;
            }
        }
    return false;
}

} // namespace forceshade
