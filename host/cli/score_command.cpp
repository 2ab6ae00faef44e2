// forceshade score.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/report/report.h"
#include "host/score/course.h"
#include "host/score/score.h"
#include "host/study/study_data.h"
#include "host/sweep/sweep.h"
#include "host/threads.h"

namespace forceshade {
namespace {

constexpr double kMostPatience = 1e6; // s

struct ScoreArguments {
    std::string scene, paths, map, out;
    std::vector<std::string> forces, names, renderers; // names: of the forces
    std::optional<double> rate, patience;
};

std::vector<std::pair<std::string, score::Track>>
recorded_of(const ScoreArguments& arguments, const score::ColumnMap& map, const score::Strokes& strokes) {
    std::vector<std::pair<std::string, score::Track>> all;
    for (std::size_t i = 0; i < arguments.forces.size(); ++i)
        all.emplace_back(arguments.names[i], score::read_forces(arguments.forces[i], map, strokes));
    return all;
}

// A scene, its strokes and the renderers along them.
score::SceneScores score_scene(const ScoreArguments& arguments, const CommonOptions& common,
                               std::vector<std::string>& notes, std::string& scene_text) {
    CasePreparation preparation;
    const PreparedCase prepared = prepare_scene(preparation, load_scene(arguments.scene, common), common);
    print_warnings(prepared.warnings, common);
    preparation.wait(); // renderers are timed
    const score::ColumnMap map = score::parse_map(arguments.map);
    score::ScoreOptions options;
    const std::string positions =
        arguments.paths.empty() && !arguments.forces.empty() ? arguments.forces.front() : arguments.paths;
    if (positions.empty() && arguments.rate)
        throw UsageError("--rate is of a file without times: the scene's own strokes have rate under [paths]");
    options.strokes = positions.empty() ? score::scene_strokes(prepared)
                                        : score::read_strokes(positions, map, arguments.rate, score::size_of(prepared));
    options.recorded = recorded_of(arguments, map, options.strokes);
    score::require_found(map);
    options.renderers = parse_renderers(arguments.renderers);
    if (arguments.patience)
        options.patience.update =
            std::chrono::milliseconds(static_cast<long>(std::ceil(1e3 * std::min(*arguments.patience, kMostPatience))));
    score::Scores scores = score::score_all(prepared, options);
    scene_text = prepared.scene;
    notes.push_back(fmt::format("Scene: {}. Strokes: {}{}.", arguments.scene, options.strokes.source,
                                arguments.map.empty() ? "" : fmt::format(", by the map \"{}\"", arguments.map)));
    for (std::size_t i = 0; i < arguments.forces.size(); ++i)
        notes.push_back(fmt::format("{}: {}, SHA-256 {}.", arguments.names[i], arguments.forces[i],
                                    sha256_of_file(arguments.forces[i])));
    return {std::filesystem::path(arguments.scene).stem().string(), std::move(scores), std::move(options.strokes)};
}

// The scenes of a course: each with the strokes of its name, and forces in folders of such files.
std::vector<score::SceneScores> score_course(const ScoreArguments& arguments, const CommonOptions& common,
                                             std::vector<std::string>& notes) {
    const std::filesystem::path folder = arguments.scene;
    if (!arguments.paths.empty())
        throw UsageError("score of a course: its strokes are in {}; leave --paths out", (folder / "strokes").string());
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".toml")
            files.push_back(entry.path());
    std::ranges::sort(files);
    if (files.empty())
        throw UsageError("{}: a folder without scenes; forceshade init course --out DIR makes one", folder.string());
    std::vector<ScoreArguments> all;
    for (const std::filesystem::path& file : files) {
        ScoreArguments& one = all.emplace_back(arguments);
        const std::filesystem::path strokes = file.stem().string() + ".csv";
        one.scene = file.string();
        one.paths = (folder / "strokes" / strokes).string();
        for (std::string& forces : one.forces)
            forces = (std::filesystem::path(forces) / strokes).string();
        std::vector<std::string> needed = one.forces;
        needed.push_back(one.paths);
        for (const std::string& name : needed)
            if (!std::filesystem::exists(name))
                throw IoError("{}: there is no such file; each scene of a course has one", name);
    }
    std::vector<score::SceneScores> scenes;
    Stage stage("scenes", files.size(), "scenes");
    for (const ScoreArguments& one : all) {
        stage.update(scenes.size(), std::filesystem::path(one.scene).stem().string());
        std::string text;
        scenes.push_back(score_scene(one, common, notes, text));
    }
    const bool mapped = std::ranges::any_of(score::parse_map(arguments.map),
                                            [](const auto& one) { return !one.first.starts_with('f'); });
    notes.push_back(mapped
                        ? "The course's strokes were read by the map: scores on them cannot be compared with others'."
                        : score::course_note(folder));
    return scenes;
}

int run(const ScoreArguments& given, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const std::filesystem::path folder = std::filesystem::path(given.out) / "score";
    if (!given.out.empty() && !may_write({folder / "study.json"}, common))
        return 0;
    ScoreArguments arguments = given;
    for (const std::string& file : arguments.forces) // "logs/mine.csv" and the folder "mine/" are "mine"
        arguments.names.push_back((std::filesystem::path(file) / "").parent_path().stem().string());
    const Clock::time_point start = Clock::now();
    study::StudyData data;
    score::Scores scores;
    score::Strokes strokes;
    std::vector<score::SceneScores> scenes;
    std::vector<std::string> notes;
    if (std::filesystem::is_directory(arguments.scene)) {
        scenes = score_course(arguments, common, notes);
        std::tie(scores, strokes) = score::over_scenes(scenes);
    } else {
        score::SceneScores one = score_scene(arguments, common, notes, data.scene);
        scores = std::move(one.scores);
        strokes = std::move(one.strokes);
    }
    print_warnings(scores.warnings, common);

    data.study = "score";
    data.program = version();
    data.engine = "cpu";
    data.device = data.cpu = cpu_name();
    data.cores = most_threads();
    data.seconds = seconds_since(start);
    score::add_scores(data, scores, strokes, scenes);
    study::append(data.notes, std::move(notes));
    for (const RendererSource& source : parse_renderers(arguments.renderers))
        data.notes.push_back(
            fmt::format("{}: {}, SHA-256 {}.", source.name, source.library.string(), sha256_of_file(source.library)));
    if (!common.json)
        print_data(fmt::format("{} of {}\n{}{}", numbers::counted(strokes.all.size(), "stroke"),
                               numbers::counted(strokes.samples(), "sample"), score::score_text(scores),
                               scenes.empty() ? "" : score::scenes_text(scenes)));
    if (!arguments.out.empty()) {
        make_subfolder(arguments.out, "score");
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
                                numbers::counted(std::uint64_t(failed), "renderer"), failed == 1 ? "has" : "have"));
    return 0;
}

void describe(Options& options, ScoreArguments& arguments) {
    options.required("SCENE", arguments.scene,
                     "scene file (TOML) whose law is the oracle, or the folder of a course (forceshade init course)");
    options.optional("--paths STROKES", arguments.paths,
                     "positions: CSV with x, y, z and perhaps t and path; rows of numbers without a header and .npy "
                     "arrays with --map. Left out: positions of the first --forces, or the scene's own [paths]");
    options.list("--forces FILE", arguments.forces,
                 "forces of other programs along these positions, a sample a row: fx, fy, fz; of a course, folders of "
                 "such files by the scenes' names");
    options.repeated("--renderer LIBRARY[:OPTIONS]", arguments.renderers,
                     "a shared library that exports the functions of forceshade_renderer.h; once for each");
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
