#include <optional>
#include <sys/stat.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/experiment/run.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/report/report.h"
#include "host/study/study_data.h"

namespace forceshade {

namespace {

struct ExperimentArguments {
    std::string file, out, session = "1", participant = "person", check, age, hand;
    std::optional<int> port;
    DeviceArguments device;
    std::vector<std::string> folders, subjects, compare, buttons;
    bool paths = false;
};

std::uint64_t session_number(const std::string& text) {
    if (const auto number = number_in<std::uint64_t>(text, 1, 9999))
        return *number;
    throw UsageError("--session: a number from 1 to 9999, got \"{}\"", text);
}

std::vector<unsigned> answer_buttons(const std::vector<std::string>& words) {
    std::vector<unsigned> buttons;
    buttons.reserve(words.size());
    for (const std::string& word : words)
        buttons.push_back(read_button("--answer-buttons", word));
    return buttons;
}

// The outcome of a check: of a file, or made now with the first stimulus.
std::string checked_device(const ExperimentArguments& arguments, const experiment::Experiment& experiment,
                           const CommonOptions& common) {
    if (arguments.check.empty())
        return {};
    if (arguments.check != "now")
        return read_file(arguments.check);
    const device::DeviceCheck check =
        device::check_device(checked_options(arguments.device), CasePreparation().prepare(experiment.study.cases[0]),
                             check_guide(arguments.device, false, common));
    if (!common.quiet || !check.passed())
        print_note("{}", device::check_text(check));
    return device::check_json(check).dump();
}

experiment::PersonOptions person_options(const ExperimentArguments& arguments, const experiment::Experiment& experiment,
                                         const CommonOptions& common) {
    experiment::PersonOptions options;
    options.session = checked_options(arguments.device);
    options.port = page_port(arguments.port);
    options.buttons = answer_buttons(arguments.buttons);
    options.check = checked_device(arguments, experiment, common);
    return options;
}

experiment::Experiment read(const ExperimentArguments& arguments, const CommonOptions& common) {
    experiment::Experiment experiment = experiment::read_experiment(arguments.file, overrides(common));
    print_warnings(experiment.study.warnings, common);
    return experiment;
}

experiment::ObserverParameters observer_named(const std::string& participant) {
    for (std::size_t i = 0; i < experiment::kObserverModelNames.size(); ++i)
        if (participant == fmt::format("observer-{}", experiment::kObserverModelNames[i]))
            return experiment::published_observer(static_cast<experiment::ObserverModel>(i));
    return {};
}

experiment::ParticipantFacts participant_facts(const ExperimentArguments& arguments) {
    experiment::ParticipantFacts facts{number_in<unsigned>(arguments.age, 1, 120), arguments.hand};
    if (!arguments.age.empty() && !facts.age)
        throw UsageError("--age: years from 1 to 120, got \"{}\"", arguments.age);
    return facts;
}

int run_experiment(const ExperimentArguments& arguments, const CommonOptions& common) {
    if (arguments.out.empty())
        throw UsageError("--out is empty: name the folder of the data");
    const experiment::Experiment experiment = read(arguments, common);
    const bool person = arguments.participant == "person";
    if (!person && (!arguments.check.empty() || !arguments.buttons.empty()))
        throw UsageError("--check and --answer-buttons are of a device: they are for --participant person");
    if (person && arguments.subjects.size() > 1)
        throw UsageError("--subject: one person at a time; several are for --participant observer");
    if (!person && (!arguments.age.empty() || !arguments.hand.empty()))
        throw UsageError("--age and --hand are of a person: they are for --participant person");
    participant_facts(arguments); // errors now, not after a session has begun
    const std::unique_ptr<experiment::Participant> participant =
        person ? experiment::make_person(experiment, person_options(arguments, experiment, common))
               : experiment::make_observer(experiment, observer_named(arguments.participant), true);
    ::umask(0077);                   // data of people are their experimenter's alone
    std::optional<LongRun> long_run; // a person is not left with a device that pushes
    if (!person)
        long_run.emplace(common.quiet, "trials that were finished stay; the same command goes on from there");
    for (const std::string& subject : arguments.subjects) {
        experiment::RunOptions options;
        options.folder = arguments.out;
        options.info = {subject, session_number(arguments.session), arguments.participant, participant->device(),
                        person && !arguments.check.empty() ? "passed" : "none"};
        options.paths = person || arguments.paths;
        options.participant = participant_facts(arguments);
        const std::size_t answered = experiment::run_session(experiment, *participant, options);
        note(common, "subject {}, session {}: {} in {}\n", subject, arguments.session,
             numbers::counted(answered, "trial"), arguments.out);
    }
    return 0;
}

int analyse_data(const ExperimentArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const std::filesystem::path first = arguments.folders[0],
                                out = arguments.out.empty() ? first / "analysis" : std::filesystem::path(arguments.out);
    const experiment::Answers answers = experiment::read_answers({arguments.folders.begin(), arguments.folders.end()});
    study::StudyData data = experiment::analyse(answers);
    make_subfolder(out.has_parent_path() ? out.parent_path() : ".", out.filename().string());
    make_subfolder(out, data.study);
    std::vector<study::TextFile> files = study::figure_files(data);
    files.push_back({"analysis.R", experiment::analysis_script(answers)});
    std::vector<std::string> warnings;
    for (const std::string& name : study::write_data(out / data.study, data, files))
        warnings.push_back(fmt::format("{} is of an earlier analysis and was changed since, so it stays",
                                       (out / data.study / name).string()));
    print_warnings(warnings, common);
    return show_findings(data, out, "", "tables", common);
}

int plan_experiment(const ExperimentArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const experiment::Experiment experiment = read(arguments, common);
    std::vector<std::pair<std::string, std::string>> pairs = experiment::natural_pairs(experiment);
    if (!arguments.compare.empty()) {
        if (arguments.compare.size() != 2)
            throw UsageError("--compare wants two conditions between a comma, got {}", arguments.compare.size());
        pairs = {{arguments.compare[0], arguments.compare[1]}};
    }
    if (pairs.empty())
        throw UsageError("no stimulus is there shaded and unshaded: say --compare CONDITION,CONDITION");
    std::string text =
        "Subjects needed to distinguish two conditions (80 % power of the sign flips that analyse makes, at\n"
        "5 %), by trials of each condition, of this contrast alone; of fewer than 6 none can be significant.\n"
        "Answers as the observer expects them, subjects as different as in 1996.\n\n";
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& [first, second] : pairs) {
        const experiment::Plan plan = experiment::planned(experiment, first, second);
        text += fmt::format("{} against {}\n  answer \"{}\": {:.0f} % against {:.0f} %\n ", plan.first, plan.second,
                            plan.answer, 100 * plan.first_share, 100 * plan.second_share);
        nlohmann::ordered_json one{{"first", plan.first},
                                   {"second", plan.second},
                                   {"answer", plan.answer},
                                   {"first_share", plan.first_share},
                                   {"second_share", plan.second_share},
                                   {"subjects", nlohmann::ordered_json::array()}};
        for (const experiment::PlannedSubjects& needed : plan.needed) {
            text += fmt::format(" {} trials: {}{}", needed.trials,
                                needed.subjects ? std::to_string(*needed.subjects)
                                                : fmt::format("more than {}", experiment::kMostSubjects),
                                &needed == &plan.needed.back() ? "\n\n" : ",");
            one["subjects"].push_back({{"trials", needed.trials}, {"subjects", nullptr}});
            if (needed.subjects)
                one["subjects"].back()["subjects"] = *needed.subjects;
        }
        all.push_back(std::move(one));
    }
    print_data(common.json ? all.dump(2) + "\n" : text);
    return 0;
}

void describe_run(Options& options, ExperimentArguments& arguments) {
    options.optional("FILE", arguments.file, "experiment file (TOML); without it the paper's");
    options.required("--out DIR", arguments.out, "folder of the data");
    options.list("--subject ID", arguments.subjects,
                 "who takes part: letters and digits, as 03, no person's name; several between commas", true);
    options.optional("--session N", arguments.session, "of the subject, from 1 on");
    options.optional("--participant person|observer|observer-two-noises|observer-base-kinks", arguments.participant,
                     "person: at a device, answers in a page (default); observer: a simulated one, whose subjects "
                     "differ as the paper's; the others are its older form, with two noises, and its rival");
    options.optional("--age YEARS", arguments.age, "of the person, kept in documentation/participants.csv");
    options.optional("--hand left|right|both", arguments.hand, "that the person writes with, kept there, too");
    options.flag("--paths", arguments.paths, "keep the simulated participant's paths, too");
    options.list("--answer-buttons BUTTON", arguments.buttons,
                 "buttons of the device in the order of the answers, between commas: they answer as the keys do");
    options.optional("--check FILE", arguments.check,
                     "outcome of forceshade device check --out, kept with the data; now: make it now");
    options.optional("--port N", arguments.port, "of the pages on this machine (default: any that is free)");
    describe_device(options, arguments.device);
    describe_safety(options, arguments.device);
    options
        .example("experiment run --participant observer --subject 01,02 --out trial-run",
                 "two simulated subjects, in the paper's experiment")
        .example("experiment run FILE.toml --subject 03 --out data --device sim", "a person, who answers in a page");
}

void describe_analyse(Options& options, ExperimentArguments& arguments) {
    options.list("DIR", arguments.folders, "folders that experiment run wrote", true);
    options.optional("--out DIR", arguments.out, "of the results (default: DIR/analysis)");
    options.alias("analyze")
        .example("experiment analyse trial-run", "tables, tests and figures in trial-run/analysis")
        .example("experiment analyse trial-run data -o both", "of several folders together");
}

void describe_plan(Options& options, ExperimentArguments& arguments) {
    options.optional("FILE", arguments.file, "experiment file (TOML); without it the paper's");
    options.list("--compare CONDITION", arguments.compare,
                 "two conditions between a comma (default: all shaded and unshaded)");
    options.example("experiment plan", "of the paper's experiment")
        .example("experiment plan --json", "the same for a script");
}

} // namespace

void add_experiment_command(CommandLine& program) {
    program.add_group("experiment", "Run the classification experiment, simulated or on a device")
        .example("experiment run --participant observer --subject 01 --out trial-run", "a simulated subject")
        .example("experiment analyse trial-run", "what it answered");
    program.add<ExperimentArguments>("experiment run", "Take a subject through the trials", run_experiment,
                                     describe_run);
    program.add<ExperimentArguments>("experiment analyse", "Write tables, tests and figures of data", analyse_data,
                                     describe_analyse);
    program.add<ExperimentArguments>("experiment plan", "Say how many subjects and trials distinguish conditions",
                                     plan_experiment, describe_plan);
}

} // namespace forceshade
