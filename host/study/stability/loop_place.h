// Where a hand rests in a loop: a surface, a place beneath it, and what the force does around there.
#pragma once

#include <string>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include "host/prepare/prepared_case.h"
#include "host/study/stability/loop_linear.h"

namespace forceshade::study {

struct LoopPlace {
    std::string name;      /* "bump-shaded" */
    std::string title;     /* "bump, shaded" */
    PreparedCase prepared; /* its law has a stiffness of 1 N/m */
    HandSpec hand;         /* around which maps go */
    double rate = 1000;    /* Hz */
    double stiffness = 0;  /* N/m: the scene's own; 0: none */
    double depth = 1e-3;   /* m: how deep the probe is pressed */
    glm::dvec3 rest{};     /* m */
    bool held = false;     /* the grip's spring also holds along z */
    glm::dvec3 force{};    /* m: at rest, for each N/m of stiffness */
    glm::dmat3 slope{};    /* 1: -dF/dp there for a stiffness of 1 N/m; columns first */
    bool flat = false;     /* the plane: K_crit holds exactly */
};

/// The force at a probe, N, of a prepared case. A mesh is entered from `outside`.
glm::dvec3 force_at(const PreparedCase& prepared, const glm::dvec3& outside, const glm::dvec3& probe);

/// Fills in force and slope. `outward` points out of the surface. \throws UsageError where there is no force.
void feel_around(LoopPlace& place, const glm::dvec3& outward);

/// The loop of a hand there.
LinearLoop linear_loop(const LoopPlace& place, const HandSpec& hand, double rate);

/// How the hand rests there: {depth, m; rest: [x, y, z], m; grip, N/m; held: whether the grip's spring holds it along z
/// too}.
nlohmann::ordered_json pressed(const LoopPlace& place);

/// The study's own: plane, bump with and without shading, shaded dip, mesh with and without shading.
std::vector<LoopPlace> own_places();

/// That of the user's scene. \throws UsageError for one that no hand can be in a loop with.
LoopPlace scene_place(const PreparedCase& scene);

} // namespace forceshade::study
