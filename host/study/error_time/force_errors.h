// How far forces are from what they should be.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/reference/elementary.h"

namespace forceshade::study::error_time {

/// Root mean square, the value that 99.9 % do not exceed, and the largest.
struct Summary {
    double rms = 0, p999 = 0, largest = 0;
};

/// Over the places where there should be a force; nothing where there is none. Out of contact a force has no direction:
/// such places count to the magnitude (as 1) and the vector alone.
struct ForceErrors {
    std::optional<Summary> direction; /* deg */
    std::optional<Summary> magnitude; /* 1: | |F| - |truth| | / |truth| */
    std::optional<Summary> vector;    /* 1: |F - truth| / |truth| */
    std::size_t compared = 0;         /* places where there should be a force */
    std::size_t contact_differs = 0;  /* of all places: where only one of both is a force */
};

/// `forces` and `truth`, N, place by place.
ForceErrors force_errors(std::span<const reference::Vector<double>> forces,
                         std::span<const reference::Vector<double>> truth);

/// Of values that are not negative; their order does not matter. Nothing where there is none.
std::optional<Summary> summary_of(std::vector<double> values);

nlohmann::ordered_json to_json(const ForceErrors& errors);
ForceErrors errors_from(const nlohmann::ordered_json& json);

} // namespace forceshade::study::error_time
