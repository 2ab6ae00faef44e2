#include "host/study/energy/scenes.h"

#include <fmt/format.h>

namespace forceshade::study {
namespace {

PreparedCase parsed(const std::string& text) {
    PreparedCase prepared;
    prepared.one = parse_scene(text, "the study's own scene");
    prepared.scene = text;
    return prepared;
}

std::string force_text(const BumpForce& force) {
    return fmt::format("[force]\nstiffness = \"{} N/m\"\nshading = \"{}\"\n{}{}", kStiffness, force.shading,
                       force.depth == "normal" ? "depth = \"normal\"\n" : "",
                       force.reference == "radial" ? "reference = \"radial\"\n" : "");
}

} // namespace

PreparedCase bump_scene(double radius_mil, unsigned facets, const BumpForce& force) {
    return parsed(fmt::format("[surface]\nkind = \"bump\"\nwidth = \"1000 mil\"\nradius = \"{} mil\"\nfacets = {}\n{}",
                              radius_mil, facets, force_text(force)));
}

PreparedCase cylinder_bump_scene(double radius_mil) {
    return parsed(
        fmt::format("[surface]\nkind = \"cylinder_bump\"\nwidth = \"1000 mil\"\nradius = \"{} mil\"\n[force]\n"
                    "stiffness = \"{} N/m\"\n",
                    radius_mil, kStiffness));
}

PreparedCase height_map_scene(double radius_mil) {
    return parsed(fmt::format("[surface]\nkind = \"height_map\"\nfunction = \"cylinder\"\nwidth = \"1000 mil\"\n"
                              "radius = \"{} mil\"\n[force]\nstiffness = \"{} N/m\"\nshading = \"height_map\"\n",
                              radius_mil, kStiffness));
}

PreparedCase mesh_scene(std::shared_ptr<const SceneMesh> mesh, const std::string& name, const std::string& shading) {
    PreparedCase prepared = parsed(fmt::format("# {} is made by the study and in no file\n[surface]\nkind = \"mesh\"\n"
                                               "file = \"{}\"\n[force]\nstiffness = \"{} N/m\"\nshading = \"{}\"\n",
                                               name, name, kStiffness, shading));
    prepared.images.mesh = std::move(mesh);
    return prepared;
}

void set_section(PreparedCase& prepared, const SectionGrid& grid) {
    Scene& scene = prepared.one.scene;
    scene.grid = {};
    scene.grid.size = {grid.columns, 1, grid.rows};
    scene.grid.origin = {grid.low[0], grid.y, grid.low[1]};
    const double dx = (grid.high[0] - grid.low[0]) / static_cast<double>(grid.columns - 1);
    const double dz = (grid.high[1] - grid.low[1]) / static_cast<double>(grid.rows - 1);
    scene.grid.spacing = {dx, dz, dz};
    scene.field = true;
    scene.output.channels = layout::kChannelForce | layout::kChannelDepth;
    scene.precision = Precision::f64;
}

} // namespace forceshade::study
