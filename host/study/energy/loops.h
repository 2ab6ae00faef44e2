// Surfaces and laws of the energy study, loops below them, and the work of a force round a loop.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "host/field/prepared_case.h"
#include "host/study/data/medians.h"

namespace forceshade::study {

/// A law of the energy study.
struct EnergyLaw {
    std::string surface;            /* "bump", "mesh", "scene" */
    std::string scheme;             /* "shaded", of a mesh "mean_value" */
    std::optional<double> elements; /* facets of a bump, cells of a mesh over its width */
    bool unshaded = false;
    std::shared_ptr<const PreparedCase> prepared;
};

/// A stroke out from one place to another, up or down to another depth, and back: depths are vertical, below the
/// facets.
struct Stroke {
    glm::dvec2 from{0}, to{0}; /* m: x and y */
    double out = 0, back = 0;  /* m */
};

/// The region of strokes.
struct StrokeRegion {
    glm::dvec2 low{0}, high{0}; /* m */
    double deepest = 2e-3;      /* m: the shallowest is a tenth of it */
};

struct EnergySurface {
    std::string name;     /* "bump" */
    std::string elements; /* "facets", "cells"; empty: none */
    StrokeRegion region;
    std::vector<Stroke> strokes{}; /* the same for all laws */
    std::vector<EnergyLaw> laws{}; /* those without shading before those with */
};

/// Random strokes in the region, at least a quarter of its longer side long, depths log-uniform.
std::vector<Stroke> drawn_strokes(const StrokeRegion& region, std::size_t count);

/// The places of a loop, m, the first again at the end: `steps` for each of out and back, an eighth up and down.
/// Empty if the loop leaves the surface.
std::optional<std::vector<glm::dvec3>> places_of_loop(const EnergyLaw& law, const Stroke& stroke, std::size_t steps);

/// Work of the force on the probe round a loop, J.
struct LoopWork {
    double work = 0;
    double effort = 0; /* the integral of |F dl| */
};

/// From the position alone, of a mesh the static field: between places by the mean of both forces; steps are halved at
/// jumps down to rounding error. Empty if the loop leaves contact.
std::optional<LoopWork> work_by_place(const EnergyLaw& law, const std::vector<glm::dvec3>& places);

/// Of a mesh, followed by the god-object from place to place; the second loop, when it knows its side.
std::optional<LoopWork> work_by_history(const EnergyLaw& law, const std::vector<glm::dvec3>& places);

} // namespace forceshade::study
