// One scene of every kind of analytic surface and shading, for paths.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "host/output/height_image.h"
#include "tests/unit/laws.h"

namespace forceshade::test {

inline HeightMapSpec map_of(MapFunction function) {
    HeightMapSpec map;
    map.function = function;
    map.width = 0.02;
    map.radius = function == MapFunction::gaussian ? 0.008 : 0.03;
    map.height = 0.003;
    if (function == MapFunction::file) {
        map.file = "waves";
        map.size = {0.03, 0.02};
    }
    return map;
}

inline std::shared_ptr<const HeightImage> waves() {
    auto image = std::make_shared<HeightImage>();
    image->columns = 31;
    image->rows = 17;
    for (std::size_t i = 0; i < image->columns * image->rows; ++i)
        image->samples.push_back(0.5 + 0.5 * std::sin(0.7 * static_cast<double>(i)));
    return image;
}

struct Surface {
    const char* name;
    Scene scene;
    SceneImages images;
};

inline std::vector<Surface> surfaces() {
    std::vector<Surface> all;
    all.push_back({"facets", bump(kRadii[0], 3), {}});
    all.push_back({"shaded facets", bump(kRadii[0], 5, Shading::reference), {}});
    all.push_back({"many facets", bump(kRadii[1], 100000, Shading::reference), {}});
    all.push_back({"normal depth, radial", bump(kRadii[0], 4, Shading::reference), {}});
    all.back().scene.force.depth = DepthReading::normal;
    all.back().scene.force.reference = ReferenceDirection::radial;
    all.push_back({"cylinder", cylinder_bump(kRadii[1]), {}});
    all.push_back({"sine", height_map(map_of(MapFunction::sine)), {}});
    all.push_back({"gaussian, textured", height_map(map_of(MapFunction::gaussian)), {}});
    all.back().scene.texture = TextureSpec{30.0, map_of(MapFunction::sine)};
    all.push_back({"samples, textured by samples", height_map(map_of(MapFunction::file)), {}});
    all.back().scene.texture = TextureSpec{30.0, map_of(MapFunction::file)};
    all.back().images = {waves(), waves(), nullptr};
    all.push_back({"facets, textured", bump(kRadii[0], 3, Shading::reference), {}});
    all.back().scene.texture = TextureSpec{30.0, map_of(MapFunction::gaussian)};
    return all;
}

} // namespace forceshade::test
