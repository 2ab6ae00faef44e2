#include "host/study/error_time/error_time_points.h"

#include <cmath>

#include <fmt/format.h>

#include "host/study/data/median.h"

namespace forceshade::study {

bool is(const Table& points, Row row, const Way& way) {
    return points.word(row, "family") == way.family && points.word(row, "precision") == way.precision;
}

std::string law_of(const Table& points, Row row) {
    const std::string name = points.word(row, "contender");
    return name.substr(0, name.find(':'));
}

bool has_smooth_shape(const Table& points, Row row) {
    return points.word(row, "against") == "the smooth shape";
}

std::string on_surface(const std::string& surface) {
    return surface == "scene" ? "In the scene" : "On the " + surface;
}

std::vector<std::pair<Row, Row>> pairs(const Table& points, const Way& one, const Way& other) {
    std::vector<std::pair<Row, Row>> result;
    for (Row row = 0; row < points.rows.size(); ++row)
        for (Row with = 0; with < points.rows.size(); ++with)
            if (is(points, row, one) && is(points, with, other) && law_of(points, row) == law_of(points, with))
                result.emplace_back(row, with);
    return result;
}

double value(const Table& points, Row row, std::string_view column) {
    return points.number(row, column).value_or(NAN);
}

double median_ratio(const Table& points, const std::vector<std::pair<Row, Row>>& of, std::string_view column) {
    std::vector<double> ratios;
    for (const auto& [one, other] : of)
        ratios.push_back(value(points, one, column) / value(points, other, column));
    return median(std::move(ratios));
}

std::string against(double ratio) {
    if (ratio < kCheaper)
        return fmt::format("takes {:.2g} times the time of", ratio);
    if (ratio > 1.05)
        return fmt::format("takes {:.2g} times as long as", ratio);
    return "takes as long as";
}

} // namespace forceshade::study
