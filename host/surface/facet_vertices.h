// G2: where the facets of a bump begin.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/scene.h"

namespace forceshade {

/// The n + 1 x coordinates, m, of the vertices of an n-facet bump, from -a to a exactly, symmetric, not decreasing.
/// Computed in double and rounded once to T. `half_width` is a, `radius` R >= a, both in m.
template <typename T>
std::vector<T> facet_vertices(std::uint32_t facets, double half_width, double radius, FacetSpacing spacing);

extern template std::vector<float> facet_vertices<float>(std::uint32_t, double, double, FacetSpacing);
extern template std::vector<double> facet_vertices<double>(std::uint32_t, double, double, FacetSpacing);

} // namespace forceshade
