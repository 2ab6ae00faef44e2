#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/validate/validate.h"

namespace forceshade {
namespace {

const char* precision_name(Precision precision) {
    return precision == Precision::f32 ? "f32" : "f64";
}

nlohmann::ordered_json to_json(const Comparison& one, const Distance& distance) {
    return {{"largest_error_N", distance.largest},
            {"relative_error", one.relative(distance)},
            {"boundary_voxels", distance.boundary},
            {"unexplained_voxels", distance.unexplained}};
}

} // namespace

Totals totals_of(const std::vector<Comparison>& comparisons) {
    Totals totals;
    for (const Comparison& one : comparisons) {
        totals.voxels += one.voxels;
        totals.differing += one.differing;
        totals.passed = totals.passed && one.passed;
    }
    return totals;
}

std::string comparison_table(const std::vector<Comparison>& comparisons) {
    std::size_t width = 4;
    for (const Comparison& one : comparisons)
        width = std::max(width, one.name.size());
    std::string text = fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "case",
                                   width, "", "voxels", "bits", "ULP", "max |F|", "against", "boundary", "against", "");
    text += fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11}  {:>11}  {:>8}  {:>11}  {}\n", "", width, "", "",
                        "differ", "", "N", "oracle f64", "voxels", "closed form", "");
    for (const Comparison& one : comparisons)
        text += fmt::format("{:<{}}  {:>4}  {:>10}  {:>8}  {:>7}  {:>11.4g}  {:>11.2e}  {:>8}  {:>11.2e}  {}\n",
                            one.name, width, precision_name(one.precision), one.voxels, one.differing, one.largest_ulp,
                            one.largest_force, one.relative(one.oracle),
                            one.boundary + one.oracle.boundary + one.closed_form.boundary,
                            one.relative(one.closed_form), one.passed ? "ok" : "FAILED: " + one.first_difference);
    return text + "errors are the largest |F - F_referee| over the largest |F|; boundary voxels are not among them: "
                  "rounding took them to the other side of an edge\n";
}

std::string comparison_json(const std::vector<Comparison>& comparisons, const EngineReport& engine) {
    nlohmann::ordered_json json;
    json["engine"] = {{"kind", engine.engine},
                      {"device", engine.device},
                      {"uuid", engine.uuid},
                      {"driver", engine.driver},
                      {"software", engine.software}};
    json["cases"] = nlohmann::ordered_json::array();
    for (const Comparison& one : comparisons)
        json["cases"].push_back({{"case", one.name},
                                 {"precision", precision_name(one.precision)},
                                 {"voxels", one.voxels},
                                 {"differing", one.differing},
                                 {"largest_ulp", one.largest_ulp},
                                 {"beyond_bound", one.beyond},
                                 {"boundary_voxels", one.boundary},
                                 {"largest_force_N", one.largest_force},
                                 {"oracle_f64", to_json(one, one.oracle)},
                                 {"closed_form", to_json(one, one.closed_form)},
                                 {"passed", one.passed},
                                 {"first_difference", one.first_difference}});
    const Totals totals = totals_of(comparisons);
    json["voxels"] = totals.voxels;
    json["differing"] = totals.differing;
    json["passed"] = totals.passed;
    return json.dump(2);
}

} // namespace forceshade
