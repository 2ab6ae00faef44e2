// What of a scene touches its surface: where nothing does, leaving things out changes nothing and saves nothing real.
#pragma once

#include <cstdint>

#include "host/engine/engine.h"
#include "host/study/omission/base_scene.h"

namespace forceshade::study {

/// Samples with a force.
struct Touched {
    std::uint64_t field = 0, paths = 0;
};

/// Of the scene's grid and of its generated paths, as far as it has these, in its precision.
Touched touched(Engine& engine, const BaseScene& base);

} // namespace forceshade::study
