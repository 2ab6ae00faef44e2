// A session: trial after trial is put before a participant, and what comes of it is recorded.
#pragma once

#include <memory>
#include <string>

#include "device/loop/sample.h"
#include "host/experiment/record.h"
#include "host/experiment/stroke.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::experiment {

/// Who answers: a person at a device, or a simulated one.
class Participant {
public:
    virtual ~Participant() = default;
    /// Feels the stimulus and answers. `path`: where its path is logged; empty: nowhere. \throws Error if nobody can go
    /// on.
    virtual TrialOutcome take(const Trial& trial, const PreparedCase& stimulus, const std::filesystem::path& path,
                              SessionRecord& record) = 0;
    /// After the last trial.
    virtual void finish() {}
    /// What displays the forces.
    virtual std::string device() const = 0;
};

/// The model observer: a simulated hand strokes, the answer is drawn from the shares that its cues give. Answers are
/// the paper's four. \throws UsageError for an experiment of others.
std::unique_ptr<Participant> make_observer(const Experiment& experiment, const ObserverParameters& parameters = {});

/// Writes samples as `live --log` does. \throws IoError.
void log_path(const std::vector<device::LiveSample>& samples, const std::filesystem::path& file, Precision precision);

/// What the samples of a trial say: everything but status, answer and reaction.
TrialOutcome outcome_of(const Feature& feature, const std::vector<device::LiveSample>& samples, double period);

struct RunOptions {
    std::filesystem::path folder;
    SessionInfo info;
    bool paths = false; /* keep them */
};

/// Until no trial is left. \throws as SessionRecord and Participant; Interrupted: what is answered stays.
void run_session(const Experiment& experiment, Participant& participant, const RunOptions& options);

} // namespace forceshade::experiment
