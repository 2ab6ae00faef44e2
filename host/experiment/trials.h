// The trials of a session, in an order that follows from the experiment's seed, the subject and the session alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/experiment/experiment.h"

namespace forceshade::experiment {

struct Trial {
    std::uint64_t number = 0;           /* 1: the first of the session, practice included */
    std::uint64_t block = 0;            /* 1: the first; 0: practice */
    std::size_t condition = 0;          /* index of Experiment::conditions */
    std::uint64_t seed = 0;             /* of what is random in the trial */
    bool standard_first = false;        /* of the task compare */
    std::optional<std::size_t> track{}; /* which chooses the condition before the trial: SessionRecord::next */
    bool is_practice() const { return block == 0; }
};

/// A standard comes first in half of the trials of each condition or track.
std::vector<Trial> trials_of(const Experiment& experiment, const std::string& subject, std::uint64_t session);

} // namespace forceshade::experiment
