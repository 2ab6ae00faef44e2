// A case made ready to evaluate: its mesh read and put in its place, its images, and every table that a law reads.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/structure.h"
#include "host/scene/scene.h"
#include "host/scene/study.h"
#include "shaders/shared/law.h"

namespace forceshade {

struct HeightImage;
struct VibrationModels;
struct PolygonFile;

/// How far from its centre a mesh's law is evaluated, in units of its frame: further out the mesh is a point, and which
/// facet is the nearest is a matter of rounding.
template <typename T> inline constexpr double kMeshReach = std::is_same_v<T, float> ? 0x1p20 : 0x1p48;

struct SceneMesh {
    std::string sha256, format; /* of the file's bytes; "OBJ", "PLY (text)" */
    Mesh mesh;                  /* m, in the scene's frame */
    MeshStructure structure;
    MeshFindings findings;
    InsideTest inside = InsideTest::pseudonormal; /* as the spec has it, or what suits the mesh */
    std::vector<MeshFault> changes;               /* parts of the file that were skipped, facets that orient turned */
    std::size_t file_triangles = 0;               /* as require_mesh_memory() was asked for them */
};

/// Polygons in the scene's frame, m, as they are placed. `winding`: with the tree's winding numbers.
std::shared_ptr<SceneMesh> made_mesh(PolygonSoup polygons, bool winding = false, const MeshPlacement& placement = {});

/// A file that a scene names and that is there. \throws IoError `bump.toml:14:8: cannot read ...; did you mean ...?`
void require_file(const FileSpec& spec);

/// \throws UsageError if the memory that a mesh of this many triangles needs, 1100 B each, is more than is allowed
void require_mesh_memory(const std::filesystem::path& file, std::size_t triangles);

/// Skipped parts of the file, and the findings that leave the computation meaningful, a sentence each, after
/// the file's name.
std::vector<std::string> warnings_of(const MeshSpec& spec, const SceneMesh& mesh, MeshUse use);

/// The grid of `samples` along the longest side of the mesh's bounding box and 5 %, about its centre, with as many
/// samples along the other sides as cover the box and as much beyond it.
GridSpec fitted_grid(std::uint64_t samples, const Mesh& mesh);

// A scene as the laws read it: facets of a bump (G2), gradients of a height map (G3), the arrays of a mesh, in T.

/// The n + 1 x coordinates, m, of the vertices of an n-facet bump, from -a to a exactly, symmetric, not decreasing.
/// Computed in double and rounded once to T. `half_width` is a, `radius` R >= a, both in m.
template <typename T>
std::vector<T> facet_vertices(std::uint32_t facets, double half_width, double radius, FacetSpacing spacing);

/// The steepest gradient: its square is a normal number of T. The scene's check has the same limit for analytic maps.
template <typename T> inline constexpr double kSteepestGradient = sizeof(T) == 4 ? kSteepestF32 : kSteepestF64;

/// (dU/dx, dU/dy) pairs of a grid of samples that spans size_x by size_y metres between its outermost nodes. `samples`
/// are of 1 = `height` metres, rows * columns, row 0 at the largest y (image order); the result has row 0 at the
/// smallest y. Central differences, one-sided at the border; 0 along an axis of a single sample. Computed in double and
/// rounded once to T. \throws UsageError that names `file`, row and column of the image if a gradient is steeper than
/// kSteepestGradient<T> or no number.
template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height, const std::string& file);

// Every table that a law reads, rounded once from double to the run's precision.

/// What the files that a scene names hold; null where it names none.
struct SceneImages {
    std::shared_ptr<const HeightImage> map, texture;
    std::shared_ptr<const SceneMesh> mesh;
    std::shared_ptr<const VibrationModels> vibration{};
};

/// Owns the data of a layout::FieldInput.
template <typename T> struct FieldTables {
    layout::Features features;
    layout::LawParams<T> params{};
    std::vector<T> facet_vertices, map_gradients, texture_gradients;
    std::shared_ptr<const MeshTables<T>> mesh;
    std::vector<T> x, y, z; /* m; of a mesh in its own frame */

    layout::Law<T> law() const {
        layout::Law<T> law{features, params, facet_vertices, map_gradients, texture_gradients};
        if (mesh)
            law.mesh = mesh->view();
        return law;
    }
    layout::FieldInput<T> input() const { return {law(), x, y, z}; }
};

/// `what` of a scene as a T. \throws UsageError if that is beyond T's range.
template <typename T> T rounded(double value, const char* what) {
    const T result = static_cast<T>(value);
    if (!std::isfinite(result))
        throw UsageError("{} = {} is beyond {} precision{}", what, value,
                         std::is_same_v<T, float> ? "single" : "double",
                         std::is_same_v<T, float> ? ": use precision f64" : "");
    return result;
}

/// How much of a grid is evaluated.
enum class Extent {
    nothing,     /* the law alone */
    what_varies, /* one y where the force does not depend on it */
    everything,
};

/// \throws UsageError if a value leaves the range of T, or an image rises too steeply for it.
template <typename T> FieldTables<T> make_tables(const Scene& scene, const SceneImages& images, Extent extent);

/// Makes the updates of god-objects on the tables' mesh faster (MeshObstacles). Takes as long as several updates a
/// triangle; laws made before do not see it.
template <typename T> void find_obstacles(FieldTables<T>& tables);

/// The features of a scene (layout::Features).
layout::Features features_of(const Scene& scene);

/// True if any channel depends on y, so that a grid must be evaluated at every y.
bool depends_on_y(const layout::Features& features);
bool depends_on_y(const Scene& scene); /* also for GridSpec::every_y */

/// The features left out of the kernel and why, one short phrase each, for the manifest and the volume's attributes.
std::vector<std::string> omissions(const Scene& scene);

// A case with the images that it names: everything its evaluation needs.

struct PreparedCase {
    Case one; // with the files' SHA-256 filled in, and the grid that follows from a mesh
    SceneImages images;
    std::shared_ptr<const SceneMesh> compared_mesh; // of [compare]; null: it has none
    std::string scene;                              /* resolved TOML, as it goes into files */
    std::vector<std::string> warnings;              /* of the mesh's file and the grid, for a static field */
    double seconds = 0;                             /* that this took: files that cases share are read once */
};

/// \throws UsageError if a file's SHA-256 is another than the one that the scene states; it may state none.
void check_digest(const std::string& file, const std::string& stated, const std::string& found);

/// Where the case's places are measured from, m, in the world: those of its paths, of proxies and of god-objects,
/// before they are rounded. origin_of() its mesh; without one the world's own origin.
glm::dvec3 scene_origin(const PreparedCase& prepared);

/// A place from such an origin, m, in the world. For an origin of 0 the same bits: a zero keeps its sign.
inline glm::dvec3 world_place(const glm::dvec3& place, const glm::dvec3& origin) {
    return place - (glm::dvec3(0) - origin);
}

/// A warning that names f64, where single precision rounds coordinates of up to `farthest`, m, to more than a hundredth
/// of `length`, m, which is `what`; empty in double precision, or for no length.
std::optional<std::string> coarse_warning(Precision precision, double farthest, const std::string& what, double length);

/// 1: Coulomb's coefficient of a scene with friction, whose vibration file may give it.
double friction_coefficient(const PreparedCase& prepared);

/// Why a case that leaves its precision open should take double: in words, for a mesh with parts too thin for single,
/// which leave a proxy no room; else empty.
std::string too_thin_for_single(const PreparedCase& prepared);

/// Reads images, meshes and models of vibration; cases that follow each other share them, and only the last few stay in
/// memory.
class CasePreparation {
public:
    /// \param given stands for the file of the scene's mesh
    /// \throws IoError for a file that is missing or damaged, UsageError for one that is not a height map or mesh, or
    /// not the one whose SHA-256 the scene states.
    PreparedCase prepare(const Case& one, const PolygonFile* given = nullptr);

    /// As prepare(); where the case leaves its precision open and the mesh has parts too thin for single, in double,
    /// and `note` says why.
    PreparedCase prepare_open(Case one, std::string& note, const PolygonFile* given = nullptr);

    /// Waits for a mesh that is being kept for later runs (mesh_cache.h) to be written, as the destructor does.
    void wait() {
        if (keeping_.valid())
            keeping_.wait();
    }

    /// The mesh alone; fills in its file's SHA-256. \throws as above
    std::shared_ptr<const SceneMesh> mesh(MeshSpec& spec, const PolygonFile* given = nullptr);

private:
    std::shared_ptr<const HeightImage> image(HeightMapSpec& map);
    std::shared_ptr<const SceneMesh> compared_mesh(Scene& scene);
    std::shared_ptr<const VibrationModels> vibration(VibrationSpec& spec);
    std::deque<std::pair<MeshSpec, std::shared_ptr<const SceneMesh>>> meshes_;      // the newest first
    std::deque<std::pair<std::string, std::shared_ptr<const HeightImage>>> images_; // path and image, the newest first
    std::deque<std::pair<std::string, std::shared_ptr<const VibrationModels>>> vibrations_; // by SHA-256
    std::map<std::string, MeshFindings> findings_;                                          // by the file's SHA-256
    std::future<void> keeping_;                                                             // of the newest mesh
};

/// Squares of lengths up to this, m, stay numbers of T: the most that scenes may have, too.
template <typename T> constexpr double kLargestLength = std::is_same_v<T, float> ? 1e15 : 1e150;

/// The largest coordinate of a probe in the world, m: squares of lengths stay numbers of T, and a mesh can still be
/// distinguished from a point.
template <typename T> double largest_coordinate(const PreparedCase& prepared);

} // namespace forceshade
