// What loops gave, as tables, figures and findings.
#pragma once

#include "host/study/energy/curl.h"
#include "host/study/energy/surfaces.h"
#include "host/study/run/study_run.h"

namespace forceshade::study {

/// A loop of a law.
struct LoopRow {
    const EnergyLaw* law = nullptr;
    bool history = false;   /* of a mesh: followed by the god-object */
    std::size_t number = 0; /* of the stroke: the same for all laws of a surface */
    double gain = 0;        /* J: to the hand, by the way round that gives more */
    double effort = 0;      /* J */
};

/// The loops of a law, one way of feeling it.
struct LawRow {
    const EnergyLaw* law = nullptr;
    bool history = false;
    std::size_t loops = 0;
    Interval gain;                /* J: median */
    double low = 0, high = 0;     /* J: 5 and 95 % of the loops' gains */
    double effort = 0;            /* J: median */
    std::optional<Interval> more; /* J: median of the gain less that of the same surface unshaded, on the same loop */
};

std::vector<LawRow> summed_up(const std::vector<LoopRow>& loops);

struct EnergyResults {
    std::vector<EnergySurface> surfaces;
    std::vector<LoopRow> loops;
    std::vector<LawRow> laws;
    std::vector<CurlCell> curl;
};

/// Adds tables, figures, notes and findings: at most four.
void add_energy(StudyData& data, const EnergyResults& results);

} // namespace forceshade::study
