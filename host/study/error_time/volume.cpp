#include "host/study/error_time/volume.h"

#include <algorithm>

#include "host/output/rows.h"
#include "host/reference/field.h"

namespace forceshade::study::error_time {

std::vector<Half> halves_of(std::span<const float> numbers) {
    std::vector<Half> halves(numbers.size());
    encode_row(numbers, PixelFormat::half, reinterpret_cast<std::byte*>(halves.data()));
    return halves;
}

VolumeGrid volume_grid(const glm::dvec3& low, const glm::dvec3& high, double spacing) {
    VolumeGrid grid;
    grid.spacing = spacing;
    for (int axis = 0; axis < 3; ++axis) {
        grid.origin[axis] = low[axis] - 2 * spacing;
        grid.size[static_cast<std::size_t>(axis)] =
            static_cast<std::size_t>(std::ceil((high[axis] - low[axis]) / spacing)) + 5;
    }
    return grid;
}

template <typename T> std::vector<T> sampled(const PreparedCase& prepared, const VolumeGrid& grid) {
    Scene scene = prepared.one.scene;
    scene.output.channels = layout::kChannelForce;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        scene.grid.size[axis] = grid.size[axis];
        scene.grid.origin[axis] = grid.origin[i];
        scene.grid.spacing[axis] = grid.spacing;
    }
    const FieldTables<T> tables = make_tables<T>(scene, prepared.images, Extent::everything);
    std::vector<T> forces(3 * grid.samples());
    reference::evaluate_field<T>(tables.input(), {}, [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t z = 0; z < chunk.z_count; ++z)
            for (std::size_t y = 0; y < chunk.y_count; ++y) {
                const std::size_t from = (z * chunk.y_count + y) * chunk.x_pitch;
                const std::size_t to = ((chunk.z_first + z) * grid.size[1] + chunk.y_first + y) * grid.size[0];
                std::copy_n(chunk.force.begin() + static_cast<std::ptrdiff_t>(3 * from), 3 * chunk.x_count,
                            forces.begin() + static_cast<std::ptrdiff_t>(3 * to));
            }
    });
    return forces;
}

template std::vector<float> sampled<float>(const PreparedCase&, const VolumeGrid&);
template std::vector<double> sampled<double>(const PreparedCase&, const VolumeGrid&);

} // namespace forceshade::study::error_time
