// The study of work round closed loops and curl.
#pragma once

#include "host/study/energy/curl.h"
#include "host/study/run/study_run.h"

namespace forceshade::study {

/// A user's scene with all shadings that its surface has, its own among them. \throws UsageError where it has no room
/// for a stroke.
EnergySurface scene_energy_surface(const PreparedCase& scene);

/// A loop of a law.
struct LoopRow {
    const EnergyLaw* law = nullptr;
    bool history = false;   /* of a mesh: followed by the god-object */
    std::size_t number = 0; /* of the stroke: the same for all laws of a surface */
    double gain = 0;        /* J: to the hand, in the worse direction of travel */
    double effort = 0;      /* J */
};

/// The loops of a law, by the static field or by the god-object.
struct LawRow {
    const EnergyLaw* law = nullptr;
    bool history = false;
    std::size_t loops = 0;
    Interval gain;                /* J: median */
    double low = 0, high = 0;     /* J: 5 and 95 % of the loops' gains */
    double effort = 0;            /* J: median */
    std::optional<Interval> more; /* J: median of the gain less that of the same surface unshaded, on the same loop */
};

std::vector<LawRow> summarise_by_law(const std::vector<LoopRow>& loops);

struct EnergyResults {
    std::vector<EnergySurface> surfaces;
    std::vector<LoopRow> loops;
    std::vector<LawRow> laws;
    std::vector<CurlCell> curl;
};

/// Adds tables, figures, notes and findings: at most four.
void add_energy(StudyData& data, const EnergyResults& results);

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_energy(StudyRun& run);

} // namespace forceshade::study
