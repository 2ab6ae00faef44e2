#include "host/experiment/run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/long_run.h"
#include "host/norm.h"
#include "host/numbers.h"
#include "host/program.h"
#include "host/random.h"
#include "host/reference/elementary.h"
#include "shaders/shared/law.h"

namespace forceshade::experiment {
namespace {

// By inversion.
std::uint64_t poisson(double mean, Random& random) {
    const double drawn = random.uniform();
    double share = std::exp(-mean), below = share;
    std::uint64_t count = 0;
    while (drawn >= below && share > 0) {
        share *= mean / static_cast<double>(++count);
        below += share;
    }
    return count;
}

class Observer final : public Participant {
public:
    Observer(const ObserverParameters& parameters, bool subjects_differ)
        : parameters_(parameters), subjects_differ_(subjects_differ) {}

    std::string device() const override { return "simulated hand and device"; }

    TrialOutcome take(const Trial& trial, std::span<const Shown> shown, SessionRecord& record) override {
        const ObserverParameters own = subjects_differ_ ? observer_of(parameters_, record.info().subject) : parameters_;
        TrialOutcome outcome;
        std::vector<Cues> cues;
        for (const Shown& one : shown) {
            const Manner manner = manner_of(one.stimulus.one.scene);
            const Feature feature = feature_of(one.stimulus);
            const std::vector<device::LiveSample> samples = stroke(one.stimulus, manner);
            TrialOutcome of_one = outcome_of(feature, samples, 1 / manner.rate);
            of_one.reaction = static_cast<double>(samples.size()) / manner.rate;
            if (cues.empty())
                outcome = of_one;
            else
                add_interval(outcome, of_one);
            cues.push_back(mean_cues(passes_over(feature, samples), own));
            if (!one.path.empty())
                log_path(samples, one.path, Precision::f64);
        }
        Random random(trial.seed, "");
        outcome.answer =
            cues.size() == 1 ? random.among(shares_of(cues.front(), own)) : smoother(cues[0], cues[1], own, random);
        return outcome;
    }

private:
    // Of each the edges and level tops are counted that it happens to notice: fewer are smoother, as many are guessed.
    static std::size_t smoother(const Cues& first, const Cues& second, const ObserverParameters& own, Random& random) {
        const auto noticed = [&](const Cues& cues) {
            const Events events = events_of(cues, own);
            const bool felt = random.uniform() < events.felt;
            return felt ? poisson(events.edges + events.levels, random) : 0;
        };
        const std::uint64_t one = noticed(first), other = noticed(second);
        if (one == other || random.uniform() < own.lapse)
            return random.below(2);
        return one < other ? 0 : 1;
    }

    const ObserverParameters parameters_;
    const bool subjects_differ_;
};

} // namespace

std::unique_ptr<Participant> make_observer(const Experiment& experiment, const ObserverParameters& parameters,
                                           bool subjects_differ) {
    if (experiment.spec.task == Task::compare) {
        if (experiment.spec.correct != kSmoother)
            throw UsageError("--participant observer: of two stimuli it knows which is smoother only; correct = \"" +
                             experiment.spec.correct + "\" asks something else");
        return std::make_unique<Observer>(parameters, subjects_differ);
    }
    if (!experiment.has_papers_answers())
        throw UsageError("--participant observer: it knows the paper's four answers only, {}; these are others",
                         fmt::join(kPictureNames, ", "));
    return std::make_unique<Observer>(parameters, subjects_differ);
}

void log_path(const std::vector<device::LiveSample>& samples, const std::filesystem::path& file, Precision precision,
              bool with_buttons) {
    device::LiveLog log(file, static_cast<double>(samples.size()), precision, true, with_buttons);
    for (const device::LiveSample& sample : samples)
        log.ring().put(sample);
    log.close();
    if (!log.failure().empty())
        throw IoError(log.failure());
}

TrialOutcome outcome_of(const Feature& feature, const std::vector<device::LiveSample>& samples, double period) {
    TrialOutcome outcome;
    double way = 0, press = 0; // m, N
    std::uint64_t contacts = 0, limited = 0;
    const device::LiveSample* before = nullptr;
    for (const device::LiveSample& sample : samples) {
        outcome.largest_force = std::max(outcome.largest_force, reference::length(sample.commanded));
        if (sample.facet != layout::kNoFacet) {
            ++contacts;
            limited += (sample.flags & device::kLasting) != 0;
            press += sample.commanded.z;
            if (before && before->facet != layout::kNoFacet)
                way += reference::length(sample.probe - before->probe);
        }
        before = &sample;
    }
    outcome.contact = static_cast<double>(contacts) * period;
    outcome.strokes = passes_over(feature, samples).size();
    if (contacts > 0) {
        outcome.limited = static_cast<double>(limited) / static_cast<double>(contacts);
        outcome.speed = way / outcome.contact;
        outcome.press = press / static_cast<double>(contacts);
    }
    return outcome;
}

void add_interval(TrialOutcome& outcome, const TrialOutcome& other) {
    const double contact = outcome.contact + other.contact; // s
    const auto mean = [&](double one, double two) {
        return contact > 0 ? (one * outcome.contact + two * other.contact) / contact : 0;
    };
    outcome.speed = mean(outcome.speed, other.speed);
    outcome.press = mean(outcome.press, other.press);
    outcome.limited = mean(outcome.limited, other.limited);
    outcome.contact = contact;
    outcome.strokes += other.strokes;
    outcome.largest_force = std::max(outcome.largest_force, other.largest_force);
    outcome.reaction = other.reaction;
    outcome.answer = other.answer;
    outcome.answered_by = other.answered_by;
    outcome.status = other.status;
}

std::size_t run_session(const Experiment& experiment, Participant& participant, const RunOptions& options) {
    SessionRecord record(options.folder, experiment, options.info);
    if (!record.repaired().empty())
        print_note("warning: {}\n", record.repaired());
    if (const std::string about = participant.about_device(); !about.empty())
        record.keep_device(about);
    if (options.participant.age || !options.participant.hand.empty())
        record.keep_participant(options.participant);
    std::vector<std::optional<PreparedCase>> prepared(experiment.study.cases.size());
    CasePreparation preparation;
    const std::uint64_t all = record.left();
    Stage stage("beginning", all, "trials");
    while (const std::optional<Trial> trial = record.next()) {
        check_interrupt();
        const Condition& condition = experiment.conditions[trial->condition];
        std::vector<std::size_t> cases{condition.stimulus};
        if (condition.standard)
            cases.insert(trial->standard_first ? cases.begin() : cases.end(), *condition.standard);
        std::vector<Shown> shown;
        for (const std::size_t one : cases) {
            if (!prepared[one])
                prepared[one] = preparation.prepare(experiment.study.cases[one]);
            const std::size_t interval = cases.size() > 1 ? shown.size() + 1 : 0;
            shown.push_back(
                {*prepared[one], options.paths ? record.path_file(*trial, interval) : std::filesystem::path()});
        }
        record.add(*trial, participant.take(*trial, shown, record));
        stage.update(all - std::min(all, record.left()), experiment.stimulus(condition).name);
    }
    participant.finish();
    if (const std::vector<std::string> given_up = record.given_up(); !given_up.empty())
        print_note("warning: {} failed more than max_repeats = {} times and {} left out: {}\n",
                   numbers::counted(given_up.size(), "trial"), experiment.spec.max_repeats,
                   given_up.size() == 1 ? "is" : "are", fmt::join(given_up, ", "));
    const std::vector<TrialRow> last = last_rows(record.rows());
    return static_cast<std::size_t>(
        std::ranges::count_if(last, [](const TrialRow& row) { return row.outcome.status == kAnswered; }));
}

} // namespace forceshade::experiment
