#include "host/cases/path_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "host/cases/case_files.h"
#include "host/cases/path_comparison.h"
#include "host/cases/sinks.h"
#include "host/error.h"
#include "host/field/comparison.h"
#include "host/long_run.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/rows.h"
#include "host/paths/path_files.h"
#include "host/paths/recorded.h"
#include "host/paths/scene_paths.h"
#include "host/picture/scene_picture.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr layout::uint kAlways = layout::kChannelForce | layout::kChannelPosition;

bool is_csv(const std::filesystem::path& path) {
    return path.extension() == ".csv";
}

// What the files hold; `asked`: the scene's channels.
layout::uint channels_for(const PathRunOptions& options, layout::uint asked) {
    if (options.samples.empty())
        return 0;
    return is_csv(options.samples) ? kSampled | (asked & kComparedChannels)
                                   : (asked & (kSampled | kComparedChannels)) | kAlways;
}

} // namespace

std::vector<std::string> path_file_names(const PathRunOptions& options, layout::uint channels) {
    std::vector<std::string> names;
    const std::string stem = options.stem.filename().string();
    if (!options.samples.empty())
        names.push_back(options.samples.filename().string());
    names.push_back(stem + ".paths.csv");
    if (options.npy)
        for (const layout::uint channel : kPathChannels)
            if (channels_for(options, channels) & channel)
                names.push_back(fmt::format("{}{}.{}.npy", stem, options.label, name_of_channel(channel)));
    if (options.vtp)
        names.push_back(fmt::format("{}{}.vtp", stem, options.label));
    std::ranges::move(picture::names_with(stem + ".paths", options.pictures), std::back_inserter(names));
    return names;
}

namespace {

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
    template <typename T> void add(const PathRows<T>& rows);

    // s: of a sample of the rows added last.
    double at(std::uint64_t path, std::uint64_t step) const;
    // s: how long a path of the rows added last was in contact, once they end it.
    double contact_time(std::uint64_t path) const { return contact_[path - first_].total(); }
    // s: of a sample of a path, wherever it is; paths come in order.
    double later(std::uint64_t path, std::uint64_t step);

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

template <typename T> void RecordedTimes::add(const PathRows<T>& rows) {
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

double RecordedTimes::at(std::uint64_t path, std::uint64_t step) const {
    return times_[begins_[path - first_] + (step - step_first_)];
}

double RecordedTimes::later(std::uint64_t path, std::uint64_t step) {
    for (; later_path_ < path; ++later_path_)
        later_begin_ += file_->steps()[later_path_];
    later_.go_to(later_begin_ + step);
    return later_.next().time;
}

template <typename T> class Run : EngineAndOracle<T> {
public:
    Run(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options)
        : Run(engine, prepared, options, read_paths<T>(prepared, options)) {}

    PathRecord run() {
        record_.paths = input.paths;
        record_.steps = input.steps;
        record_.stretch = paths.stretch();
        record_.engine_times = engine_.explore(
            input, [this](const layout::PathChunk<T>& chunk) { receive(chunk); },
            [this](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { receive(first, metrics); });
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
          engine_(engine), prepared_(prepared), origin_(scene_origin(prepared)), options_(options),
          file_(std::move(file)), rate_(rate_of(prepared.one.scene)),
          written_(channels_for(options, written_channels(prepared.one.scene))),
          total_(file_ ? file_->samples() : std::uint64_t(input.paths) * input.steps),
          gatherer_(source, [this](const PathRows<T>& rows) { receive(rows); }) {
        if (file_)
            times_.emplace(file_);
        open_files();
    }

    // How long a recorded path was in contact is known from its samples alone. Polylines always tell the contact.
    static layout::uint channels_of(const PreparedCase& prepared, const PathRunOptions& options, bool recorded) {
        layout::uint computed = channels_for(options, prepared.one.scene.output.channels) & kSampled;
        if (recorded)
            computed |= layout::kChannelFacet;
        if (options.vtp)
            computed |= layout::kChannelFacet | layout::kChannelDepth;
        return computed;
    }

    std::filesystem::path with_stem(const std::string& kind) const { return options_.stem.string() + kind; }

    void open_files() {
        const Scene& scene = prepared_.one.scene;
        if (!options_.samples.empty())
            sinks_.add(options_.samples, is_csv(options_.samples)
                                             ? std::unique_ptr<PathSink>(std::make_unique<PathCsvWriter>(
                                                   options_.samples, labels(), origin_, scene.compare.has_value()))
                                             : std::make_unique<PathVolumeWriter>(options_.samples, header()));
        summary_.emplace(with_stem(".paths.csv"), scene.precision);
        if (options_.npy)
            for (const layout::uint channel : kPathChannels)
                if (written_ & channel) {
                    const std::filesystem::path file =
                        with_stem(fmt::format("{}.{}.npy", options_.label, name_of_channel(channel)));
                    sinks_.add(file, std::make_unique<PathNpyWriter>(file, input.paths, input.steps, channel,
                                                                     scene.precision, origin_));
                }
        if (options_.vtp) {
            const std::filesystem::path file = with_stem(options_.label + ".vtp");
            sinks_.add(file, std::make_unique<PathVtpWriter>(
                                 file,
                                 PathVtpHeader{input.paths, total_, (written_ & layout::kChannelProxy) != 0,
                                               scene.precision, scene.compare.has_value(), origin_},
                                 labels()));
        }
        if (written_ & kComparedChannels)
            compared_.emplace(prepared_, static_cast<unsigned>(options_.threads));
        if (options_.pictures.any())
            collector_.emplace(input.paths, input.steps, origin_);
    }

    PathVolumeHeader header() const {
        const Scene& scene = prepared_.one.scene;
        PathVolumeHeader header;
        header.steps = input.steps;
        header.paths = input.paths;
        header.rate = file_ && input.features.loop == layout::kLoopOpen ? 0 : rate_;
        header.channels = written_;
        Scene of_paths = scene;
        of_paths.field = false;
        set_options(header, prepared_, of_paths, options_.threads);
        return header;
    }

    std::uint64_t id_of(std::uint64_t path) const { return file_ ? file_->ids()[path] : path; }
    double time_of(std::uint64_t path, std::uint64_t step) const {
        return times_ ? times_->at(path, step) : double(step) / rate_;
    }

    PathLabels labels() {
        return {[this](std::uint64_t path) { return id_of(path); },
                [this](std::uint64_t path, std::uint64_t step) { return time_of(path, step); }};
    }

    void receive(const layout::PathChunk<T>& chunk) {
        check_interrupt();
        if (input.features.channels != 0)
            gatherer_.add(chunk);
        progress(std::min(batch_samples(), chunk.path_count * (chunk.step_first + chunk.step_count)));
    }

    void receive(const PathRows<T>& rows) {
        if (times_)
            times_->add(rows);
        require_finite(rows);
        oracle.compare(rows);
        const PathRows<T> written = compared_ ? compared_->paths(rows) : rows;
        sinks_.write(written);
        if (collector_)
            collector_->add(rows);
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
                                options_.stem.string(), id_of(path), where));
    }

    void receive(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
        check_interrupt();
        oracle.compare(first, metrics);
        const bool closed = input.features.loop == layout::kLoopClosed;
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            const bool inside = !source.inside().empty() && source.inside()[i];
            const PathFigures figures =
                figures_of(metrics[i], {source.lengths()[i], rate_, closed, inside, times_of(first + i, metrics[i])});
            if (!std::isfinite(figures.largest_force + figures.rms_force + figures.work + figures.steepest_turn))
                refuse(first + i, "");
            summary_->add(id_of(first + i), figures);
            count(figures, metrics[i].contact_samples);
        }
        done_ += batch_samples();
        progress(0);
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
        if (options_.progress)
            options_.progress(done_ + done, total_);
    }

    void finish() {
        check_interrupt();
        if (file_)
            file_->require_unchanged();
        record_.error = oracle.error();
        record_.warnings = paths.warnings();
        if (compared_)
            record_.deviation = compared_->record();
        if (record_.in_contact > 0) {
            const double samples = double(record_.in_contact);
            record_.mean_depth = depth_ / samples;
            record_.depth_deviation =
                std::sqrt(std::max(depth_square_ / samples - record_.mean_depth * record_.mean_depth, 0.0));
        }
        if (!options_.samples.empty())
            sinks_.finish_first(record_);
        add_file(record_, with_stem(".paths.csv").filename().string(), summary_->finish());
        sinks_.finish_others(record_);
        if (collector_)
            add_picture();
    }

    void add_picture() {
        const PathCollector::Reach reach = collector_->reach();
        const double border = std::max(0.05 * (reach.to - reach.from), 1e-9);
        picture::Look look = options_.look;
        if (look.title.empty())
            look.title = fmt::format("{}, {}", picture::title_of(prepared_.one),
                                     file_ ? "recorded paths" : picture::paths_title(*prepared_.one.scene.paths));
        const picture::Picture drawn =
            collector_->draw(look, surface_lines(prepared_, {reach.from - border, reach.to + border, reach.y}));
        std::ranges::move(picture::write_picture(with_stem(".paths"), options_.pictures, drawn),
                          std::back_inserter(record_.files));
    }

    Engine& engine_;
    const PreparedCase& prepared_;
    const glm::dvec3 origin_; /* m, in the world: of the places of rows */
    const PathRunOptions& options_;
    std::shared_ptr<const RecordedFile> file_; // null: the paths are generated
    double rate_;                              /* 1/s */
    layout::uint written_;                     // channels
    std::uint64_t total_ = 0, done_ = 0;       // samples: in all, and of the batches before
    static constexpr std::uint64_t kMillion = 1000000;
    Stage stage_{"exploring paths", total_ / kMillion, "million samples"};
    RowGatherer<T> gatherer_;
    std::optional<RecordedTimes> times_;
    Sinks<PathSink> sinks_; // the samples first, if they are asked for
    std::optional<PathSummary> summary_;
    std::optional<Compared> compared_; // with [compare]
    std::optional<PathCollector> collector_;
    double depth_ = 0, depth_square_ = 0; // m, m^2: sums over the samples in contact
    PathRecord record_;
};

} // namespace

PathRecord run_paths(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options) {
    if (prepared.one.scene.precision == Precision::f32)
        return Run<float>(engine, prepared, options).run();
    return Run<double>(engine, prepared, options).run();
}

} // namespace forceshade
