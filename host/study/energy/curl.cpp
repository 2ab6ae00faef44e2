#include "host/study/energy/curl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/ranges.h>

#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/program.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMapColumns = 61, kMapRows = 30; /* cells of a map in the table, at most */

template <typename T> SectionField evaluated_in(Engine& engine, const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    const FieldTables<T> tables = make_tables<T>(scene, prepared.images, Extent::everything);
    SectionField field;
    for (std::size_t i = 0; i < scene.grid.size[0]; ++i)
        field.x.push_back(scene.grid.origin[0] + scene.grid.spacing[0] * static_cast<double>(i));
    for (std::size_t k = 0; k < scene.grid.size[2]; ++k)
        field.z.push_back(scene.grid.origin[2] + scene.grid.spacing[2] * static_cast<double>(k));
    field.force.resize(3 * field.x.size() * field.z.size());
    field.depth.resize(field.x.size() * field.z.size());
    engine.evaluate(tables.input(), [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t k = 0; k < chunk.z_count; ++k)
            for (std::size_t i = 0; i < chunk.x_count; ++i) {
                const std::size_t from = k * chunk.y_count * chunk.x_pitch + i, to = field.at(i, chunk.z_first + k);
                field.depth[to] = static_cast<double>(chunk.depth[from]);
                for (std::size_t c = 0; c < 3; ++c)
                    field.force[3 * to + c] = static_cast<double>(chunk.force[3 * from + c]);
            }
    });
    return field;
}

VolumeHeader header_of(const PreparedCase& prepared, const GridSpec& grid, const std::string& remark) {
    const Scene& scene = prepared.one.scene;
    VolumeHeader header;
    header.size = grid.size;
    header.origin = grid.origin;
    header.spacing = grid.spacing;
    header.scene = remark + prepared.scene;
    header.version = version();
    header.omitted = fmt::format("{}", fmt::join(omissions(scene), ", "));
    return header;
}

/// Force, and depth if there is one.
Json written(const std::filesystem::path& folder, const std::string& name, VolumeHeader header,
             std::span<const double> vectors, std::span<const double> depth) {
    header.channels = depth.empty() ? layout::kChannelForce : layout::kChannelForce | layout::kChannelDepth;
    layout::FieldChunk<double> chunk{};
    chunk.x_count = chunk.x_pitch = header.size[0];
    chunk.y_count = header.size[1];
    chunk.z_count = header.size[2];
    chunk.force = vectors;
    chunk.depth = depth;
    VolumeWriter writer(folder / name, header);
    writer.write(chunk, 1);
    const VolumeResult result = writer.finish();
    return {{"name", name}, {"sha256", result.sha256}, {"bytes", result.bytes}};
}

/// Blocks of cells, one a cell of the map.
struct Blocks {
    std::size_t across, up;     /* cells of a block */
    std::size_t columns, rows;  /* blocks */
    GridSpec grid;              /* of their middles, m */
    std::vector<double> curl_y; /* N/m: means; NaN where more than half is unknown */
};

/// The means over the blocks of `across` x `up` cells of a field.
std::vector<double> block_means(const Blocks& blocks, std::size_t across, std::size_t up,
                                const std::vector<double>& curl, std::size_t across_all) {
    std::vector<double> means;
    for (std::size_t block = 0; block < blocks.columns * blocks.rows; ++block) {
        const std::size_t i = block % blocks.columns * across, k = block / blocks.columns * up, all = across * up;
        double sum = 0;
        std::size_t count = 0;
        for (std::size_t at = 0; at < all; ++at)
            if (const double value = curl[(k + at / across) * across_all + i + at % across]; !std::isnan(value)) {
                sum += value;
                ++count;
            }
        means.push_back(2 * count >= all ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN());
    }
    return means;
}

/// Of an even number of cells each way, so that half as many samples have the same blocks.
Blocks blocks_of(const SectionField& field, const std::vector<double>& curl, const GridSpec& fine) {
    const std::size_t across_all = field.x.size() - 1, up_all = field.z.size() - 1;
    const auto stride = [](std::size_t cells, std::size_t most) { return 2 * ((cells + 2 * most - 1) / (2 * most)); };
    Blocks blocks{stride(across_all, kMapColumns), stride(up_all, kMapRows), 0, 0, fine, {}};
    blocks.columns = across_all / blocks.across;
    blocks.rows = up_all / blocks.up;
    blocks.grid.size = {blocks.columns, 1, blocks.rows};
    const std::size_t counts[3] = {blocks.across, 1, blocks.up};
    for (const std::size_t axis : {std::size_t(0), std::size_t(2)}) {
        blocks.grid.spacing[axis] *= static_cast<double>(counts[axis]);
        blocks.grid.origin[axis] += blocks.grid.spacing[axis] / 2;
    }
    blocks.curl_y = block_means(blocks, blocks.across, blocks.up, curl, across_all);
    return blocks;
}

/// How far cells are from the closed form at their middles, at most, N/m.
double closed_form_difference(const CurlMap& map, const SectionField& field, const std::vector<double>& curl) {
    double most = 0;
    const std::size_t columns = field.x.size() - 1;
    for (std::size_t cell = 0; cell < curl.size(); ++cell) {
        const std::size_t i = cell % columns, k = cell / columns;
        const double off = std::abs(curl[cell] - map.closed_form(std::midpoint(field.x[i], field.x[i + 1]),
                                                                 std::midpoint(field.z[k], field.z[k + 1])));
        most = std::isnan(off) ? most : std::max(most, off);
    }
    return most;
}

struct Sizes {
    double largest = 0, sum = 0; /* N/m */
    std::size_t count = 0;
    Json mean(double stiffness) const { return count ? Json(sum / static_cast<double>(count) / stiffness) : Json(); }
};

/// Of the numbers that are known.
Sizes sizes_of(const std::vector<double>& values) {
    Sizes sizes;
    for (const double value : values) {
        if (std::isnan(value))
            continue;
        sizes.largest = std::max(sizes.largest, std::abs(value));
        sizes.sum += std::abs(value);
        ++sizes.count;
    }
    return sizes;
}

/// What the blocks' means change by where every second sample is left out, N/m. At a jump of the force the work round
/// a cell depends on where samples lie; what is left of that in a mean shrinks with their spacing, curl does not.
std::vector<double> changes_of_half(const SectionField& field, const Blocks& blocks) {
    const SectionField half = every_second(field);
    std::vector<double> changes =
        block_means(blocks, blocks.across / 2, blocks.up / 2, cell_curls(half), half.x.size() - 1);
    for (std::size_t i = 0; i < changes.size(); ++i)
        changes[i] -= blocks.curl_y[i];
    return changes;
}

Json cells_of(const Blocks& blocks, double stiffness) {
    Json cells = Json::array();
    const GridSpec& grid = blocks.grid;
    for (std::size_t block = 0; block < blocks.curl_y.size(); ++block)
        if (!std::isnan(blocks.curl_y[block]))
            cells.push_back({grid.origin[0] + grid.spacing[0] * static_cast<double>(block % blocks.columns),
                             grid.origin[2] + grid.spacing[2] * static_cast<double>(block / blocks.columns),
                             blocks.curl_y[block] / stiffness});
    return cells;
}

/// Of the field every sample at a block's lower corner.
Json written_force(const CurlMap& map, const SectionField& field, const Blocks& blocks,
                   const std::filesystem::path& folder) {
    const GridSpec& fine = map.prepared.one.scene.grid;
    GridSpec grid = blocks.grid;
    grid.origin = fine.origin;
    grid.size = {blocks.columns + 1, 1, blocks.rows + 1};
    std::vector<double> force, depth;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        for (std::size_t i = 0; i < grid.size[0]; ++i) {
            const std::size_t from = field.at(i * blocks.across, k * blocks.up);
            force.insert(force.end(), &field.force[3 * from], &field.force[3 * from] + 3);
            depth.push_back(field.depth[from]);
        }
    return written(folder, map.name + ".exr", header_of(map.prepared, grid, ""), force, depth);
}

Json written_curl(const CurlMap& map, const Blocks& blocks, const std::filesystem::path& folder) {
    std::vector<double> vectors(3 * blocks.curl_y.size());
    for (std::size_t i = 0; i < blocks.curl_y.size(); ++i)
        vectors[3 * i + 1] = std::isnan(blocks.curl_y[i]) ? 0 : blocks.curl_y[i];
    return written(folder, map.name + ".curl.exr",
                   header_of(map.prepared, blocks.grid,
                             "# curl of this scene's force in N/m: R, G, B are curl_x, curl_y, curl_z; of them only "
                             "curl_y was computed\n"),
                   vectors, {});
}

} // namespace

SectionField evaluated_section(Engine& engine, const PreparedCase& prepared) {
    return engine.report().f64 ? evaluated_in<double>(engine, prepared) : evaluated_in<float>(engine, prepared);
}

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
                         up = (f[3 * b + 2] + f[3 * c + 2] - f[3 * a + 2] - f[3 * d + 2]) / 2; /* N */
            curls.push_back(across / (field.z[k + 1] - field.z[k]) - up / (field.x[i + 1] - field.x[i]));
        }
    return curls;
}

SectionField every_second(const SectionField& field) {
    SectionField half;
    for (std::size_t i = 0; i < field.x.size(); i += 2)
        half.x.push_back(field.x[i]);
    for (std::size_t k = 0; k < field.z.size(); k += 2) {
        half.z.push_back(field.z[k]);
        for (std::size_t i = 0; i < field.x.size(); i += 2) {
            const double* force = &field.force[3 * field.at(i, k)];
            half.force.insert(half.force.end(), force, force + 3);
            half.depth.push_back(field.depth[field.at(i, k)]);
        }
    }
    return half;
}

Json curl_result(const CurlMap& map, Engine& engine, const std::filesystem::path& folder) {
    const SectionField field = evaluated_section(engine, map.prepared);
    const std::vector<double> curl = cell_curls(field);
    const double stiffness = map.prepared.one.scene.force.stiffness;
    const Blocks blocks = blocks_of(field, curl, map.prepared.one.scene.grid);
    const Sizes sizes = sizes_of(blocks.curl_y);
    Json result{{"map", map.title},
                {"scheme", map.scheme},
                {"spacing_mm", 1e3 * map.prepared.one.scene.grid.spacing[0]},
                {"cell_mm", 1e3 * blocks.grid.spacing[0]}};
    result["largest_per_K"] = sizes.largest / stiffness;
    result["mean_per_K"] = sizes.mean(stiffness);
    result["sampling_per_K"] = sizes_of(changes_of_half(field, blocks)).mean(stiffness);
    if (map.closed_form)
        result["closed_form_difference_per_K"] = closed_form_difference(map, field, curl) / stiffness;
    result["cells"] = cells_of(blocks, stiffness);
    result["volumes"] = Json::array({written_force(map, field, blocks, folder), written_curl(map, blocks, folder)});
    return result;
}

} // namespace forceshade::study
