// Cases one after the other: computed on the engine while earlier ones are encoded on other threads.
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "host/cases/case_files.h"
#include "host/field/engine.h"
#include "host/picture/values.h"

namespace forceshade {

/// What the pictures of a case show and how.
struct PictureChoice {
    picture::Look look; /* without a title: the case in words */
    picture::SliceChoice slice;
};

struct CaseJob {
    PreparedCase prepared;
    std::filesystem::path volume; /* .exr path */
    std::string fingerprint;
    AlsoFormats also{};       /* in the folder of the volume */
    PictureChoice pictures{}; /* of the field */
};

struct CaseOutcome {
    const CaseJob* job = nullptr;
    CaseRecord record; // where error is null
    std::exception_ptr error;
};

struct PipelineOptions {
    unsigned encoders = 0;                              /* threads; 0: one a core, at most one a case */
    std::size_t waiting_bytes = std::size_t(128) << 20; /* between engine and encoders */
};

/// Runs every job; `next` yields them one by one (null at the end), so that only those under way are in memory. `done`
/// is called for each as it ends, from encoder threads but never from two at once. An error of one case does not stop
/// the others; an I/O or device error and an interrupt do. \throws the error that stopped the run.
void run_cases(Engine& engine, const std::function<std::unique_ptr<CaseJob>()>& next, std::size_t cases,
               const PipelineOptions& options, const std::function<void(const CaseOutcome&)>& done);

} // namespace forceshade
