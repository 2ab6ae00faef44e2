#include "host/study/energy/curl.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/ranges.h>

#include "host/io/exr_volume.h"
#include "host/version.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMapColumns = 81, kMapRows = 40; /* cells of a map in the table, at most */

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

VolumeHeader header_of(const PreparedCase& prepared, const std::string& remark) {
    const Scene& scene = prepared.one.scene;
    VolumeHeader header;
    header.size = scene.grid.size;
    header.origin = scene.grid.origin;
    header.spacing = scene.grid.spacing;
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

/// Every so many samples, so that a map has no more cells than it can show.
std::size_t stride(std::size_t samples, std::size_t most) {
    return (samples + most - 1) / most;
}

struct Summary {
    double largest = 0, squares = 0, off = 0; /* N/m */
    std::size_t count = 0;
};

Summary summary_of(const CurlMap& map, const SectionField& field, const std::vector<double>& curl) {
    Summary summary;
    for (std::size_t k = 0; k < field.z.size(); ++k)
        for (std::size_t i = 0; i < field.x.size(); ++i) {
            const double value = curl[field.at(i, k)];
            if (std::isnan(value))
                continue;
            summary.largest = std::max(summary.largest, std::abs(value));
            summary.squares += value * value;
            ++summary.count;
            if (map.closed_form)
                summary.off = std::max(summary.off, std::abs(value - map.closed_form(field.x[i], field.z[k])));
        }
    return summary;
}

/// Means over blocks, so that the circulation round a cell is its value times its area: x, z, curl / K.
Json cells_of(const SectionField& field, const std::vector<double>& curl, double stiffness) {
    Json cells = Json::array();
    const std::size_t across = stride(field.x.size(), kMapColumns), up = stride(field.z.size(), kMapRows);
    for (std::size_t k = 0; k + up <= field.z.size(); k += up)
        for (std::size_t i = 0; i + across <= field.x.size(); i += across) {
            double sum = 0;
            std::size_t count = 0;
            for (std::size_t at = 0; at < up * across; ++at)
                if (const double value = curl[field.at(i + at % across, k + at / across)]; !std::isnan(value)) {
                    sum += value;
                    ++count;
                }
            if (2 * count >= up * across)
                cells.push_back({std::midpoint(field.x[i], field.x[i + across - 1]),
                                 std::midpoint(field.z[k], field.z[k + up - 1]),
                                 sum / static_cast<double>(count) / stiffness});
        }
    return cells;
}

} // namespace

SectionField evaluated_section(Engine& engine, const PreparedCase& prepared) {
    return engine.report().f64 ? evaluated_in<double>(engine, prepared) : evaluated_in<float>(engine, prepared);
}

std::vector<double> curl_y(const SectionField& field) {
    std::vector<double> curl(field.depth.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 1; k + 1 < field.z.size(); ++k)
        for (std::size_t i = 1; i + 1 < field.x.size(); ++i) {
            const std::size_t left = field.at(i - 1, k), right = field.at(i + 1, k), below = field.at(i, k - 1),
                              above = field.at(i, k + 1);
            const auto touches = [&](std::size_t sample) { return field.depth[sample] > 0; };
            if (touches(left) && touches(right) && touches(below) && touches(above))
                curl[field.at(i, k)] =
                    (field.force[3 * above] - field.force[3 * below]) / (field.z[k + 1] - field.z[k - 1]) -
                    (field.force[3 * right + 2] - field.force[3 * left + 2]) / (field.x[i + 1] - field.x[i - 1]);
        }
    return curl;
}

Json curl_result(const CurlMap& map, Engine& engine, const std::filesystem::path& folder) {
    const SectionField field = evaluated_section(engine, map.prepared);
    const std::vector<double> curl = curl_y(field);
    const double stiffness = map.prepared.one.scene.force.stiffness;
    std::vector<double> vectors(3 * curl.size());
    for (std::size_t i = 0; i < curl.size(); ++i)
        vectors[3 * i + 1] = std::isnan(curl[i]) ? 0 : curl[i];
    const Summary summary = summary_of(map, field, curl);
    Json result{{"map", map.title}, {"spacing_mm", 1e3 * map.prepared.one.scene.grid.spacing[0]}};
    result["largest_per_K"] = summary.largest / stiffness;
    result["rms_per_K"] =
        summary.count ? Json(std::sqrt(summary.squares / static_cast<double>(summary.count)) / stiffness) : Json();
    if (map.closed_form)
        result["closed_form_difference_per_K"] = summary.off / stiffness;
    result["cells"] = cells_of(field, curl, stiffness);
    result["volumes"] = Json::array(
        {written(folder, map.name + ".exr", header_of(map.prepared, ""), field.force, field.depth),
         written(folder, map.name + ".curl.exr",
                 header_of(map.prepared, "# curl of this scene's force in N/m: R, G, B are curl_x, curl_y, curl_z; of "
                                         "them only curl_y was computed\n"),
                 vectors, {})});
    return result;
}

bool has_volumes(const Json& result, const std::filesystem::path& folder) {
    return std::ranges::all_of(result.at("volumes"), [&](const Json& volume) {
        return volume_is_intact(folder / volume.at("name").get<std::string>(), volume.at("sha256"));
    });
}

} // namespace forceshade::study
