#include "host/field/scene_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/error.h"
#include "host/io/memory_limit.h"
#include "host/mesh/prepare_mesh.h"
#include "host/mesh_file/mesh_file.h"
#include "host/scene/limits.h"

namespace forceshade {
namespace {

constexpr double kMargin = 0.05; // of the box's longest side

} // namespace

MeshBox bounding_box(const PolygonSoup& polygons) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    MeshBox box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
    for (const std::uint32_t corner : polygons.corners)
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(axis);
            box.low[i] = std::min(box.low[i], polygons.vertices[corner][axis]);
            box.high[i] = std::max(box.high[i], polygons.vertices[corner][axis]);
        }
    return box;
}

std::shared_ptr<const SceneMesh> read_scene_mesh(const MeshSpec& spec) {
    PolygonFile file = read_polygons(spec.path);
    constexpr double kTriangleBytes =
        1100; // measured: of the structure, its tables in both precisions and on the device
    const std::size_t triangles =
        file.polygons.corners.size() - std::min(file.polygons.corners.size(), 2 * file.polygons.facets());
    require_memory(spec.path, fmt::format("a mesh of {} triangles", triangles),
                   kTriangleBytes * static_cast<double>(triangles));
    auto mesh = std::make_shared<SceneMesh>();
    mesh->sha256 = file.sha256;
    mesh->findings = inspect(file.polygons);
    refuse_if_meaningless(mesh->findings, spec.file);
    MeshPlacement placement;
    placement.unit = spec.unit;
    placement.scale = spec.scale;
    placement.rotate = spec.rotate;
    placement.translate = spec.translate;
    mesh->mesh = prepare_mesh(std::move(file.polygons), placement,
                              spec.normals == NormalWeights::angle ? VertexNormals::angle : VertexNormals::plain);
    StructureOptions options;
    options.winding = spec.inside == InsideTest::winding;
    options.solid = is_solid(mesh->findings);
    mesh->structure = build_structure(mesh->mesh, options);
    return mesh;
}

std::vector<std::string> warnings_of(const MeshSpec& spec, const SceneMesh& mesh, MeshUse use) {
    std::vector<std::string> result;
    for (const std::string& warning : warnings(mesh.findings, use))
        result.push_back(fmt::format("{}: {}", spec.file, warning));
    return result;
}

void check_mesh_fits(const Scene& scene, const SceneMesh& mesh) {
    if (scene.force.shading != Shading::barycentric)
        return;
    const auto& begins = mesh.mesh.polygons.begins;
    for (std::size_t facet = 0; facet + 1 < begins.size(); ++facet)
        if (begins[facet + 1] - begins[facet] != 3)
            throw UsageError(fmt::format("shading \"barycentric\" is for triangles, and facet {} of {} has {} corners: "
                                         "use \"mean_value\", which is the same on triangles",
                                         facet, scene.surface.mesh.file, begins[facet + 1] - begins[facet]));
}

GridSpec fitted_grid(std::uint64_t samples, const Mesh& mesh) {
    const MeshBox box = bounding_box(mesh.polygons);
    double longest = 0; /* m */
    for (std::size_t i = 0; i < 3; ++i)
        longest = std::max(longest, box.high[i] - box.low[i]);
    GridSpec grid;
    const double spacing = samples > 1 ? (1 + kMargin) * longest / static_cast<double>(samples - 1) : longest;
    for (std::size_t i = 0; i < 3; ++i) {
        const double covered = box.high[i] - box.low[i] + kMargin * longest;
        // A side as long as the longest one has as many samples, whatever the division rounds to.
        const double count = std::ceil(covered / spacing - 1e-9) + 1; // infinite where the spacing underflows
        grid.size[i] = count < static_cast<double>(samples) ? static_cast<std::uint64_t>(count) : samples;
        grid.spacing[i] = spacing;
        const double half = spacing * static_cast<double>(grid.size[i] - 1) / 2;
        grid.origin[i] = box.low[i] + (box.high[i] - box.low[i]) / 2 - half;
    }
    if (grid.size[1] * grid.size[2] > kMostRows)
        throw UsageError(fmt::format("grid.samples = {} makes {} rows, y times z; an EXR holds up to {}", samples,
                                     grid.size[1] * grid.size[2], kMostRows));
    return grid;
}

} // namespace forceshade
