// A scene's surface as triangles.
#include <algorithm>
#include <cmath>

#include "host/field/case_law.h"
#include "host/reference/motion.h"
#include "host/renderer/renderer_process.h"

namespace forceshade {
namespace {

constexpr std::size_t kSmoothStrips = 512; // of a bump that is a cylinder
constexpr double kBeyond = 8;              // half widths of the bump, on each side
constexpr double kLeastExtent = 0.1;       // m

// The x at which an analytic surface bends, m, ascending.
std::vector<double> bends_of(const CaseLaw<double>& law, const Scene& scene) {
    switch (scene.surface.kind) {
    case SurfaceKind::bump:
        return law.tables().facet_vertices;
    case SurfaceKind::cylinder_bump: {
        std::vector<double> all;
        for (std::size_t i = 0; i <= kSmoothStrips; ++i)
            all.push_back(scene.surface.width * (double(i) / kSmoothStrips - 0.5));
        return all;
    }
    default:
        return {};
    }
}

} // namespace

RendererMesh renderer_mesh(const PreparedCase& prepared) {
    RendererMesh mesh;
    if (prepared.images.mesh) {
        const Mesh& from = prepared.images.mesh->mesh;
        mesh.vertices = from.polygons.vertices;
        for (std::size_t i = 0; i < from.triangles.corners.size(); ++i) {
            const auto& corners = from.triangles.corners[i];
            if (!std::ranges::binary_search(from.redundant_facets, from.triangles.facets[i]))
                mesh.triangles.push_back({int(corners[0]), int(corners[1]), int(corners[2])});
        }
        return mesh;
    }
    const Scene& scene = prepared.one.scene;
    const CaseLaw<double> law(prepared);
    mesh.extent = std::max(kLeastExtent, kBeyond * scene.surface.width / 2);
    std::vector<double> at = bends_of(law, scene);
    at.insert(at.begin(), -mesh.extent);
    at.push_back(mesh.extent);
    for (const double x : at)
        for (const double y : {-mesh.extent, mesh.extent})
            mesh.vertices.emplace_back(x, y, reference::nominal_height(law.law(), x));
    for (int strip = 0; strip + 1 < int(at.size()); ++strip) {
        const int left = 2 * strip, right = left + 2;
        mesh.triangles.push_back({left, right, right + 1});
        mesh.triangles.push_back({left, right + 1, left + 1});
    }
    return mesh;
}

} // namespace forceshade
