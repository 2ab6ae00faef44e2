// Curl of a force field in a section, from the volume that an engine evaluates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/engine/engine.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::study {

/// A field over a section of x and z at one y, in contact where depth is above 0.
struct SectionField {
    std::vector<double> x, z;  /* m */
    std::vector<double> force; /* N: 3 a sample, x fastest, then z */
    std::vector<double> depth; /* m */

    std::size_t at(std::size_t i, std::size_t k) const { return k * x.size() + i; }
};

/// The scene's own grid, which has one y, on the engine; in double precision where it has it. \throws what
/// Engine::evaluate throws.
SectionField evaluated_section(Engine& engine, const PreparedCase& prepared);

/// curl_y F = dF_x/dz - dF_z/dx, N/m, of each cell between four samples, x fastest: the work round it, by the mean of
/// two samples' forces along each side, over its area; NaN where a corner is out of contact. So the work round cells
/// together is their sum, forces that jump along slanted lines included.
std::vector<double> cell_curls(const SectionField& field);

/// The field without every second sample, the first kept.
SectionField every_second(const SectionField& field);

/// The force as NAME.exr, each sample that stands for a cell of the map, and the map's curl as NAME.curl.exr (R, G, B:
/// curl_x, curl_y, curl_z in N/m; of them only curl_y is known, the others and what is not known are 0), with a summary
/// and the map's cells, means over blocks of cells, as JSON. What sampling leaves of curl is told by how those
/// means change where every second sample is left out. `closed_form`(x, z) is the curl in N/m where it is known,
/// or empty.
struct CurlMap {
    std::string name;   /* the volumes' stem */
    std::string title;  /* as the table has it */
    std::string scheme; /* as the table of loops has it */
    PreparedCase prepared;
    std::function<double(double x, double z)> closed_form;
};
nlohmann::ordered_json curl_result(const CurlMap& map, Engine& engine, const std::filesystem::path& folder);

} // namespace forceshade::study
