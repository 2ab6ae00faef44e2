#include "host/study/omission/touched.h"

#include "host/norm.h"
#include "host/study/omission/side.h"

namespace forceshade::study {
namespace {

template <typename T> std::uint64_t with_force(Engine& engine, const Setup& setup, bool paths) {
    const std::vector<T> force = make_side<T>(setup, paths)->capture(engine, 0).force;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i + 2 < force.size(); i += 3)
        count += norm(double(force[i]), double(force[i + 1]), double(force[i + 2])) > 0;
    return count;
}

std::uint64_t with_force(Engine& engine, const BaseScene& base, bool paths) {
    Setup setup{base.prepared, "all"};
    Scene& scene = setup.prepared.one.scene;
    scene.field = !paths;
    return scene.precision == Precision::f32 ? with_force<float>(engine, setup, paths)
                                             : with_force<double>(engine, setup, paths);
}

} // namespace

Touched touched(Engine& engine, const BaseScene& base) {
    Touched samples;
    if (base.field)
        samples.field = with_force(engine, base, false);
    if (base.paths)
        samples.paths = with_force(engine, base, true);
    return samples;
}

} // namespace forceshade::study
