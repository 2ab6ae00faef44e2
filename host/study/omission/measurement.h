// A comparison measured: both sides in turn, again and again, and what they gave held against each other.
#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/engine/engine.h"
#include "host/study/omission/comparison.h"

namespace forceshade::study {

struct Rounds {
    unsigned count = 0;     /* most; each evaluates both sides in turn, in shuffled order, and takes the least times */
    double seconds = 0;     /* about what a round is given; it evaluates at least once */
    double budget = 0;      /* s: for all rounds; there are five at least */
    std::uint64_t seed = 0; /* of the order */
};

/// The step's result: {"with": side, "without": side, "compared", "in_contact", "differing", "largest"}, a side being
/// {"kernel_s": [one a round], "whole_s": [likewise], "uploaded", "received", "evaluated", "samples", "file"}.
/// A volume is written in `folder` for its size, and removed.
nlohmann::ordered_json measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                               const std::filesystem::path& folder);

} // namespace forceshade::study
