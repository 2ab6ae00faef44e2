#include "host/study/error_time/force_errors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/reference/elementary.h"
#include "host/study/error_time/angle.h"

namespace forceshade::study::error_time {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const std::optional<Summary>& summary) {
    return summary ? Json::array({summary->rms, summary->p999, summary->largest}) : Json();
}

std::optional<Summary> summary_from(const Json& json) {
    if (json.is_null())
        return std::nullopt;
    return Summary{json.at(0), json.at(1), json.at(2)};
}

} // namespace

std::optional<Summary> summary_of(std::vector<double> values) {
    if (values.empty())
        return std::nullopt;
    std::sort(values.begin(), values.end());
    double squares = 0;
    for (const double value : values)
        squares += value * value;
    const double count = static_cast<double>(values.size());
    const auto place = static_cast<std::size_t>(std::ceil(0.999 * count)) - 1;
    return Summary{std::sqrt(squares / count), values[place], values.back()};
}

ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth) {
    ForceErrors errors;
    std::vector<double> directions, magnitudes, vectors;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double is = reference::length(forces[i]), should = reference::length(truth[i]);
        if ((is > 0) != (should > 0))
            ++errors.contact_differs;
        if (!(should > 0))
            continue;
        ++errors.compared;
        magnitudes.push_back(std::abs(is - should) / should);
        vectors.push_back(reference::length(forces[i] - truth[i]) / should);
        if (is > 0)
            directions.push_back(angle_between(forces[i], truth[i]) / kDegree);
    }
    errors.direction = summary_of(std::move(directions));
    errors.magnitude = summary_of(std::move(magnitudes));
    errors.vector = summary_of(std::move(vectors));
    return errors;
}

Json to_json(const ForceErrors& errors) {
    return {{"direction_deg", to_json(errors.direction)},
            {"magnitude", to_json(errors.magnitude)},
            {"vector", to_json(errors.vector)},
            {"compared", errors.compared},
            {"contact_differs", errors.contact_differs}};
}

ForceErrors errors_from(const Json& json) {
    ForceErrors errors;
    errors.direction = summary_from(json.at("direction_deg"));
    errors.magnitude = summary_from(json.at("magnitude"));
    errors.vector = summary_from(json.at("vector"));
    errors.compared = json.at("compared");
    errors.contact_differs = json.at("contact_differs");
    return errors;
}

} // namespace forceshade::study::error_time
