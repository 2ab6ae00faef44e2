// The answers of an experiment's folders as they are analysed, and as other programs read them.
#include <algorithm>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "experiment_pages.h"
#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/output/files.h"

namespace forceshade::experiment {
namespace {

// Of keys in which the stimuli differ, as columns: "surface_facets".
std::vector<std::string> varied_keys(const Experiment& experiment) {
    std::vector<std::string> keys = varying_keys_of(experiment);
    std::ranges::for_each(keys, [](std::string& key) { std::ranges::replace(key, '.', '_'); });
    return keys;
}

void exclude_by_catch_trials(Answers& answers) {
    const std::size_t all = answers.rows.size();
    for (const std::string& subject : answers.subjects()) {
        std::size_t caught = 0, right = 0;
        for (const TrialRow& row : answers.rows)
            if (row.subject == subject && answers.experiment.is_catch(row.condition)) {
                ++caught;
                right += row.correct.value_or(false);
            }
        if (static_cast<double>(right) >= answers.experiment.spec.catch_least * static_cast<double>(caught))
            continue;
        answers.excluded.push_back(fmt::format("{} ({} of {} catch trials right)", subject, right, caught));
        std::erase_if(answers.rows, [&](const TrialRow& row) { return row.subject == subject; });
    }
    if (answers.rows.empty() && all > 0)
        throw UsageError("every subject is left out: {}; catch_least is {}", fmt::join(answers.excluded, ", "),
                         answers.experiment.spec.catch_least);
}

} // namespace

std::vector<std::string> Answers::subjects() const {
    std::set<std::string> names;
    for (const TrialRow& row : rows)
        names.insert(row.subject);
    return {names.begin(), names.end()};
}

std::vector<double> Answers::counts(std::size_t condition, const std::string& subject) const {
    const std::string& name = experiment.study.cases[condition].name;
    std::vector<double> counts(experiment.spec.answers.size());
    for (const TrialRow& row : rows) {
        if (row.condition != name || (!subject.empty() && row.subject != subject))
            continue;
        const auto answer = std::ranges::find(experiment.spec.answers, row.answer, &Answer::name);
        if (answer != experiment.spec.answers.end())
            counts[static_cast<std::size_t>(answer - experiment.spec.answers.begin())] += 1;
    }
    return counts;
}

Answers read_answers(const std::vector<std::filesystem::path>& folders) {
    std::optional<Answers> answers;
    std::string first;
    std::set<std::string> ids;
    for (const std::filesystem::path& folder : folders) {
        const std::vector<std::filesystem::path> files = data_files(folder);
        const std::filesystem::path file = folder / "materials" / "experiment.toml";
        const std::string toml = read_file(file);
        if (!answers) {
            answers = Answers{parse_experiment(toml, file.string(), folder / "materials"), {}, 0};
            first = resolved_toml(answers->experiment);
        } else if (toml != first &&
                   resolved_toml(parse_experiment(toml, file.string(), folder / "materials")) != first) {
            throw UsageError("{} and {} hold different experiments; analyse them apart", folders[0].string(),
                             folder.string());
        }
        for (const std::filesystem::path& one : files)
            for (TrialRow& row : last_rows(read_rows(one, &answers->experiment))) {
                if (!row.counts()) {
                    ++answers->left_out;
                    continue;
                }
                if (!ids.insert(fmt::format("{}/{}/{}", row.subject, row.session, row.number)).second)
                    throw UsageError("{}: trial {} of subject {}, session {} is there twice; two folders may "
                                     "hold the same session",
                                     one.string(), row.number, row.subject, row.session);
                answers->rows.push_back(std::move(row));
            }
    }
    if (!answers || answers->rows.empty())
        throw UsageError("{} holds no answered trial yet", folders.empty() ? "." : folders[0].string());
    exclude_by_catch_trials(*answers);
    return *answers;
}

std::optional<std::size_t> smooth_answer(const ExperimentSpec& spec) {
    for (std::size_t i = 0; i < spec.answers.size(); ++i)
        if (spec.answers[i].facets == 0u)
            return i;
    return std::nullopt;
}

study::Table wide_table(const Answers& data) {
    const Experiment& experiment = data.experiment;
    const bool compares = experiment.spec.task == Task::compare;
    study::Table table{"wide", "Counts of answers, a row a subject and condition", {}, {}};
    table.columns = {{"subject", "", "who"}, {"condition", "", "stimulus"}};
    for (const std::string& key : varied_keys(experiment))
        table.columns.push_back({key, "", "the stimulus' value, with its unit; empty: it has none"});
    if (compares)
        table.columns.push_back({"standard", "", "that it was compared with"});
    table.columns.push_back({"trials", "1", "with an answer"});
    if (compares)
        table.columns.push_back({"right", "1", "of these"});
    for (const Answer& answer : experiment.spec.answers)
        if (!compares)
            table.columns.push_back({"answered_" + answer.name, "1", "of these"});
    for (const std::string& subject : data.subjects())
        for (const Condition& condition : experiment.conditions) {
            std::vector<double> counts = data.counts(condition.stimulus, subject);
            const double trials = std::accumulate(counts.begin(), counts.end(), 0.0);
            if (compares) { // of this comparison the right ones
                counts.assign(1, 0);
                for (const TrialRow& row : data.rows)
                    counts[0] += row.subject == subject && row.condition == experiment.stimulus(condition).name &&
                                 row.correct.value_or(false);
            }
            if (trials == 0)
                continue;
            const Case& stimulus = experiment.stimulus(condition);
            std::vector<study::Cell> row{subject, stimulus.name};
            for (const std::string& path : varying_keys_of(experiment))
                row.emplace_back(value_text(stimulus, path));
            if (compares)
                row.emplace_back(experiment.study.cases[*condition.standard].name);
            row.emplace_back(trials);
            row.insert(row.end(), counts.begin(), counts.end());
            table.rows.push_back(std::move(row));
        }
    return table;
}

std::string analysis_script(const Answers& answers) {
    const ExperimentSpec& spec = answers.experiment.spec;
    const std::string count =
        spec.task == Task::compare
            ? "right"
            : "answered_" + spec.answers[smooth_answer(spec).value_or(spec.answers.size() - 1)].name;
    std::string text(pages::analysis_r);
    const auto fill = [&](std::string_view place, const std::string& with) {
        text.replace(text.find(place), place.size(), with);
    };
    std::vector<std::string> keys = varied_keys(answers.experiment);
    std::ranges::for_each(keys, [](std::string& key) { key = '"' + key + '"'; });
    fill("@keys@", fmt::format("{}", fmt::join(keys, ", ")));
    fill("@count@", count);
    return text;
}

} // namespace forceshade::experiment
