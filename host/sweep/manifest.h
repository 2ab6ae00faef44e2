// The account of a sweep's folder, manifest.json and summary.csv, and what goes into it: the records of its cases, and
// which of them count as done (the same scene and files, the same program); this process and its machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/scene/study.h"

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

/// Of everything that decides the bytes of a case. `scene`: as resolved_toml() writes it, with the SHA-256 of its
/// files.
std::string fingerprint(const std::string& scene, bool cpu_engine);

/// For each case of a study that counts, the fingerprints of which its record must have one. Records of other scenes or
/// programs under the same name do not.
using Fingerprints = std::map<std::string, std::set<std::string>>;

/// Sets in the scenes of a study the SHA-256 of the files that they name, each read once, and returns what records
/// must say. Cases whose files cannot be read, or are not those that the scene means, are missing in the result.
Fingerprints identify(Study& study);

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
