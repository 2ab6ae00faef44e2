#include "host/study/energy/curl_maps.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/study/energy/bump_mesh.h"
#include "host/study/energy/scenes.h"

namespace forceshade::study {
namespace {

constexpr double kRadiusMil = 1000;
constexpr unsigned kMeshCells = 8;

CurlMap section_of(const std::string& name, const std::string& title, const std::string& scheme, PreparedCase prepared,
                   std::uint64_t columns, double y = 0) {
    SectionGrid grid{{-1.05 * kHalfWidth, -0.003}, {1.05 * kHalfWidth, 0.0036}, y, columns, columns / 2};
    set_section(prepared, grid);
    return {name, title, scheme, std::move(prepared), {}};
}

constexpr double kEdge = 0.0003; /* m: so near the bump's edge, where directions jump, no curl is expected */

/// -K N_x + K z dN_z/dx on the flat plane, below it.
double shaded_plane_curl(double x, double z) {
    if (std::abs(x) > kHalfWidth - kEdge)
        return std::numeric_limits<double>::quiet_NaN();
    const double radius = kRadiusMil * kMil, sine = x / radius;
    return kStiffness * (-sine - z * sine / (radius * std::sqrt(1 - sine * sine)));
}

} // namespace

std::vector<CurlMap> curl_maps(std::uint64_t columns) {
    std::vector<CurlMap> maps;
    const auto add_bump = [&](const char* name, const char* title, unsigned facets, const BumpForce& force) {
        const char* scheme = force.shading == "none" ? "facets" : "shaded";
        maps.push_back(section_of(name, title, scheme, bump_scene(kRadiusMil, facets, force), columns));
    };
    const BumpForce shaded{"reference", "vertical", "normal"};
    add_bump("facets-1-shaded", "1 facet, shaded", 1, shaded);
    maps.back().closed_form = shaded_plane_curl;
    add_bump("facets-2", "2 facets", 2, {});
    add_bump("facets-2-shaded", "2 facets, shaded", 2, shaded);
    add_bump("facets-8", "8 facets", 8, {});
    add_bump("facets-8-shaded", "8 facets, shaded", 8, shaded);
    maps.push_back(section_of("superposed", "plane and cylinder superposed", "superposed",
                              cylinder_bump_scene(kRadiusMil), columns));
    const auto mesh = bump_mesh({kHalfWidth, kRadiusMil * kMil, kMeshCells, kMeshCells, MeshCells::triangles});
    for (const char* shading : {"none", "morgenbesser", "mean_value", "two_pass"})
        maps.push_back(section_of(fmt::format("mesh-8-{}", shading), fmt::format("mesh of 8 cells, {}", shading),
                                  fmt::format("triangles {}", shading),
                                  mesh_scene(mesh, "bump-8-triangles.off", shading), columns,
                                  0.137 * 2 * kHalfWidth / kMeshCells));
    return maps;
}

} // namespace forceshade::study
