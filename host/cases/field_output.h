// What the field of a case leaves: the volume, what `--also` asks for, the check against the oracle, the record.
#pragma once

#include <filesystem>
#include <memory>

#include "host/cases/case_output.h"
#include "host/picture/slice_collector.h"
#include "host/referee/oracle_check.h"

namespace forceshade {

/// What the pictures of a case show and how.
struct PictureChoice {
    picture::Look look; /* without a title: the case in words */
    picture::SliceChoice slice;
};

class FieldOutput {
public:
    /// Files go to `volume` (an .exr path) and its folder. `threads`: that compress this case's volume, 0 for the
    /// calling one alone. `exact_bits`: as in OracleCheck.
    FieldOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also,
                const PictureChoice& pictures, int threads, bool exact_bits);

    template <typename T> void write(const layout::FieldChunk<T>& chunk);

    /// Publishes every file and returns the record, without what only the caller knows (fingerprint, engine and its
    /// times). \throws UsageError, IoError, Error. The volume is published first, so it may
    /// stand where another file failed.
    CaseRecord finish();

private:
    void add_surface(CaseRecord& record);
    void add_pictures(CaseRecord& record);

    CaseOutput<ChunkSink> output_; // the volume first
    bool also_vtp_;
    picture::SliceChoice slice_;
    int threads_;
    double checking_ = 0; /* s */
    std::size_t repeat_y_;
    std::uint64_t evaluated_;
    std::unique_ptr<picture::SliceCollector> slices_;
    OracleCheck check_;
};

} // namespace forceshade
