#include "host/experiment/analysis.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/experiment/statistics.h"
#include "host/numbers.h"

namespace forceshade::experiment {
namespace {

using study::cell;
using study::Cell;
using study::Table;

constexpr const char* kAll = "all";

// Subjects, and before several all of them together.
std::vector<std::string> groups_of(const Answers& data) {
    std::vector<std::string> groups = data.subjects();
    if (groups.size() > 1)
        groups.insert(groups.begin(), kAll);
    return groups;
}

bool is_in(const TrialRow& row, const std::string& group) {
    return group == kAll || row.subject == group;
}

struct Tally {
    double trials = 0, right = 0, stimulus = 0, first = 0; /* answers: right, "the stimulus", "the first" */
    bool has_right = false;
    double share() const { return trials > 0 ? right / trials : NAN; }
};

Tally tally_of(const Answers& data, const std::string& group, const std::string& condition) {
    Tally counts;
    for (const TrialRow& row : data.rows) {
        if (!is_in(row, group) || row.condition != condition)
            continue;
        const bool first = row.answer == data.experiment.spec.answers.front().name;
        counts.trials += 1;
        counts.right += row.correct.value_or(false);
        counts.first += first;
        counts.stimulus += first == (row.standard_interval == 2);
        counts.has_right = counts.has_right || row.correct;
    }
    return counts;
}

Table comparison_table(const Answers& data) {
    struct Row {
        std::string subject, stimulus, standard;
        Tally counts;
        Range trials, subjects;
    };
    std::vector<Row> rows;
    for (const std::string& group : groups_of(data))
        for (const Condition& condition : data.experiment.conditions) {
            const std::string& name = data.experiment.stimulus(condition).name;
            const Tally counts = tally_of(data, group, name);
            if (counts.trials == 0)
                continue;
            std::vector<double> shares;
            for (const std::string& subject : data.subjects())
                if (const Tally own = tally_of(data, subject, name); group == kAll && own.trials > 0)
                    shares.push_back(own.share());
            const Range none{NAN, NAN};
            rows.push_back({group, name, data.experiment.study.cases[*condition.standard].name, counts,
                            counts.has_right ? jeffreys(counts.right, counts.trials) : none,
                            counts.has_right ? mean_interval(shares) : none});
        }
    return study::table_of<Row>(
        "comparisons", "Answers by comparison",
        {{{"subject", "", "all, or which"}, &Row::subject},
         {{"condition", "", "stimulus"}, &Row::stimulus},
         {{"standard", "", "that it was compared with"}, &Row::standard},
         {{"trials", "1", "with an answer"}, [](const Row& r) { return Cell(r.counts.trials); }},
         {{"right_percent", "%", "answers that are right; nothing: none is"},
          [](const Row& r) { return r.counts.has_right ? Cell(100 * r.counts.share()) : Cell(); }},
         {{"right_from_percent", "%", "95 % interval of a share of trials (Jeffreys)"},
          [](const Row& r) { return cell(100 * r.trials.low); }},
         {{"right_to_percent", "%", "its upper end"}, [](const Row& r) { return cell(100 * r.trials.high); }},
         {{"right_subjects_from_percent", "%", "95 % interval over subjects (Student's t)"},
          [](const Row& r) { return cell(100 * r.subjects.low); }},
         {{"right_subjects_to_percent", "%", "its upper end"},
          [](const Row& r) { return cell(100 * r.subjects.high); }},
         {{"stimulus_percent", "%", "answers that chose the stimulus, not its standard"},
          [](const Row& r) { return Cell(100 * r.counts.stimulus / r.counts.trials); }},
         {{"first_percent", "%", "answers \"the first\": 50 without a bias"},
          [](const Row& r) { return Cell(100 * r.counts.first / r.counts.trials); }}},
        rows);
}

// A subject's trials of a track, or everybody's.
struct Estimate {
    std::string subject, track, label; /* label: what figures call it */
    const Track* levels = nullptr;
    std::vector<Tally> counts; /* by level */
    double trials = 0;
    ThresholdTrack posterior;
};

struct TrackTrial {
    std::string label;
    std::uint64_t session = 0, trial = 0; /* trial: of the track, from 1 on */
    double level = 0;
    bool right = false;
    Threshold after;
};

std::vector<Estimate> estimates_of(const Answers& data, std::vector<TrackTrial>& trials) {
    const Experiment& experiment = data.experiment;
    const std::vector<ThresholdTrack> unanswered = unanswered_tracks(experiment);
    std::vector<Estimate> estimates;
    for (const std::string& group : groups_of(data))
        for (std::size_t i = 0; i < experiment.tracks.size(); ++i) {
            const Track& track = experiment.tracks[i];
            const std::string label = experiment.tracks.size() > 1 ? fmt::format("{}, {}", group, track.name) : group;
            Estimate one{group, track.name, label, &track, std::vector<Tally>(track.levels.size()), 0, unanswered[i]};
            for (const TrialRow& row : data.rows) {
                if (!is_in(row, group) || row.track != track.name || !row.correct)
                    continue;
                const auto of_row = [&](std::size_t condition) {
                    return experiment.stimulus(experiment.conditions[condition]).name == row.condition;
                };
                const auto level =
                    static_cast<std::size_t>(std::ranges::find_if(track.conditions, of_row) - track.conditions.begin());
                if (level == track.conditions.size())
                    continue;
                one.posterior.add(level, *row.correct);
                one.counts[level].trials += 1;
                one.counts[level].right += *row.correct;
                one.trials += 1;
                if (group != kAll)
                    trials.push_back({label, row.session, static_cast<std::uint64_t>(one.trials), track.levels[level],
                                      *row.correct, one.posterior.threshold()});
            }
            if (one.trials > 0)
                estimates.push_back(std::move(one));
        }
    return estimates;
}

Table threshold_table(const std::vector<Estimate>& estimates, const std::string& axis, const std::string& unit) {
    using E = Estimate;
    const std::string of = axis + " at which the standard is told from the stimulus half way between chance and what "
                                  "lapses leave, about 75 % right: median of the posterior";
    return study::table_of<E>(
        "thresholds", "Thresholds of " + axis,
        {{{"label", "", "subject and track"}, &E::label},
         {{"subject", "", "which; all: as if it were one"}, &E::subject},
         {{"track", "", "settings that its stimuli share"}, &E::track},
         {{"trials", "1", "with an answer"}, &E::trials},
         {{"threshold", unit, of}, [](const E& e) { return cell(e.posterior.threshold().median); }},
         {{"from", unit, "95 % credible interval"}, [](const E& e) { return cell(e.posterior.threshold().range.low); }},
         {{"to", unit, "its upper end"}, [](const E& e) { return cell(e.posterior.threshold().range.high); }},
         {{"unbounded", "", "below or above: no threshold that was considered ends the interval there"},
          [](const E& e) {
              const int beyond = e.posterior.threshold().beyond;
              return Cell(std::string(beyond < 0 ? "below" : beyond > 0 ? "above" : ""));
          }},
         {{"lowest_level", unit, "that could be shown: a threshold beyond the levels is a guess"},
          [](const E& e) { return cell(e.levels->levels.front()); }},
         {{"highest_level", unit, "the last"}, [](const E& e) { return cell(e.levels->levels.back()); }}},
        estimates);
}

Table level_table(const std::vector<Estimate>& estimates, const std::string& axis, const std::string& unit) {
    Table table{"levels", "Right answers by level", {}, {}};
    table.columns = {{"subject", "", "all, or which"},
                     {"track", "", "settings that its stimuli share"},
                     {"level", unit, axis},
                     {"trials", "1", "with an answer"},
                     {"right_percent", "%", "of the answers"},
                     {"from_percent", "%", "95 % interval of a share of trials (Jeffreys)"},
                     {"to_percent", "%", "its upper end"}};
    for (const Estimate& one : estimates)
        for (std::size_t i = 0; i < one.counts.size(); ++i)
            if (const Tally& counts = one.counts[i]; counts.trials > 0) {
                const Range range = jeffreys(counts.right, counts.trials);
                table.rows.push_back({one.subject, one.track, one.levels->levels[i], counts.trials,
                                      100 * counts.share(), 100 * range.low, 100 * range.high});
            }
    return table;
}

Table curve_table(const std::vector<Estimate>& estimates, const std::string& axis, const std::string& unit) {
    constexpr int kPoints = 60;
    Table table{"psychometric", "Psychometric functions, mean of the posterior", {}, {}};
    table.columns = {{"subject", "", "all, or which"},
                     {"track", "", "settings that its stimuli share"},
                     {"level", unit, axis},
                     {"right_percent", "%", "right answers to be expected"}};
    for (const Estimate& one : estimates)
        for (int i = 0; i <= kPoints; ++i) {
            const double level = std::exp(std::lerp(std::log(one.levels->levels.front()),
                                                    std::log(one.levels->levels.back()), double(i) / kPoints));
            table.rows.push_back({one.subject, one.track, level, 100 * one.posterior.share_right(level)});
        }
    return table;
}

Table trial_table(const std::vector<TrackTrial>& trials, const std::string& axis, const std::string& unit) {
    using T = TrackTrial;
    return study::table_of<T>(
        "tracks", "Tracks, trial by trial",
        {{{"label", "", "subject and track"}, &T::label},
         {{"session", "1", "of the subject"}, &T::session},
         {{"trial", "1", "of the track"}, &T::trial},
         {{"level", unit, axis}, &T::level},
         {{"answer", "", "right or wrong"}, [](const T& t) { return Cell(t.right ? "right" : "wrong"); }},
         {{"threshold", unit, "estimated after the trial"}, [](const T& t) { return cell(t.after.median); }},
         {{"from", unit, "95 % credible interval"}, [](const T& t) { return cell(t.after.range.low); }},
         {{"to", unit, "its upper end"}, [](const T& t) { return cell(t.after.range.high); }}},
        trials);
}

void add_track_figures(study::StudyData& data, const std::vector<Estimate>& estimates, const std::string& label) {
    study::Figure shares =
        study::make_figure("psychometric", "Right answers by level",
                           "Shares of the answers with their 95 % intervals (Jeffreys), and the psychometric function "
                           "that the posterior expects. Half of the answers are right by chance.",
                           study::FigureKind::scatter, "levels", {{"subject", estimates.front().subject}},
                           {"level", label, true}, {"right_percent", "right answers / %"}, "track");
    shares.low = "from_percent";
    shares.high = "to_percent";
    for (const Estimate& one : estimates)
        if (one.subject == estimates.front().subject)
            shares.curves.push_back({"psychometric",
                                     {{"subject", one.subject}, {"track", one.track}},
                                     "level",
                                     "right_percent",
                                     one.track + ", expected",
                                     false});
    study::Figure track = study::make_figure(
        "track", "Levels, trial by trial",
        "Which level each trial had: the one whose answer was expected to say most about the threshold (QUEST+).",
        study::FigureKind::scatter, "tracks", {}, {"trial", "trial of the track"}, {"level", label, true}, "label");
    track.joined = true;
    study::Figure thresholds = study::make_figure(
        "thresholds", "Thresholds", "Medians of the posterior with its 95 % intervals.", study::FigureKind::bars,
        "thresholds", {}, {"label", "subject, track"}, {"threshold", label});
    thresholds.low = "from";
    thresholds.high = "to";
    data.figures = {shares, track, thresholds};
}

void add_comparison_figure(study::StudyData& data, const std::string& group) {
    study::Figure& bars = data.figures.emplace_back(
        study::make_figure("comparisons", "Right answers by stimulus",
                           "Each compared with its standard; with 95 % intervals of shares of trials (Jeffreys). Half "
                           "of the answers are right by chance.",
                           study::FigureKind::bars, "comparisons", {{"subject", group}}, {"condition", "stimulus"},
                           {"right_percent", "right answers / %"}));
    bars.low = "right_from_percent";
    bars.high = "right_to_percent";
}

// "14.2" or "0.0161 m".
std::string with_unit(double value, const std::string& unit) {
    return fmt::format("{:.3g}{}", value, unit == "1" ? "" : " " + unit);
}

// A subject whose answers name no threshold among the levels.
void warn_of_thresholds_beyond(study::StudyData& data, const std::vector<Estimate>& estimates) {
    for (const Estimate& one : estimates) {
        const Threshold found = one.posterior.threshold();
        const std::vector<double>& levels = one.levels->levels;
        if (one.subject != kAll && (found.beyond != 0 || found.median < levels.front() || found.median > levels.back()))
            data.notes.push_back(fmt::format(
                "{}: the threshold is likely {} the levels{}: show {} ones, or leave this subject out of means.",
                one.label, found.median < levels.front() ? "below" : "above",
                found.beyond != 0 ? ", and nothing bounds it there" : "",
                found.median < levels.front() ? "lower" : "higher"));
    }
}

void add_threshold_findings(study::StudyData& data, const Answers& answers, const std::vector<Estimate>& estimates) {
    const std::string &axis = answers.experiment.track_key, &unit = answers.experiment.track_unit;
    warn_of_thresholds_beyond(data, estimates);
    for (const Track& track : answers.experiment.tracks) {
        std::vector<double> logarithms;
        Threshold single;
        double trials = 0;
        for (const Estimate& one : estimates)
            if (one.track == track.name && one.subject != kAll) {
                single = one.posterior.threshold();
                logarithms.push_back(std::log(single.median));
                trials += one.trials;
            }
        if (logarithms.empty())
            continue;
        double mean = 0;
        for (const double one : logarithms)
            mean += one / double(logarithms.size());
        const Range over = mean_interval(logarithms);
        const bool several = logarithms.size() > 1;
        const double threshold = std::exp(mean);
        const bool below = threshold<track.levels.front(), above = threshold> track.levels.back();
        const auto range_text = [&](const char* what, double low, double high) {
            return fmt::format("95 % {}: {} to {}", what, with_unit(low, unit), with_unit(high, unit));
        };
        data.findings.push_back(
            {fmt::format("threshold_{}", &track - answers.experiment.tracks.data() + 1),
             fmt::format("Threshold of {}{}: {}.", axis,
                         answers.experiment.tracks.size() > 1 ? fmt::format(" ({})", track.name) : "",
                         below ? fmt::format("below {}, the lowest level", with_unit(track.levels.front(), unit))
                         : above
                             ? fmt::format("above {}, the highest level", with_unit(track.levels.back(), unit))
                             : with_unit(threshold, unit) + (several ? ", the geometric mean of the subjects'" : "")),
             "psychometric", track.name,
             fmt::format("{}, {:.0f} trials; right half way between chance and what lapses leave",
                         numbers::counted(logarithms.size(), "subject"), trials),
             below || above ? "no level reaches it, so that there is no interval"
             : several      ? range_text("over subjects", std::exp(over.low), std::exp(over.high))
                            : range_text("credible", single.range.low, single.range.high)});
    }
}

} // namespace

void add_comparisons(study::StudyData& data, const Answers& answers) {
    const Experiment& experiment = answers.experiment;
    data.tables.push_back(comparison_table(answers));
    const std::string group = groups_of(answers).front();
    if (experiment.tracks.empty()) {
        double right = 0, trials = 0;
        for (const TrialRow& row : answers.rows)
            if (row.correct) {
                right += *row.correct;
                trials += 1;
            }
        if (trials > 0) {
            const Range range = jeffreys(right, trials);
            data.findings.push_back(
                {"right", fmt::format("{:.0f} % of {:.0f} answers are right.", 100 * right / trials, trials),
                 "comparisons", "all stimuli", numbers::counted(answers.subjects().size(), "subject"),
                 fmt::format("95 % of a share of trials: {:.0f} to {:.0f} %", 100 * range.low, 100 * range.high)});
            add_comparison_figure(data, group);
        }
    } else {
        std::vector<TrackTrial> trials;
        const std::vector<Estimate> estimates = estimates_of(answers, trials);
        const std::string &axis = experiment.track_key, &unit = experiment.track_unit;
        data.tables.push_back(threshold_table(estimates, axis, unit));
        data.tables.push_back(level_table(estimates, axis, unit));
        data.tables.push_back(curve_table(estimates, axis, unit));
        data.tables.push_back(trial_table(trials, axis, unit));
        add_track_figures(data, estimates, unit == "1" ? axis : fmt::format("{} / {}", axis, unit));
        add_threshold_findings(data, answers, estimates);
        data.notes.push_back("Thresholds are of a grid's posterior (threshold, slope, lapses: Watson 2017, QUEST+), "
                             "for which the function is logistic in the logarithm of the level. A subject \"all\" "
                             "takes everybody's answers for one's: its interval leaves out how subjects differ.");
    }
    data.notes.push_back(fmt::format("{} The standard was felt first in half of the trials.",
                                     experiment.spec.correct == kSmoother
                                         ? "Right is the stimulus of more facets, the smooth shape before all."
                                         : fmt::format("Right is what {} names.", experiment.spec.correct)));
    if (std::ranges::any_of(answers.rows, [](const TrialRow& row) { return row.participant.starts_with("observer"); }))
        data.notes.push_back("The observer's comparisons are a model's expectation: it was fitted to names of single "
                             "stimuli, and no experiment has compared two for it.");
}

} // namespace forceshade::experiment
