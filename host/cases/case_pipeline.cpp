#include "host/cases/case_pipeline.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "host/cases/case_files.h"
#include "host/cases/chunk_queue.h"
#include "host/clock.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/output/raw_formats.h"
#include "host/picture/frame.h"
#include "host/referee/oracle_check.h"
#include "host/threads.h"
#include "host/touch/force_errors.h"

namespace forceshade {

namespace {

// What the field of a case leaves: the volume, what `--also` asks for, the check against the oracle, the record.
class FieldOutput {
public:
    // Files go to the job's volume and its folder. `threads`: that compress it, 0 for the calling one alone.
    // `exact_bits`: as in OracleCheck.
    FieldOutput(const CaseJob& job, int threads, bool exact_bits)
        : job_(job), threads_(static_cast<unsigned>(std::max(1, threads))),
          output_(job.prepared, job.volume.parent_path() / job.volume.stem(), job.also.pictures, job.pictures.look,
                  threads_),
          check_(job.prepared, exact_bits) {
        const Scene& scene = output_.scene();
        const GridSpec& grid = scene.grid;
        const bool repeats = !depends_on_y(scene); // one y stands for all
        repeat_y_ = repeats ? grid.size[1] : 1;
        VolumeHeader header;
        header.size = grid.size;
        header.origin = grid.origin;
        header.spacing = grid.spacing;
        header.channels = written_channels(scene);
        set_options(header, job.prepared, scene, threads);
        output_.open<VolumeWriter>(job.volume, header);
        if (job.also.vti)
            output_.open<VtiWriter>(output_.path_of(".vti"),
                                    VtiHeader{header.size, header.origin, header.spacing, header.channels,
                                              scene.precision, header.place_origin});
        if (job.also.npy)
            for (const layout::uint channel : kFieldChannels)
                if (header.channels & channel)
                    output_.open<NpyWriter>(output_.path_of(npy_kind(channel)), header.size, channel, scene.precision,
                                            header.place_origin);
        if (job.also.pictures.any())
            slices_.emplace(grid, repeats, job.pictures.slice);
    }

    template <typename T> void write(const layout::FieldChunk<T>& chunk) {
        const auto write = [&](const layout::FieldChunk<T>& rows, std::size_t repeat_y) {
            output_.write(rows, repeat_y);
        };
        if (Compared* const compared = output_.compared())
            compared->field<T>(chunk, repeat_y_, write);
        else
            write(chunk, repeat_y_);
        if (slices_)
            slices_->add(chunk);
        timed(checking_, [&] { check_.add(chunk); });
    }

    // Publishes every file and returns the record, without what only the caller knows (fingerprint, engine and its
    // times). \throws UsageError, IoError, Error. The volume is published first, so it may stand where another file
    // failed.
    CaseRecord finish() {
        const auto& size = output_.scene().grid.size;
        CaseRecord record = empty_record(job_.prepared);
        record.voxels = size[0] * size[1] * size[2];
        record.evaluated = record.voxels / repeat_y_;
        timed(checking_, [&] { record.error = check_.compare(threads_); });
        const VolumeResult volume = output_.finish_first(record);
        record.largest_force = volume.largest_force;
        record.largest_voxel = volume.largest_voxel;
        output_.finish_others(record);
        record.volume_times.check = checking_;
        if (job_.also.vtp)
            add_surface(record);
        if (slices_)
            add_pictures(record);
        return record;
    }

private:
    void add_surface(CaseRecord& record) const {
        const Stage stage("writing the surface of " + job_.prepared.one.name);
        const std::filesystem::path file = output_.path_of(".vtp");
        const VolumeResult result = write_surface(file, job_.prepared);
        record.files.push_back({file.filename().string(), result.sha256, result.bytes});
    }
    void add_pictures(CaseRecord& record) const;
    void add_turns(CaseRecord& record) const;

    const CaseJob& job_;
    unsigned threads_;
    CaseOutput<ChunkSink> output_; // the volume first
    double checking_ = 0;          /* s */
    std::size_t repeat_y_;
    std::optional<picture::SliceCollector> slices_;
    OracleCheck check_;
};

void FieldOutput::add_pictures(CaseRecord& record) const {
    const PreparedCase& prepared = job_.prepared;
    const Stage stage("drawing " + prepared.one.name);
    const GridSpec& grid = output_.scene().grid;
    const picture::SliceChoice& choice = job_.pictures.slice;
    const picture::FieldSlice &slice = slices_->slice(), &unshaded = slices_->unshaded();
    const picture::SurfaceLines lines =
        choice.axis == 1 ? surface_lines(prepared, slice.axes.at) : picture::SurfaceLines{};
    constexpr double kPressed = 2e-3, kVoxels = 4;                                /* m */
    const double voxel = *std::ranges::max_element(grid.spacing);                 /* m */
    const double deep = std::max(kPressed, kVoxels * voxel);                      /* m */
    const double touching = std::clamp(voxel, pressed_depth(prepared), kPressed); // m: a line of samples is in contact
    const picture::Touch touch{touching, output_.scene().force.stiffness * touching};
    const auto look = [&](bool with_shading, const char* more = "") {
        picture::Look chosen = output_.look(picture::title_of(prepared.one, with_shading) + more);
        if (chosen.full_scale == 0)
            chosen.full_scale = output_.scene().force.stiffness * deep;
        return chosen;
    };
    if (depends_on_y(output_.scene()))
        output_.draw(".mosaic", picture::draw_mosaic(look(true), slices_->tiles(), choice.quantity), record);
    output_.draw(".arrows", picture::draw_arrows(look(true), slice, touch, lines, choice.quantity, unshaded), record);
    const std::uint64_t middle = (grid.size[1] - 1) / 2;                    // sample, rounded down
    const double y = choice.axis == 1 ? slice.axes.at : grid.at(1, middle); /* m */
    const SceneStroke stroke = stroke_of(prepared, y);
    const std::string depth = numbers::quantity_text(stroke.depth, "m");
    const std::string at_y = picture::position_labels("y", {y}, slice.axes.at_spacing,
                                                      numbers::choose_unit(std::max(stroke.depth, std::abs(y)), "m"))
                                 .front();
    output_.draw(".stroke",
                 picture::draw_stroke(look(true, ", stroked along x"),
                                      {fmt::format("probe {} below the surface, {}", depth, at_y)}, stroke.forces,
                                      output_.scene().force.shading != Shading::none),
                 record);
    if (draws_turns(prepared.one))
        add_turns(record);
    if (!unshaded.force.empty())
        output_.draw(".shading",
                     picture::draw_shading(look(false, ": what shading changes"), unshaded, slice, touch, lines),
                     record);
}

void FieldOutput::add_turns(CaseRecord& record) const {
    const PreparedCase& prepared = job_.prepared;
    std::vector<picture::TurnedMesh> shadings;
    for (const auto& [shading, name] : shadings_of(prepared))
        if (shading != Shading::barycentric) // on triangles mean_value is the same
            shadings.push_back(mesh_turns(prepared, shading)), shadings.back().shading = name;
    const std::string depth = numbers::quantity_text(pressed_depth(prepared), "m");
    output_.draw(".turns",
                 picture::draw_turns(
                     output_.look(picture::title_of(prepared.one, false) + ": by how much shading turns the force"),
                     {fmt::format("pressed {} along each facet's normal; on triangles barycentric equals mean_value; "
                                  "the colours end at the angle that 99 % of the surface does not exceed",
                                  depth)},
                     prepared.images.mesh->mesh, shadings, job_.pictures.view),
                 record);
}

constexpr std::size_t kWaitingCases = 4;

// A case between engine and encoder.
struct Transfer {
    Transfer(std::unique_ptr<CaseJob> from, ChunkBudget& budget) : job(std::move(from)), chunks(budget) {}
    std::unique_ptr<CaseJob> job;
    ChunkQueue chunks;
    EngineTimes times; // complete before the queue is closed
    std::optional<PathRecord> paths;
    std::exception_ptr error; // of the paths: concerns this case alone
};

// An error of the case alone: the others go on.
bool concerns_one_case(const std::exception_ptr& error) {
    try {
        std::rethrow_exception(error);
    } catch (const Error& known) {
        return known.code() == ExitCode::failed || known.code() == ExitCode::usage;
    } catch (...) {
        return false;
    }
}

void add_paths(PathRecord paths, CaseRecord& record) {
    record.files.insert(record.files.end(), paths.files.begin(), paths.files.end());
    paths.files.clear();
    record.paths = std::move(paths);
}

class Encoders {
public:
    Encoders(unsigned threads, int threads_a_volume, const std::function<void(const CaseOutcome&)>& done,
             const EngineReport& engine)
        : threads_a_volume_(threads_a_volume), done_(done), engine_(engine) {
        try {
            for (unsigned i = 0; i < threads; ++i)
                workers_.emplace_back([this] { work(); });
        } catch (...) {
            finish(); // those that did start wait for work
            throw;
        }
    }
    ~Encoders() { finish(); }

    // Waits while too many cases do: their chunks may be small, but each holds its images.
    void add(std::shared_ptr<Transfer> transfer) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return waiting_.size() < kWaitingCases; });
        waiting_.push_back(std::move(transfer));
        changed_.notify_all();
    }
    // All cases added so far end; no more may be added.
    void finish() {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
            changed_.notify_all();
        }
        workers_.clear();
    }
    // The first error that makes going on useless, if any.
    void throw_if_stopped() {
        const std::lock_guard lock(mutex_);
        if (stop_)
            std::rethrow_exception(stop_);
    }

private:
    // The next case; null when there will be none.
    std::shared_ptr<Transfer> take() {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
        if (waiting_.empty())
            return nullptr;
        std::shared_ptr<Transfer> transfer = std::move(waiting_.front());
        waiting_.pop_front();
        changed_.notify_all();
        return transfer;
    }

    void work() {
        while (const std::shared_ptr<Transfer> transfer = take()) {
            CaseOutcome outcome{transfer->job.get(), {}, nullptr};
            try {
                throw_if_stopped();
                if (transfer->error)
                    std::rethrow_exception(transfer->error);
                if (!encode(*transfer, outcome.record))
                    continue; // the engine gave up and says why itself
            } catch (...) {
                outcome.error = std::current_exception();
            }
            transfer->chunks.abandon(); // wakes an engine that waits for room
            report(outcome);
        }
    }

    // False if the engine never completed the case.
    bool encode(Transfer& transfer, CaseRecord& record) {
        const PreparedCase& prepared = transfer.job->prepared;
        if (!prepared.one.scene.field)
            record = empty_record(prepared);
        else if (!encode_field(transfer, record))
            return false;
        record.fingerprint = transfer.job->fingerprint;
        record.engine = engine_;
        if (transfer.paths)
            add_paths(std::move(*transfer.paths), record);
        return true;
    }

    bool encode_field(Transfer& transfer, CaseRecord& record) {
        FieldOutput output(*transfer.job, threads_a_volume_, engine_.software);
        while (auto waiting = transfer.chunks.pop()) {
            check_interrupt();
            std::visit([&](const auto& owned) { output.write(owned.view); }, waiting->chunk);
            transfer.chunks.encoded(*std::move(waiting));
        }
        if (!transfer.chunks.whole())
            return false;
        record = output.finish();
        record.touch = touched_error(transfer.job->prepared);
        record.engine_times = transfer.times;
        record.engine_times.prepare = transfer.job->prepared.seconds;
        if (transfer.job->prepared.images.mesh)
            record.evaluated = transfer.times.voxels_evaluated;
        if (record.evaluated == record.voxels)
            std::erase(record.omitted, kFreeSpace);
        return true;
    }

    void report(const CaseOutcome& outcome) {
        const std::lock_guard lock(mutex_);
        std::exception_ptr stop = outcome.error;
        if (!outcome.error || concerns_one_case(outcome.error))
            try {
                done_(outcome);
                stop = nullptr;
            } catch (...) {
                stop = std::current_exception();
            }
        if (!stop_)
            stop_ = stop;
    }

    int threads_a_volume_;
    const std::function<void(const CaseOutcome&)>& done_;
    EngineReport engine_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::shared_ptr<Transfer>> waiting_;
    bool closed_ = false;
    std::exception_ptr stop_;
    std::vector<std::jthread> workers_;
};

EngineTimes compute_field(Engine& engine, const CaseJob& job, ChunkQueue& chunks) {
    const Scene& scene = job.prepared.one.scene;
    return in_precision(scene.precision, [&]<typename T>(std::type_identity<T>) {
        const FieldTables<T> tables = make_tables<T>(scene, job.prepared.images, Extent::what_varies);
        return engine.evaluate(tables.input(), [&](const layout::FieldChunk<T>& chunk) {
            check_interrupt();
            chunks.push(chunk);
        });
    });
}

// Paths are written as they are computed, by the engine's thread: their rows need no second copy.
void compute_paths(Engine& engine, Transfer& transfer) {
    const CaseJob& job = *transfer.job;
    if (!job.prepared.one.scene.paths)
        return;
    const auto cores = static_cast<int>(most_threads());
    try {
        transfer.paths = run_paths(engine, job.prepared, path_options(job.volume, job.also, cores));
    } catch (...) {
        transfer.error = std::current_exception();
        if (!concerns_one_case(transfer.error))
            throw;
    }
}

} // namespace

void run_cases(Engine& engine, const std::function<std::unique_ptr<CaseJob>()>& next, std::size_t cases,
               const PipelineOptions& options, const std::function<void(const CaseOutcome&)>& done) {
    const unsigned cores = most_threads();
    const auto encoders = static_cast<unsigned>(
        std::clamp<std::size_t>(options.encoders ? options.encoders : cores, 1, std::max<std::size_t>(1, cases)));
    ChunkBudget budget(options.waiting_bytes);
    // A lone volume is compressed by all cores, several by one core each.
    Encoders pool(encoders, encoders < cores ? static_cast<int>(cores) : 0, done, engine.report());
    while (std::unique_ptr<CaseJob> job = next()) {
        check_interrupt();
        pool.throw_if_stopped();
        const auto transfer = std::make_shared<Transfer>(std::move(job), budget);
        compute_paths(engine, *transfer);
        const bool field = transfer->job->prepared.one.scene.field && !transfer->error;
        pool.add(transfer);
        if (!field) {
            transfer->chunks.close(true);
            continue;
        }
        try {
            transfer->times = compute_field(engine, *transfer->job, transfer->chunks);
            transfer->chunks.close(true);
        } catch (const EncoderFailed&) {
            transfer->chunks.close(false); // its encoder reports why
        } catch (...) {
            transfer->chunks.close(false);
            throw;
        }
    }
    pool.finish();
    pool.throw_if_stopped();
}

CaseRecord run_case(Engine& engine, CaseJob job) {
    auto only = std::make_unique<CaseJob>(std::move(job));
    CaseOutcome outcome;
    run_cases(
        engine, [&] { return std::move(only); }, 1, {}, [&](const CaseOutcome& ended) { outcome = ended; });
    if (outcome.error)
        std::rethrow_exception(outcome.error);
    return outcome.record;
}

} // namespace forceshade
