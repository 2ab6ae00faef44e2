#include "host/cases/case_pipeline.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/cases/path_comparison.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/paths/path_files.h"
#include "host/paths/recorded.h"
#include "host/paths/scene_paths.h"
#include "host/picture/picture.h"
#include "host/program.h"
#include "host/threads.h"

namespace forceshade {

namespace {

constexpr layout::uint kAlways = layout::kChannelForce | layout::kChannelPosition;

bool is_csv(const std::filesystem::path& path) {
    return path.extension() == ".csv";
}

// The arrays alone: no file has the name itself.
bool is_npy(const std::filesystem::path& path) {
    return path.extension() == ".npy";
}
bool makes_arrays(const PathRunOptions& options) {
    return options.also.npy || is_npy(options.samples);
}

constexpr const char* kTimes = ".time.npy";

} // namespace

layout::uint path_channels(const PathRunOptions& options, layout::uint asked) {
    if (options.samples.empty())
        return 0;
    return is_csv(options.samples) ? kSampled | (asked & kComparedChannels)
                                   : (asked & (kSampled | kComparedChannels)) | kAlways;
}

layout::uint computed_channels(const PathRunOptions& options, layout::uint asked) {
    return (path_channels(options, asked) & kSampled) |
           (options.also.vtp ? layout::kChannelFacet | layout::kChannelDepth : 0);
}

std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels) {
    std::vector<std::string> names;
    const std::string stem = options.stem.filename().string();
    if (!options.samples.empty() && !is_npy(options.samples))
        names.push_back(options.samples.filename().string());
    names.push_back(stem + ".paths.csv");
    if (makes_arrays(options)) {
        for (const layout::uint channel : kPathChannels)
            if (path_channels(options, channels) & channel)
                names.push_back(stem + options.label + npy_kind(channel));
        names.push_back(stem + options.label + kTimes);
    }
    if (options.also.vtp)
        names.push_back(stem + options.label + ".vtp");
    std::ranges::move(picture::names_with(stem + ".paths", options.also.pictures), std::back_inserter(names));
    return names;
}

PathRunOptions path_options(const std::filesystem::path& volume, AlsoFormats also, int threads) {
    const std::string stem = volume.stem().string();
    PathRunOptions options;
    options.samples = volume.parent_path() / (stem + ".paths.exr");
    options.stem = volume.parent_path() / stem;
    options.label = ".paths";
    options.also = also;
    options.threads = threads;
    return options;
}

namespace {

// What files say of all paths.
struct WrittenPaths {
    std::uint64_t paths, steps; /* of the longest */
    std::uint64_t samples;      /* in all */
    double rate;                /* 1/s; 0: samples come at times of their own */
    PathLabels labels;
    bool recorded = false; /* each path has times of its own */
    std::string title;     /* what paths they are, for a picture */
};

class PathOutput {
public:
    PathOutput(const PreparedCase& prepared, const PathRunOptions& options, const WrittenPaths& written)
        : options_(options), written_(written),
          output_(prepared, options.stem, options.also.pictures, options.look, static_cast<unsigned>(options.threads),
                  !options.samples.empty()),
          summary_(output_.path_of(".paths.csv"), prepared.one.scene.precision) {
        const Precision precision = prepared.one.scene.precision;
        const bool compared = prepared.one.scene.compare.has_value();
        const layout::uint channels = path_channels(options, written_channels(prepared.one.scene));
        const glm::dvec3 origin = scene_origin(prepared);
        if (is_csv(options.samples))
            output_.open<PathCsvWriter>(options.samples, written_.labels, origin, compared);
        else if (!options.samples.empty() && !is_npy(options.samples))
            output_.open<PathVolumeWriter>(options.samples, header(channels));
        if (makes_arrays(options)) {
            for (const layout::uint channel : kPathChannels)
                if (channels & channel)
                    output_.open<PathNpyWriter>(output_.path_of(options.label + npy_kind(channel)), written_.paths,
                                                written_.steps, channel, precision, origin);
            output_.open<PathTimesWriter>(output_.path_of(options.label + kTimes), written_.recorded * written_.paths,
                                          written_.steps, written_.labels);
        }
        if (options.also.vtp)
            output_.open<PathVtpWriter>(output_.path_of(options.label + ".vtp"),
                                        PathVtpHeader{written_.paths, written_.samples,
                                                      (channels & layout::kChannelProxy) != 0, precision, compared,
                                                      origin},
                                        written_.labels);
        if (options.also.pictures.any())
            collector_.emplace(written_.paths, written_.steps, origin);
    }

    // Rows as a RowGatherer hands them on; and what each path was like, when it has ended.
    template <typename T> void write(const PathRows<T>& rows) {
        Compared* const compared = output_.compared();
        output_.write(compared ? compared->paths(rows) : rows);
        if (collector_)
            collector_->add(rows);
    }
    void add(std::uint64_t id, const PathFigures& figures) { summary_.add(id, figures); }

    // Publishes every file, and adds them and what [compare] says to the record. \throws as FieldOutput::finish().
    void finish(PathRecord& record) {
        if (!options_.samples.empty())
            output_.finish_first(record);
        add_file(record, output_.path_of(".paths.csv").filename().string(), summary_.finish());
        output_.finish_others(record);
        if (!collector_)
            return;
        const PathCollector::Reach reach = collector_->reach();
        const double border = std::max(0.05 * (reach.to - reach.from), 1e-9);
        const PreparedCase& prepared = output_.prepared();
        const picture::Look look = output_.look(fmt::format("{}, {}", picture::title_of(prepared.one), written_.title));
        const picture::SurfaceLines lines = surface_lines(prepared, {reach.from - border, reach.to + border, reach.y});
        output_.draw(".paths", collector_->draw(look, lines), record);
    }

private:
    PathVolumeHeader header(layout::uint channels) const {
        PathVolumeHeader header;
        header.steps = written_.steps;
        header.paths = written_.paths;
        header.rate = written_.rate;
        header.channels = channels;
        Scene of_paths = output_.scene();
        of_paths.field = false;
        set_options(header, output_.prepared(), of_paths, options_.threads);
        return header;
    }

    PathRunOptions options_;
    WrittenPaths written_;
    CaseOutput<PathSink> output_; // the samples first, if they are asked for
    PathSummary summary_;
    std::optional<PathCollector> collector_;
};

double rate_of(const Scene& scene) {
    return scene.paths ? scene.paths->rate : PathsSpec{}.rate;
}

// Null: the paths are generated.
template <typename T>
std::shared_ptr<const RecordedFile> read_paths(const PreparedCase& prepared, const PathRunOptions& options) {
    const std::optional<PathsSpec>& spec = prepared.one.scene.paths;
    const bool recorded = spec && spec->kind == PathKind::recorded;
    if (!options.recorded && !recorded)
        return nullptr;
    return read_recorded<T>(prepared, options.recorded.value_or(spec ? spec->path : ""));
}

// Reads the file alongside of an engine's rows, and sums up of each path how long it was in contact.
class RecordedTimes {
public:
    explicit RecordedTimes(std::shared_ptr<const RecordedFile> file)
        : file_(std::move(file)), cursor_(*file_), later_(*file_) {}

    // The times of these rows, which come in order; they need the channel of facets.
    template <typename T> void add(const PathRows<T>& rows) {
        first_ = rows.path_first;
        step_first_ = rows.step_first;
        if (rows.step_first == 0)
            contact_.assign(rows.path_count, ContactTime{});
        begins_.clear();
        times_.clear();
        for (std::size_t path = 0; path < rows.path_count; ++path) {
            begins_.push_back(times_.size());
            for (std::size_t i = 0; i < rows.samples(path); ++i) {
                times_.push_back(cursor_.next().time);
                contact_[path].add(times_.back(), rows.facet[path * rows.pitch + i] != layout::kNoFacet);
            }
        }
    }

    // s: of a sample of the rows added last.
    double at(std::uint64_t path, std::uint64_t step) const {
        return times_[begins_[path - first_] + (step - step_first_)];
    }
    // s: how long a path of the rows added last was in contact, once they end it.
    double contact_time(std::uint64_t path) const { return contact_[path - first_].total(); }
    // s: of a sample of a path, wherever it is; paths come in order.
    double later(std::uint64_t path, std::uint64_t step) {
        for (; later_path_ < path; ++later_path_)
            later_begin_ += file_->steps()[later_path_];
        later_.go_to(later_begin_ + step);
        return later_.next().time;
    }

private:
    std::shared_ptr<const RecordedFile> file_;
    RecordedCursor cursor_, later_;
    std::uint64_t first_ = 0;                        // path
    std::uint64_t step_first_ = 0;                   // of the rows
    std::vector<std::size_t> begins_;                // in times_, by path
    std::vector<double> times_;                      /* s */
    std::vector<ContactTime> contact_;               // by path
    std::uint64_t later_path_ = 0, later_begin_ = 0; // a path, and its first sample in the file
};

template <typename T> class Run : EngineAndOracle<T> {
public:
    Run(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options)
        : Run(engine, prepared, options, read_paths<T>(prepared, options)) {}
    Run(const Run&) = delete; // others keep where it is

    PathRecord run() {
        record_.paths = input.paths;
        record_.steps = input.steps;
        record_.stretch = paths.stretch();
        record_.engine_times = engine_.explore(
            input, [this](const layout::PathChunk<T>& chunk) { receive(chunk); },
            [this](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { receive(first, metrics); });
        written_.wait();
        finish();
        return record_;
    }

private:
    using Base = EngineAndOracle<T>;
    using Base::input, Base::oracle, Base::paths, Base::source;

    Run(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options,
        std::shared_ptr<const RecordedFile> file)
        : Base(prepared, file, channels_of(prepared, options, file != nullptr), engine.report().software,
               kComparedSamples),
          engine_(engine), is_oracle_(engine.report().engine == "cpu"), stem_(options.stem.string()),
          origin_(scene_origin(prepared)), progress_(options.progress), file_(std::move(file)),
          rate_(rate_of(prepared.one.scene)),
          total_(file_ ? file_->samples() : std::uint64_t(input.paths) * input.steps),
          gatherer_(source, [this](const PathRows<T>& rows) { receive(rows); }),
          output_(prepared, options, written(prepared.one.scene)) {
        if (file_)
            times_.emplace(file_);
    }

    // How long a recorded path was in contact is known from its samples alone.
    static layout::uint channels_of(const PreparedCase& prepared, const PathRunOptions& options, bool recorded) {
        return computed_channels(options, prepared.one.scene.output.channels) | (recorded ? layout::kChannelFacet : 0);
    }

    std::uint64_t id_of(std::uint64_t path) const { return file_ ? file_->ids()[path] : path; }
    double time_of(std::uint64_t path, std::uint64_t step) const {
        return times_ ? times_->at(path, step) : double(step) / rate_;
    }

    WrittenPaths written(const Scene& scene) {
        const bool own_times = file_ && input.features.loop == layout::kLoopOpen;
        return {input.paths,
                input.steps,
                total_,
                own_times ? 0 : rate_,
                {[this](std::uint64_t path) { return id_of(path); },
                 [this](std::uint64_t path, std::uint64_t step) { return time_of(path, step); }},
                file_ != nullptr,
                file_ ? "recorded paths" : picture::paths_title(*scene.paths)};
    }

    void receive(const layout::PathChunk<T>& chunk) {
        check_interrupt();
        if (input.features.channels != 0)
            gatherer_.add(chunk);
        progress(std::min(batch_samples(), chunk.path_count * (chunk.step_first + chunk.step_count)));
    }

    // The next batch is computed while this one is written: rows wait for their metrics, but those of a path alone come
    // in pieces.
    void receive(const PathRows<T>& rows) {
        if (rows.step_first + rows.pitch < source.longest())
            written_.add([this, rows] { write(rows); });
        else
            rows_ = rows;
    }
    void receive(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
        check_interrupt();
        written_.add([this, batch = Batch{std::exchange(rows_, std::nullopt),
                                          first,
                                          {metrics.begin(), metrics.end()},
                                          {source.lengths().begin(), source.lengths().end()},
                                          source.inside()}] { write(batch); });
        done_ += batch_samples();
        progress(0);
    }

    struct Batch {
        std::optional<PathRows<T>> rows;
        std::size_t first = 0; // path
        std::vector<layout::PathMetrics<T>> metrics;
        std::vector<layout::uint> steps;
        std::vector<bool> inside; // empty without a mesh
    };

    void write(const PathRows<T>& rows) {
        if (times_)
            times_->add(rows);
        require_finite(rows);
        if (!is_oracle_)
            oracle.compare(rows);
        output_.write(rows);
    }

    void require_finite(const PathRows<T>& rows) const {
        if (rows.force.empty())
            return;
        for (std::size_t path = 0; path < rows.path_count; ++path)
            for (std::size_t i = 3 * path * rows.pitch; i < 3 * (path * rows.pitch + rows.samples(path)); ++i)
                if (!std::isfinite(rows.force[i]) || !std::isfinite(rows.position[i]))
                    refuse(rows.path_first + path,
                           fmt::format(" at step {}, at ({}, {}, {}) m,", rows.step_first + i / 3 - path * rows.pitch,
                                       in_world(rows, i / 3, 0), in_world(rows, i / 3, 1), in_world(rows, i / 3, 2)));
    }

    // m: a coordinate of a sample's place, as short as its precision has it.
    std::string in_world(const PathRows<T>& rows, std::size_t sample, int axis) const {
        const T place = rows.position[3 * sample + std::size_t(axis)];
        return origin_[axis] != 0 ? fmt::format("{}", origin_[axis] + double(place)) : fmt::format("{}", place);
    }

    [[noreturn]] void refuse(std::uint64_t path, const std::string& where) const {
        throw Error(ExitCode::failed,
                    fmt::format("{}: the force on path {}{} is no finite number of this precision; nothing was written",
                                stem_, id_of(path), where));
    }

    void write(const Batch& batch) {
        if (batch.rows)
            write(*batch.rows);
        if (!is_oracle_)
            oracle.compare(batch.first, batch.metrics);
        const bool closed = input.features.loop == layout::kLoopClosed;
        for (std::size_t i = 0; i < batch.metrics.size(); ++i) {
            const layout::PathMetrics<T>& metrics = batch.metrics[i];
            const std::uint64_t path = batch.first + i;
            const bool inside = !batch.inside.empty() && batch.inside[i];
            const PathFigures figures =
                figures_of(metrics, {batch.steps[i], rate_, closed, inside, times_of(path, metrics)});
            if (!std::isfinite(figures.largest_force + figures.rms_force + figures.work + figures.steepest_turn))
                refuse(path, "");
            output_.add(id_of(path), figures);
            count(figures, metrics.contact_samples);
        }
    }

    std::optional<PathTimes> times_of(std::uint64_t path, const layout::PathMetrics<T>& metrics) {
        if (!times_)
            return std::nullopt;
        const bool left = metrics.unstable_step != layout::kNever;
        return PathTimes{times_->contact_time(path), left ? times_->later(path, metrics.unstable_step) : 0};
    }

    std::uint64_t batch_samples() const {
        return std::accumulate(source.lengths().begin(), source.lengths().end(), std::uint64_t(0));
    }

    void count(const PathFigures& figures, std::uint64_t contact) {
        record_.samples += figures.steps;
        record_.in_contact += contact;
        record_.unstable += figures.unstable_time.has_value();
        record_.fell += figures.fell;
        record_.began_inside += figures.began_inside;
        record_.unfinished += figures.unfinished;
        record_.largest_force = std::max(record_.largest_force, figures.largest_force);
        record_.work += figures.work;
        record_.effort += figures.effort;
        if (contact == 0)
            return;
        depth_ += double(contact) * *figures.mean_depth;
        depth_square_ += double(contact) * (*figures.mean_depth * *figures.mean_depth +
                                            *figures.depth_deviation * *figures.depth_deviation);
    }

    // `done`: of the present batch.
    void progress(std::uint64_t done) {
        stage_.update((done_ + done) / kMillion);
        if (progress_)
            progress_(done_ + done, total_);
    }

    void finish() {
        check_interrupt();
        if (file_)
            file_->require_unchanged();
        record_.error = oracle.error();
        record_.warnings = paths.warnings();
        if (record_.in_contact > 0) {
            const double samples = double(record_.in_contact);
            record_.mean_depth = depth_ / samples;
            record_.depth_deviation =
                std::sqrt(std::max(depth_square_ / samples - record_.mean_depth * record_.mean_depth, 0.0));
        }
        output_.finish(record_);
    }

    Engine& engine_;
    bool is_oracle_; // a comparison would compute the same again
    std::string stem_;
    glm::dvec3 origin_; /* m, in the world: of the places of rows */
    std::function<void(std::uint64_t, std::uint64_t)> progress_;
    std::shared_ptr<const RecordedFile> file_; // null: the paths are generated
    double rate_;                              /* 1/s */
    std::uint64_t total_ = 0, done_ = 0;       // samples: in all, and of the batches before
    static constexpr std::uint64_t kMillion = 1000000;
    Stage stage_{"exploring paths", total_ / kMillion, "million samples"};
    RowGatherer<T> gatherer_;
    std::optional<RecordedTimes> times_;
    PathOutput output_;
    double depth_ = 0, depth_square_ = 0; // m, m^2: sums over the samples in contact
    PathRecord record_;
    std::optional<PathRows<T>> rows_; // of the present batch, complete
    OneBehind written_;               // last: it uses the others
};

} // namespace

PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options) {
    return in_precision(prepared.one.scene.precision,
                        [&]<typename T>(std::type_identity<T>) { return Run<T>(engine, prepared, options).run(); });
}

} // namespace forceshade
