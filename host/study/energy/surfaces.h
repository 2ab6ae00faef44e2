// The surfaces and laws whose energy is asked for.
#pragma once

#include "host/study/energy/loops.h"

namespace forceshade::study {

struct EnergySurface {
    std::string name;     /* "bump" */
    std::string elements; /* "facets", "cells"; empty: none */
    StrokeRegion region;
    std::vector<Stroke> strokes{}; /* the same for all laws */
    std::vector<EnergyLaw> laws{}; /* those without shading before those with */
};

/// The paper's bump of R = 1000 mil over its facets, and meshes of its cylinder over their cells.
std::vector<EnergySurface> own_energy_surfaces(bool quick);
/// A user's scene with all shadings that its surface has, its own among them. \throws UsageError where it has no room
/// for a stroke.
EnergySurface scene_energy_surface(const PreparedCase& scene);

} // namespace forceshade::study
