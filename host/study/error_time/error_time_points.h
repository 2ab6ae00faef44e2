// Rows of the table of points, and how two ways of coming by the same force are told apart.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

using Row = std::size_t;

/// What a row must be.
struct Way {
    std::string family, precision;
};

bool is(const Table& points, Row row, const Way& way);

/// "bump, 64 facets, shaded" of "bump, 64 facets, shaded: direct f64"
std::string law_of(const Table& points, Row row);

/// Whether the errors of a row are against a known smooth shape, so that less of them is closer to a truth.
bool has_smooth_shape(const Table& points, Row row);

/// "On the mesh", "In the scene"
std::string on_surface(const std::string& surface);

/// Rows of the same law, one of each way.
std::vector<std::pair<Row, Row>> pairs(const Table& points, const Way& one, const Way& other);

/// The number in a row, no number where there is none.
double value(const Table& points, Row row, std::string_view column);

/// Of the pairs: a column of the first over that of the second.
double median_ratio(const Table& points, const std::vector<std::pair<Row, Row>>& of, std::string_view column);

/// Of a ratio of times: below this it is told as less.
constexpr double kCheaper = 0.95;

/// "takes 1.3 times as long as", to stand between two ways.
std::string against(double ratio);

} // namespace forceshade::study
