// The study of the limits of loops and numbers: the results of its loops.
#pragma once

#include "host/limits/coupling_limits.h"
#include "host/study/run/study_run.h"
#include "host/study/stability/atlas.h"

namespace forceshade::study {

/// A point of direction_profile().
struct ProfilePoint {
    std::string surface;
    double x, z; /* m */
};

/// A virtual coupling through which the surface's own hand may feel a stiffness.
struct CouplingRow {
    std::string surface, which;   /* "own": the scene's; "safe", "stiffest" */
    double scene = 0;             /* N/m */
    HoldingCoupling coupling;     /* N/m, N s/m */
    bool rests = true;            // at all places
    std::optional<bool> foreseen; /* stepped at its weakest place: 2 % softer rests, 2 % stiffer grows */
};

/// Of 1e4, 1e5 and 1e6 N/m and the scene's own, if that is another.
std::vector<CouplingRow> couplings_on(const LoopSurface& surface, const std::vector<RestPlace>& places);

/// With the program's default hand: plane, bump of 2 facets with and without shading, height map of a bump and of a
/// dip, mesh with and without shading.
std::vector<LoopSurface> own_surfaces();

struct LoopResults {
    std::vector<LoopSurface> surfaces;
    std::vector<LeastLimit> limits;
    std::vector<AtlasPoint> atlas;
    std::vector<EdgeSwing> swings;
    std::vector<CouplingRow> couplings;
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

/// Their findings: at most six.
std::vector<Finding> loop_findings(const LoopResults& results);

/// \throws what StudyRun::run throws, UsageError for a
/// scene that the study cannot use.
StudyData study_stability(StudyRun& run);

} // namespace forceshade::study
