// The data of an experiment as a Psych-DS folder: a row a trial, on the disk as soon as it is there.
//
//   dataset_description.json                 what the columns are
//   .psychds-ignore                          folders that are no data in the sense of Psych-DS
//   data/subject-03_session-1_data.csv       a row a trial
//   materials/experiment.toml                the experiment, resolved
//   materials/order/subject-03_session-1.csv its order, written before the first trial
//   materials/stimuli/CASE.toml              the scene of each condition
//   materials/edge.png                       the picture of an answer, under the answer's name
//   materials/consent.md                     and the other texts of the experiment, under their keys' names
//   documentation/participants.csv           subject, session, age, hand, where they were given
//   documentation/subject-03_session-1_...   the operator's notes, and a line of JSON about the device for each start
//   paths/subject-03_session-1_trial-12.csv  the probe's path, as `live` logs it, where paths are kept
//   paths/subject-03_session-1_trial-12_interval-2.csv  likewise where two stimuli are compared
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/experiment/experiment.h"
#include "host/experiment/statistics.h"

namespace forceshade::experiment {

/// How a trial ended: answered, or why it does not count and is done again at the end.
inline constexpr const char *kAnswered = "answered", *kWithdrawn = "withdrawn";

/// What came of a trial.
struct TrialOutcome {
    std::string status = kAnswered; /* else "no answer", "no contact", "too early", "interrupted", "device lost", "force
                                       clamped", "force off", "withdrawn" */
    std::string started = {};       /* UTC; empty: now */
    std::optional<std::size_t> answer; /* index of the experiment's answers */
    double reaction = 0;               /* s: from the stimulus, of two the second, to the answer */
    double contact = 0;                /* s: in contact */
    double largest_force = 0;          /* N */
    double limited = 0;           /* 1: share of the time in contact in which the force was lowered for the motors */
    std::uint64_t strokes = 0;    /* passes across the whole feature */
    double speed = 0;             /* m/s: mean in contact */
    double press = 0;             /* N: mean vertical force in contact */
    std::string answered_by = {}; /* "key", "button"; empty: a simulated participant, or nobody */
};

/// What the rows say about who and how.
struct SessionInfo {
    std::string subject; /* of letters and digits */
    std::uint64_t session = 1;
    std::string participant;           /* "person", or the simulated one's name */
    std::string device;                /* "simulated hand and device" */
    std::string device_check = "none"; /* of it before the session: "passed", or none was made */
};

/// What is kept of a person; no names.
struct ParticipantFacts {
    std::optional<unsigned> age; /* years */
    std::string hand;            /* "left", "right", "both"; empty: unknown */
};

/// A row of the data.
struct TrialRow : SessionInfo {
    std::uint64_t sequence = 0;          /* 1: the first row of the session */
    std::uint64_t number = 0;            /* of the trial in its order */
    std::uint64_t block = 0;             /* 0: practice */
    std::string condition;               /* the case's name */
    std::string standard;                /* the case that it was compared with; empty: none */
    std::uint64_t standard_interval = 0; /* 1 or 2: when the standard was felt; 0: there is none */
    std::string track;                   /* that chose the condition; empty: none */
    std::string answer;                  /* its name; empty: none */
    std::optional<bool> correct;         /* whether it names the stimulus' nominal shape; nothing: no answer does */
    TrialOutcome outcome;                /* read back without the answer's index */
    std::uint64_t seed = 0;
    std::string program; /* forceshade's version */
    bool counts() const { return block > 0 && outcome.status == kAnswered; }
};

/// The posteriors of an experiment's tracks before the first trial.
std::vector<ThresholdTrack> unanswered_tracks(const Experiment& experiment);

/// Rows of one file; with an experiment its answers alone are answers. \throws IoError, or UsageError
/// `file:line:column: ...` for a row that is none.
std::vector<TrialRow> read_rows(const std::filesystem::path& file, const Experiment* experiment = nullptr);

/// The last row of each trial, which decides whether it counts: one that was withdrawn has a later row.
std::vector<TrialRow> last_rows(const std::vector<TrialRow>& rows);

/// The data files of a folder, by name. \throws IoError if it has none.
std::vector<std::filesystem::path> data_files(const std::filesystem::path& folder);

/// One session of one subject, begun or taken up again.
class SessionRecord {
public:
    /// Makes the folder and its files, or checks that they are of the same experiment and reads what is done. A last
    /// line that was cut off is removed. \throws UsageError for a name that is none, another experiment in the folder,
    /// a session that is complete, a damaged row; IoError if another process has it, or files cannot be written.
    SessionRecord(const std::filesystem::path& folder, const Experiment& experiment, const SessionInfo& info);
    ~SessionRecord();
    SessionRecord(const SessionRecord&) = delete;
    SessionRecord& operator=(const SessionRecord&) = delete;

    const SessionInfo& info() const { return info_; }
    const std::vector<Trial>& order() const { return order_; }
    const std::vector<TrialRow>& rows() const { return rows_; }
    /// What an earlier run left behind that is gone now; empty: nothing.
    const std::string& repaired() const { return repaired_; }

    /// The next trial: first those of the order, then those that have to be done again, at most max_repeats times;
    /// nothing: none is left. A track's condition is chosen by the rows that are there.
    std::optional<Trial> next() const;
    std::uint64_t left() const; /* trials; the most where tracks may end before */
    /// Trials that failed as often as they may, "trial 3 (force clamped)".
    std::vector<std::string> given_up() const;

    /// Onto the disk. \throws IoError: the row is not there then, not in part either.
    void add(const Trial& trial, const TrialOutcome& outcome);

    /// The last answered trial does not count and comes again; false: there is none. \throws IoError.
    bool withdraw_last();

    /// Keeps an operator's note, in documentation/. \throws IoError.
    void note(const std::string& text) const;

    /// Keeps a line of JSON about the device of this start, likewise. \throws IoError.
    void keep_device(const std::string& json) const;

    /// Keeps a row in documentation/participants.csv, that of the first start of each session. \throws IoError.
    void keep_participant(const ParticipantFacts& facts) const;

    /// Where the path of the next row belongs. `interval`: 1 or 2 where stimuli are compared, else 0.
    std::filesystem::path path_file(const Trial& trial, std::size_t interval = 0) const;

private:
    void write_materials() const;
    void document(const std::string& name, const std::string& line) const;
    void open_data();
    std::vector<const TrialRow*> latest() const;
    bool comes_again(const TrialRow& last) const;
    void read_back();
    void update_tracks();
    void learn(const TrialRow& row);
    bool has_ended(const Trial& trial) const { return trial.track && ended_[*trial.track]; }
    std::optional<Trial> trial_of(const TrialRow& row) const;
    std::string stem() const;

    const std::filesystem::path folder_;
    const Experiment& experiment_;
    const SessionInfo info_;
    const std::vector<Trial> order_;
    std::filesystem::path file_;
    int descriptor_ = -1;
    std::vector<TrialRow> rows_;
    const std::vector<ThresholdTrack> unanswered_; // by track: before the first row
    std::vector<ThresholdTrack> tracks_;           // with what the rows say
    std::vector<bool> ended_;                      // by track: its threshold is known well enough
    std::string repaired_;
};

} // namespace forceshade::experiment
