#include "host/study/energy/curl.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/ranges.h>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/output/exr_volume.h"
#include "host/program.h"

namespace forceshade::study {
namespace {

constexpr std::size_t kBlock = 8; // cells of samples along a side of a cell of the map

// Samples of the scene's grid, which has one y.
template <typename T> SectionField evaluated_section(Engine& engine, const PreparedCase& prepared) {
    const GridSpec& grid = prepared.one.scene.grid;
    SectionField field;
    for (std::size_t i = 0; i < grid.size[0]; ++i)
        field.x.push_back(grid.origin[0] + grid.spacing[0] * static_cast<double>(i));
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        field.z.push_back(grid.origin[2] + grid.spacing[2] * static_cast<double>(k));
    const Field<T> evaluated = evaluate<T>(prepared, engine);
    field.force.assign(evaluated.force.begin(), evaluated.force.end());
    field.depth.assign(evaluated.depth.begin(), evaluated.depth.end());
    return field;
}

// The grid over the middle of a region: 2.5 depths of strokes below the lowest facet to the top.
void set_section(PreparedCase& prepared, const EnergyLaw& law, const StrokeRegion& region, std::uint64_t columns) {
    const double y = 0.5 * (region.low.y + region.high.y), width = region.high.x - region.low.x;
    const auto loop = places_of_loop(law, {{region.low.x, y}, {region.high.x, y}, 0, 0}, 256);
    double low = 0, high = 0;
    if (loop) {
        const auto [lowest, highest] =
            std::ranges::minmax_element(*loop, {}, [](const glm::dvec3& at) { return at.z; });
        low = lowest->z;
        high = highest->z;
    }
    low -= 1.5 * region.deepest;
    const double spacing = width / static_cast<double>(columns * kBlock);
    const auto rows = static_cast<std::uint64_t>(std::ceil((high - low) / (spacing * kBlock)));
    Scene& scene = prepared.one.scene;
    scene.grid = {};
    scene.grid.size = {columns * kBlock + 1, 1, rows * kBlock + 1};
    scene.grid.origin = {region.low.x, y, low};
    scene.grid.spacing = {spacing, spacing, spacing};
    scene.field = true;
    scene.output.channels = layout::kChannelForce | layout::kChannelDepth;
    scene.precision = Precision::f64;
    scene.paths.reset();
}

// The force of every eighth sample.
FileRecord written(const std::filesystem::path& folder, const std::string& name, PreparedCase prepared,
                   const SectionField& field) {
    GridSpec& grid = prepared.one.scene.grid;
    std::vector<double> forces;
    for (std::size_t k = 0; k < field.z.size(); k += kBlock)
        for (std::size_t i = 0; i < field.x.size(); i += kBlock)
            forces.insert(forces.end(), &field.force[3 * field.at(i, k)], &field.force[3 * field.at(i, k)] + 3);
    for (const std::size_t axis : {std::size_t(0), std::size_t(2)}) {
        grid.size[axis] = (grid.size[axis] - 1) / kBlock + 1;
        grid.spacing[axis] *= kBlock;
    }
    VolumeHeader header;
    header.size = grid.size;
    header.origin = grid.origin;
    header.spacing = grid.spacing;
    header.scene = resolved_toml(prepared.one);
    header.version = version();
    header.omitted = fmt::format("{}", fmt::join(omissions(prepared.one.scene), ", "));
    layout::FieldChunk<double> chunk{};
    chunk.x_count = chunk.x_pitch = grid.size[0];
    chunk.y_count = grid.size[1];
    chunk.z_count = grid.size[2];
    chunk.force = forces;
    VolumeWriter writer(folder / name, header);
    writer.write(chunk, 1);
    const VolumeResult result = writer.finish();
    return {name, result.sha256, result.bytes};
}

// The mean over a block of cells; NaN where more than half of it is out of contact.
double block_mean(const std::vector<double>& curl, std::size_t columns, std::size_t i, std::size_t k) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t at = 0; at < kBlock * kBlock; ++at)
        if (const double one = curl[(k * kBlock + at / kBlock) * columns * kBlock + i * kBlock + at % kBlock];
            !std::isnan(one)) {
            sum += one;
            ++count;
        }
    return 2 * count >= kBlock * kBlock ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

std::string words_of(const EnergyLaw& law) {
    const std::string cells = law.surface == "mesh" ? "cells" : "facets";
    return law.elements ? fmt::format("{} of {} {}, {}", law.surface, *law.elements, cells, law.scheme)
                        : fmt::format("{}, {}", law.surface, law.scheme);
}

} // namespace

std::vector<double> cell_curls(const SectionField& field) {
    std::vector<double> curls;
    for (std::size_t k = 0; k + 1 < field.z.size(); ++k)
        for (std::size_t i = 0; i + 1 < field.x.size(); ++i) {
            const std::size_t corners[4] = {field.at(i, k), field.at(i + 1, k), field.at(i + 1, k + 1),
                                            field.at(i, k + 1)};
            if (!std::ranges::all_of(corners, [&](std::size_t corner) { return field.depth[corner] > 0; })) {
                curls.push_back(std::numeric_limits<double>::quiet_NaN());
                continue;
            }
            const auto [a, b, c, d] = corners;
            const auto& f = field.force;
            const double across = (f[3 * d] + f[3 * c] - f[3 * a] - f[3 * b]) / 2,
                         up = (f[3 * b + 2] + f[3 * c + 2] - f[3 * a + 2] - f[3 * d + 2]) / 2; // N
            curls.push_back(across / (field.z[k + 1] - field.z[k]) - up / (field.x[i + 1] - field.x[i]));
        }
    return curls;
}

std::vector<CurlCell> curl_map(Engine& engine, const EnergyLaw& law, const StrokeRegion& region, std::uint64_t columns,
                               const std::filesystem::path& folder, std::vector<FileRecord>& volumes) {
    PreparedCase prepared = *law.prepared;
    set_section(prepared, law, region, columns);
    const SectionField field =
        engine.report().f64 ? evaluated_section<double>(engine, prepared) : evaluated_section<float>(engine, prepared);
    const std::vector<double> curl = cell_curls(field);
    const double side = kBlock * prepared.one.scene.grid.spacing[0]; /* m: of a cell */
    std::vector<CurlCell> cells;
    for (std::size_t k = 0; k < (field.z.size() - 1) / kBlock; ++k)
        for (std::size_t i = 0; i < columns; ++i)
            if (const double mean = block_mean(curl, columns, i, k); !std::isnan(mean))
                cells.push_back({words_of(law), field.x[0] + side / 2 + side * static_cast<double>(i),
                                 field.z[0] + side / 2 + side * static_cast<double>(k),
                                 mean / prepared.one.scene.force.stiffness});
    std::string name = words_of(law);
    std::erase(name, ',');
    std::ranges::replace(name, ' ', '-');
    volumes.push_back(written(folder, name + ".exr", prepared, field));
    return cells;
}

} // namespace forceshade::study
