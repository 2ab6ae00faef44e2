// What cases will take, told before they are computed: voxels, bytes on the disk, time.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/cases/case_pipeline.h"
#include "host/field/engine.h"

namespace forceshade {

struct Forecast {
    Forecast& operator+=(const Forecast& other); /* of what is not measured */

    double voxels = 0;             /* of fields */
    double samples = 0;            /* of paths */
    double most_bytes = 0;         /* nothing can be compressed */
    double surface_bytes = 0;      /* of them, those of surfaces, which hardly grow with the grid */
    double least_bytes = 0;        /* everything is compressed as far as its format can */
    std::optional<double> bytes;   /* as small copies of the cases came out */
    std::optional<double> seconds; /* likewise, and with pictures */
};

/// Of a scene whose grid is known: a mesh's is when it was read.
Forecast forecast(const Scene& scene, AlsoFormats also);

/// Fills in bytes and seconds by computing up to six of the jobs, at most 200 thousand voxels and samples of each, into
/// a scratch folder: a second or so.
void measure(Engine& engine, const std::vector<const Case*>& cases, const std::function<CaseJob(const Case&)>& job_of,
             Forecast& forecast);

/// Bytes that a user may still write where a folder is or will be.
double free_bytes(const std::filesystem::path& folder);

/// \throws IoError if not even the best compression makes the files fit there.
void require_space(const std::filesystem::path& folder, const Forecast& forecast);
/// True if it depends on the compression whether they fit: measure then.
bool is_space_doubtful(const std::filesystem::path& folder, const Forecast& forecast);
/// The warning where they probably do not fit, else empty.
std::string space_warning(const std::filesystem::path& folder, const Forecast& forecast);

/// "3.4 GB"
std::string bytes_text(double bytes);

} // namespace forceshade
