// Merges the results of a study's shards, without computing.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "host/scene/study.h"
#include "host/sweep/shards.h"

namespace forceshade {

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
