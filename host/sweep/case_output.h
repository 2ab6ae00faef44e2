// Everything that one case leaves behind: the volume, what `--also` asks for, the check against the oracle, the record.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/output/rows.h"
#include "host/paths/path_run.h"
#include "host/picture/slice_collector.h"
#include "host/prepare/prepared_case.h"
#include "host/referee/oracle_check.h"

namespace forceshade {

/// What is written beside the EXR.
struct AlsoFormats {
    bool vti = false, npy = false, png = false;
};

/// \throws UsageError for a name that is none of vti, npy, png.
AlsoFormats parse_also(const std::vector<std::string>& names);

inline constexpr std::uint32_t kAllChannels = layout::kChannelForce | layout::kChannelDepth | layout::kChannelFacet |
                                              layout::kChannelProxy | layout::kChannelUnshaded;

/// The names of all files that a case leaves whose volume is or would be called `STEM.exr`, the volume first.
std::vector<std::string> file_names(const std::string& stem, const Scene& scene, AlsoFormats also);
/// Every name that a case may leave.
std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also);

/// Where the paths of such a case go: STEM.paths.exr, STEM.paths.csv and what else is asked for.
PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads);

/// The record of a case without what is computed.
CaseRecord empty_record(const PreparedCase& prepared);

class CaseOutput {
public:
    /// Files go to `volume` (an .exr path) and beside it. `threads`: that compress this case's volume, 0 for the
    /// calling one alone. `exact_bits`: as in OracleCheck.
    CaseOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also, int threads,
               bool exact_bits);

    template <typename T> void write(const layout::FieldChunk<T>& chunk);

    /// Publishes every file and returns the record, without what only the caller knows (fingerprint, engine and its
    /// times). \throws UsageError, IoError, Error. The volume is published first, so it may
    /// stand where another file failed.
    CaseRecord finish();

private:
    void add_pictures(CaseRecord& record);

    const PreparedCase& prepared_;
    std::filesystem::path volume_;
    AlsoFormats also_;
    std::size_t repeat_y_;
    std::uint64_t evaluated_;
    std::vector<std::pair<std::string, std::unique_ptr<ChunkSink>>> sinks_; // file name and sink, the volume first
    std::unique_ptr<picture::SliceCollector> slices_;
    OracleCheck check_;
};

} // namespace forceshade
