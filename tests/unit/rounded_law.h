// A law for number types that round otherwise, out of its tables in double precision.
#pragma once

#include <cmath>
#include <vector>

#include "host/reference/contact.h"
#include "shaders/shared/law.h"
#include "tests/unit/affine.h"

namespace forceshade::test {

/// What T::given() and T::made() make of a law on an analytic surface, for probes whose x is near `near_x`: the
/// vertices of the facet there are rounded, others are not looked at.
template <typename T> class RoundedLaw {
public:
    RoundedLaw(const layout::Law<double>& exact, double near_x)
        : map_(made(exact.map_gradients)), texture_(made(exact.texture_gradients)) {
        law_.features = exact.features;
        law_.params.stiffness = T::given(exact.params.stiffness);
        law_.params.texture_stiffness = T::given(exact.params.texture_stiffness);
        law_.params.half_width = T::given(exact.params.half_width);
        law_.params.radius = T::given(exact.params.radius);
        law_.params.centre_depth = T::made(exact.params.centre_depth);
        law_.params.facets = exact.params.facets;
        law_.params.map = of(exact.params.map);
        law_.params.texture = of(exact.params.texture);
        law_.map_gradients = map_;
        law_.texture_gradients = texture_;
        add_vertices(exact, near_x);
    }
    RoundedLaw(const RoundedLaw&) = delete;
    RoundedLaw& operator=(const RoundedLaw&) = delete;

    /// mesh_contact() wants a tree of numbers that stand side by side: not of these.
    reference::Contact<T> operator()(double x, double y, double z) const {
        const reference::Column<T> column = reference::column_at(law_, T(x), T(y));
        return law_.features.surface == layout::kSurfaceCylinderBump
                   ? reference::cylinder_bump_contact(law_, column, T(z))
                   : reference::facet_contact(law_, column, T(z));
    }

private:
    static std::vector<T> made(std::span<const double> values) {
        std::vector<T> result;
        for (const double value : values)
            result.push_back(T::made(value));
        return result;
    }

    static layout::MapParams<T> of(const layout::MapParams<double>& map) {
        return {T::given(map.half_width),
                T::given(map.half_length),
                T::given(map.radius),
                T::made(map.slope),
                T::made(map.inverse_length),
                T::made(map.nodes_per_x),
                T::made(map.nodes_per_y),
                map.columns,
                map.rows};
    }

    // Vertices lie symmetrically, and the outermost are the edges.
    void add_vertices(const layout::Law<double>& exact, double near_x) {
        const std::span<const double> all = exact.facet_vertices;
        if (all.empty())
            return;
        for (const double x : all)
            vertices_.push_back(T(single_precision(x)));
        const double a = exact.params.half_width;
        const layout::uint first = reference::facet_at(exact, near_x).id;
        for (std::size_t i = first; i < std::min<std::size_t>(first + 2, all.size()); ++i)
            vertices_[i] = all[i] == a    ? law_.params.half_width
                           : all[i] == -a ? -law_.params.half_width
                                          : T::made(all[i]);
        if (first + 1 < all.size() && all[first] == -all[first + 1])
            vertices_[first] = -vertices_[first + 1];
        law_.facet_vertices = vertices_;
    }

    std::vector<T> vertices_, map_, texture_;
    layout::Law<T> law_{};
};

} // namespace forceshade::test
