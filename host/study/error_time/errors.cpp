#include "host/study/error_time/errors.h"

#include <algorithm>
#include <cmath>

#include "host/study/error_time/angle.h"

namespace forceshade::study::error_time {

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

double rms_of(std::span<const glm::dvec3> forces) {
    double squares = 0;
    for (const glm::dvec3& force : forces)
        squares += reference::dot(force, force);
    return forces.empty() ? 0 : std::sqrt(squares / static_cast<double>(forces.size()));
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
    }
    errors.direction = summary_of(std::move(directions));
    errors.local = summary_of(std::move(local));
    errors.typical = summary_of(std::move(of_typical));
    return errors;
}

} // namespace forceshade::study::error_time
