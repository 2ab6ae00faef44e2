// A study evaluated into a folder: finishes what is missing, keeps what is intact, shares the work out among shards.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "compute/device.h"
#include "host/cases/case_pipeline.h"
#include "host/cases/forecast.h"
#include "host/clock.h"
#include "host/field/engine.h"
#include "host/scene/study.h"
#include "host/sweep/manifest.h"
#include "host/sweep/shards.h"

namespace forceshade {

struct SweepOptions {
    std::filesystem::path folder;
    std::string only = "*";     /* shell pattern of case names */
    std::optional<Shard> shard; /* the study holds its cases alone; writes files and records, and a note of its own,
                                   for merge_sweep() */
    bool fresh = false;         /* compute every chosen case anew */
    bool replace = false;       /* take the place of another study in the folder */
    bool dry = false;           /* only report what is to be done */
    bool quiet = false;
    AlsoFormats also;
    std::optional<compute::DeviceReport>
        device;              /* only what such a device and driver computed counts as done; none: any */
    bool any_engine = false; /* results of the other engine count as done, too */
    unsigned encoders = 0;   /* threads; 0: one a core */
};

struct SweepResult {
    std::size_t chosen = 0, computed = 0, kept = 0;
    Forecast forecast;                       /* of the missing cases */
    std::vector<std::string> failures;       /* "CASE: why" */
    int exit_code = 0;                       /* of the failures; 0 without */
    std::uint64_t differing = 0;             /* voxels of the chosen cases whose bits are not the oracle's */
    std::uint64_t differing_samples = 0;     /* of their paths */
    std::uint64_t voxels = 0, evaluated = 0; /* of the chosen cases; the others are copies, or free space */
    double largest_relative_error = 0;       /* against the oracle in double, over all chosen cases */
    RunAccount account;
};

/// Evaluates the chosen cases of a study into `options.folder`, which is made if need be. `engine` is called only if
/// some case is to be computed. \throws UsageError (no case chosen; another study in the folder), IoError (also
/// before it begins, where the files cannot fit the disk), compute::DeviceError, Interrupted. Whatever was finished
/// stays; running again goes on from there.
SweepResult run_sweep(Study study, const std::function<std::unique_ptr<Engine>()>& engine, bool cpu_engine,
                      const SweepOptions& options);

} // namespace forceshade
