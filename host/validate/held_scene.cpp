#include "host/validate/held_scene.h"

namespace forceshade {
namespace {

// The nearest T. Volatile, because g++ 12 at -O2 turns two of these side by side into vectors and drops the rounding.
template <typename T> double held(double value) {
    const volatile T rounded = static_cast<T>(value);
    return static_cast<double>(rounded);
}

// Half of a length is what a kernel is given, and twice a T is exact.
template <typename T> void hold_extent(double& length) {
    length = 2 * held<T>(length / 2);
}

template <typename T> void hold_map(HeightMapSpec& map) {
    if (map.function == MapFunction::file) {
        hold_extent<T>(map.size[0]);
        hold_extent<T>(map.size[1]);
    }
    if (map.function == MapFunction::cylinder || map.function == MapFunction::dip) {
        hold_extent<T>(map.width);
        map.radius = held<T>(map.radius);
    }
}

} // namespace

template <typename T> Scene held_scene(const Scene& scene) {
    Scene result = scene;
    hold_extent<T>(result.surface.width);
    result.surface.radius = held<T>(scene.surface.radius);
    hold_map<T>(result.surface.map);
    if (result.texture)
        hold_map<T>(result.texture->map);
    return result;
}

template Scene held_scene<float>(const Scene&);
template Scene held_scene<double>(const Scene&);

} // namespace forceshade
