// The cases of a sweep: everything that one leaves behind (the volume, what `--also` asks for, the check against the
// oracle, the record), computed case after case on the engine while earlier ones are encoded on other threads.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "host/cases/path_run.h"
#include "host/field/comparison.h"
#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/output/record.h"
#include "host/output/rows.h"
#include "host/picture/picture.h"
#include "host/picture/slice_collector.h"
#include "host/referee/oracle_check.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// What is written beside the EXR.
struct AlsoFormats {
    bool vti = false, vtp = false, npy = false;
    picture::Endings pictures{};
};

/// \throws UsageError for a name that is none of vti, vtp, npy, png, svg, pdf.
AlsoFormats parse_also(const std::vector<std::string>& names);

/// The names of all files that a case leaves whose volume is or would be called `STEM.exr`, the volume first.
std::vector<std::string> file_names(const std::string& stem, const Scene& scene, AlsoFormats also);
/// Every name that a case may leave.
std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also);

/// Where the paths of such a case go: STEM.paths.exr, STEM.paths.csv and what else is asked for.
PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads);

/// The record of a case without what is computed.
CaseRecord empty_record(const PreparedCase& prepared);

/// What the pictures of a case show and how.
struct PictureChoice {
    picture::Look look; /* without a title: the case in words */
    picture::SliceChoice slice;
};

class CaseOutput {
public:
    /// Files go to `volume` (an .exr path) and beside it. `threads`: that compress this case's volume, 0 for the
    /// calling one alone. `exact_bits`: as in OracleCheck.
    CaseOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also,
               const PictureChoice& pictures, int threads, bool exact_bits);

    template <typename T> void write(const layout::FieldChunk<T>& chunk);

    /// Publishes every file and returns the record, without what only the caller knows (fingerprint, engine and its
    /// times). \throws UsageError, IoError, Error. The volume is published first, so it may
    /// stand where another file failed.
    CaseRecord finish();

private:
    void add_surface(CaseRecord& record);
    void add_pictures(CaseRecord& record);

    const PreparedCase& prepared_;
    std::filesystem::path volume_;
    AlsoFormats also_;
    PictureChoice pictures_;
    int threads_;
    double checking_ = 0; /* s */
    std::size_t repeat_y_;
    std::uint64_t evaluated_;
    std::vector<std::pair<std::string, std::unique_ptr<ChunkSink>>> sinks_; // file name and sink, the volume first
    std::unique_ptr<picture::SliceCollector> slices_;
    OracleCheck check_;
    std::optional<Compared> compared_; // with [compare]
};

// Chunks on their way from the engine to the thread that encodes their case, bounded in bytes over all cases.

/// A chunk that owns its samples.
template <typename T> struct OwnedChunk {
    layout::FieldChunk<T> view; // its spans point into the vectors below
    std::vector<T> force, depth, proxy, unshaded;
    std::vector<layout::uint> facet;

    explicit OwnedChunk(const layout::FieldChunk<T>& from)
        : view(from), force(from.force.begin(), from.force.end()), depth(from.depth.begin(), from.depth.end()),
          proxy(from.proxy.begin(), from.proxy.end()), unshaded(from.unshaded.begin(), from.unshaded.end()),
          facet(from.facet.begin(), from.facet.end()) {
        view.force = force;
        view.depth = depth;
        view.proxy = proxy;
        view.unshaded = unshaded;
        view.facet = facet;
    }
    OwnedChunk(OwnedChunk&&) = default; // the vectors' memory stays where it is
    OwnedChunk& operator=(OwnedChunk&&) = default;

    std::size_t bytes() const {
        return (force.size() + depth.size() + proxy.size() + unshaded.size()) * sizeof(T) +
               facet.size() * sizeof(layout::uint);
    }
};

using AnyChunk = std::variant<OwnedChunk<float>, OwnedChunk<double>>;

/// Bytes that may wait between engine and encoders; one chunk always may.
class ChunkBudget {
public:
    explicit ChunkBudget(std::size_t bytes) : free_(bytes), all_(bytes) {}

    /// A share of the budget, given back when it goes out of scope, also by an exception.
    class Share {
    public:
        Share(ChunkBudget& budget, std::size_t bytes) : budget_(&budget), bytes_(bytes) {}
        Share(Share&& from) noexcept : budget_(std::exchange(from.budget_, nullptr)), bytes_(from.bytes_) {}
        Share& operator=(Share&& from) noexcept {
            std::swap(budget_, from.budget_);
            std::swap(bytes_, from.bytes_);
            return *this;
        }
        ~Share() {
            if (budget_)
                budget_->give(bytes_);
        }

    private:
        ChunkBudget* budget_;
        std::size_t bytes_;
    };

    /// Waits until there is room.
    Share take(std::size_t bytes) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return free_ >= bytes || free_ == all_; });
        const std::size_t taken = std::min(bytes, free_);
        free_ -= taken;
        return Share(*this, taken);
    }

private:
    void give(std::size_t bytes) {
        const std::lock_guard lock(mutex_);
        free_ += bytes;
        changed_.notify_all();
    }

    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t free_, all_;
};

/// A chunk on its way; it counts against the budget as long as it lives.
struct WaitingChunk {
    AnyChunk chunk;
    ChunkBudget::Share share;
};

/// Thrown to the engine when the encoder of its case has failed: there is no use in computing on.
struct EncoderFailed : std::runtime_error {
    EncoderFailed() : std::runtime_error("the case's encoder failed") {}
};

/// The chunks of one case, in order.
class ChunkQueue {
public:
    explicit ChunkQueue(ChunkBudget& budget) : budget_(budget) {}

    /// Waits for room. \throws EncoderFailed once the consumer has abandoned the queue.
    template <typename T> void push(const layout::FieldChunk<T>& chunk) {
        OwnedChunk<T> owned(chunk);
        ChunkBudget::Share share = budget_.take(owned.bytes());
        const std::lock_guard lock(mutex_);
        if (abandoned_)
            throw EncoderFailed();
        chunks_.push_back({std::move(owned), std::move(share)});
        changed_.notify_all();
    }

    /// No more chunks: the case is complete, or (`whole` false) will never be.
    void close(bool whole) {
        const std::lock_guard lock(mutex_);
        closed_ = true;
        whole_ = whole;
        changed_.notify_all();
    }

    /// The next chunk; nothing at the end.
    std::optional<WaitingChunk> pop() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return closed_ || !chunks_.empty(); });
        if (chunks_.empty())
            return std::nullopt;
        WaitingChunk chunk = std::move(chunks_.front());
        chunks_.pop_front();
        return chunk;
    }
    bool whole() const { return whole_; }

    /// The consumer gives up: waiting chunks are dropped, further ones refused.
    void abandon() {
        const std::lock_guard lock(mutex_);
        abandoned_ = true;
        chunks_.clear();
    }

private:
    ChunkBudget& budget_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<WaitingChunk> chunks_;
    bool closed_ = false, whole_ = false, abandoned_ = false;
};

// Computes case after case on the engine while earlier ones are encoded on other threads.

struct CaseJob {
    PreparedCase prepared;
    std::filesystem::path volume; /* .exr path */
    std::string fingerprint;
    AlsoFormats also{};       /* written beside the volume */
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
