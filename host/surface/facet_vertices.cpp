#include "host/surface/facet_vertices.h"

#include <algorithm>
#include <cmath>

namespace forceshade {

template <typename T>
std::vector<T> facet_vertices(std::uint32_t facets, double half_width, double radius, FacetSpacing spacing) {
    // An arc sine would lose half of the digits where R is barely above a.
    const double edge_angle = std::atan2(half_width, std::sqrt((radius - half_width) * (radius + half_width)));
    std::vector<T> vertices(std::size_t(facets) + 1);
    for (std::uint32_t i = 0; 2 * std::uint64_t(i) <= facets; ++i) {
        // How far vertex i lies from the middle towards the right edge, of 1; exact at the middle and at the edge.
        const double fraction = static_cast<double>(facets - 2 * std::uint64_t(i)) / facets;
        const double x = i == 0                             ? half_width
                         : spacing == FacetSpacing::equal_x ? half_width * fraction
                                                            : radius * std::sin(edge_angle * fraction);
        const T rounded = static_cast<T>(std::min(x, half_width));
        vertices[i] = -rounded;
        vertices[facets - i] = rounded;
    }
    if (facets % 2 == 0)
        vertices[facets / 2] = T(0);
    return vertices;
}

template std::vector<float> facet_vertices<float>(std::uint32_t, double, double, FacetSpacing);
template std::vector<double> facet_vertices<double>(std::uint32_t, double, double, FacetSpacing);

} // namespace forceshade
