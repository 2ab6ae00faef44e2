// What may be left out of a scene without changing a force: each thing switched alone, with it and without it.
#pragma once

#include <string>
#include <vector>

#include "host/mesh/block_plan.h"
#include "host/study/omission/base_scene.h"

namespace forceshade::study {

/// One side of a comparison.
struct Setup {
    PreparedCase prepared;
    std::string what;                    /* "all 32 y samples": for readers */
    Extent extent = Extent::what_varies; /* of a field */
    FreeSpace free = FreeSpace::skipped; /* of a mesh's field */
    bool samples = true;                 /* of paths: written, not metrics alone */
};

/// What must be the same on both sides.
enum class Same {
    bits,    /* the forces, bit for bit */
    values,  /* the forces as numbers: zeros may differ in sign */
    metrics, /* what each path adds up to, bit for bit: one side writes no forces */
};

/// The feature of a comparison whose sides are alike.
inline constexpr const char* kControl = "nothing";

struct Comparison {
    std::string feature; /* "facet channel", unique in its scene */
    std::string scene;   /* of BaseScene */
    Setup with, without;
    Same same = Same::bits;
    std::uint32_t channels = 0; /* layout::kChannel... bits that must be the same bit for bit beside the force */
    std::string omitted;        /* as the manifest calls it; empty: it does not tell of this */
    bool always = false;        /* the program always leaves it out, and no scene can ask for it */
    bool paths = false;
};

/// True if the manifest tells of this omission where it is left out, and (unless it always is) only there.
bool agrees_with_manifest(const Comparison& comparison);

/// Everything that this scene can do without. `gpu`: also what only a Vulkan device does.
std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu);

} // namespace forceshade::study
