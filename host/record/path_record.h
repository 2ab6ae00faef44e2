// What is known of paths that were taken through an engine.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/io/chunk_sink.h"
#include "host/io/file_record.h"
#include "host/record/engine_account.h"
#include "host/record/oracle_errors.h"

namespace forceshade {

/// What became of paths.
struct PathRecord {
    std::uint64_t paths = 0;
    std::uint64_t steps = 0; /* of the longest */
    std::uint64_t samples = 0, in_contact = 0;
    double stretch = 0;                           /* m: the way that turns of the force are counted over */
    std::uint64_t unstable = 0, began_inside = 0; /* paths */
    std::uint64_t fell = 0;                       /* of the unstable ones */
    std::uint64_t unfinished = 0;                 /* samples */
    double largest_force = 0;                     /* N */
    double work = 0, effort = 0;                  /* J: sums over the paths */
    double depth_deviation = 0;                   /* m: root mean square of depth about its mean, in contact */
    double mean_depth = 0;                        /* m */
    PathError error;
    std::vector<FileRecord> files; /* the samples first, if there are any */
    EngineTimes engine_times;
    VolumeTimings volume_times;
    std::vector<std::string> warnings;

    double steps_per_second() const; /* of the engine */
};

/// What is wrong with a run whose paths are further from the oracle than rounding allows, or hold samples whose proxy
/// never rested; empty where nothing is.
std::string complaint(const PathRecord& record, const std::string& name, const std::string& device);

} // namespace forceshade
