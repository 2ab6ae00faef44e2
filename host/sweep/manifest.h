// The account of a sweep's folder, manifest.json and summary.csv, and what goes into it: the records of its cases, this
// process and its machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/scene/study.h"
#include "host/sweep/identity.h"

namespace forceshade {

/// The processor's name, "unknown" where the system does not say.
std::string cpu_name();
/// Seconds of processor time that this process took, all threads.
double cpu_seconds();
/// Most bytes that this process had resident.
std::uint64_t peak_memory();

/// The cost of a run of the program; in the manifest only.
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

/// The records of the study's cases that count, shards' and earlier runs' too, in the study's order; empty where a
/// case has none. On all cores.
std::vector<std::optional<CaseRecord>> records_of(const std::filesystem::path& folder, const Study& study,
                                                  const Fingerprints& fingerprints);

/// Writes manifest.json and summary.csv of such records. Without `run` the account of the last run is kept. \throws
/// IoError.
void write_manifest(const std::filesystem::path& folder, const Study& study,
                    const std::vector<std::optional<CaseRecord>>& records, const RunAccount* run);

/// Refuses to put a study's summary, manifest and report in the place of those that list finished cases which the
/// study does not have. The same cases with other parameters, some of them or more are not another study. \throws
/// UsageError.
void require_same_study(const std::filesystem::path& folder, const Study& study);

} // namespace forceshade
