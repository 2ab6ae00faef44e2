#include "host/experiment/run.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "device/session/live_log.h"
#include "host/error.h"
#include "host/experiment/random.h"
#include "host/norm.h"
#include "host/program.h"
#include "shaders/shared/law.h"

namespace forceshade::experiment {
namespace {

class Observer final : public Participant {
public:
    explicit Observer(const ObserverParameters& parameters) : parameters_(parameters) {}

    std::string device() const override { return "simulated hand and device"; }

    TrialOutcome take(const Trial& trial, const PreparedCase& stimulus, const std::filesystem::path& path,
                      SessionRecord&) override {
        const Manner manner = manner_of(stimulus.one.scene);
        const Feature feature = feature_of(stimulus);
        const std::vector<device::LiveSample> samples = stroke(stimulus, manner);
        TrialOutcome outcome = outcome_of(feature, samples, 1 / manner.rate);
        outcome.reaction = static_cast<double>(samples.size()) / manner.rate;
        const Shares shares = answer_shares(passes_over(feature, samples), parameters_);
        outcome.answer = Random(trial.seed).among(shares);
        if (!path.empty())
            log_path(samples, path, Precision::f64);
        return outcome;
    }

private:
    const ObserverParameters parameters_;
};

} // namespace

std::unique_ptr<Participant> make_observer(const Experiment& experiment, const ObserverParameters& parameters) {
    const auto& answers = experiment.spec.answers;
    bool papers = answers.size() == kPictures;
    for (std::size_t i = 0; papers && i < kPictures; ++i)
        papers = answers[i].name == kPictureNames[i];
    if (!papers)
        throw UsageError(fmt::format("--participant observer: it knows the paper's four answers only, {}; these are "
                                     "others",
                                     fmt::join(kPictureNames, ", ")));
    return std::make_unique<Observer>(parameters);
}

void log_path(const std::vector<device::LiveSample>& samples, const std::filesystem::path& file, Precision precision) {
    device::SampleRing ring(samples.size());
    device::LiveLog log(file, ring, precision, true);
    for (const device::LiveSample& sample : samples)
        ring.put(sample);
    log.close();
    if (!log.failure().empty())
        throw IoError(log.failure());
}

TrialOutcome outcome_of(const Feature& feature, const std::vector<device::LiveSample>& samples, double period) {
    TrialOutcome outcome;
    double way = 0, press = 0; // m, N
    std::uint64_t contacts = 0;
    const device::LiveSample* before = nullptr;
    for (const device::LiveSample& sample : samples) {
        outcome.largest_force = std::max(outcome.largest_force, reference::length(sample.commanded));
        if (sample.facet != layout::kNoFacet) {
            ++contacts;
            press += sample.commanded.z;
            if (before && before->facet != layout::kNoFacet)
                way += reference::length(sample.probe - before->probe);
        }
        before = &sample;
    }
    outcome.contact = static_cast<double>(contacts) * period;
    outcome.strokes = passes_over(feature, samples).size();
    if (contacts > 0) {
        outcome.speed = way / outcome.contact;
        outcome.press = press / static_cast<double>(contacts);
    }
    return outcome;
}

void run_session(const Experiment& experiment, Participant& participant, const RunOptions& options) {
    SessionRecord record(options.folder, experiment, options.info);
    if (!record.repaired().empty())
        remark("warning: {}\n", record.repaired());
    std::vector<std::optional<PreparedCase>> stimuli(experiment.study.cases.size());
    CasePreparation preparation;
    while (const Trial* trial = record.next()) {
        check_interrupt();
        std::optional<PreparedCase>& stimulus = stimuli[trial->condition];
        if (!stimulus)
            stimulus = preparation.prepare(experiment.study.cases[trial->condition]);
        const Trial now = *trial;
        const std::filesystem::path path = options.paths ? record.path_file(now) : std::filesystem::path();
        record.add(now, participant.take(now, *stimulus, path, record));
    }
    participant.finish();
}

} // namespace forceshade::experiment
