// A scene's mesh, read, put in its place and ready for every precision.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/structure.h"
#include "host/prepare/tables.h"
#include "host/scene/scene.h"
#include "host/scene/study.h"

namespace forceshade {

/// How far from its centre a mesh's law is evaluated, in units of its frame: further out the mesh is a point, and which
/// facet is the nearest is a matter of rounding.
template <typename T> inline constexpr double kMeshReach = std::is_same_v<T, float> ? 0x1p20 : 0x1p48;

struct SceneMesh {
    std::string sha256; /* of the file's bytes */
    Mesh mesh;          /* m, in the scene's frame */
    MeshStructure structure;
    MeshFindings findings;
};

struct MeshBox {
    std::array<double, 3> low, high; /* m */
};

/// Of the vertices that some facet uses.
MeshBox bounding_box(const PolygonSoup& polygons);

/// Reads the file that the spec names. \throws IoError, UsageError for a file in which the law has no meaning.
std::shared_ptr<const SceneMesh> read_scene_mesh(const MeshSpec& spec);

/// The findings with which what is done still has a meaning, a sentence each, after the file's name.
std::vector<std::string> warnings_of(const MeshSpec& spec, const SceneMesh& mesh, MeshUse use);

/// \throws UsageError if the scene asks for what the mesh has not: barycentric shading of facets that are no triangles.
void check_mesh_fits(const Scene& scene, const SceneMesh& mesh);

/// The grid of `samples` along the longest side of the mesh's bounding box and 5 %, about its centre, with as many
/// samples along the other sides as cover the box and as much beyond it.
GridSpec fitted_grid(std::uint64_t samples, const Mesh& mesh);

// A case with the images that it names: everything its evaluation needs.

struct PreparedCase {
    Case one; // with the files' SHA-256 filled in, and the grid that follows from a mesh
    SceneImages images;
    std::string scene;                 /* resolved TOML, as it goes into files */
    std::vector<std::string> warnings; /* of the mesh's file, for a static field */
};

/// Reads images and meshes; cases that follow each other share them, and only the last few stay in memory.
class CasePreparation {
public:
    /// \throws IoError for a file that is missing or damaged, UsageError for one that is no height map or mesh, or not
    /// the one whose SHA-256 the scene states.
    PreparedCase prepare(const Case& one);

private:
    std::shared_ptr<const HeightImage> image(HeightMapSpec& map);
    std::shared_ptr<const SceneMesh> mesh(MeshSpec& spec);
    std::deque<std::pair<MeshSpec, std::shared_ptr<const SceneMesh>>> meshes_;      // the newest first
    std::deque<std::pair<std::string, std::shared_ptr<const HeightImage>>> images_; // path and image, the newest first
};

} // namespace forceshade
