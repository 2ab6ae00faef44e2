// A case made ready to evaluate: its mesh read and put in its place, its images, and its law as a moving probe meets
// it.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <glm/vec3.hpp>

#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/structure.h"
#include "host/prepare/tables.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/scene/scene.h"
#include "host/scene/study.h"

namespace forceshade {

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
    std::vector<MeshFault> changes;               /* what was skipped of the file, what orient turned */
};

/// What of the file was skipped, and the findings with which what is done still has a meaning, a sentence each, after
/// the file's name.
std::vector<std::string> warnings_of(const MeshSpec& spec, const SceneMesh& mesh, MeshUse use);

/// The grid of `samples` along the longest side of the mesh's bounding box and 5 %, about its centre, with as many
/// samples along the other sides as cover the box and as much beyond it.
GridSpec fitted_grid(std::uint64_t samples, const Mesh& mesh);

// A case with the images that it names: everything its evaluation needs.

struct PreparedCase {
    Case one; // with the files' SHA-256 filled in, and the grid that follows from a mesh
    SceneImages images;
    std::shared_ptr<const SceneMesh> compared_mesh; // of [compare]; null: it has none
    std::string scene;                              /* resolved TOML, as it goes into files */
    std::vector<std::string> warnings;              /* of the mesh's file and the grid, for a static field */
    double seconds = 0;                             /* that this took: files that cases share are read once */
};

/// Where the case's places are measured from, m, in the world: those of its paths, of proxies and of god-objects,
/// before they are rounded. origin_of() its mesh; without one the world's own origin.
glm::dvec3 scene_origin(const PreparedCase& prepared);

/// A place from such an origin, m, in the world. For an origin of 0 the same bits: a zero keeps its sign.
inline glm::dvec3 world_place(const glm::dvec3& place, const glm::dvec3& origin) {
    return place - (glm::dvec3(0) - origin);
}

/// A warning that names f64, where single precision rounds coordinates of up to `farthest`, m, to more than a hundredth
/// of `length`, m, which is `what`; nothing in double precision, or for no length.
std::optional<std::string> coarse_warning(Precision precision, double farthest, const std::string& what, double length);

/// Reads images and meshes; cases that follow each other share them, and only the last few stay in memory.
class CasePreparation {
public:
    /// \param given stands for the file of the scene's mesh
    /// \throws IoError for a file that is missing or damaged, UsageError for one that is no height map or mesh, or not
    /// the one whose SHA-256 the scene states.
    PreparedCase prepare(const Case& one, const PolygonFile* given = nullptr);

    /// The mesh alone; fills in its file's SHA-256. \throws as above
    std::shared_ptr<const SceneMesh> mesh(MeshSpec& spec, const PolygonFile* given = nullptr);

private:
    std::shared_ptr<const HeightImage> image(HeightMapSpec& map);
    std::shared_ptr<const SceneMesh> compared_mesh(Scene& scene);
    std::deque<std::pair<MeshSpec, std::shared_ptr<const SceneMesh>>> meshes_;      // the newest first
    std::deque<std::pair<std::string, std::shared_ptr<const HeightImage>>> images_; // path and image, the newest first
    std::map<std::string, MeshFindings> findings_;                                  // by the file's SHA-256
};

/// The law at a place of the world, m, that has no history, as a field has it; each coordinate of the world, or of the
/// mesh's frame, is rounded once to T. The proxy is measured from scene_origin(). `hint`: what was nearest to the place
/// before, a good guess for the next.
template <typename T>
reference::Contact<T> static_contact(const layout::Law<T>& law, const PreparedCase& prepared, const glm::dvec3& place,
                                     layout::uint& hint) noexcept {
    if (!prepared.images.mesh)
        return reference::evaluate(law, reference::Vector<T>(place));
    const glm::dvec3 local = to_mesh_frame(prepared.images.mesh->structure, place);
    return reference::mesh_contact(law, reference::Vector<T>(local), hint);
}

// A force law as a probe meets it that moves along paths: laws with a history keep one for each path.

/// The contact of a sample, places from scene_origin().
template <typename T> struct PathContact {
    reference::Contact<T> contact; /* out of contact the proxy is the probe, the facet layout::kNoFacet */
    bool begins_inside =
        false;            /* first sample of a path, behind the surface: its proxy begins at the nearest place of it */
    bool finished = true; /* false: the proxy could not come to rest within its limit of steps */
};

/// Squares of lengths up to this, m, stay numbers of T: the most that scenes may have, too.
template <typename T> constexpr double kLargestLength = std::is_same_v<T, float> ? 1e15 : 1e150;

/// The largest coordinate of a probe in the world, m: squares of lengths stay numbers of T, and a mesh can still be
/// told from a point.
template <typename T> double largest_coordinate(const PreparedCase& prepared);

template <typename T> class PathLaw {
public:
    explicit PathLaw(const PreparedCase& prepared)
        : origin_(scene_origin(prepared)),
          tables_(make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()) {}
    PathLaw(const PathLaw&) = delete;

    /// As scene_origin().
    const glm::dvec3& origin() const { return origin_; }

    /// A probe in the world, m; each coordinate, from the scene's origin, is rounded once to T. `path`: 0 or one more
    /// than any before begins a new path, others go on from where their last sample left them.
    PathContact<T> at(std::size_t path, const glm::dvec3& probe);

private:
    glm::dvec3 origin_; /* m */
    FieldTables<T> tables_;
    layout::Law<T> law_;                           // points into the tables
    reference::Neighbourhood<T> around_;           // of a mesh: of the probe
    std::vector<reference::GodObject<T>> proxies_; // of a mesh: by path
};

/// The law of a scene. `prepared` must outlive it.
/// \throws UsageError if a value leaves the range of T.
template <typename T> std::unique_ptr<PathLaw<T>> make_path_law(const PreparedCase& prepared);

// L6 to L9 as one probe meets them: the god-object begins, and follows.

/// Whether a place of the mesh's frame is one at which T still follows a probe.
template <typename T> bool is_within_reach(const reference::Vector<T>& local) noexcept {
    return reference::largest_coordinate(local) <= T(kMeshReach<T>);
}

/// Begins a path at a place of the mesh's frame; true if that is behind the surface.
template <typename T>
bool begin_probe(const layout::Law<T>& law, reference::Neighbourhood<T>& around, reference::GodObject<T>& proxy,
                 const reference::Vector<T>& local) noexcept {
    const layout::ProxyStart<T> start = reference::proxy_start(law, around, local);
    proxy = reference::god_object_at(start);
    return start.inside != 0;
}

/// Takes the probe on, to `probe`, m, from the scene's origin, which in the mesh's frame is `local`. Neither allocates
/// nor throws.
template <typename T>
PathContact<T> follow_probe(const layout::Law<T>& law, reference::Neighbourhood<T>& around,
                            reference::GodObject<T>& proxy, const reference::Vector<T>& probe,
                            const reference::Vector<T>& local) noexcept {
    const auto rest = reference::update(law.mesh, proxy, around, local);
    PathContact<T> contact{reference::mesh_contact(law, rest, local), false, rest.finished};
    if (contact.contact.facet == layout::kNoFacet)
        contact.contact.proxy = probe; // not there and back through the mesh's frame
    return contact;
}

} // namespace forceshade
