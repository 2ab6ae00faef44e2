// What may be left out of a scene without changing a force: each thing switched alone, with it and without it.
#pragma once

#include <string>
#include <vector>

#include "host/mesh/block_plan.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::study {

/// A scene as it stands, each of whose features is then switched alone.
struct BaseScene {
    std::string name;  /* a word: "bump" */
    std::string about; /* for readers, a sentence's end: "a bump of three facets, ..." */
    PreparedCase prepared;
    bool field = true;  /* features of its field are switched */
    bool paths = false; /* likewise of its paths */
};

/// A bump, a height map, a mesh, and strokes over a bump; small ones for a quick study.
std::vector<BaseScene> own_scenes(bool quick);

/// The user's scene, its grid and paths thinned out to what can be measured in a while. \throws UsageError for a scene
/// with recorded paths alone.
BaseScene user_scene(const PreparedCase& prepared, bool quick);

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
