// forceshade study.
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/long_run.h"
#include "host/program.h"
#include "host/study/energy/energy.h"
#include "host/study/error_time/error_time.h"
#include "host/study/omission/omission.h"
#include "host/study/stability/stability.h"
#include "host/study/study_data.h"
#include "host/sweep/sweep.h"

namespace forceshade {

namespace {

struct KnownStudy {
    const char* name;
    const char* about;
    study::StudyData (*run)(study::StudyRun&);
    const char* precision = ""; /* what it uses in place of the scene's; empty: the scene's */
    bool many = false;          /* of a study's scenes, not of one */
    bool renderers = false;     /* measures those of the user's own on a scene */
    bool rubs = false;          /* measures a scene's friction and vibration, too */
};

constexpr std::array<KnownStudy, 5> kStudies{{
    {"error-time", "force error against run time: facets, shadings, precision, look-up volumes",
     study::study_error_time, "", false, true},
    {"stability", "where the sampled loop and the numbers stop being stable", study::study_stability, "", false, true,
     true},
    {"energy", "work round closed loops and curl, for each shading", study::study_energy,
     "quadrature and oracle are in double precision, the engine in double where the device has it", false, true, true},
    {"omission", "what leaving out what a scene does not need saves", study::study_omission},
    {"perception", "what a model observer expects people to feel", experiment::study_perception,
     "strokes and oracle are in double precision", true},
}};

constexpr const char* kAll = "all";

struct StudyArguments {
    std::string name, scene, out;
    std::vector<std::string> renderers;
    bool quick = false, fresh = false;
};

std::vector<std::string> study_names() {
    std::vector<std::string> names;
    names.reserve(kStudies.size() + 1);
    for (const KnownStudy& one : kStudies)
        names.emplace_back(one.name);
    names.emplace_back(kAll);
    return names;
}

const KnownStudy& known_study(const std::string& name) {
    for (const KnownStudy& one : kStudies)
        if (name == one.name)
            return one;
    refuse_unknown("study", name, study_names());
}

// \throws UsageError for renderers that no study measures.
void check_renderers(const StudyArguments& arguments, bool measured) {
    if (!arguments.renderers.empty() && !(measured && !arguments.scene.empty()))
        throw UsageError("--renderer is of study error-time SCENE, stability SCENE and energy SCENE: a renderer is "
                         "measured on a scene of yours");
}

// The user's scene.
std::optional<Case> scene_of(const KnownStudy& known, const StudyArguments& arguments, const CommonOptions& common) {
    if (*known.precision && !common.precision.empty())
        throw UsageError("--precision has no effect in the study {}: {}; leave it out", known.name, known.precision);
    if (arguments.scene.empty() && !common.precision.empty())
        throw UsageError("--precision needs a scene; the study's own scenes are measured in both");
    if (arguments.scene.empty() || known.many)
        return std::nullopt;
    return load_scene(arguments.scene, common);
}

// The study that a folder holds, if it can be read.
std::optional<study::StudyData> study_in(const std::filesystem::path& folder) {
    try {
        return study::read_data(folder);
    } catch (const Error&) {
        return std::nullopt;
    }
}

// What the new run would replace of an earlier one without computing it again; may be empty.
std::string lost_by(const std::optional<study::StudyData>& before, const study::StudyRun& run,
                    const study::StudyOptions& options) {
    if (before && before->scene != run.scene_text())
        return "holds tables and figures of this study of another scene";
    if (before && options.quick && !before->quick)
        return "holds tables and figures of a full run, which --quick would make coarse";
    return "";
}

int run_one(const KnownStudy& known, const StudyArguments& arguments, const CommonOptions& common) {
    if (arguments.out.empty())
        throw UsageError("--out is empty: name a folder, \".\" for the current one");
    const std::filesystem::path out = arguments.out;
    study::StudyOptions options;
    options.folder = out / known.name;
    options.scene = scene_of(known, arguments, common);
    if (known.many && !arguments.scene.empty())
        options.cases = load_study(arguments.scene, common).cases;
    check_renderers(arguments, known.renderers);
    options.renderers = parse_renderers(arguments.renderers);
    options.rubs = known.rubs;
    options.quick = arguments.quick;
    options.engine = device_options(common, true);
    const auto show = [&](const study::StudyData& data, const std::string& how) {
        return show_findings(data, out, fmt::format("{} {}; ", data.study, how), "numbers", common);
    };
    const std::optional<study::StudyData> before = study_in(options.folder);
    study::StudyRun study_run(known.name, options);
    if (before && before->fingerprint == study_run.fingerprint() && !arguments.fresh &&
        study::files_are_intact(options.folder, *before))
        return show(*before, "computed before by the same program of the same scene, so it stays");
    if (const std::string lost = lost_by(before, study_run, options); !lost.empty() && !arguments.fresh) {
        if (!common.overwrite && !common.no_clobber)
            throw UsageError(
                "{} {}: --overwrite replaces them, --no-clobber leaves them; or name another --out to keep both",
                options.folder.string(), lost);
        if (common.no_clobber)
            return show(*before, "computed before stays (--no-clobber)");
    }
    study::StudyData data = known.run(study_run);
    std::vector<std::string> warnings;
    for (const std::string& name : study::write_data(options.folder, data, study::figure_files(data)))
        warnings.push_back(
            fmt::format("{} is of an earlier run and was changed since, so it stays; this run does not name it",
                        (options.folder / name).string()));
    print_warnings(warnings, common);
    const int shown = show(data, "in " + clock_text(data.seconds));
    return data.failed_renderers > 0 ? static_cast<int>(ExitCode::failed) : shown;
}

// One study after the other; a later run goes on with those that are not there yet.
int run(const StudyArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    if (arguments.name != kAll)
        return run_one(known_study(arguments.name), arguments, common);
    check_renderers(arguments, false);
    if (common.json)
        throw UsageError("--json is of one study: name it, or read study.json in each one's folder");
    if (!common.precision.empty())
        throw UsageError(
            "--precision is of a study that measures in the scene's own: name error-time, stability or omission");
    for (const KnownStudy& one : kStudies)
        run_one(one, arguments, common);
    return 0;
}

void describe(Options& options, StudyArguments& arguments) {
    std::string names = "which study:";
    for (const KnownStudy& one : kStudies)
        names += fmt::format(" {} ({});", one.name, one.about);
    names += " all (one after the other, for a page that compares the shadings).";
    options.required("STUDY", arguments.name, names).one_of(study_names());
    options.optional("SCENE", arguments.scene,
                     "scene file (TOML) to study, for perception also one of many scenes; without it the study's own");
    options.required("--out DIR", arguments.out, "folder of the results; each study has a folder of its name in it");
    options.repeated(
        "--renderer LIBRARY[:OPTIONS]", arguments.renderers,
        "error-time, stability and energy of a scene: a shared library of your own, measured too "
        "(forceshade_renderer.h); once for each; if one fails, the rest is measured and the exit code is 1");
    options.flag("--quick", arguments.quick, "coarse, in about a minute each");
    options.flag("--fresh", arguments.fresh, "compute it anew although the same run is there already");
    options.example("study all --quick --out results", "which shading? in some two minutes")
        .example("study error-time --quick --out results", "in about a minute")
        .example("study energy bump.toml --quick -o results", "of a scene of your own")
        .example("study stability bump.toml --renderer ./libmine.so -o results",
                 "up to which stiffness yours is stable");
}

} // namespace

void add_study_command(CommandLine& program) {
    program.add<StudyArguments>(
        "study",
        "Measure errors, run times, stability, energy, savings or perception into a folder, with figures and a report",
        run, describe);
}

} // namespace forceshade
