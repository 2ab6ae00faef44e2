// Curl of a force field in a section, from the volume that an engine evaluates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/field/engine.h"
#include "host/output/files.h"
#include "host/study/energy/loops.h"

namespace forceshade::study {

/// A field over a section of x and z at one y, in contact where depth is above 0.
struct SectionField {
    std::vector<double> x, z;  /* m */
    std::vector<double> force; /* N: 3 a sample, x fastest, then z */
    std::vector<double> depth; /* m */

    std::size_t at(std::size_t i, std::size_t k) const { return k * x.size() + i; }
};

/// curl_y F = dF_x/dz - dF_z/dx, N/m, of each cell between four samples, x fastest: the work round it, by the mean of
/// two samples' forces along each side, over its area; NaN where a corner is out of contact. So the work round several
/// cells is their sum, also where forces jump along slanted lines.
std::vector<double> cell_curls(const SectionField& field);

/// A cell of a map of curl.
struct CurlCell {
    std::string map;           /* "bump of 8 facets, shaded" */
    double x, z;               /* m: its middle */
    double curl_per_stiffness; /* 1 */
};

/// Curl of a law over the middle of a region, `columns` cells wide, each the mean over 8 x 8 cells of samples; the
/// force of every eighth sample goes to NAME.exr, whose record is added to `volumes`.
std::vector<CurlCell> curl_map(Engine& engine, const EnergyLaw& law, const StrokeRegion& region, std::uint64_t columns,
                               const std::filesystem::path& folder, std::vector<FileRecord>& volumes);

} // namespace forceshade::study
