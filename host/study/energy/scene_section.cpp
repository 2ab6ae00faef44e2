#include "host/study/energy/scene_section.h"

#include <algorithm>
#include <cmath>

#include "host/prepare/prepared_case.h"
#include "host/reference/motion.h"

namespace forceshade::study {
namespace {

constexpr std::size_t kCasts = 64;
constexpr int kDown = 256;              /* steps of a cast from top to bottom */
constexpr std::size_t kMostCuts = 4096; /* of facets so many that nobody could tell, none is cut out */

/// Heights at equal steps of x, straight in between.
struct Heights {
    double first, step;
    std::vector<double> at;

    std::size_t cell(double x) const {
        const double place = std::floor((x - first) / step);
        return static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(at.size() - 2)));
    }
    double slope(double x) const { return (at[cell(x) + 1] - at[cell(x)]) / step; }
    double height(double x) const {
        const std::size_t i = cell(x);
        return at[i] + slope(x) * (x - (first + step * static_cast<double>(i)));
    }
};

/// Where a probe that comes from above at (x, y) is first inside, m.
double cast(const PlacedLaw& law, const MeshBox& box, double x, double y) {
    const auto inside = [&](double z) { return law(Vector(x, y, z)).facet != layout::kNoFacet; };
    const double top = box.high[2], step = (top - box.low[2]) / kDown;
    for (int i = 1; i < kDown; ++i) {
        double low = top - i * step, high = low + step;
        if (!inside(low))
            continue;
        for (int halving = 0; halving < 60 && low < (low + high) / 2 && (low + high) / 2 < high; ++halving)
            (inside((low + high) / 2) ? low : high) = (low + high) / 2;
        return low;
    }
    return box.low[2];
}

Section mesh_section(const PreparedCase& prepared, double first, double last, double y) {
    const PlacedLaw law(prepared);
    const MeshBox box = bounding_box(prepared.images.mesh->mesh.polygons);
    Heights heights{first, (last - first) / kCasts, {}};
    Section section;
    for (std::size_t i = 0; i <= kCasts; ++i) {
        section.breaks.push_back(i == kCasts ? last : first + heights.step * static_cast<double>(i));
        heights.at.push_back(cast(law, box, section.breaks.back(), y));
    }
    section.height = [heights](double x) { return heights.height(x); };
    section.slope = [heights](double x) { return heights.slope(x); };
    section.y = y;
    return section;
}

} // namespace

Section scene_section(const PreparedCase& prepared, double first, double last, double y) {
    if (prepared.images.mesh)
        return mesh_section(prepared, first, last, y);
    const auto law = std::make_shared<const PlacedLaw>(prepared);
    const layout::LawParams<double>& params = law->law().params;
    const bool circle = law->law().features.surface == layout::kSurfaceCylinderBump;
    const bool facets = law->law().features.surface == layout::kSurfaceBump;
    std::vector<double> cuts{-params.half_width, params.half_width};
    if (facets && law->law().facet_vertices.size() <= kMostCuts)
        cuts.assign(law->law().facet_vertices.begin(), law->law().facet_vertices.end());
    if (circle) // towards a rim that may be upright
        for (const double short_of : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6})
            for (const double side : {-1.0, 1.0})
                cuts.push_back(side * (1 - short_of) * params.half_width);
    std::ranges::sort(cuts);
    Section section;
    section.breaks.push_back(first);
    for (const double cut : cuts)
        if (cut > first && cut < last)
            section.breaks.push_back(cut);
    section.breaks.push_back(last);
    section.y = y;
    section.height = [law](double x) { return reference::nominal_height(law->law(), x); };
    section.slope = [law, circle, facets](double x) {
        if (facets) {
            const reference::Facet<double> facet = reference::facet_at(law->law(), x);
            return -facet.normal_x / facet.normal_z;
        }
        const bool on_bump = circle && std::abs(x) < law->law().params.half_width;
        return on_bump ? -x / reference::circle_rise(law->law().params.radius, x) : 0.0;
    };
    return section;
}

} // namespace forceshade::study
