// The account of a sweep's folder, manifest.json and summary.csv, and what goes into it: this process, its machine and
// its share of the study.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "host/scene/study.h"

namespace forceshade {

/// The processor's name, "unknown" where the system does not tell.
std::string cpu_name();
/// Seconds of processor time that this process took, all threads.
double cpu_seconds();
/// Most bytes that this process had resident.
std::uint64_t peak_memory();

// Which part of a study this process does.

struct Shard {
    std::size_t index = 1, count = 1; /* 1-based: "3/8" */
};

/// \throws UsageError unless the text is I/N with 1 <= I <= N.
Shard parse_shard(const std::string& text);

/// The shard that Slurm's array variables name, if they are set. \throws UsageError if they make no sense: a task that
/// then took the whole study would do the others' work too.
std::optional<Shard> slurm_shard();

/// What a run of the program cost; stands in the manifest only.
struct RunAccount {
    std::string engine_device, engine_driver;
    std::size_t computed = 0;      /* cases */
    std::size_t kept = 0;          /* cases that were there already */
    double wall = 0;               /* s */
    double cpu = 0;                /* s, all cores */
    double engine = 0;             /* s: uploads, kernels and read-back */
    double output = 0;             /* s over all encoder threads: encoding, flushing, reading back, hashing */
    std::uint64_t peak_memory = 0; /* bytes resident */
};

/// For each case of a study, what its record must say to count: any of the fingerprints. Records of other scenes or
/// programs under the same name do not.
using Fingerprints = std::map<std::string, std::set<std::string>>;

/// Merges the records of the study's cases, other shards' and earlier runs' too, into manifest.json and summary.csv.
/// Without `run` the account of the last run is kept. Returns how many cases are recorded. \throws IoError.
std::size_t write_manifest(const std::filesystem::path& folder, const Study& study, const Fingerprints& fingerprints,
                           const RunAccount* run);

/// Refuses to put a study's summary, manifest and report in the place of those that tell of finished cases which the
/// study does not have. The same cases with other parameters, some of them or more are no other study. \throws
/// UsageError.
void require_same_study(const std::filesystem::path& folder, const Study& study);

} // namespace forceshade
