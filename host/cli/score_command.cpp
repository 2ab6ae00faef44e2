// forceshade score.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/output/files.h"
#include "host/report/report.h"
#include "host/score/score.h"
#include "host/study/data/study_data.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade {
namespace {

struct ScoreArguments {
    std::string scene, paths, map, out;
    std::vector<std::string> forces, renderers;
    std::optional<double> rate, patience;
};

// "logs/mine.csv" is "mine".
std::vector<std::pair<std::string, score::Track>>
recorded_of(const ScoreArguments& arguments, const score::ColumnMap& map, const score::Strokes& strokes) {
    std::vector<std::pair<std::string, score::Track>> all;
    for (const std::string& file : arguments.forces)
        all.emplace_back(std::filesystem::path(file).stem().string(), score::read_forces(file, map, strokes));
    return all;
}

int run(const ScoreArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const std::filesystem::path folder = std::filesystem::path(arguments.out) / "score";
    if (!arguments.out.empty() && !may_write({folder / "study.json"}, common))
        return 0;
    CasePreparation preparation;
    const PreparedCase prepared = prepare_scene(preparation, load_scene(arguments.scene, common), common);
    print_warnings(prepared.warnings, common);
    const score::ColumnMap map = score::parse_map(arguments.map);
    score::ScoreOptions options;
    const std::string positions =
        arguments.paths.empty() && !arguments.forces.empty() ? arguments.forces.front() : arguments.paths;
    options.strokes = positions.empty() ? score::scene_strokes(prepared)
                                        : score::read_strokes(positions, map, arguments.rate, score::size_of(prepared));
    options.recorded = recorded_of(arguments, map, options.strokes);
    score::require_found(map);
    for (const std::string& renderer : arguments.renderers)
        options.renderers.push_back(parse_renderer(renderer));
    if (arguments.patience)
        options.patience.update = std::chrono::milliseconds(static_cast<long>(std::ceil(1e3 * *arguments.patience)));
    const Clock::time_point start = Clock::now();
    const score::Scores scores = score::score_all(prepared, options);
    print_warnings(scores.warnings, common);

    study::StudyData data;
    data.study = "score";
    data.program = version();
    data.engine = "cpu";
    data.device = data.cpu = cpu_name();
    data.cores = most_threads();
    data.scene = prepared.scene;
    data.seconds = seconds_since(start);
    score::add_scores(data, scores, options.strokes);
    data.notes.push_back(fmt::format("Scene: {}. Strokes: {}{}.", arguments.scene, options.strokes.source,
                                     arguments.map.empty() ? "" : fmt::format(", by the map \"{}\"", arguments.map)));
    for (const RendererSource& source : options.renderers)
        data.notes.push_back(
            fmt::format("{}: {}, SHA-256 {}.", source.name, source.library.string(), sha256_of_file(source.library)));
    for (const std::string& file : arguments.forces)
        data.notes.push_back(fmt::format("{}: {}, SHA-256 {}.", std::filesystem::path(file).stem().string(), file,
                                         sha256_of_file(file)));
    note(common, "{}", score::score_text(scores));
    if (!arguments.out.empty()) {
        make_subfolder(arguments.out, data.study);
        study::write_data(folder, data, study::figure_files(data));
        note(common, "look at {}, numbers in {}\n", full_path(report::write_report(arguments.out).file),
             full_path(folder));
    }
    if (common.json)
        print_data(study::data_json(data));
    const auto failed = std::ranges::count_if(scores.all, [](const score::Scored& one) { return !one.failed.empty(); });
    if (failed > 0)
        throw Error(ExitCode::failed,
                    fmt::format("{} failed and {} no score; the table says why",
                                plural(std::uint64_t(failed), "renderer"), failed == 1 ? "has" : "have"));
    return 0;
}

void describe(Options& options, ScoreArguments& arguments) {
    options.required("SCENE", arguments.scene, "scene file (TOML) whose law is the oracle");
    options.optional(
        "--paths STROKES", arguments.paths,
        "positions: CSV with x, y, z and, if there are any, t and path; rows of numbers without a header "
        "and .npy arrays with --map; by default those of the first --forces, else those of the scene's [paths]");
    options.list("--forces FILE,...", arguments.forces,
                 "forces of other programs along these positions, a sample a row: fx, fy, fz");
    options.list("--renderer LIBRARY[:OPTIONS],...", arguments.renderers,
                 "shared libraries that export the functions of forceshade_renderer.h");
    options.optional("--map COLUMNS", arguments.map,
                     "which column is what where names differ, and its unit: \"x=px mm, z=-py mm, fx=#4\"");
    read_positive(options, "--rate FREQUENCY", arguments.rate, Dimension::frequency,
                  "of samples, for files without times: \"1 kHz\"");
    read_positive(options, "--patience TIME", arguments.patience, Dimension::time,
                  "how long an update may take before its renderer is given up; 2 s by default");
    options.optional("--out DIR", arguments.out, "folder of the page and the tables; without it the table alone");
    options.example("score bump.toml --paths felt.csv --renderer ./libmine.so --out scores", "your renderer's score")
        .example("score bump.toml --forces felt.csv --map \"fx=fx N, fy=fy N, fz=fz N\" -o scores",
                 "of another program's log");
}

} // namespace

void add_score_command(CommandLine& program) {
    program.add<ScoreArguments>(
        "score",
        "Compare renderers of your own with the oracle along recorded strokes: errors, faults, vibration, time", run,
        describe);
}

} // namespace forceshade
