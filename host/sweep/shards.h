// The parts of a study that several processes do: which one this is; the status file of each in the folder, from which
// any process can see how the whole stands; and how their results are merged, without computing.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/scene/study.h"

namespace forceshade {

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

} // namespace forceshade
