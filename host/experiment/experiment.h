// An experiment: which stimuli, how often and in which order, what is asked, and which answers there are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "host/experiment/observer.h"
#include "host/scene/study.h"

namespace forceshade::experiment {

/// Which answer a stimulus is named by, or which of two, felt one after the other, is asked for.
enum class Task { name, compare };

/// random: over a whole session. balanced: each block has every condition equally often. latin: a repetition after the
/// other, each a row of a balanced Latin square (Williams 1949), so that over the subjects every condition stands at
/// every place and follows every other equally often. sequential: as the conditions are listed.
enum class Order { random, balanced, latin, sequential };

/// A picture file, PNG or SVG, as read.
struct AnswerPicture {
    std::string extension; /* ".png" or ".svg" */
    std::string bytes;     /* empty: none */
};

/// A text file in the experiment's folder, as read.
struct GivenFile {
    std::filesystem::path path;
    std::string bytes; // empty: none is given
};

/// The name that such a file of a key has in materials/: "consent.md".
std::string text_file_name(std::string_view key);

/// An answer, in the order of its key: 1 for the first.
struct Answer {
    std::string name;               /* of [a-z0-9_], as data has it: "two_poly" */
    std::string label;              /* as a participant reads it */
    std::optional<unsigned> facets; /* of the nominal shape that it names; 0: the smooth shape */
    std::string correct_for;        /* shell pattern of case names; empty: stimuli of these facets */
    AnswerPicture picture;          /* in place of the drawn shape */

    /// "edge.png": as materials/ has it; empty: none.
    std::string picture_file() const { return picture.bytes.empty() ? "" : name + picture.extension; }
};

/// The rule of the task compare by which the stimulus of more facets is right, the smooth shape before all.
inline constexpr const char* kSmoother = "smoother";

struct ExperimentSpec {
    Task task = Task::name;
    std::string title = "Shapes that are felt";
    std::string question = "Which shape did you feel?";
    std::vector<Answer> answers;
    std::uint64_t trials = 24;  /* of each condition; of each track the most */
    std::uint64_t practice = 0; /* trials before, of conditions in turn; they do not count */
    std::uint64_t blocks = 1;   /* with a break between */
    Order order = Order::random;
    bool feedback = false;
    double longest_trial = 60;     /* s */
    double least_contact = 0.2;    /* s: an answer after less is none */
    std::uint64_t max_repeats = 3; /* of a trial that does not count; then it is left out */
    std::uint64_t seed = 1996;
    std::map<std::string, std::string> text; /* sentences of the participant's page, by their keys: page_texts() */
    GivenFile consent, instructions;         /* Markdown: pages before the first trial */
    bool familiarise = false;                /* each answer's stimulus is displayed once before, with its name */
    std::uint64_t break_every = 0;           /* trials between breaks, besides those between blocks; 0: none */
    double break_after = 0;                  /* s since the last break; 0: none */
    double break_least = 0;                  /* s: the shortest break */
    GivenFile conditions;      /* CSV: a row a condition, as often as it stands there; else each case once */
    std::string block_by;      /* key of the study: a block for each of its values; empty: blocks */
    std::string catch_trials;  /* shell pattern of the cases whose answer is beyond doubt; empty: none */
    double catch_least = 0.75; /* 1: share of these that a subject answers right; who has less is left out */
    /* of the task compare: */
    std::string standard;            /* shell pattern of the cases that the others are compared with */
    std::string correct = kSmoother; /* or a shell pattern of the case names that are right */
    double interval = 0;             /* s: that a stimulus is felt; 0: until a key is pressed */
    std::string track;               /* key of the study whose levels are chosen adaptively; empty: none */
    double track_ratio = 1;          /* of the ends of a threshold's interval, which end its track; 1: trials do */
};

/// The pictures and text files that are given: their names in materials/ and what they hold.
std::vector<std::pair<std::string, std::string>> given_files(const ExperimentSpec& spec);

/// What is asked about in a trial: indices of the study's cases.
struct Condition {
    std::size_t stimulus = 0;
    std::optional<std::size_t> standard; /* that it is compared with */
};

/// Conditions that differ by one numeric key alone, whose threshold is looked for.
struct Track {
    std::string name;                    /* what they share and others do not: "shading none"; "all" */
    std::vector<std::size_t> conditions; /* by level, ascending */
    std::vector<double> levels;          /* SI: positive */
    bool rises = true;                   /* whether higher levels are told from the standard more easily */
};

struct Trial {
    std::uint64_t number = 0;           /* 1: the first of the session, practice included */
    std::uint64_t block = 0;            /* 1: the first; 0: practice */
    std::size_t condition = 0;          /* index of Experiment::conditions */
    std::uint64_t seed = 0;             /* of what is random in the trial */
    bool standard_first = false;        /* of the task compare */
    std::optional<std::size_t> track{}; /* which chooses the condition before the trial: SessionRecord::next */
    bool is_practice() const { return block == 0; }
};

/// Stimuli are a study's cases. A participant strokes them as [paths] says, if it is given.
struct Experiment {
    ExperimentSpec spec;
    Study study;
    std::vector<Condition> conditions; /* of the task name: the study's cases as they are */
    std::vector<std::size_t> listed; /* conditions that are asked about equally often: each once, or as the file says */
    std::vector<Track> tracks;       /* empty: each condition is equally frequent */
    std::string track_key, track_unit; /* "surface.radius", "m" or "1" */

    /// Which answer names a stimulus' nominal shape; nothing if none does.
    std::optional<std::size_t> correct_answer(const Case& stimulus) const;
    /// Which answer is right, of either task; nothing if none is.
    std::optional<std::size_t> correct_answer(const Trial& trial) const;
    /// Whether the answers are the paper's four.
    bool has_papers_answers() const { return std::ranges::equal(spec.answers, kPictureNames, {}, &Answer::name); }
    const Case& stimulus(const Condition& condition) const { return study.cases[condition.stimulus]; }
    /// The listed conditions, each once, in the order of conditions.
    std::vector<std::size_t> asked() const;
    /// Whether the right answer to a case is beyond doubt.
    bool is_catch(const std::string& name) const;
    /// Trials that count; with tracks the most.
    std::size_t size() const { return (tracks.empty() ? listed.size() : tracks.size()) * spec.trials; }
};

/// Reads an experiment, or with an empty path the paper's; "-" is standard input. \throws IoError, UsageError
/// `file:line:column: ...`.
Experiment read_experiment(const std::filesystem::path& file, std::span<const Override> overrides = {});
Experiment parse_experiment(std::string_view text, const std::string& source, const std::filesystem::path& folder = {},
                            std::span<const Override> overrides = {});

/// Morgenbesser & Srinivasan 1996: 7 bumps, 3 radii, 24 trials of each, four pictures.
std::string_view paper_experiment();

/// As complete TOML: reading it gives an equal experiment.
std::string resolved_toml(const Experiment& experiment);

/// The keys of [experiment] as TOML with comments; it parses as the defaults.
std::string experiment_schema();

/// The same in the form of schema_json()'s keys.
nlohmann::ordered_json experiment_schema_json();

/// A standard comes first in half of the trials of each condition or track.
std::vector<Trial> trials_of(const Experiment& experiment, const std::string& subject, std::uint64_t session);

/// From the spec and the study. \throws UsageError without a place in the file: the standard names no case or all, or
/// a stimulus is as much like one standard as another.
void find_conditions(Experiment& experiment);

/// After the conditions. \throws UsageError `file:line:column: ...` for a row of the file that names no condition or
/// several.
void list_conditions(Experiment& experiment);

/// Keys of the study whose values differ among the stimuli that are asked about, "surface.facets".
std::vector<std::string> varying_keys_of(const Experiment& experiment);

/// A case's value of a key as text, "600 mil"; empty: it has none.
std::string value_text(const Case& one, const std::string& path);

/// Of a balanced Latin square over n: 2 n rows if n is odd. Counted from 0, on and on.
std::vector<std::size_t> latin_row(std::size_t n, std::uint64_t row);

/// After the conditions, if the spec has a track. \throws UsageError likewise: the axis is none, or no track can have
/// its levels.
void find_tracks(Experiment& experiment);

} // namespace forceshade::experiment
