#include "host/study/error_time/volume.h"

#include "host/output/rows.h"
#include "host/reference/field.h"

namespace forceshade::study::error_time {

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

std::vector<float> sampled(const PreparedCase& prepared, const VolumeGrid& grid) {
    Scene scene = prepared.one.scene;
    scene.output.channels = layout::kChannelForce;
    scene.grid.size = {grid.size[0], grid.size[1], grid.size[2]};
    scene.grid.origin = {grid.origin.x, grid.origin.y, grid.origin.z};
    scene.grid.spacing = {grid.spacing, grid.spacing, grid.spacing};
    const FieldTables<float> tables = make_tables<float>(scene, prepared.images, Extent::everything);
    std::vector<float> forces;
    forces.reserve(3 * grid.samples());
    reference::evaluate_field<float>(tables.input(), {}, [&](const layout::FieldChunk<float>& chunk) {
        append_rows(chunk, chunk.force, 3, 1, forces);
    });
    return forces;
}

} // namespace forceshade::study::error_time
