// Closed loops as paths: work as an engine, or the oracle, adds it up from sample to sample. On a mesh this is the
// god-object's.
#pragma once

#include <vector>

#include "host/engine/engine.h"
#include "host/prepare/prepared_case.h"
#include "host/study/energy/loop_work.h"

namespace forceshade::study {

/// Places of a probe, m; the first is the last.
using LoopPlaces = std::vector<Vector>;

/// The loop of work_round below a section, `steps` equal steps of x for each leg and a sixteenth of them up and down.
/// At a break, both sides of it are places.
LoopPlaces loop_places(const Section& section, double out, double back, int steps);

struct PathWork {
    Work work;
    unsigned unfinished = 0; /* samples at which a proxy did not come to rest */
};

/// The work round each loop by the mean of two samples' forces times the way between them, in double precision where
/// the engine has it. Loops have as many places as each other. \throws what Engine::explore throws.
std::vector<PathWork> engine_work(Engine& engine, const PreparedCase& prepared, const std::vector<LoopPlaces>& loops);

/// The same by the CPU oracle in double precision.
std::vector<PathWork> oracle_work(const PreparedCase& prepared, const std::vector<LoopPlaces>& loops);

} // namespace forceshade::study
