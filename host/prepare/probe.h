// A force law as a probe meets it that moves along paths: laws with a history keep one for each path.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include <glm/vec3.hpp>

#include "host/prepare/prepared_case.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"

namespace forceshade {

/// What a sample felt, in world coordinates.
template <typename T> struct PathContact {
    reference::Contact<T> contact; /* out of contact the proxy is the probe, the facet layout::kNoFacet */
    bool begins_inside =
        false;            /* first sample of a path, behind the surface: its proxy begins at the nearest place of it */
    bool finished = true; /* false: the proxy could not come to rest within its limit of steps */
};

/// Squares of lengths up to this, m, stay numbers of T: the most that scenes may have, too.
template <typename T> constexpr double kLargestLength = std::is_same_v<T, float> ? 1e15 : 1e150;

template <typename T> class PathLaw {
public:
    virtual ~PathLaw() = default;

    /// The largest coordinate of a probe, m: squares of lengths stay numbers of T up to here.
    virtual double largest_coordinate() const = 0;

    /// A probe, m, each coordinate rounded once to T. `path`: 0 or one more than any before begins a new path, others
    /// go on from where their last sample left them.
    virtual PathContact<T> at(std::size_t path, const glm::dvec3& probe) = 0;
};

/// The law of a scene. `prepared` must outlive it.
/// \throws UsageError if a value leaves the range of T.
template <typename T> std::unique_ptr<PathLaw<T>> make_path_law(const PreparedCase& prepared);

extern template std::unique_ptr<PathLaw<float>> make_path_law<float>(const PreparedCase&);
extern template std::unique_ptr<PathLaw<double>> make_path_law<double>(const PreparedCase&);

// L6 to L9 as one probe meets them in the world: the god-object begins, and follows.

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

/// Takes the probe on, to `probe`, m, which in the mesh's frame is `local`. Neither allocates nor throws.
template <typename T>
PathContact<T> follow_probe(const layout::Law<T>& law, reference::Neighbourhood<T>& around,
                            reference::GodObject<T>& proxy, const glm::dvec3& probe,
                            const reference::Vector<T>& local) noexcept {
    const auto rest = reference::update(law.mesh, proxy, around, local);
    PathContact<T> felt;
    felt.contact = reference::mesh_contact(law, rest, local);
    if (felt.contact.facet == layout::kNoFacet)
        felt.contact.proxy = reference::Vector<T>(probe); // not there and back through the mesh's frame
    felt.finished = rest.finished;
    return felt;
}

} // namespace forceshade
