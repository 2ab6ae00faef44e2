// A simulated participant: a hand and a device that stroke a stimulus in closed loop, and what that gives to feel.
#pragma once

#include <vector>

#include <glm/vec2.hpp>

#include "device/loop/sample.h"
#include "host/experiment/observer.h"
#include "host/field/prepared_case.h"

namespace forceshade::experiment {

/// How a stimulus is stroked: to and fro along x, pressed down by a constant force; the hand is the scene's.
struct Manner {
    double speed = 0.1;  /* m/s */
    double press = 1;    /* N */
    double rate = 1000;  /* Hz: of the loop */
    unsigned passes = 4; /* across the feature */
};

/// As the scene's [paths] say, or 0.1 m/s, 1 N and 1 kHz.
Manner manner_of(const Scene& scene);

/// Where a stimulus' feature lies: the default region of its paths (host/paths), less its margins.
struct Feature {
    glm::dvec2 centre{0}; /* m */
    double width = 0;     /* m: along x */
};
Feature feature_of(const PreparedCase& stimulus);

/// The stimulus with the paths that this manner takes: what the simulated device of `live` follows, too.
PreparedCase stroked(PreparedCase stimulus, const Manner& manner);

/// Steps hand, device and law (in double) until all passes are done. The manner's values are positive.
std::vector<device::LiveSample> stroke(const PreparedCase& stimulus, const Manner& manner);

/// The passes across the whole feature, each in the order of x: what was felt of them, without what was flown over. A
/// pass less than half of which was in contact is none.
std::vector<StrokeSignals> passes_over(const Feature& feature, const std::vector<device::LiveSample>& samples);

/// What a simulated hand feels of a stimulus that it strokes as its scene says.
std::vector<StrokeSignals> passes_of(const PreparedCase& stimulus);

/// The mean of what these passes give to feel. \throws UsageError without any.
Cues mean_cues(const std::vector<StrokeSignals>& passes, const ObserverParameters& observer);

/// What the observer answers after these passes: the shares of their mean cues. \throws UsageError without any.
Shares answer_shares(const std::vector<StrokeSignals>& passes, const ObserverParameters& observer);

} // namespace forceshade::experiment
