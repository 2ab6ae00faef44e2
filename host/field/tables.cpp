#include "host/field/prepared_case.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/error.h"
#include "host/output/height_image.h"
#include "host/output/record.h"

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

namespace {

// The slope at node i of `count`, `spacing` metres apart, from the values at its neighbours.
template <typename Value> double slope(std::size_t i, std::size_t count, double spacing, const Value& value) {
    if (count < 2)
        return 0.0;
    const std::size_t low = i > 0 ? i - 1 : i;
    const std::size_t high = std::min(i + 1, count - 1);
    return (value(high) - value(low)) / (spacing * static_cast<double>(high - low));
}

template <typename T>
[[noreturn]] void refuse(double gradient, std::size_t row, std::size_t column, const std::string& file) {
    constexpr bool kSingle = sizeof(T) == 4;
    const bool double_holds = kSingle && std::abs(gradient) <= kSteepestGradient<double>;
    throw UsageError("{}: a slope of {:.3g} m/m at row {}, column {} is too steep: {} allows {:g}; make the map's "
                     "height smaller or its size larger{}",
                     file, gradient, row, column, kSingle ? "f32" : "f64", kSteepestGradient<T>,
                     double_holds ? ", or use precision f64" : "");
}

} // namespace

template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height, const std::string& file) {
    const double spacing_x = columns > 1 ? size_x / static_cast<double>(columns - 1) : 0.0;
    const double spacing_y = rows > 1 ? size_y / static_cast<double>(rows - 1) : 0.0;
    const auto u = [&](std::size_t column, std::size_t row) {
        return height * samples[(rows - 1 - row) * columns + column];
    };
    std::vector<T> gradients(2 * columns * rows);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            const double pair[] = {slope(column, columns, spacing_x, [&](std::size_t i) { return u(i, row); }),
                                   slope(row, rows, spacing_y, [&](std::size_t i) { return u(column, i); })};
            for (std::size_t i = 0; i < 2; ++i) {
                if (!(std::abs(pair[i]) <= kSteepestGradient<T>))
                    refuse<T>(pair[i], rows - 1 - row, column, file);
                gradients[2 * (row * columns + column) + i] = static_cast<T>(pair[i]);
            }
        }
    return gradients;
}

template std::vector<float> map_gradients<float>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                 double, const std::string&);
template std::vector<double> map_gradients<double>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                   double, const std::string&);

namespace {

layout::uint map_kind(MapFunction function) {
    constexpr layout::uint kKinds[] = {layout::kMapCylinder, layout::kMapDip, layout::kMapSine, layout::kMapGaussian,
                                       layout::kMapSamples};
    return kKinds[static_cast<std::size_t>(function)];
}

// Values of a map that its kind does not read stay zero, so that a wrong read shows.
template <typename T> layout::MapParams<T> map_params(const HeightMapSpec& map, const HeightImage* image) {
    layout::MapParams<T> params{};
    switch (map.function) {
    case MapFunction::cylinder:
    case MapFunction::dip:
        params.half_width = rounded<T>(map.width / 2, "a height map's half width");
        params.radius = rounded<T>(map.radius, "a height map's radius");
        break;
    case MapFunction::sine:
        params.slope = rounded<T>(2 * std::numbers::pi * map.height / map.width, "the sine's slope");
        params.inverse_length = rounded<T>(1 / map.width, "1 / wavelength");
        break;
    case MapFunction::gaussian:
        params.slope = rounded<T>(2 * map.height / map.radius, "the Gaussian's slope");
        params.inverse_length = rounded<T>(1 / map.radius, "1 / radius");
        break;
    case MapFunction::file:
        params.half_width = rounded<T>(map.size[0] / 2, "a height map's half size");
        params.half_length = rounded<T>(map.size[1] / 2, "a height map's half size");
        params.nodes_per_x =
            rounded<T>(static_cast<double>(image->columns - 1) / map.size[0], "a height map's sampling");
        params.nodes_per_y = rounded<T>(static_cast<double>(image->rows - 1) / map.size[1], "a height map's sampling");
        params.columns = static_cast<layout::uint>(image->columns);
        params.rows = static_cast<layout::uint>(image->rows);
        break;
    }
    return params;
}

template <typename T> std::vector<T> gradients(const HeightMapSpec& map, const HeightImage* image) {
    return map.function != MapFunction::file ? std::vector<T>()
                                             : map_gradients<T>(image->samples, image->columns, image->rows,
                                                                map.size[0], map.size[1], map.height, map.file);
}

// The first `count` samples along an axis, (world - centre) / scale.
template <typename T>
std::vector<T> axis(const GridSpec& grid, std::size_t which, std::size_t count, double centre = 0, double scale = 1,
                    const char* what = "a grid coordinate") {
    std::vector<T> samples(count);
    for (std::size_t i = 0; i < count; ++i)
        samples[i] = rounded<T>((grid.at(which, i) - centre) / scale, what);
    return samples;
}

// In the mesh's own frame, where single precision suffices however far the mesh is from the origin.
template <typename T> std::vector<T> local_axis(const GridSpec& grid, int which, const MeshStructure& mesh) {
    const auto i = static_cast<std::size_t>(which);
    const double farthest = grid.farthest(i, mesh.centre[which]);
    if (!(farthest <= kMeshReach<T> * mesh.scale))
        throw UsageError("the grid reaches {:.3g} m from the mesh's centre along {}, and the mesh is about {:.3g} m in "
                         "size: beyond {:.0f} sizes {} cannot distinguish its facets; move the grid or check the unit",
                         farthest, "xyz"[which], 2 * mesh.scale, kMeshReach<T> / 2, name_of(kPrecisionOf<T>));
    return axis<T>(grid, i, grid.size[i], mesh.centre[which], mesh.scale, "a grid coordinate, in sizes of the mesh,");
}

layout::uint mesh_shading(Shading shading) {
    switch (shading) {
    case Shading::morgenbesser:
        return layout::kShadingMorgenbesser;
    case Shading::barycentric:
        return layout::kShadingBarycentric;
    case Shading::mean_value:
        return layout::kShadingMeanValue;
    case Shading::two_pass:
        return layout::kShadingTwoPass;
    case Shading::none:
    case Shading::reference: // of bumps and height maps
    case Shading::height_map:
        break;
    }
    return layout::kShadingNone;
}

bool tilts_normals(const Scene& scene) {
    return scene.texture && scene.texture->effect == TextureEffect::normal;
}

// The map that gives directions: of a plane its own (L5), of a mesh the texture that tilts its normals (L9).
const HeightMapSpec& direction_map(const Scene& scene) {
    return tilts_normals(scene) ? scene.texture->map : scene.surface.map;
}
const HeightImage* direction_image(const Scene& scene, const SceneImages& images) {
    return tilts_normals(scene) ? images.texture.get() : images.map.get();
}

// A sine is read but for whole wavelengths, so that its phase does not suffer where the mesh is far away.
template <typename T> void place_map(const Scene& scene, const MeshStructure& mesh, layout::MeshParams<T>& params) {
    if (!scene.texture || scene.texture->map.function != MapFunction::sine)
        return;
    const double length = scene.texture->map.width, whole = std::round(origin_of(mesh).x / length); /* m, 1 */
    params.map_x = static_cast<T>(mesh.centre.x - whole * length);
}

bool is_shaded_by_map(const Scene& scene) {
    return scene.surface.kind == SurfaceKind::height_map && scene.force.shading == Shading::height_map;
}

} // namespace

layout::Features features_of(const Scene& scene) {
    layout::Features features;
    const bool bump = scene.surface.kind == SurfaceKind::bump;
    const bool mesh = scene.surface.kind == SurfaceKind::mesh;
    features.surface = bump                                               ? layout::kSurfaceBump
                       : scene.surface.kind == SurfaceKind::cylinder_bump ? layout::kSurfaceCylinderBump
                       : mesh                                             ? layout::kSurfaceMesh
                                                                          : layout::kSurfaceHeightMap;
    features.shading = is_shaded_by_map(scene)                     ? layout::kShadingHeightMap
                       : scene.force.shading == Shading::reference ? layout::kShadingReference
                       : mesh                                      ? mesh_shading(scene.force.shading)
                                                                   : layout::kShadingNone;
    if (mesh && scene.surface.mesh.inside == InsideTest::winding)
        features.inside = layout::kInsideWinding;
    // The two readings differ only on facets that slope.
    if (bump && scene.force.depth == DepthReading::normal)
        features.depth = layout::kDepthNormal;
    if (features.shading == layout::kShadingReference && scene.force.reference == ReferenceDirection::radial)
        features.reference = layout::kReferenceRadial;
    if (is_shaded_by_map(scene) || tilts_normals(scene))
        features.map = map_kind(direction_map(scene).function);
    if (scene.texture && !tilts_normals(scene) && scene.texture->stiffness != 0)
        features.texture = map_kind(scene.texture->map.function);
    features.channels = scene.output.channels | layout::kChannelForce;
    return features;
}

bool depends_on_y(const layout::Features& features) {
    const auto varies = [](layout::uint map) { return map == layout::kMapGaussian || map == layout::kMapSamples; };
    return features.surface == layout::kSurfaceMesh || varies(features.map) || varies(features.texture) ||
           (features.channels & layout::kChannelProxy);
}

bool depends_on_y(const Scene& scene) {
    return scene.grid.every_y || depends_on_y(features_of(scene));
}

std::vector<std::string> omissions(const Scene& scene) {
    const layout::Features features = features_of(scene);
    std::vector<std::string> left_out;
    if (features.shading == layout::kShadingNone)
        left_out.push_back("shading");
    if (features.texture == layout::kMapNone)
        left_out.push_back("texture");
    if (features.surface == layout::kSurfaceMesh && features.map == layout::kMapNone)
        left_out.push_back("tilted normals");
    // Paths never have these.
    if (scene.field && features.surface == layout::kSurfaceMesh && features.inside != layout::kInsideWinding)
        left_out.push_back("winding number");
    if (scene.field && features.surface == layout::kSurfaceMesh)
        left_out.push_back(kFreeSpace);
    if (features.map != layout::kMapSamples && features.texture != layout::kMapSamples)
        left_out.push_back("sampled height maps");
    const auto channel = [&](layout::uint bit, const char* name) {
        if (!(features.channels & bit))
            left_out.push_back(name);
    };
    channel(layout::kChannelDepth, "depth channel");
    channel(layout::kChannelFacet, "facet channel");
    channel(layout::kChannelProxy, "proxy channel");
    if (scene.field) // paths have no such channel
        channel(layout::kChannelUnshaded, "unshaded channel");
    if (scene.field && !depends_on_y(scene) && scene.grid.size[1] > 1)
        left_out.push_back(fmt::format("{} of {} y samples, alike", scene.grid.size[1] - 1, scene.grid.size[1]));
    return left_out;
}

template <typename T> FieldTables<T> make_tables(const Scene& scene, const SceneImages& images, Extent extent) {
    FieldTables<T> tables;
    tables.features = features_of(scene);
    layout::LawParams<T>& params = tables.params;
    params.stiffness = rounded<T>(scene.force.stiffness, "stiffness");
    if (scene.surface.kind == SurfaceKind::bump || scene.surface.kind == SurfaceKind::cylinder_bump) {
        const double half_width = scene.surface.width / 2, radius = scene.surface.radius;
        params.half_width = rounded<T>(half_width, "the half width");
        params.radius = rounded<T>(radius, "radius");
        params.centre_depth = rounded<T>(std::sqrt((radius - half_width) * (radius + half_width)), "the axis' depth");
    }
    if (scene.surface.kind == SurfaceKind::bump) {
        params.facets = scene.surface.facets;
        tables.facet_vertices = facet_vertices<T>(scene.surface.facets, scene.surface.width / 2, scene.surface.radius,
                                                  scene.surface.facet_spacing);
    }
    if (tables.features.map != layout::kMapNone) {
        params.map = map_params<T>(direction_map(scene), direction_image(scene, images));
        tables.map_gradients = gradients<T>(direction_map(scene), direction_image(scene, images));
    }
    if (tables.features.texture != layout::kMapNone) {
        params.texture_stiffness = rounded<T>(scene.texture->stiffness, "the texture's stiffness");
        params.texture = map_params<T>(scene.texture->map, images.texture.get());
        tables.texture_gradients = gradients<T>(scene.texture->map, images.texture.get());
    }
    if (images.mesh) {
        const MeshStructure& mesh = images.mesh->structure;
        MeshTables<T> made = make_mesh_tables<T>(mesh, scene.force.stiffness);
        place_map(scene, mesh, made.params);
        tables.mesh = std::make_shared<const MeshTables<T>>(std::move(made));
        if (extent == Extent::nothing)
            return tables;
        tables.x = local_axis<T>(scene.grid, 0, mesh);
        tables.y = local_axis<T>(scene.grid, 1, mesh);
        tables.z = local_axis<T>(scene.grid, 2, mesh);
        return tables;
    }
    if (extent == Extent::nothing)
        return tables;
    const bool every_y = extent == Extent::everything || depends_on_y(scene);
    tables.x = axis<T>(scene.grid, 0, scene.grid.size[0]);
    tables.y = axis<T>(scene.grid, 1, every_y ? scene.grid.size[1] : 1);
    tables.z = axis<T>(scene.grid, 2, scene.grid.size[2]);
    return tables;
}

template <typename T> void find_obstacles(FieldTables<T>& tables) {
    MeshTables<T> mesh = *tables.mesh;
    find_obstacles(mesh);
    tables.mesh = std::make_shared<const MeshTables<T>>(std::move(mesh));
}

template void find_obstacles(FieldTables<float>&);
template void find_obstacles(FieldTables<double>&);
template FieldTables<float> make_tables<float>(const Scene&, const SceneImages&, Extent);
template FieldTables<double> make_tables<double>(const Scene&, const SceneImages&, Extent);

} // namespace forceshade
