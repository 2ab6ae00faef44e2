// A study evaluated into a folder: finishes what is missing, keeps what is intact, shares the work out among shards.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "compute/device.h"
#include "host/clock.h"
#include "host/engine/engine.h"
#include "host/scene/study.h"
#include "host/sweep/case_pipeline.h"
#include "host/sweep/manifest.h"

namespace forceshade {

/// How far long work has come, on stderr: a bar with the time left on a terminal, now and then a line elsewhere.
class Progress {
public:
    /// `total` steps of `what` ("cases"). Silent if `quiet`.
    Progress(std::string what, std::size_t total, bool quiet);
    ~Progress();

    /// `done` steps have ended, `now` is the last of them. Not for two threads at once.
    void update(std::size_t done, const std::string& now);

    /// A line of its own, above the bar.
    void say(const std::string& line);

private:
    void clear();

    std::string what_;
    std::size_t total_;
    bool quiet_, terminal_, drawn_ = false;
    Clock::time_point start_ = Clock::now(), last_ = start_;
};

/// "0:07", "12:40", "3:05:00".
std::string clock_text(double seconds);

struct SweepOptions {
    std::filesystem::path folder;
    std::string only = "*"; /* shell pattern of case names */
    std::optional<Shard> shard;
    bool fresh = false;   /* compute every chosen case anew */
    bool replace = false; /* take the place of another study in the folder */
    bool quiet = false;
    AlsoFormats also;
    std::optional<compute::DeviceReport>
        device;            /* only what such a device and driver computed counts as done; none: any */
    unsigned encoders = 0; /* threads; 0: one a core */
};

struct SweepResult {
    std::size_t chosen = 0, computed = 0, kept = 0;
    std::vector<std::string> failures;   /* "CASE: why" */
    int exit_code = 0;                   /* of the failures; 0 without */
    std::uint64_t differing = 0;         /* voxels of the chosen cases whose bits are not the oracle's */
    std::uint64_t differing_samples = 0; /* likewise of their paths */
    double largest_relative_error = 0;   /* against the oracle in double, over all chosen cases */
    RunAccount account;
};

/// Evaluates the chosen cases of a study into `options.folder`, which is made if need be. `engine` is called only if
/// there is something to compute. \throws UsageError (nothing chosen; another study in the folder), IoError,
/// compute::DeviceError, Interrupted. Whatever was finished stays; running again goes on from there.
SweepResult run_sweep(const Study& study, const std::function<std::unique_ptr<Engine>()>& engine, bool cpu_engine,
                      const SweepOptions& options);

} // namespace forceshade
