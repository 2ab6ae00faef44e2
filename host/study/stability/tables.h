// What the loops of the study came to, as tables and figures.
#pragma once

#include <vector>

#include "host/study/data/study_data.h"
#include "host/study/stability/maps.h"

namespace forceshade::study {

/// A point of felt_profile().
struct ProfilePoint {
    std::string surface;
    double x, z; /* m */
};

struct LoopResults {
    std::vector<LoopSurface> surfaces;
    std::vector<LeastLimit> limits;
    std::vector<EdgeSwing> swings;
    std::vector<MapLoop> maps;
    std::vector<MapCurvePoint> curves;
    std::string map_kind; /* of the place of the map over damping */
    std::vector<ProfilePoint> profile;

    /// The row with the least limit of those with the hand's own damping, rate and delay; of all surfaces where
    /// `surface` is empty. Null if there is none.
    const LeastLimit* worst(const std::string& surface = {}, std::optional<double> depth = {}) const;
};

/// Adds tables, figures and notes of the loops.
void add_loops(StudyData& data, const LoopResults& results);

/// What they say: at most four.
std::vector<Finding> loop_findings(const LoopResults& results);

} // namespace forceshade::study
