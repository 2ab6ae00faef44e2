// Features switched on and off alone: what is evaluated with and without one, and what must be the same.
#pragma once

#include <string>
#include <vector>

#include "host/mesh/block_plan.h"
#include "host/study/omission/base_scene.h"

namespace forceshade::study {

/// One side of a comparison.
struct Setup {
    PreparedCase prepared;
    std::string what;                    /* "reference", "all 32 y samples": for readers */
    Extent extent = Extent::what_varies; /* of a field */
    FreeSpace free = FreeSpace::skipped; /* of a mesh's field */
    bool samples = true;                 /* of paths: written, not metrics alone */
};

/// How the forces of both sides must agree.
enum class Agreement {
    bits,      /* bit for bit */
    values,    /* equal numbers: zeros may differ in sign */
    magnitude, /* |F| to rounding: only the direction is the feature's */
    along_z,   /* F_z bit for bit: the feature is tangential */
    contact,   /* zero or not, sample by sample */
    none,      /* what paths add up to is compared in its place, bit for bit */
    nothing,   /* nor that: both sides are other laws, see Comparison::why_nothing */
};

/// The feature of a comparison whose sides are alike.
inline constexpr const char* kControl = "nothing";

struct Comparison {
    std::string feature; /* "shading", unique in its scene */
    std::string scene;   /* of BaseScene */
    Setup with, without; /* the feature, or the work that an omission saves */
    Agreement force = Agreement::bits;
    const char* why_nothing = "";   /* is compared, for readers */
    std::uint32_t channels = 0;     /* layout::kChannel... bits that must be the same bit for bit beside the force */
    bool unshaded_is_force = false; /* the channel `unshaded` with the feature is the force without it */
    std::string omitted;            /* as the manifest calls it; empty: it does not tell of this */
    bool forced = false;            /* the scene is the same: only a study does the work that is always left out */
    bool paths = false;
};

/// What the manifest says is left out of a setup.
std::vector<std::string> omitted_by(const Setup& setup);

/// Whether the forces are the same numbers on both sides, so that the one without may stand for the one with.
bool same_forces(const Comparison& comparison);

/// True if the manifest tells of this omission where it is left out, and (unless forced) only there.
bool agrees_with_manifest(const Comparison& comparison);

/// Every feature that this scene can have, switched alone. `gpu`: also those of a Vulkan device.
std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu);

} // namespace forceshade::study
