// The files that a case leaves: their names, what is asked for, and the record that lists them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/cases/case_output.h"
#include "host/cases/path_run.h"
#include "host/field/prepared_case.h"
#include "host/output/exr_volume.h"
#include "host/output/record.h"

namespace forceshade {

/// \throws UsageError for a name that is none of vti, vtp, npy, png, svg, pdf.
AlsoFormats parse_also(const std::vector<std::string>& names);

/// The names of all files that a case leaves whose volume is or would be called `STEM.exr`, the volume first.
std::vector<std::string> file_names(const std::string& stem, const Scene& scene, AlsoFormats also);
/// Every name that a case may leave.
std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also);

/// Where the paths of such a case go: STEM.paths.exr, STEM.paths.csv and what else is asked for.
PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads);

/// Attributes and compression of the EXR of a case's field or paths; `written`: the part of the scene that it holds.
void set_options(ExrOptions& options, const PreparedCase& prepared, const Scene& written, int threads);

/// The record of a case without what is computed.
CaseRecord empty_record(const PreparedCase& prepared);

/// "left out: 94 % of the voxels (15 of 16 y samples, alike); shading, texture; channels depth, facet": what the scene
/// did not need.
std::string left_out_text(const CaseRecord& record);

} // namespace forceshade
