// An experiment: which stimuli, how often and in which order, what is asked, and which answers there are.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/experiment/observer.h"
#include "host/scene/study.h"

namespace forceshade::experiment {

/// Over a whole session, or so that each block has every condition equally often.
enum class Order { random, balanced };

/// An answer, in the order of its key: 1 for the first.
struct Answer {
    std::string name;               /* of [a-z0-9_], as data has it: "two_poly" */
    std::string label;              /* as a participant reads it */
    std::optional<unsigned> facets; /* of the nominal shape that its picture shows; 0: the smooth shape */
    std::string correct_for;        /* shell pattern of case names; empty: stimuli of these facets */
};

struct ExperimentSpec {
    std::string title = "Shapes that are felt";
    std::string question = "Which shape did you feel?";
    std::vector<Answer> answers;
    std::uint64_t trials = 24;  /* of each condition */
    std::uint64_t practice = 0; /* trials before, of conditions in turn; they do not count */
    std::uint64_t blocks = 1;   /* with a break between */
    Order order = Order::random;
    bool feedback = false;
    double longest_trial = 60; /* s */
    std::uint64_t seed = 1996;
};

/// Stimuli are a study's cases. A participant strokes them as [paths] says, if it is given.
struct Experiment {
    ExperimentSpec spec;
    Study study;

    /// Which answer names a stimulus' nominal shape; nothing if none does.
    std::optional<std::size_t> correct_answer(const Case& stimulus) const;
    std::size_t size() const { return study.cases.size() * spec.trials; } /* trials that count */
};

/// Reads an experiment, or with an empty path the paper's. \throws IoError, UsageError `file:line:column: ...`.
Experiment read_experiment(const std::filesystem::path& file, std::span<const Override> overrides = {});
Experiment parse_experiment(std::string_view text, const std::string& source, const std::filesystem::path& folder = {},
                            std::span<const Override> overrides = {});

/// Morgenbesser & Srinivasan 1996: 7 bumps, 3 radii, 24 trials of each, four pictures.
std::string_view paper_experiment();

/// As complete TOML: reading it gives an equal experiment.
std::string resolved_toml(const Experiment& experiment);

/// The keys of [experiment] as TOML with comments; it parses as the defaults.
std::string experiment_schema();

} // namespace forceshade::experiment
