// The study of work round closed loops and of curl: its surfaces and laws, loops below them, the work of a force round
// a loop, and the curl of a field in a section.
#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "host/study/study_run.h"

namespace forceshade::study {

/// A law of the energy study.
struct EnergyLaw {
    std::string surface;            /* "bump", "mesh", "scene" */
    std::string scheme;             /* "shaded", of a mesh "mean_value" */
    std::optional<double> elements; /* facets of a bump, cells of a mesh over its width */
    bool unshaded = false;
    std::shared_ptr<const PreparedCase> prepared;
    std::vector<std::shared_ptr<const PreparedCase>> drawn{}; /* on meshes tessellated anew; empty: on `prepared` */

    /// The law on the mesh of one stroke: the drawn meshes take turns.
    EnergyLaw of_stroke(std::size_t number) const {
        return {surface, scheme, elements, unshaded, drawn.empty() ? prepared : drawn[number % drawn.size()]};
    }
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

    void add(double step) {
        work += step;
        effort += std::abs(step);
    }
};

/// From the position alone, of a mesh the static field: by Simpson's rule between places; steps are halved at jumps
/// down to rounding error. Empty if the loop leaves contact.
std::optional<LoopWork> work_by_place(const EnergyLaw& law, const std::vector<glm::dvec3>& places);

/// A loop as a path, m: from above the surface down to its begin, then twice round; the second round has as many steps
/// as the loop.
std::vector<glm::dvec3> path_of_loop(const EnergyLaw& law, const std::vector<glm::dvec3>& places);

/// Of the last `steps` steps of a path, by the mean of both ends' forces, N.
LoopWork work_of_last(const std::vector<glm::dvec3>& path, const std::vector<glm::dvec3>& forces, std::size_t steps);

/// Of a law that is followed along path_of_loop, a mesh's by its god-object; the second round, when it knows its side.
std::optional<LoopWork> work_by_history(const EnergyLaw& law, const std::vector<glm::dvec3>& places);

/// A field over a section of x and z at one y, in contact where depth is above 0.
struct SectionField {
    std::vector<double> x, z;  /* m */
    std::vector<double> force; /* N: 3 a sample, x fastest, then z */
    std::vector<double> depth; /* m */

    std::size_t at(std::size_t i, std::size_t k) const { return k * x.size() + i; }
};

/// curl_y F = dF_x/dz - dF_z/dx, N/m, of each cell between four samples, x fastest: the work round it, by the mean of
/// two samples' forces along each side, over its area; NaN where a corner is out of contact. So the work round several
/// cells is their sum, also where forces jump along slanted lines.
std::vector<double> cell_curls(const SectionField& field);

/// A cell of a section of curl.
struct CurlCell {
    std::string section;       /* "bump of 8 facets, shaded" */
    double x, z;               /* m: its middle */
    double curl_per_stiffness; /* 1 */
};

/// Curl of a law over the middle of a region, `columns` cells wide, each the mean over 8 x 8 cells of samples; the
/// force of every eighth sample goes to NAME.exr, whose record is added to `volumes`.
std::vector<CurlCell> curl_map(Engine& engine, const EnergyLaw& law, const StrokeRegion& region, std::uint64_t columns,
                               const std::filesystem::path& folder, std::vector<FileRecord>& volumes);

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

/// A renderer of the user's own on the loops of a scene, or the scene's own law, without and with its friction and
/// vibration: each loop is walked as path_of_loop.
struct RendererLoops {
    struct Loop {
        std::size_t number = 0; /* of the stroke */
        double gain = 0;        /* J: to the hand, in the worse direction of travel */
        double effort = 0;      /* J */
        double speed = 0;       /* m/s: mean */
        double rule = NAN;      /* J: by which the gain changes with half the steps; of the scene's own law */
    };
    std::string name;          /* "mine:fast"; of the scene's own law "own law", "own law with friction" */
    std::vector<Loop> loops{}; /* in which the scene's own law stays in contact */
    std::string status = "ok"; /* else what the renderer did wrong */
};

/// A part that finds the loops of the scene's own law on some strokes, then a part that walks them for each of
/// run.rubbing() and each renderer; `found` must outlive them, and has the law's first.
std::vector<Part> renderer_parts(const StudyRun& run, const EnergySurface& surface, std::size_t strokes,
                                 std::size_t steps, std::vector<RendererLoops>& found);

/// Adds tables, a figure, a note and a finding for each but the law alone; nothing without one.
void add_renderers(StudyData& data, const std::vector<RendererLoops>& found);

/// "0.10 mJ"; rounding errors, a millionth of an effort in J, as a bound.
std::string milli(double joules, double effort = 1e-3);

struct EnergyResults {
    std::vector<EnergySurface> surfaces;
    std::vector<LoopRow> loops;
    std::vector<LawRow> laws;
    std::vector<CurlCell> curl;
    std::vector<RendererLoops> renderers;
};

/// Adds tables, figures, notes and findings: at most four, and one a renderer.
void add_energy(StudyData& data, const EnergyResults& results);

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_energy(StudyRun& run);

} // namespace forceshade::study
