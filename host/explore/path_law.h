// A force law as a probe meets it that moves along paths: laws with a history keep one for each path.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/reference/contact.h"

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

} // namespace forceshade
