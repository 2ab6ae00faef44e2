// A simulated participant: a hand and a device that stroke a stimulus in closed loop, and what that gives to feel.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "host/experiment/observer.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::experiment {

/// How a stimulus is stroked: to and fro along x, pressed down by a constant force; the hand is the scene's.
struct Manner {
    double speed = 0.1;      /* m/s */
    double press = 1;        /* N */
    double rate = 1000;      /* Hz: of the loop */
    unsigned passes = 4;     /* across the feature */
    std::uint64_t still = 0; /* samples before the hand begins to move */
};

/// Where a stimulus' feature lies: the default region of its paths (host/paths), less its margins.
struct Feature {
    glm::dvec2 centre{0}; /* m */
    double width = 0;     /* m: along x */
};
Feature feature_of(const PreparedCase& stimulus);

/// What moved and what was felt, a sample each period.
struct StrokeSample {
    glm::dvec3 probe{0};     /* m */
    glm::dvec3 force{0};     /* N */
    double depth = 0;        /* m */
    std::uint32_t facet = 0; /* layout::kNoFacet out of contact */
};

/// The stimulus with the paths that this manner takes: what the simulated device of `live` follows, too.
PreparedCase stroked(PreparedCase stimulus, const Manner& manner);

/// Steps hand, device and law (in double) until all passes are done. The manner's values are positive.
std::vector<StrokeSample> stroke(const PreparedCase& stimulus, const Manner& manner);

/// The passes across the whole feature, each in the order of x: what was felt of them, without what was flown over. A
/// pass less than half of which was in contact is none.
std::vector<StrokeSignals> passes_over(const Feature& feature, const std::vector<StrokeSample>& samples);

/// What the observer answers after these passes: the shares of their mean cues. \throws UsageError without any.
Shares answer_shares(const std::vector<StrokeSignals>& passes, const ObserverParameters& observer);

} // namespace forceshade::experiment
