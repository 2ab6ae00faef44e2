// The study of the limits of loops and numbers: the results of its loops.
#pragma once

#include "host/study/run/study_run.h"
#include "host/study/stability/atlas.h"

namespace forceshade::study {

/// A point of direction_profile().
struct ProfilePoint {
    std::string surface;
    double x, z; /* m */
};

/// With the program's default hand: plane, bump of 2 facets with and without shading, height map of a bump and of a
/// dip, mesh with and without shading.
std::vector<LoopSurface> own_surfaces();

struct LoopResults {
    std::vector<LoopSurface> surfaces;
    std::vector<LeastLimit> limits;
    std::vector<AtlasPoint> atlas;
    std::vector<EdgeSwing> swings;
    std::vector<MapLoop> maps;
    std::vector<MapCurvePoint> curves;
    std::string map_kind; /* of the place of the map over damping */
    std::vector<ProfilePoint> profile;

    /// worst_of(limits).
    const LeastLimit* worst(const std::string& surface = {}, std::optional<double> depth = {},
                            std::optional<PlaceKind> kind = {}) const {
        return worst_of(limits, surface, depth, kind);
    }
};

/// Adds tables, figures and notes of the loops.
void add_loops(StudyData& data, const LoopResults& results);

/// Their findings: at most five.
std::vector<Finding> loop_findings(const LoopResults& results);

/// \throws what StudyRun::run throws, UsageError for a
/// scene that the study cannot use.
StudyData study_stability(StudyRun& run);

} // namespace forceshade::study
