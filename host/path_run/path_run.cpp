#include "host/path_run/path_run.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "host/error.h"
#include "host/interrupt.h"
#include "host/io/chunk_rows.h"
#include "host/io/exr_paths.h"
#include "host/io/hash.h"
#include "host/io/temporary_file.h"
#include "host/outline/surface_lines.h"
#include "host/path_output/path_csv.h"
#include "host/path_output/path_figures.h"
#include "host/path_output/path_npy.h"
#include "host/path_output/path_picture.h"
#include "host/path_output/path_summary.h"
#include "host/path_run/path_files.h"
#include "host/path_run/recorded_times.h"
#include "host/paths/recorded_paths.h"
#include "host/paths/scene_paths.h"
#include "host/version.h"

namespace forceshade {
namespace {

double rate_of(const Scene& scene) {
    return scene.paths ? scene.paths->rate : PathsSpec{}.rate;
}

template <typename T>
std::unique_ptr<ScenePaths<T>> make_paths(const PreparedCase& prepared, const PathRunOptions& options) {
    if (const std::filesystem::path file = recorded_file(prepared.one.scene, options); !file.empty())
        return std::make_unique<ScenePaths<T>>(prepared, file);
    return std::make_unique<ScenePaths<T>>(prepared);
}

struct NamedSink {
    std::string name;
    std::unique_ptr<PathSink> sink;
};

template <typename T> class Run {
public:
    Run(Engine& engine, const PreparedCase& prepared, const PathRunOptions& options)
        : engine_(engine), prepared_(prepared), options_(options), paths_(make_paths<T>(prepared, options)),
          alike_(make_paths<T>(prepared, options)), input_(paths_->input()), rate_(rate_of(prepared.one.scene)) {
        if (!recorded_file(prepared.one.scene, options).empty() && paths_->ids().empty())
            throw UsageError("recorded paths go through --engine cpu into a .csv file, in open loop; nothing else can "
                             "take them yet");
        const layout::uint channels = channels_for(options, prepared.one.scene.output.channels);
        input_.features.channels = channels;
        source_ = std::make_unique<BatchedSource<T>>(*paths_, input_.steps, paths_that_fit(input_));
        input_.source = source_.get();
        layout::PathInput<T> same = alike_->input();
        same.features.channels = channels;
        oracle_ = std::make_unique<PathOracle<T>>(same, engine.report().software);
        gatherer_ =
            std::make_unique<RowGatherer<T>>(*source_, input_.steps, [this](const PathRows<T>& rows) { take(rows); });
        open_files();
    }

    PathRecord run() {
        record_.paths = input_.paths;
        record_.steps = input_.steps;
        record_.engine_times = engine_.explore(
            input_, [this](const layout::PathChunk<T>& chunk) { take(chunk); },
            [this](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { take(first, metrics); });
        finish();
        return record_;
    }

private:
    std::filesystem::path beside(const std::string& kind) const { return options_.stem.string() + kind; }

    void open_files() {
        const Scene& scene = prepared_.one.scene;
        if (!options_.samples.empty())
            add_sink(options_.samples,
                     is_csv(options_.samples)
                         ? std::unique_ptr<PathSink>(std::make_unique<PathCsvWriter>(options_.samples, labels()))
                         : std::make_unique<PathVolumeWriter>(options_.samples, header()));
        summary_.emplace(beside(".paths.csv"), scene.precision);
        if (options_.npy)
            for (const layout::uint channel : kPathChannels)
                if (input_.features.channels & channel) {
                    const std::filesystem::path file =
                        beside(fmt::format("{}.{}.npy", options_.label, name_of_channel(channel)));
                    add_sink(file, std::make_unique<PathNpyWriter>(file, input_.paths, input_.steps, channel,
                                                                   scene.precision));
                }
        if (options_.png)
            collector_.emplace(input_.paths, input_.steps);
    }

    void add_sink(const std::filesystem::path& file, std::unique_ptr<PathSink> sink) {
        sinks_.push_back({file.filename().string(), std::move(sink)});
    }

    PathVolumeHeader header() const {
        const Scene& scene = prepared_.one.scene;
        PathVolumeHeader header;
        header.steps = input_.steps;
        header.paths = input_.paths;
        header.rate = rate_;
        header.channels = input_.features.channels;
        header.compression = scene.output.compression;
        header.pixel = scene.output.pixel;
        header.scene = prepared_.scene;
        header.version = version();
        header.omitted = fmt::format("{}", fmt::join(omissions(scene), "; "));
        header.threads = options_.threads;
        return header;
    }

    std::uint64_t id_of(std::uint64_t path) const { return paths_->ids().empty() ? path : paths_->ids()[path]; }

    PathLabels labels() {
        const auto id = [this](std::uint64_t path) { return id_of(path); };
        if (paths_->ids().empty())
            return {id, [this](std::uint64_t, std::uint64_t step) { return double(step) / rate_; }};
        const std::filesystem::path file = recorded_file(prepared_.one.scene, options_);
        const auto times = std::make_shared<RecordedTimes>(file, kRecordedSamples);
        return {id, [times](std::uint64_t path, std::uint64_t step) { return times->at(path, step); }};
    }

    void take(const layout::PathChunk<T>& chunk) {
        check_interrupt();
        if (input_.features.channels != 0)
            gatherer_->add(chunk);
        progress(chunk.path_first * input_.steps + chunk.path_count * (chunk.step_first + chunk.step_count));
    }

    void take(const PathRows<T>& rows) {
        require_finite(rows);
        oracle_->compare(rows);
        for (NamedSink& sink : sinks_) {
            check_interrupt();
            sink.sink->write(rows);
        }
        if (collector_)
            collector_->add(rows);
    }

    void require_finite(const PathRows<T>& rows) const {
        for (std::size_t path = 0; path < rows.path_count; ++path)
            for (std::size_t i = 3 * path * rows.pitch; i < 3 * (path * rows.pitch + rows.steps[path]); ++i)
                if (!std::isfinite(rows.force[i]) || !std::isfinite(rows.position[i]))
                    refuse(rows.path_first + path,
                           fmt::format(" at step {}, at ({}, {}, {}) m,", i / 3 - path * rows.pitch,
                                       rows.position[i / 3 * 3], rows.position[i / 3 * 3 + 1],
                                       rows.position[i / 3 * 3 + 2]));
    }

    [[noreturn]] void refuse(std::uint64_t path, const std::string& where) const {
        throw Error(ExitCode::failed,
                    fmt::format("{}: the force on path {}{} is no finite number of this precision; nothing was written",
                                options_.stem.string(), id_of(path), where));
    }

    void take(std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
        check_interrupt();
        oracle_->compare(first, metrics);
        const bool closed = input_.features.loop == layout::kLoopClosed;
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            const bool inside = !source_->inside().empty() && source_->inside()[i];
            const PathFigures figures = figures_of(metrics[i], {source_->lengths()[i], rate_, closed, inside});
            if (!std::isfinite(figures.largest_force + figures.rms_force + figures.work))
                refuse(first + i, "");
            summary_->add(id_of(first + i), figures);
            count(figures, metrics[i].contact_samples);
        }
        progress((first + metrics.size()) * input_.steps);
    }

    void count(const PathFigures& figures, std::uint64_t contact) {
        record_.samples += figures.steps;
        record_.in_contact += contact;
        record_.unstable += figures.unstable_time.has_value();
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

    void progress(std::uint64_t done) const {
        if (options_.progress)
            options_.progress(done, std::uint64_t(input_.paths) * input_.steps);
    }

    void add_file(const std::string& name, const VolumeResult& result) {
        record_.files.push_back({name, result.sha256, result.bytes});
        record_.volume_times.encode += result.timings.encode;
        record_.volume_times.flush += result.timings.flush;
        record_.volume_times.read_back += result.timings.read_back;
        record_.volume_times.hash += result.timings.hash;
    }

    void finish() {
        check_interrupt();
        record_.error = oracle_->error();
        record_.warnings = paths_->warnings();
        if (record_.in_contact > 0) {
            const double samples = double(record_.in_contact);
            record_.mean_depth = depth_ / samples;
            record_.depth_deviation =
                std::sqrt(std::max(depth_square_ / samples - record_.mean_depth * record_.mean_depth, 0.0));
        }
        // The samples come first: they refuse what must not be published.
        if (!options_.samples.empty())
            add_file(sinks_.front().name, sinks_.front().sink->finish());
        add_file(beside(".paths.csv").filename().string(), summary_->finish());
        for (std::size_t i = 1; i < sinks_.size(); ++i)
            add_file(sinks_[i].name, sinks_[i].sink->finish());
        if (collector_)
            add_picture();
    }

    void add_picture() {
        const PathCollector::Reach reach = collector_->reach();
        const double border = std::max(0.05 * (reach.to - reach.from), 1e-9);
        const picture::Picture drawn = collector_->draw(
            prepared_.one.name, surface_lines(prepared_, {reach.from - border, reach.to + border, reach.y}));
        const auto bytes = std::as_bytes(std::span(drawn.png));
        const std::filesystem::path file = beside(".paths.png");
        write_file_atomically(file, bytes);
        record_.files.push_back({file.filename().string(), sha256_of(bytes), bytes.size()});
    }

    Engine& engine_;
    const PreparedCase& prepared_;
    const PathRunOptions& options_;
    std::unique_ptr<ScenePaths<T>> paths_, alike_; // the engine's, and the oracle's
    layout::PathInput<T> input_;
    double rate_; /* 1/s */
    std::unique_ptr<BatchedSource<T>> source_;
    std::unique_ptr<PathOracle<T>> oracle_;
    std::unique_ptr<RowGatherer<T>> gatherer_;
    std::vector<NamedSink> sinks_; // the samples first, if there are any
    std::optional<PathSummary> summary_;
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
