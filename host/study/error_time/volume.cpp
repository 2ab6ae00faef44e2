#include "host/study/error_time/volume.h"

#include "host/output/rows.h"
#include "host/reference/field.h"

namespace forceshade::study::error_time {

GridSpec volume_grid(const glm::dvec3& low, const glm::dvec3& high, double spacing) {
    GridSpec grid;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        grid.origin[axis] = low[i] - 2 * spacing;
        grid.spacing[axis] = spacing;
        grid.size[axis] = static_cast<std::uint64_t>(std::ceil((high[i] - low[i]) / spacing)) + 5;
    }
    return grid;
}

std::vector<float> sampled(const PreparedCase& prepared, const GridSpec& grid) {
    Scene scene = prepared.one.scene;
    scene.output.channels = layout::kChannelForce;
    scene.grid = grid;
    const FieldTables<float> tables = make_tables<float>(scene, prepared.images, Extent::everything);
    std::vector<float> forces;
    forces.reserve(3 * grid.size[0] * grid.size[1] * grid.size[2]);
    reference::evaluate_field<float>(tables.input(), {}, [&](const layout::FieldChunk<float>& chunk) {
        append_rows(chunk, chunk.force, 3, 1, forces);
    });
    return forces;
}

} // namespace forceshade::study::error_time
