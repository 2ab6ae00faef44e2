// A study evaluated into a folder: finishes what is missing, keeps what is intact, shares the work out among shards,
// and accounts for it.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compute/device.h"
#include "host/cases/case_pipeline.h"
#include "host/clock.h"
#include "host/field/engine.h"
#include "host/output/record.h"
#include "host/scene/study.h"

namespace forceshade {

// The account of a sweep's folder, manifest.json and summary.csv, and what goes into it: the records of its cases, and
// which of them count as done (the same scene and files, the same program); this process and its machine.

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

// The parts of a study that several processes do: which one this is; the status file of each in the folder, from which
// any process can see how the whole stands; and how their results are merged, without computing.

struct Shard {
    std::size_t index = 1, count = 1; /* 1-based: "3/8" */
    friend auto operator<=>(const Shard&, const Shard&) = default;
};

/// "3/8", or "slurm": what Slurm's variables name, a task of an array 1-N or 0-(N-1), one of the tasks of an srun, or
/// both. \throws UsageError for another text, and where Slurm names none: in an array of other numbers, which may be
/// some tasks of a larger one, the part is unknown.
Shard parse_shard(const std::string& text);

/// \throws UsageError where Slurm runs several tasks: each would do the whole, or they were started for something else.
/// Jobs inherit the variables of those that submit them, so a part is never taken unasked.
void require_whole();

/// The status of a shard, in FOLDER/manifest.d/shards/I-of-N.json.
struct ShardNote {
    Shard shard;
    std::string only = "*"; /* pattern of the cases that the shards share */
    std::size_t cases = 0, kept = 0, computed = 0;
    struct Failure {
        std::string name, message; /* of a case */
    };
    std::vector<Failure> failures;
    std::string host;
    std::int64_t process = 0;
    double started = 0, updated = 0; /* s since 1970 */
    bool ended = false;

    std::size_t done() const { return kept + computed; }
    std::string name() const; /* "3/8" */
};

/// \throws IoError
void write_note(const std::filesystem::path& folder, const ShardNote& note);
/// Those that can be understood, by count, then index.
std::vector<ShardNote> read_notes(const std::filesystem::path& folder);

/// How the shards of a folder stand: a line for each that is at work, has failed or is silent, and what is left.
std::string status_text(const std::vector<ShardNote>& notes, double now);
/// The same for programs.
std::string status_json(const std::vector<ShardNote>& notes, double now);

struct MergeOptions {
    std::filesystem::path folder;
    bool verify = false;  /* by the files' SHA-256, not only by their size */
    bool replace = false; /* take the place of another study in the folder */
};

struct MergeResult {
    std::size_t cases = 0, recorded = 0; /* no file is written where none is recorded */
    std::vector<std::string> missing;    /* cases without a record that counts, or whose files are not what it says */
    std::vector<std::string> shards;     /* "3/8": those they belong to, as the study was shared out last */
    std::vector<std::string> failures;   /* "CASE: why", of cases that are missing, as far as it is known */
    std::size_t others = 0;         /* missing ones with a record of another scene, other files or another program */
    std::size_t temporaries = 0;    /* of other machines: at work, or killed */
    std::vector<std::string> wrong; /* "CASE: why", of recorded cases that are further from the oracle than allowed */
};

/// Writes study.toml, manifest.json and summary.csv of a folder's records. \throws UsageError (another study in the
/// folder, or none of whose shards anything is known), IoError
MergeResult merge_sweep(Study study, const MergeOptions& options);

// The sweep itself.

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
    std::set<std::string> warnings;          /* of paths of computed cases */
    std::set<std::string> untouched;         /* chosen cases without any force in their grid */
    int exit_code = 0;                       /* of the failures; 0 without */
    std::uint64_t differing = 0;             /* voxels of the chosen cases whose bits are not the oracle's */
    std::uint64_t differing_samples = 0;     /* of their paths */
    std::uint64_t voxels = 0, evaluated = 0; /* of the chosen cases; the others are copies, or free space */
    bool free_space = false;                 /* whether some are */
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
