#include "host/cases/case_pipeline.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <thread>

#include <fmt/format.h>

#include "host/cases/surface_file.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/picture/picture.h"
#include "host/picture/scene_picture.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/threads.h"

namespace forceshade {

namespace {

VolumeHeader volume_header(const PreparedCase& prepared, int threads) {
    const Scene& scene = prepared.one.scene;
    VolumeHeader header;
    header.size = scene.grid.size;
    header.origin = scene.grid.origin;
    header.spacing = scene.grid.spacing;
    header.channels = written_channels(scene);
    set_options(header, prepared, scene, threads);
    return header;
}

// By base name: no path of the machine goes into results.
std::vector<FileRecord> inputs_of(const Scene& scene) {
    std::vector<FileRecord> inputs;
    const auto add = [&](const std::string& file, const std::string& sha256) {
        if (!sha256.empty())
            inputs.push_back({std::filesystem::path(file).filename().string(), sha256, 0});
    };
    if (scene.paths)
        add(scene.paths->file, scene.paths->sha256);
    if (scene.compare)
        add(scene.compare->file.file, scene.compare->file.sha256);
    add(scene.surface.mesh.file, scene.surface.mesh.sha256);
    add(scene.surface.map.file, scene.surface.map.sha256);
    if (scene.texture)
        add(scene.texture->map.file, scene.texture->map.sha256);
    return inputs;
}

bool stands_for_all_y(const Scene& scene) {
    return !depends_on_y(features_of(scene));
}

} // namespace

AlsoFormats parse_also(const std::vector<std::string>& names) {
    AlsoFormats also;
    for (const std::string& name : names) {
        if (name == "vti")
            also.vti = true;
        else if (name == "vtp")
            also.vtp = true;
        else if (name == "npy")
            also.npy = true;
        else if (!also.pictures.add(name))
            throw UsageError(
                fmt::format("--also {}: there are vti, vtp, npy, png, svg and pdf, with commas between them", name));
    }
    return also;
}

namespace {

// Of a field; force is always among the channels.
void add_field_files(const std::string& stem, std::uint32_t channels, AlsoFormats also,
                     std::vector<std::string>& names) {
    names.push_back(stem + ".exr");
    if (also.vti)
        names.push_back(stem + ".vti");
    if (also.npy)
        for (const layout::uint channel : kFieldChannels)
            if ((channels | layout::kChannelForce) & channel)
                names.push_back(fmt::format("{}.{}.npy", stem, name_of_channel(channel)));
    if (also.vtp)
        names.push_back(stem + ".vtp");
    for (const char* kind : {".mosaic", ".arrows", ".shading"})
        if (kind != std::string_view(".shading") || (channels & layout::kChannelUnshaded))
            std::ranges::move(picture::names_with(stem + kind, also.pictures), std::back_inserter(names));
}

void add_path_files(const std::string& stem, std::uint32_t channels, AlsoFormats also,
                    std::vector<std::string>& names) {
    for (std::string& name : path_file_names(path_options(stem + ".exr", also, 0), channels))
        names.push_back(std::move(name));
}

} // namespace

std::vector<std::string> file_names(const std::string& stem, const Scene& scene, AlsoFormats also) {
    std::vector<std::string> names;
    if (scene.field)
        add_field_files(stem, written_channels(scene), also, names);
    if (scene.paths)
        add_path_files(stem, written_channels(scene), also, names);
    return names;
}

std::vector<std::string> possible_file_names(const std::string& stem, AlsoFormats also) {
    std::vector<std::string> names;
    constexpr std::uint32_t kAll = ~0u;
    add_field_files(stem, kAll, also, names);
    add_path_files(stem, kAll, also, names);
    return names;
}

PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads) {
    const std::string stem = volume.stem().string();
    PathRunOptions options;
    options.samples = volume.parent_path() / (stem + ".paths.exr");
    options.stem = volume.parent_path() / stem;
    options.label = ".paths";
    options.npy = also.npy;
    options.vtp = also.vtp;
    options.pictures = also.pictures;
    options.threads = threads;
    return options;
}

CaseRecord empty_record(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    CaseRecord record;
    record.name = prepared.one.name;
    record.parameters = prepared.one.varied;
    record.inputs = inputs_of(scene);
    record.precision = name_of(scene.precision);
    record.omitted = omissions(scene);
    return record;
}

CaseOutput::CaseOutput(const PreparedCase& prepared, const std::filesystem::path& volume, AlsoFormats also,
                       const PictureChoice& pictures, int threads, bool exact_bits)
    : prepared_(prepared), volume_(volume), also_(also), pictures_(pictures), threads_(std::max(1, threads)),
      check_(prepared, exact_bits) {
    const Scene& scene = prepared.one.scene;
    const bool repeats = stands_for_all_y(scene);
    repeat_y_ = repeats ? scene.grid.size[1] : 1;
    evaluated_ = scene.grid.size[0] * scene.grid.size[2] * (repeats ? 1 : scene.grid.size[1]);
    const VolumeHeader header = volume_header(prepared, threads);
    const std::filesystem::path folder = volume.parent_path();
    const std::string stem = volume.stem().string();
    sinks_.emplace_back(stem + ".exr", std::make_unique<VolumeWriter>(volume, header));
    if (also.vti)
        sinks_.emplace_back(stem + ".vti", std::make_unique<VtiWriter>(
                                               folder / (stem + ".vti"),
                                               VtiHeader{header.size, header.origin, header.spacing, header.channels,
                                                         scene.precision, header.place_origin}));
    if (also.npy)
        for (const layout::uint channel : kFieldChannels)
            if (header.channels & channel) {
                const std::string name = fmt::format("{}.{}.npy", stem, name_of_channel(channel));
                sinks_.emplace_back(name, std::make_unique<NpyWriter>(folder / name, header.size, channel,
                                                                      scene.precision, header.place_origin));
            }
    if (scene.compare)
        compared_.emplace(prepared, static_cast<unsigned>(threads_));
    if (also.pictures.any())
        slices_ = std::make_unique<picture::SliceCollector>(scene.grid, repeats, pictures.slice);
}

template <typename T> void CaseOutput::write(const layout::FieldChunk<T>& chunk) {
    const auto write = [&](const layout::FieldChunk<T>& rows, std::size_t repeat_y) {
        for (auto& [name, sink] : sinks_)
            sink->write(rows, repeat_y);
    };
    if (compared_)
        compared_->field<T>(chunk, repeat_y_, write);
    else
        write(chunk, repeat_y_);
    if (slices_)
        slices_->add(chunk);
    timed(checking_, [&] { check_.add(chunk); });
}

template void CaseOutput::write<float>(const layout::FieldChunk<float>&);
template void CaseOutput::write<double>(const layout::FieldChunk<double>&);

CaseRecord CaseOutput::finish() {
    const Scene& scene = prepared_.one.scene;
    CaseRecord record = empty_record(prepared_);
    record.voxels = scene.grid.size[0] * scene.grid.size[1] * scene.grid.size[2];
    record.evaluated = evaluated_;
    timed(checking_, [&] { record.error = check_.compare(static_cast<unsigned>(threads_)); });
    // The volume comes first: it refuses what must not be published.
    for (auto& [name, sink] : sinks_) {
        const VolumeResult result = sink->finish();
        if (record.files.empty()) {
            record.volume_times = result.timings;
            record.largest_force = result.largest_force;
            record.largest_voxel = result.largest_voxel;
        }
        record.files.push_back({name, result.sha256, result.bytes});
    }
    if (compared_)
        record.deviation = compared_->record();
    record.volume_times.check = checking_;
    if (also_.vtp)
        add_surface(record);
    if (slices_)
        add_pictures(record);
    return record;
}

void CaseOutput::add_surface(CaseRecord& record) {
    const Stage stage("writing the surface of " + prepared_.one.name);
    const std::string name = volume_.stem().string() + ".vtp";
    const VolumeResult result = write_surface(volume_.parent_path() / name, prepared_);
    record.files.push_back({name, result.sha256, result.bytes});
}

void CaseOutput::add_pictures(CaseRecord& record) {
    const Stage stage("drawing " + prepared_.one.name);
    const picture::FieldSlice &slice = slices_->slice(), &unshaded = slices_->unshaded();
    const picture::Quantity quantity = pictures_.slice.quantity;
    const picture::SurfaceLines lines =
        pictures_.slice.axis == 1 ? surface_lines(prepared_, slice.axes.at) : picture::SurfaceLines{};
    const auto look = [&](bool with_shading, const char* more) {
        picture::Look titled = pictures_.look;
        if (titled.title.empty())
            titled.title = picture::title_of(prepared_.one, with_shading) + more;
        return titled;
    };
    const auto add = [&](const char* kind, const picture::Picture& drawn) {
        const std::filesystem::path stem = volume_.parent_path() / (volume_.stem().string() + kind);
        std::ranges::move(picture::write_picture(stem, also_.pictures, drawn), std::back_inserter(record.files));
    };
    add(".mosaic", picture::draw_mosaic(look(true, ""), slices_->tiles(), quantity));
    add(".arrows", picture::draw_arrows(look(true, ""), slice, lines, quantity, unshaded));
    if (!unshaded.force.empty())
        add(".shading", picture::draw_shading(look(false, ": what shading changes"), unshaded, slice, lines));
}

namespace {

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
    paths.warnings.clear();
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
        CaseOutput output(transfer.job->prepared, transfer.job->volume, transfer.job->also, transfer.job->pictures,
                          threads_a_volume_, engine_.software);
        while (const auto waiting = transfer.chunks.pop()) {
            check_interrupt();
            std::visit([&](const auto& owned) { output.write(owned.view); }, waiting->chunk);
        }
        if (!transfer.chunks.whole())
            return false;
        record = output.finish();
        record.engine_times = transfer.times;
        record.engine_times.prepare = transfer.job->prepared.seconds;
        if (transfer.job->prepared.images.mesh)
            record.evaluated = transfer.times.voxels_evaluated;
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

template <typename T> EngineTimes compute(Engine& engine, const CaseJob& job, ChunkQueue& chunks) {
    const FieldTables<T> tables = make_tables<T>(job.prepared.one.scene, job.prepared.images, Extent::what_varies);
    return engine.evaluate(tables.input(), [&](const layout::FieldChunk<T>& chunk) {
        check_interrupt();
        chunks.push(chunk);
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
            transfer->times = transfer->job->prepared.one.scene.precision == Precision::f32
                                  ? compute<float>(engine, *transfer->job, transfer->chunks)
                                  : compute<double>(engine, *transfer->job, transfer->chunks);
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

} // namespace forceshade
