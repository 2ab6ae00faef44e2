#include "host/study/omission/usual_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/output/height_image.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::study {
namespace {

// How far the scene's feature reaches along x, m.
double extent_of(const PreparedCase& prepared) {
    if (!prepared.images.mesh)
        return prepared.one.scene.surface.width;
    const MeshBox box = bounding_box(prepared.images.mesh->mesh.polygons);
    return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

double height_at(const HeightMapSpec& map, double x, double y) {
    if (map.function == MapFunction::sine)
        return std::sin(2 * std::numbers::pi * x / map.width);
    return std::exp(-(x * x + y * y) / (map.radius * map.radius));
}

} // namespace

Shading usual_shading(SurfaceKind kind) {
    switch (kind) {
    case SurfaceKind::bump:
        return Shading::reference;
    case SurfaceKind::height_map:
        return Shading::height_map;
    case SurfaceKind::mesh:
        return Shading::mean_value;
    case SurfaceKind::cylinder_bump:
        break;
    }
    return Shading::none;
}

const char* name_of(Shading shading) {
    constexpr const char* kNames[] = {"none",        "reference",  "height_map", "morgenbesser",
                                      "barycentric", "mean_value", "two_pass"};
    return kNames[static_cast<std::size_t>(shading)];
}

TextureSpec usual_texture(const PreparedCase& prepared, TextureEffect effect) {
    TextureSpec texture;
    texture.stiffness = prepared.one.scene.force.stiffness / 5;
    texture.effect = effect;
    texture.map.function = MapFunction::sine;
    texture.map.width = extent_of(prepared) / 12;
    texture.map.height = texture.map.width / 100;
    return texture;
}

std::shared_ptr<const HeightImage> sample_map(HeightMapSpec& map) {
    constexpr std::size_t kNodes = 129;
    const double extent = map.function == MapFunction::sine ? 12 * map.width : 6 * map.radius; /* m */
    auto image = std::make_shared<HeightImage>();
    image->columns = image->rows = kNodes;
    for (std::size_t row = 0; row < kNodes; ++row)
        for (std::size_t column = 0; column < kNodes; ++column) {
            const auto at = [&](std::size_t i) { return extent * (double(i) / double(kNodes - 1) - 0.5); };
            image->samples.push_back(height_at(map, at(column), -at(row)));
        }
    map.function = MapFunction::file;
    map.file = "sampled";
    map.size = {extent, extent};
    return image;
}

} // namespace forceshade::study
