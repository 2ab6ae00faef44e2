#include "host/report/space_data.h"

#include <algorithm>
#include <cmath>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/picture/scene_picture.h"
#include "host/prepare/prepared_case.h"
#include "host/scene/study.h"

namespace forceshade::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoints = 130; /* of a row; beyond that facets do not show */
constexpr std::size_t kRows = 33;
constexpr double kUnits = 20000; /* of the volume's width */
constexpr std::uint64_t kMostPaths = 8, kLeastSteps = 50, kMostSteps = 600;
constexpr std::size_t kCharactersASample = 24; /* of three vectors of three halves, compressed */

std::optional<Case> case_of(const std::string& scene) {
    try {
        return scene.empty() ? std::nullopt : std::optional(parse_scene(scene, "the volume's scene"));
    } catch (const Error&) {
        return std::nullopt;
    }
}

// Ends stay; in between every so many points.
void add_row(Json& sheet, const std::vector<picture::LinePoint>& line, double unit) {
    Json x = Json::array(), z = Json::array();
    const std::size_t every = (line.size() + kMostPoints - 1) / kMostPoints;
    for (std::size_t i = 0; i < line.size(); ++i)
        if (i % every == 0 || i + 1 == line.size()) {
            x.push_back(std::llround(line[i].x / unit));
            z.push_back(std::llround(line[i].z / unit));
        }
    sheet["x"] = std::move(x);
    sheet["z"].push_back(std::move(z));
}

} // namespace

Json surface_data(const SampledVolume& volume) {
    const std::optional<Case> one = case_of(volume.scene);
    if (!one || one->scene.surface.kind == SurfaceKind::mesh ||
        (one->scene.surface.kind == SurfaceKind::height_map && one->scene.surface.map.function == MapFunction::file))
        return {};
    PreparedCase prepared;
    prepared.one = *one;
    const auto end = [&](std::size_t axis) {
        return volume.origin[axis] + volume.spacing[axis] * static_cast<double>(volume.full[axis] - 1);
    };
    const double unit = (end(0) - volume.origin[0]) / kUnits;
    if (!(unit > 0))
        return {};
    const bool by_y = one->scene.surface.kind == SurfaceKind::height_map &&
                      one->scene.surface.map.function == MapFunction::gaussian && volume.full[1] > 1;
    Json nominal{{"unit_m", unit}}, smooth = nominal;
    for (std::size_t row = 0; row < (by_y ? kRows : 1); ++row) {
        const double y = std::lerp(volume.origin[1], end(1), static_cast<double>(row) / (kRows - 1));
        const picture::SurfaceLines lines = surface_lines(prepared, {volume.origin[0], end(0), y});
        if (row == 0)
            add_row(nominal, lines.nominal, unit);
        if (!lines.smooth.empty())
            add_row(smooth, lines.smooth, unit);
    }
    Json surface{{"nominal", std::move(nominal)}};
    if (smooth.contains("x"))
        surface["smooth"] = std::move(smooth);
    return surface;
}

Json loop_data(const std::string& scene) {
    const std::optional<Case> one = case_of(scene);
    if (!one)
        return {};
    const HandSpec& hand = one->scene.hand;
    return {{"mass", hand.mass},
            {"damping", hand.damping},
            {"grip", hand.grip_damping},
            {"delay", hand.delay_samples},
            {"period", 1 / (one->scene.paths ? one->scene.paths->rate : PathsSpec().rate)},
            {"stiffness", one->scene.force.stiffness}};
}

double path_period(const std::string& scene) {
    const std::optional<Case> one = case_of(scene);
    return one && one->scene.paths && one->scene.paths->kind != PathKind::recorded ? 1 / one->scene.paths->rate : NAN;
}

PackedPaths pack_paths(const std::filesystem::path& path, std::size_t budget) {
    const std::uint64_t samples = budget / kCharactersASample;
    const PathSamples read = read_paths(path, kMostPaths, std::clamp(samples / kMostPaths, kLeastSteps, kMostSteps));
    PackedPaths packed{{{"size", {read.steps, read.paths, 1}}}, {}};
    if (const double period = path_period(read.scene); period > 0)
        packed.about["rate_Hz"] = 1 / (period * static_cast<double>(read.every_step));
    for (const auto& [name, values] :
         {std::pair("force", &read.force), {"position", &read.position}, {"proxy", &read.proxy}}) {
        if (values->empty())
            continue;
        SampledVolume vectors;
        vectors.size = {read.steps, read.paths, 1};
        vectors.force = *values;
        PackedForce force = pack_force(vectors);
        packed.about["scale"][name] = force.scale;
        packed.vectors.emplace_back(name, std::move(force.bytes));
    }
    return packed;
}

} // namespace forceshade::report
