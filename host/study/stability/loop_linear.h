// A sampled loop near its place of rest, as a linear map: what stability is expected of any surface, without the
// engine.
#pragma once

#include <optional>

#include <glm/mat3x3.hpp>

#include "host/paths/scene_paths.h"

namespace forceshade::study {

struct LinearLoop {
    Axis lateral, vertical; /* hand and device along x and y, and along z */
    double period = 1e-3;   /* s */
    int delay = 0;          /* samples from measurement to force */
    glm::dmat3 slope{};     /* 1: -dF/dp for a stiffness of 1 N/m */
};

/// The logarithm of the factor by which its slowest mode grows in a sample.
double growth_of(const LinearLoop& loop, double stiffness);

/// The least stiffness, N/m, above `low` at which a mode grows, to 1e-7 of it; nothing where none does up to `high`,
/// 0 where one does already at `low`.
std::optional<double> linear_limit(const LinearLoop& loop, double low, double high);

} // namespace forceshade::study
