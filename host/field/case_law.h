// The force law of a prepared case at a probe, by the CPU oracle: without a history, as a field has it, or with one, as
// a path and a hand have it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/reference/contact.h"
#include "host/reference/friction.h"
#include "host/reference/god_object.h"

namespace forceshade {

/// A contact in either precision: each float is exact here.
struct ProbeContact {
    glm::dvec3 proxy;    /* m, in the world; out of contact the probe */
    glm::dvec3 force;    /* N: the law's, perhaps not finite */
    glm::dvec3 coupled;  /* N: the same through a virtual coupling, if the hand has one */
    double depth;        /* m */
    std::uint32_t facet; // layout::kNoFacet out of contact
    bool finished;       // the proxy came to rest
};

/// Neither allocates nor throws once it is made; threads may share it.
template <typename T> class CaseLaw {
public:
    /// Copies what it needs of the case, and its grid to an extent. \throws UsageError if a value leaves the range of
    /// T.
    explicit CaseLaw(const PreparedCase& prepared, Extent grid = Extent::nothing);
    CaseLaw(CaseLaw&&) noexcept = default;
    CaseLaw& operator=(CaseLaw&&) noexcept = default;

    /// Makes paths on a mesh faster (MeshObstacles); takes as long as several updates a triangle.
    void find_obstacles();

    const layout::Law<T>& law() const { return law_; }
    const FieldTables<T>& tables() const { return tables_; }
    const glm::dvec3& origin() const { return origin_; } /* as scene_origin() */
    /// A probe, m, in the world, as the law has it: from the case's origin, each coordinate rounded once to T.
    reference::Vector<T> from_origin(const glm::dvec3& probe) const noexcept {
        return reference::Vector<T>(on_mesh() ? probe - origin_ : probe);
    }
    glm::dvec3 in_world(const reference::Vector<T>& place) const { return world_place(glm::dvec3(place), origin_); }
    ProbeContact widened(const reference::LawContact<T>& found) const noexcept;

    /// Whether the law has a meaning at a probe, m, in the world: T can still distinguish the mesh from a point.
    bool reaches(const glm::dvec3& probe) const noexcept;

    // Without a history.

    /// A place of the world, m, as the law takes it: each coordinate, on a mesh of the mesh's frame, rounded once to T.
    reference::Vector<T> rounded(const glm::dvec3& place) const noexcept;
    /// `hint`: the triangle nearest to the last place, a good guess for the next; 0 at first.
    reference::Contact<T> at_rounded(const reference::Vector<T>& place, layout::uint& hint) const noexcept;
    reference::Contact<T> at(const glm::dvec3& place, layout::uint& hint) const noexcept {
        return at_rounded(rounded(place), hint);
    }
    reference::Contact<T> at(const glm::dvec3& place) const noexcept {
        layout::uint hint = 0;
        return at(place, hint);
    }

    /// A voxel of the grid, which must be in the extent.
    reference::Vector<T> voxel(std::size_t x, std::size_t y, std::size_t z) const noexcept {
        return {tables_.x[x], tables_.y[y], tables_.z[z]};
    }

    // With one.

    /// A law's state along a path.
    struct Path {
        reference::GodObject<T> proxy;
        bool begun = false;
    };
    /// The contact of the next sample of a path, places in m from the case's origin, at a probe, m, in the world, that
    /// the law reaches; each coordinate, from the case's origin, is rounded once to T. A path that begins behind a
    /// mesh's surface begins at the nearest place of it. `around` is any one, best that of the sample before.
    reference::LawContact<T> follow(Path& path, reference::Neighbourhood<T>& around,
                                    const glm::dvec3& probe) const noexcept;

private:
    bool on_mesh() const { return mesh_ != nullptr; }

    std::shared_ptr<const SceneMesh> mesh_; // null: an analytic surface
    glm::dvec3 origin_;                     /* m, in the world */
    FieldTables<T> tables_;
    layout::Law<T> law_; // points into the tables
};

/// The error text for a probe, m, of a path on a mesh that its law does not reach.
template <typename T> std::string beyond_reach(const glm::dvec3& probe);

/// One probe and its law.
template <typename T> class CaseProbe {
public:
    explicit CaseProbe(const PreparedCase& prepared) : law_(prepared) {}

    CaseLaw<T>& law() { return law_; }
    const CaseLaw<T>& law() const { return law_; }
    /// Forgets the history: the next sample begins a path.
    void begin_path() noexcept { path_.begun = false; }
    /// Forgets what lies around the proxy: the next sample has to find it anew, and gives the same.
    void forget_neighbours() noexcept {
        around_.count = 0;
        around_.box = reference::kNoBox;
        around_.close.forget();
    }
    /// As CaseLaw::follow.
    reference::LawContact<T> at(const glm::dvec3& probe) noexcept { return law_.follow(path_, around_, probe); }

private:
    CaseLaw<T> law_;
    typename CaseLaw<T>::Path path_;
    reference::Neighbourhood<T> around_;
};

/// The hand's virtual coupling in a scene of `stiffness`, N/m, each `period`, s.
template <typename T> layout::Coupling<T> coupling_of(const HandSpec& hand, double stiffness, double period) noexcept;

/// What a scene with friction or vibration adds to its law in a loop of `period`, s; empty for another. May allocate.
template <typename T>
std::optional<reference::SurfaceForces<T>> surface_forces(const PreparedCase& prepared, double period);

/// The first 64 bits of the SHA-256 of the scene's resolved TOML.
std::uint64_t scene_id(const PreparedCase& prepared);

/// A law in the precision of its scene, and its probe. Neither allocates, locks, throws nor logs.
class ProbeLaw {
public:
    virtual ~ProbeLaw() = default;

    std::uint64_t scene = 0; // scene_id(): of which scene a sample is

    /// As CaseLaw's and CaseProbe's: the numbers of `explore`, bit for bit.
    virtual bool reaches(const glm::dvec3& probe) const noexcept = 0;
    virtual void begin_path() noexcept = 0;
    /// From now on `coupled` is through the virtual coupling of the scene's hand, if it has one, each `period`,
    /// s; a metre of the hand is `scale` metres of the scene.
    virtual void couple(double /*scale*/, double /*period*/) noexcept {}
    virtual ProbeContact at(const glm::dvec3& probe) noexcept = 0;
};

/// With the scene's friction and vibration, in a loop of `period`, s; 0: that of its paths. \throws UsageError if a
/// value leaves the precision's range.
std::unique_ptr<ProbeLaw> make_probe_law(const PreparedCase& prepared, double period = 0);

} // namespace forceshade
