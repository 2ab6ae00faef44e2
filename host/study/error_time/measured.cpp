#include "host/study/error_time/measured.h"

#include <fmt/format.h>

namespace forceshade::study::error_time {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFewFacets = 8; // below it the facets are too steep for a power law
constexpr double kFewCells = 8;  // below it the mesh's border, where vertex normals are one-sided, is near

Json optional_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

std::optional<double> optional_from(const Json& json) {
    return json.is_number() ? std::optional(json.get<double>()) : std::nullopt;
}

Series& series_named(Measured& measured, const Series& like) {
    for (Series& one : measured.series)
        if (one.name == like.name)
            return one;
    return measured.series.emplace_back(like);
}

void add_point(Measured& measured, const Series& like, double size, double error) {
    Series& series = series_named(measured, like);
    series.sizes.push_back(size);
    series.errors.push_back(error);
}

std::string order_source(const std::string& shading) {
    return shading == "none" || shading == "morgenbesser" ? "L7" : "depth";
}

} // namespace

void add_series(Measured& measured) {
    for (std::size_t i = 0; i < measured.contenders.size(); ++i) {
        const Contender& one = measured.contenders[i];
        const bool direct = one.family == "direct" || one.family == "god-object";
        if (!direct || one.precision != "f64" || one.against != kSmoothShape || !measured.compared[i].smooth)
            continue;
        const ForceErrors& errors = *measured.compared[i].smooth;
        if (one.facets && *one.facets >= kFewFacets && one.shading == "none" && errors.direction)
            add_point(measured, {"bump, flat", "direction RMS / deg", "1 / facets", {}, {}, 1, "G2"}, 1 / *one.facets,
                      errors.direction->rms);
        if (one.facets && *one.facets >= kFewFacets && one.shading == "reference" && errors.magnitude)
            add_point(measured, {"bump, shaded", "magnitude RMS, relative", "1 / facets", {}, {}, 2, "G2"},
                      1 / *one.facets, errors.magnitude->rms);
        // A probe at depth d sees the proxy's angle off the facet's middle shrunk by d / R: to every shading that adds
        // d / R of the flat error, of order 1.
        if (one.cells && *one.cells >= kFewCells && errors.direction)
            add_point(measured,
                      {fmt::format("mesh, {}, {}", one.shading, one.family == "direct" ? "static" : "god-object"),
                       "direction RMS / deg",
                       "1 / cells",
                       {},
                       {},
                       1,
                       order_source(one.shading)},
                      1 / *one.cells, errors.direction->rms);
    }
}

Json to_json(const std::vector<PatchRow>& rows) {
    Json json = Json::array();
    for (const PatchRow& row : rows) {
        Json printed = Json::array();
        for (const auto& value : row.printed)
            printed.push_back(optional_json(value));
        json.push_back({{"surface", row.surface},
                        {"of", row.cells_of},
                        {"shading", row.shading},
                        {"cells", row.cells},
                        {"found_deg", row.found},
                        {"printed_deg", printed}});
    }
    return json;
}

std::vector<PatchRow> patch_rows_from(const Json& json) {
    std::vector<PatchRow> rows;
    for (const Json& one : json) {
        PatchRow row{one.at("surface"), one.at("of"), one.at("shading"), one.at("cells"), one.at("found_deg"), {}};
        for (std::size_t i = 0; i < row.printed.size(); ++i)
            row.printed[i] = optional_from(one.at("printed_deg").at(i));
        rows.push_back(std::move(row));
    }
    return rows;
}

Json to_json(const std::vector<LookupError>& errors) {
    Json json = Json::array();
    for (const LookupError& one : errors)
        json.push_back({{"method", one.method},
                        {"place", one.place},
                        {"places", one.places},
                        {"rms", one.rms},
                        {"largest", one.largest},
                        {"direction_rms_deg", one.direction_rms}});
    return json;
}

std::vector<LookupError> lookup_errors_from(const Json& json) {
    std::vector<LookupError> errors;
    for (const Json& one : json)
        errors.push_back({one.at("method"), one.at("place"), one.at("places"), one.at("rms"), one.at("largest"),
                          one.at("direction_rms_deg")});
    return errors;
}

} // namespace forceshade::study::error_time
