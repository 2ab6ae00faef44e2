// L7: how far the direction of a shading is from the normal of the smooth surface that a patch was cut from.
#pragma once

#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "host/mesh/structure.h"
#include "host/reference/elementary.h"
#include "tests/mesh/patch.h"

namespace forceshade::study {

/// A smooth surface over the square [-1/2, 1/2]^2.
struct SmoothSurface {
    const char* name;
    std::function<double(double, double)> height;
    std::function<reference::Vector<double>(double, double)> normal; /* of any length */
};

extern const SmoothSurface kUnitCylinder, kUnitSphere, kSaddle;

struct PatchErrors {
    double rms, largest; /* deg: area-uniform, against the true normal at the same (x, y) */
    double jump;         /* deg: the largest across an edge */
};

/// A patch, and the facets of it that count.
class PatchStudy {
public:
    /// Facets that touch no border edge and lie within |x|, |y| <= `within`. `smooth` must outlive it.
    PatchStudy(const SmoothSurface& smooth, Cells kind, unsigned cells, double within = 1);

    /// Of a shading, layout::kShadingNone or of L7.
    PatchErrors errors(layout::uint shading) const;

private:
    using Edge = std::pair<layout::uint, layout::uint>; // vertices, the lower first

    Edge edge_of(layout::uint facet, layout::uint i) const;
    bool counts(layout::uint facet, const std::vector<bool>& on_border, double within) const;
    template <typename Use> void over_facet(layout::uint facet, const Use& use) const;
    double largest_jump(const Edge& ends, const std::vector<layout::uint>& facets, layout::uint shading) const;

    const SmoothSurface& smooth_;
    PolygonSoup polygons_;
    MeshStructure structure_;
    MeshTables<double> tables_;
    layout::MeshView<double> mesh_;
    std::map<Edge, std::vector<layout::uint>> facets_of_;
    std::vector<bool> counts_;
};

} // namespace forceshade::study
