#include "host/study/error_time/lookup_volume.h"

#include <algorithm>

#include "host/prepare/tables.h"
#include "host/reference/field.h"

namespace forceshade::study::error_time {

template <typename T> Sampled<T> sampled(const PreparedCase& prepared, const VolumeGrid& grid) {
    Scene scene = prepared.one.scene;
    scene.output.channels = layout::kChannelForce | layout::kChannelFacet;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        scene.grid.size[axis] = grid.size[axis];
        scene.grid.origin[axis] = grid.origin[i];
        scene.grid.spacing[axis] = grid.spacing;
    }
    const FieldTables<T> tables = make_tables<T>(scene, prepared.images, Extent::everything);
    Sampled<T> result;
    result.forces.resize(3 * grid.samples());
    result.facets.resize(grid.samples());
    reference::evaluate_field<T>(tables.input(), {}, [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t z = 0; z < chunk.z_count; ++z)
            for (std::size_t y = 0; y < chunk.y_count; ++y) {
                const std::size_t from = (z * chunk.y_count + y) * chunk.x_pitch;
                const std::size_t to = ((chunk.z_first + z) * grid.size[1] + chunk.y_first + y) * grid.size[0];
                std::copy_n(chunk.force.begin() + static_cast<std::ptrdiff_t>(3 * from), 3 * chunk.x_count,
                            result.forces.begin() + static_cast<std::ptrdiff_t>(3 * to));
                std::copy_n(chunk.facet.begin() + static_cast<std::ptrdiff_t>(from), chunk.x_count,
                            result.facets.begin() + static_cast<std::ptrdiff_t>(to));
            }
    });
    return result;
}

template Sampled<float> sampled<float>(const PreparedCase&, const VolumeGrid&);
template Sampled<double> sampled<double>(const PreparedCase&, const VolumeGrid&);

} // namespace forceshade::study::error_time
