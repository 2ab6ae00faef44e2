// A study of energy in a few rows, and its findings by name.
#pragma once

#include "host/study/energy/energy_findings.h"
#include "host/study/energy/tables.h"

namespace forceshade::study {

using Json = nlohmann::ordered_json;

inline Json row(const char* surface, const char* scheme, int facets, double error, double eta) {
    return {{"surface", surface},       {"scheme", scheme},     {"facets", facets},
            {"radius_mil", 1000.0},     {"work_mJ", 1.5 * eta}, {"eta", eta},
            {"gained_mJ", 1.5 * eta},   {"effort_mJ", 1.5},     {"direction_rms_deg", error},
            {"engine_difference", 1e-9}};
}

inline StudyData sample() {
    StudyData data;
    data.study = "energy";
    const Table loops = loops_table({row("bump", "facets", 8, 2, 0.05), row("bump", "facets", 32, 0.5, 0.07),
                                     row("bump", "shaded", 1, 0, 0.24), row("bump", "shaded", 32, 0, 0.06),
                                     row("mesh of triangles", "triangles none", 8, 2.2, 0),
                                     row("mesh of triangles", "triangles none", 32, 0.4, 0),
                                     row("mesh of triangles", "triangles mean_value", 4, 1.2, 0.01),
                                     row("mesh of triangles", "triangles mean_value", 8, 0.3, 0.006)});
    data.tables = {loops, laws_table(loops), equal_error_table(loops), front_table(loops)};
    return data;
}

inline std::string finding(const StudyData& data, const std::string& name) {
    for (const Finding& one : energy_findings(data))
        if (one.name == name)
            return one.text;
    return "";
}

inline void set(Table& table, const std::string& scheme, const char* column, Cell value) {
    for (auto& cells : table.rows)
        if (std::get<std::string>(cells[table.index("scheme")]) == scheme)
            cells[table.index(column)] = value;
}

} // namespace forceshade::study
