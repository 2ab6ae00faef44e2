#include "host/study/error_time/error_time.h"

#include <algorithm>
#include <cmath>
#include <fcntl.h>
#include <map>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/cases/case_pipeline.h"
#include "host/clock.h"
#include "host/field/case_law.h"
#include "host/output/files.h"
#include "host/paths/scene_paths.h"
#include "host/study/error_time/volumes.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kRates[] = {1000, 2000, 4000, 8000, 16000}; // Hz
constexpr double kStrokeSeconds = 1.2;
constexpr double kSettled = 0.6; // s: by then the ringing of the first contact is small
constexpr std::uint64_t kStrokes = 16;
constexpr Precision kPrecisions[] = {Precision::f32, Precision::f64};

// Where the probe was and what force it met, at each millisecond of each stroke once it has settled.
struct Stroked {
    std::vector<glm::dvec3> position, force; /* m, N */
    double seconds = 0;                      /* that the computation took */
};

template <typename T> Stroked stroked_in(const PreparedCase& variant, double rate, Engine& engine) {
    PreparedCase prepared = variant;
    PathsSpec& paths = *prepared.one.scene.paths;
    paths.rate = rate;
    paths.count = kStrokes;
    paths.steps = static_cast<std::uint64_t>(std::lround(kStrokeSeconds * rate)) + 1;
    const auto every = static_cast<std::size_t>(std::lround(rate / kRates[0])), marks = (paths.steps - 1) / every + 1;
    const auto first = static_cast<std::size_t>(kSettled * kRates[0]);
    ScenePaths<T> source(prepared);
    layout::PathInput<T> input = source.input();
    input.features.channels = layout::kChannelForce | layout::kChannelPosition;
    Stroked stroked;
    stroked.position.resize(kStrokes * (marks - first));
    stroked.force.resize(kStrokes * (marks - first));
    const auto keep = [&](const layout::PathChunk<T>& chunk) {
        for (std::size_t row = 0; row < chunk.path_count; ++row)
            for (std::size_t i = 0; i < chunk.step_count; ++i)
                if (const std::size_t mark = (chunk.step_first + i) / every;
                    (chunk.step_first + i) % every == 0 && mark >= first) {
                    const std::size_t from = 3 * (i * chunk.pitch + row),
                                      to = (chunk.path_first + row) * (marks - first) + mark - first;
                    stroked.position[to] = {chunk.position[from], chunk.position[from + 1], chunk.position[from + 2]};
                    stroked.force[to] = {chunk.force[from], chunk.force[from + 1], chunk.force[from + 2]};
                }
    };
    stroked.seconds = engine.explore<T>(input, keep, [](std::size_t, const auto&) {}).kernel;
    return stroked;
}

Stroked stroked(const PreparedCase& variant, double rate, Precision precision, Engine& engine) {
    return in_precision(precision,
                        [&]<typename T>(std::type_identity<T>) { return stroked_in<T>(variant, rate, engine); });
}

// What strokes tend to as their rate grows: a loop is off by what is proportional to its period (Richardson). Across a
// rim, which strokes cross at different times, that holds of the probe alone; the force is the law's there, if it has
// no history.
Stroked strokes_in_the_limit(const PreparedCase& variant, Engine& engine) {
    Stroked strokes = stroked(variant, kFinestRate, Precision::f64, engine);
    const Stroked slower = stroked(variant, kFinestRate / 2, Precision::f64, engine);
    const CaseLaw<double> law(variant);
    for (std::size_t i = 0; i < strokes.position.size(); ++i) {
        strokes.position[i] += strokes.position[i] - slower.position[i];
        strokes.force[i] = variant.images.mesh ? strokes.force[i] + strokes.force[i] - slower.force[i]
                                               : glm::dvec3(law.at(strokes.position[i]).force);
    }
    return strokes;
}

// Of values of all strokes, one after the other, those of one.
std::vector<glm::dvec3> stroke_of(const std::vector<glm::dvec3>& values, std::size_t stroke) {
    const auto length = static_cast<std::ptrdiff_t>(values.size() / kStrokes);
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(stroke) * length;
    return {first, first + length};
}

// The RMS error of a field read between its samples, over the RMS true force: that of the look-up with its spacing,
// over the draws.
std::optional<Interval> look_up_error(const Measured& measured, const FieldRun& run) {
    const std::vector<std::size_t> found = measured.find([&](const Method& method) {
        return method.variant == run.variant && method.family == "look-up, trilinear" && method.precision == "f32" &&
               method.spacing == run.grid.spacing[0];
    });
    return found.empty() ? std::nullopt : rms_over_draws(*measured.methods[found[0]].errors, &ForceErrors::typical);
}

// A finer field takes long where free space is visited.
constexpr std::uint64_t kMostVisited = 250000; // voxels

} // namespace

bool FieldEngine::fits(const Variant& variant, const GridSpec& grid, Precision precision) const {
    if (visits)
        return variant.prepared->images.mesh && precision == Precision::f32 &&
               grid.size[0] * grid.size[1] * grid.size[2] < kMostVisited;
    return precision == Precision::f32 || engine->report().f64;
}

double rms(const std::vector<glm::dvec3>& values, const std::vector<glm::dvec3>* less) {
    double squares = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const glm::dvec3 value = less ? values[i] - (*less)[i] : values[i];
        squares += reference::dot(value, value);
    }
    return std::sqrt(squares / static_cast<double>(values.size()));
}

// The median distance of two forces over the RMS of the second.
double median_error(const std::vector<glm::dvec3>& found, const std::vector<glm::dvec3>& truth) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < found.size(); ++i)
        errors.push_back(reference::length(found[i] - truth[i]));
    return quantile(errors, 0.5) / rms(truth);
}

std::vector<double> FieldRun::whole() const {
    std::vector<double> sums = seconds;
    for (std::size_t i = 0; i < sums.size() && starts.size() == sums.size(); ++i)
        sums[i] += starts[i];
    return sums;
}

std::vector<FieldRun> field_runs(const Subject& subject, const std::vector<FieldEngine>& engines) {
    std::vector<FieldRun> runs;
    if (const Variant* variant = subject.main_variant())
        for (const double spacing : subject.spacings) {
            const GridSpec grid = volume_grid(subject.low, subject.high, spacing, glm::dvec3(0));
            for (const FieldEngine& by : engines)
                for (const Precision precision : kPrecisions)
                    if (by.fits(*variant, grid, precision))
                        runs.push_back({variant, subject.name, grid, by.name, precision, by.engine, by.words});
        }
    return runs;
}

namespace {

// s: of the program's own `field` on a scene of one block, with an engine's words: what a command takes before and
// after its field. Empty where this is not the program.
std::optional<double> start_seconds(const std::vector<std::string>& engine, const std::filesystem::path& folder) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe");
    if (!program.ends_with("/forceshade"))
        return std::nullopt;
    const std::filesystem::path scene = folder / ".start.toml", volume = folder / ".start.exr";
    write_file_atomically(scene, "grid = {size = [4, 4, 4]}\n");
    std::vector<std::string> words{program, "field", scene, "--out", volume, "--overwrite", "--quiet"};
    append(words, engine);
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&quiet, stream, "/dev/null", O_RDWR, 0);
    pid_t child = -1;
    int status = -1;
    const Clock::time_point start = Clock::now();
    const bool ran = posix_spawn(&child, program.c_str(), &quiet, nullptr, arguments.data(), environ) == 0 &&
                     waitpid(child, &status, 0) == child && status == 0;
    const double seconds = seconds_since(start);
    posix_spawn_file_actions_destroy(&quiet);
    for (const std::filesystem::path& file : {scene, volume}) {
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
    }
    return ran ? std::optional(seconds) : std::nullopt;
}

} // namespace

void measure(std::vector<FieldRun>& runs, const std::filesystem::path& folder) {
    std::map<std::vector<std::string>, std::optional<double>> starts; // by the engine's words
    for (FieldRun& run : runs) {
        if (!starts.contains(run.words))
            starts[run.words] = start_seconds(run.words, folder);
        if (starts[run.words])
            run.starts.push_back(*starts[run.words]);
        const std::filesystem::path volume = folder / ".field-run.exr";
        auto job = std::make_unique<CaseJob>(CaseJob{*run.variant->prepared, volume, ""});
        Scene& scene = job->prepared.one.scene;
        scene.grid = run.grid;
        scene.field = true; // a scene of paths alone has none
        scene.paths.reset();
        scene.output.channels = layout::kChannelForce;
        set_precision(job->prepared.one, run.precision);
        std::exception_ptr error;
        const Clock::time_point start = Clock::now();
        run_cases(
            *run.engine, [&] { return std::move(job); }, 1, {},
            [&](const CaseOutcome& done) {
                error = done.error;
                run.bytes = done.error ? 0 : static_cast<double>(done.record.files.front().bytes);
            });
        run.seconds.push_back(seconds_since(start));
        std::error_code ignored;
        std::filesystem::remove(volume, ignored);
        if (error)
            std::rethrow_exception(error);
    }
}

std::vector<LoopRun> loop_runs(const std::string& surface, const Variant& variant, Engine& single_thread,
                               std::size_t rounds) {
    const PreparedCase& prepared = *variant.prepared;
    const Stroked truth = strokes_in_the_limit(prepared, single_thread);
    std::vector<LoopRun> runs;
    for (const double rate : kRates)
        for (const Precision precision : kPrecisions) {
            const Stroked found = stroked(prepared, rate, precision, single_thread);
            std::vector<double> by_stroke;
            for (std::size_t i = 0; i < kStrokes; ++i)
                by_stroke.push_back(median_error(stroke_of(found.force, i), stroke_of(truth.force, i)));
            runs.push_back({surface, &variant, rate, precision, rms(found.force, &truth.force) / rms(truth.force),
                            median_error(found.force, truth.force), rms(found.position, &truth.position),
                            bootstrap_median(by_stroke)});
        }
    std::vector<std::vector<double>> seconds(runs.size());
    for (std::size_t round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < runs.size(); ++i)
            seconds[i].push_back(stroked(prepared, runs[i].rate, runs[i].precision, single_thread).seconds);
    for (std::size_t i = 0; i < runs.size(); ++i)
        runs[i].seconds = quantile(seconds[i], 0.5) / (kStrokeSeconds * kStrokes);
    return runs;
}

// Tables, figures and findings.
namespace {

std::vector<Table> run_tables(const Measured& measured, const std::vector<FieldRun>& fields,
                              const std::vector<LoopRun>& loops) {
    using R = FieldRun;
    const auto time = [](double share) { return [share](const R& r) { return quantile(r.whole(), share); }; };
    return {
        table_of<R>("field_runs", "Whole fields, with their files",
                    {{"surface", "", "as in ways", &R::surface},
                     {"law", "", "the law of the field", [](const R& r) { return r.variant->name; }},
                     {"series", "", "engine and precision",
                      [](const R& r) { return fmt::format("{}, {}", r.by, forceshade::name_of(r.precision)); }},
                     {"spacing_mm", "mm", "of the grid", [](const R& r) { return 1e3 * r.grid.spacing[0]; }},
                     {"voxels", "1", "of the grid",
                      [](const R& r) { return double(r.grid.size[0] * r.grid.size[1] * r.grid.size[2]); }},
                     {"field_s", "s", "evaluated, compressed, written to disk and checked, median",
                      [](const R& r) { return quantile(r.seconds, 0.5); }},
                     {"start_s", "s",
                      "of the command with a field of one block: program, engine and file, median; empty: not known",
                      [](const R& r) { return r.starts.empty() ? NAN : quantile(r.starts, 0.5); }},
                     {"time_s", "s", "of the whole command: both, median", time(0.5)},
                     {"time_low_s", "s", "the least", time(0)},
                     {"time_high_s", "s", "the largest", time(1)},
                     {"file_bytes", "B", "of the EXR file", [](const R& r) { return r.bytes; }},
                     {"typical_rms_1", "1",
                      "error of the force between the samples (trilinear) over the RMS true force, root mean "
                      "square, at the median of random draws of places and grid",
                      [&](const R& r) {
                          const auto error = look_up_error(measured, r);
                          return error ? Cell(error->median) : Cell();
                      }}},
                    fields),
        table_of<LoopRun>(
            "loop_rates", "Strokes of a hand in closed loop, by the loop's rate",
            {{"surface", "", "as in ways", &LoopRun::surface},
             {"law", "", "of the force", [](const LoopRun& r) { return r.variant->name; }},
             {"precision", "", "of the loop", [](const LoopRun& r) { return forceshade::name_of(r.precision); }},
             {"rate_kHz", "kHz", "of the loop", [](const LoopRun& r) { return r.rate / 1000; }},
             {"force_error_1", "1",
              "RMS difference from the force at the same time of an ever faster loop, extrapolated, over its RMS",
              &LoopRun::force_error},
             {"median_error_1", "1", "median difference of the force, over the same RMS", &LoopRun::median_error},
             {"position_error_um", "um", "RMS difference of the probe's position",
              [](const LoopRun& r) { return 1e6 * r.position_error; }},
             {"time_ms", "ms", "of computing, for a second of a stroke, on one thread, median",
              [](const LoopRun& r) { return 1e3 * r.seconds; }}},
            loops)};
}

std::vector<Figure> run_figures(const std::vector<FieldRun>& fields, const std::vector<LoopRun>& loops) {
    std::vector<Figure> figures;
    if (!fields.empty())
        figures.push_back(make_figure(
            "field-runs", fmt::format("Fields of \"{}\": error between samples against time", fields.front().surface),
            "Each mark is a whole command: the program and its engine started, the field evaluated, compressed, "
            "written and checked. Its label is the grid's spacing in mm. The error is that of reading between the "
            "samples, root mean square.",
            FigureKind::scatter, "field_runs", {{"surface", fields.front().surface}},
            {"time_s", "time of the command / s", true}, {"typical_rms_1", "RMS error over the RMS force", true},
            "series", "spacing_mm", {.x_low = "time_low_s", .x_high = "time_high_s", .joined = true}));
    if (!loops.empty())
        figures.push_back(make_figure(
            "loop-rates", "Strokes in closed loop: error against time, by the loop's rate",
            "Each mark is a rate, in kHz, of the same strokes of a hand that presses. The error is the median "
            "difference of the force from that of an ever faster loop, over its RMS.",
            FigureKind::scatter, "loop_rates", {{"precision", "f64"}},
            {"time_ms", "time for a second of a stroke / ms", true},
            {"median_error_1", "median error of the force", true}, "surface", "rate_kHz", {.joined = true}));
    return figures;
}

std::vector<Finding> run_findings(const Measured& measured, const std::vector<FieldRun>& fields,
                                  const std::vector<LoopRun>& loops) {
    std::vector<Finding> findings;
    const auto in_percent = [](const Interval& share) {
        const std::string median = fmt::format("{:.3g}", 100 * share.median);
        return share.low == share.high ? median // strokes that do not differ
                                       : fmt::format("{} [{:.3g}, {:.3g}]", median, 100 * share.low, 100 * share.high);
    };
    const auto in_double = [&](double rate) {
        return std::ranges::find_if(loops,
                                    [&](const LoopRun& r) { return r.rate == rate && r.precision == Precision::f64; });
    };
    if (const auto slow = in_double(1000), fast = in_double(4000);
        slow != loops.end() && std::isfinite(slow->median_error + fast->median_error)) {
        const bool of_first_order = std::abs(slow->median_error / fast->median_error / 4 - 1) < 0.25;
        const bool crosses_rims = slow->force_error > 3 * slow->median_error;
        const auto single = std::ranges::find_if(loops, [](const LoopRun& r) { return r.precision == Precision::f32; });
        const bool as_double = single != loops.end() && single->rate == slow->rate &&
                               std::abs(single->median_error / slow->median_error - 1) < 0.05;
        findings.push_back(
            {"loop_rate",
             fmt::format("Stroking, the force of a loop of 1 kHz is off that of an ever faster loop by {} % of the RMS "
                         "force, that of one of 4 kHz by {} % (median){}. {} RMS error is {:.2g} and {:.2g} %.{}",
                         in_percent(slow->by_stroke), in_percent(fast->by_stroke),
                         of_first_order ? ", an error in proportion to the period" : "",
                         crosses_rims ? "Where a stroke crosses a rim earlier or later it is off by far more, so that "
                                        "the"
                                      : "The",
                         100 * slow->force_error, 100 * fast->force_error,
                         as_double ? " Single precision adds nothing to that." : ""),
             "loop-rates", fmt::format("{}, {}", slow->surface, slow->variant->name),
             fmt::format("{} strokes of {} s with the scene's hand, without their first {} s", kStrokes, kStrokeSeconds,
                         kSettled),
             "95 % bootstrap interval of the median"});
    }
    // By the engine that is the quickest at the finest spacing, as `auto` takes it.
    std::vector<const FieldRun*> runs;
    for (const FieldRun& run : fields)
        if (run.surface == fields.front().surface && run.precision == Precision::f32)
            runs.push_back(&run);
    std::ranges::sort(runs, {},
                      [](const FieldRun* run) { return std::pair(run->grid.spacing[0], quantile(run->whole(), 0.5)); });
    if (runs.empty())
        return findings;
    const FieldRun* const fine = runs.front();
    std::erase_if(runs, [&](const FieldRun* run) { return run->by != fine->by; });
    if (runs.size() < 2 || !measured.steady())
        return findings;
    const FieldRun* const coarse = runs[1];
    const auto of_fine = look_up_error(measured, *fine), of_coarse = look_up_error(measured, *coarse);
    if (!of_fine || !of_coarse)
        return findings;
    const auto over_draws = [](const Interval& error) {
        return fmt::format("{:.1f} ({:.1f} to {:.1f})", 100 * error.median, 100 * error.low, 100 * error.high);
    };
    std::vector<double> ratios;
    const std::vector<double> of_one = fine->whole(), of_other = coarse->whole();
    for (std::size_t i = 0; i < of_one.size(); ++i)
        ratios.push_back(of_one[i] / of_other[i]);
    findings.push_back(
        {"field_spacing",
         fmt::format("The command for a field of {:.2g} mm instead of {:.2g} mm {}; the RMS error of reading between "
                     "its samples is {} instead of {} % of the RMS force, and the file has {:.1f} times the bytes.",
                     1e3 * fine->grid.spacing[0], 1e3 * coarse->grid.spacing[0],
                     times_as_long(bootstrap_median(ratios), "that one"), over_draws(*of_fine), over_draws(*of_coarse),
                     fine->bytes / coarse->bytes),
         "field-runs", fmt::format("{}, {}", fine->surface, fine->variant->name),
         fmt::format("{}; started, evaluated, compressed, written and checked", fine->by),
         "95 % bootstrap interval of paired rounds, a tenth wider for reruns; in round brackets the least and largest "
         "of draws of places and grid"});
    return findings;
}

} // namespace

void add_other_times(StudyData& data, const Measured& measured, const OtherTimes& others) {
    append(data.tables, run_tables(measured, others.fields, others.loops));
    data.tables.push_back(met_table(measured, others.met));
    append(data.findings, met_findings(measured, others.met));
    append(data.findings, run_findings(measured, others.fields, others.loops));
    append(data.figures, run_figures(others.fields, others.loops));
}

} // namespace forceshade::study::error_time
