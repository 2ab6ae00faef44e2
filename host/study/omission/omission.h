// The study of omissions that do not change a force: each feature switched alone, both sides measured in turn,
// repeatedly, and their results compared.
#pragma once

#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/mesh/block_plan.h"
#include "host/study/study_run.h"

namespace forceshade::study {

/// The mesh of a scene in other orientations; empty for another surface, and for a mesh that takes long to prepare.
using Turned = std::vector<std::shared_ptr<const SceneMesh>>;

/// A scene as it stands, each of whose features is then switched alone.
struct BaseScene {
    std::string name;  /* a word: "bump" */
    std::string about; /* for readers, a sentence's end: "a bump of three facets, ..." */
    PreparedCase prepared;
    bool field = true;  /* features of its field are switched */
    bool paths = false; /* the same for its paths */
    Turned turned{};
};

/// A bump, a height map, a mesh, and strokes over a bump; small ones for a quick study.
std::vector<BaseScene> own_scenes(bool quick);

/// The user's scene, its grid and paths thinned out to bound the measuring time. \throws UsageError for a scene
/// with recorded paths alone.
BaseScene user_scene(const PreparedCase& prepared, bool quick);

/// One side of a comparison.
struct Setup {
    PreparedCase prepared;
    std::string what;                    /* "all 32 y samples": for readers */
    Extent extent = Extent::what_varies; /* of a field */
    FreeSpace free = FreeSpace::skipped; /* of a mesh's field */
    bool samples = true;                 /* of paths: written, not metrics alone */
    Turned turned{};                     /* of a mesh: in turn, a round each */
};

/// Results that must be the same on both sides.
enum class Same {
    bits,    /* the forces, bit for bit */
    values,  /* the forces as numbers: zeros may differ in sign */
    metrics, /* the metrics of each path, bit for bit: one side writes no forces */
};

/// The feature of a comparison whose sides are alike.
inline constexpr const char* kControl = "nothing";

struct Comparison {
    std::string feature; /* "facet channel", unique in its scene */
    std::string scene;   /* of BaseScene */
    Setup with, without;
    Same same = Same::bits;
    std::uint32_t channels = 0; /* layout::kChannel... bits that must be the same bit for bit besides the force */
    std::string omitted;        /* its name in the manifest; empty: not listed there */
    bool always = false;        /* the program always leaves it out, and no scene can request it */
    bool paths = false;
};

/// True if the manifest lists this omission if and (unless it is always left out) only if it is left out.
bool agrees_with_manifest(const Comparison& comparison);

/// All omissions that this scene permits. `gpu`: also those of Vulkan devices only.
std::vector<Comparison> comparisons_of(const BaseScene& base, bool gpu);

struct Cost {
    double kernel = 0;           /* s: on the device; of the CPU oracle all of it */
    double whole = 0;            /* s: planning, tables, kernel and reading back, by the clock */
    std::uint64_t uploaded = 0;  /* bytes: tables, plans, positions */
    std::uint64_t received = 0;  /* bytes of results */
    std::uint64_t evaluated = 0; /* samples */
};

/// All samples of a grid, by z, then y, then x; or of paths, by path, then step. Channels that were not requested are
/// empty. If one y stood for all, it does so here too.
template <typename T> struct Captured : Field<T> {
    std::vector<T> position;
    std::vector<layout::PathMetrics<T>> metrics; /* of paths */
};

/// One side of a comparison, evaluated once: with more channels than the setup has.
template <typename T> Captured<T> capture(Engine& engine, const Setup& setup, bool paths, std::uint32_t channels);

struct Rounds {
    unsigned count = 0; /* most; each evaluates both sides in turn, on a grid moved at random or with paths drawn anew,
                           and takes the least times */
    double seconds = 0; /* target time of a round; it evaluates at least once */
    double budget = 0;  /* s: for all rounds; at least five */
};

struct MeasuredSide {
    std::vector<double> kernel, whole; /* s: a round each, the least of its evaluations */
    Cost cost;                         /* of the last */
    std::size_t samples = 0;           /* of the grid, or of all paths */
    std::uint64_t file = 0;            /* bytes of the volume that a sweep would write; of paths 0 */
};

/// Comparison of both sides' results, sample by sample.
struct Agreement {
    std::uint64_t compared = 0, in_contact = 0, differing = 0; /* samples; of paths that write none: paths */

    Agreement& operator+=(const Agreement& other) {
        compared += other.compared;
        in_contact += other.in_contact;
        differing += other.differing;
        return *this;
    }
};

template <typename T>
Agreement compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without);

struct Measurement {
    Comparison comparison;
    MeasuredSide with, without;
    Agreement agreement;

    /// Time with it over the time without it, in the same rounds.
    Interval kernel_ratio() const;
    Interval whole_ratio() const;
    /// Whether every force was the same on both sides.
    bool same_forces() const {
        return comparison.same != Same::metrics && agreement.compared > 0 && agreement.differing == 0;
    }
};

/// A volume is written in `folder` for its size, and removed.
Measurement measure(Engine& engine, const Comparison& comparison, const Rounds& rounds,
                    const std::filesystem::path& folder);

/// Samples with a force of the scene's grid, and of its paths. Without contact an omission cannot change a force or
/// save real work.
struct Touched {
    std::uint64_t field = 0, paths = 0;
};
Touched touched(Engine& engine, const BaseScene& base);

/// Adds tables, figures and findings.
void add_omissions(StudyData& data, const std::vector<BaseScene>& scenes, const std::vector<Measurement>& rows);

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_omission(StudyRun& run);

} // namespace forceshade::study
