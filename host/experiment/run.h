// A session: trial after trial is put before a participant, a person or a simulated one, and what comes of it is
// recorded.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "device/loop/sample.h"
#include "device/session/session.h"
#include "host/experiment/record.h"
#include "host/experiment/stroke.h"
#include "host/field/prepared_case.h"

namespace forceshade::experiment {

/// A stimulus of a trial, and where its path is logged; empty: nowhere.
struct Shown {
    const PreparedCase& stimulus;
    std::filesystem::path path;
};

/// Who answers: a person at a device, or a simulated one.
class Participant {
public:
    virtual ~Participant() = default;
    /// Feels the stimulus, or two one after the other, and answers. \throws Error if nobody can go on.
    virtual TrialOutcome take(const Trial& trial, std::span<const Shown> shown, SessionRecord& record) = 0;
    /// After the last trial.
    virtual void finish() {}
    /// What displays the forces.
    virtual std::string device() const = 0;
    /// A line of JSON that is kept of it for each start; empty: nothing.
    virtual std::string about_device() const { return {}; }
};

/// The model observer: a simulated hand strokes, the answer is drawn from the shares that its cues give. Answers are
/// the paper's four, or which of two is smoother. `subjects_differ`: each has an observer_of() its own. \throws
/// UsageError for an experiment of others.
std::unique_ptr<Participant> make_observer(const Experiment& experiment, const ObserverParameters& parameters = {},
                                           bool subjects_differ = false);

/// Writes samples as `live --log` does. \throws IoError.
void log_path(const std::vector<device::LiveSample>& samples, const std::filesystem::path& file, Precision precision,
              bool with_buttons = false);

/// What the samples of a stimulus say: everything but status, answer and reaction.
TrialOutcome outcome_of(const Feature& feature, const std::vector<device::LiveSample>& samples, double period);

/// Adds what came of another stimulus of the same trial, whose reaction and status count.
void add_interval(TrialOutcome& outcome, const TrialOutcome& other);

struct RunOptions {
    std::filesystem::path folder;
    SessionInfo info;
    bool paths = false; /* keep them */
    ParticipantFacts participant{};
};

/// Until no trial is left; returns how many trials of the session are answered. \throws as SessionRecord and
/// Participant; Interrupted: what is answered stays.
std::size_t run_session(const Experiment& experiment, Participant& participant, const RunOptions& options);

struct PersonOptions {
    device::SessionOptions session; /* device, mapping, rate and limits; the rest is not used */
    std::uint16_t port = 0;         /* of the pages; 0: any that is free */
    std::vector<unsigned> buttons;  /* of the device, one for each answer; empty: answers are the page's keys alone */
    std::string check;              /* of the device, JSON as device::check_json; empty: none was made */
};

/// Opens the device and serves the pages, whose addresses go to stderr. The force is zero but for the time in which a
/// stimulus is felt: it comes up once the probe is free of contact, and is switched off when the page is closed.
/// \throws UsageError, IoError, DeviceAbsent; UsageError for a check of another device or mapping, Error for one that
/// failed.
std::unique_ptr<Participant> make_person(const Experiment& experiment, const PersonOptions& options);

} // namespace forceshade::experiment
