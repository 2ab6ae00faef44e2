// What the observer expects people to answer to any list of scenes, and how many facets feel round.
#pragma once

#include <optional>
#include <vector>

#include "host/experiment/observer.h"
#include "host/scene/study.h"
#include "host/study/run/study_run.h"

namespace forceshade::experiment {

/// Percentage points: half the sum of the differences of two distributions of answers.
double apart(const Shares& one, const Shares& other);

/// The fewest facets from which on a bump's answers stay within `points` of its cylinder's, in the limit of a rigid
/// surface; nothing if 128 are too few.
std::optional<unsigned> facets_within(double points, double radius, double width, bool shaded,
                                      const ObserverParameters& observer = {});

/// The study "perception": of the user's cases, or the paper's and those of more facets. A case that is stroked without
/// a whole pass (it is no bump) is left out, and told of.
study::StudyData study_perception(study::StudyRun& run);

} // namespace forceshade::experiment
