#include "host/touch/force_errors.h"

#include <algorithm>

#include "host/error.h"
#include "host/reference/elementary.h"
#include "host/touch/angle.h"
#include "host/touch/force_at.h"
#include "host/touch/places.h"
#include "host/touch/true_force.h"

namespace forceshade {

std::optional<Summary> summary_of(std::vector<double> values) {
    if (values.empty())
        return std::nullopt;
    std::ranges::sort(values);
    double squares = 0;
    for (const double value : values)
        squares += value * value;
    const auto count = static_cast<double>(values.size());
    const auto at = [&](double share) { return values[static_cast<std::size_t>(std::ceil(share * count)) - 1]; };
    return Summary{std::sqrt(squares / count), at(0.5), at(0.95), values.back()};
}

ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical) {
    ForceErrors errors;
    errors.places = forces.size();
    std::vector<double> directions, local, of_typical;
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const double off = reference::length(forces[i] - truth[i]);
        const bool is = forces[i] != glm::dvec3(0), should = truth[i] != glm::dvec3(0);
        of_typical.push_back(off / typical);
        if (should)
            local.push_back(off / reference::length(truth[i]));
        if (is && should)
            directions.push_back(angle_between(forces[i], truth[i]) / kDegree);
        errors.missed += should && !is;
        errors.phantom += is && !should;
        errors.above += !should;
    }
    errors.direction = summary_of(std::move(directions));
    errors.local = summary_of(std::move(local));
    errors.typical = summary_of(std::move(of_typical));
    return errors;
}

std::optional<TouchRecord> touched_error(const PreparedCase& prepared) {
    constexpr std::size_t kPlaces = 200;
    if (shadings_of(prepared).size() == 1) // which nothing else is closer than
        return std::nullopt;
    try {
        TouchedShape shape = scene_shape(prepared);
        const TrueForce truth = true_force(prepared, shape.scale);
        shape.force = truth.force;
        shape.smooth = truth.smooth;
        const std::vector<TouchPlace> places = touched_places(shape, prepared, kPlaces);
        ContactForce law(prepared, shape.scale);
        std::vector<glm::dvec3> forces, true_ones;
        for (const TouchPlace& place : places) {
            forces.push_back(law(place));
            true_ones.push_back(truth.force(place));
        }
        const ForceErrors errors = force_errors(forces, true_ones, 1);
        if (!errors.direction || !errors.local)
            return std::nullopt;
        return TouchRecord{truth.against,         places.size(),        shape.scale.deepest,
                           errors.direction->rms, errors.local->median, errors.local->p95};
    } catch (const UsageError&) { // nothing to touch, or beyond the numbers
        return std::nullopt;
    }
}

} // namespace forceshade
