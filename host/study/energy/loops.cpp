// Work round loops, by the place and with the god-object's history; and curl.
#include <algorithm>
#include <cmath>

#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include "host/field/case_law.h"
#include "host/field/engine.h"
#include "host/output/exr_volume.h"
#include "host/program.h"
#include "host/random.h"
#include "host/reference/motion.h"
#include "host/study/energy/energy.h"

namespace forceshade::study {
namespace {

constexpr std::size_t kCasts = 64; // along a stroke over a mesh; heights are straight in between

// Heights of the facets above a stroke, m, at equal shares; straight in between.
std::optional<std::vector<double>> heights_along(const EnergyLaw& law, const Stroke& stroke, std::size_t steps) {
    std::vector<double> heights;
    if (!law.prepared->images.mesh) {
        const CaseLaw<double> direct(*law.prepared);
        for (std::size_t i = 0; i <= steps; ++i)
            heights.push_back(reference::nominal_height(
                direct.law(), std::lerp(stroke.from.x, stroke.to.x, double(i) / double(steps))));
        return heights;
    }
    std::vector<double> some;
    for (std::size_t i = 0; i <= kCasts; ++i) {
        const glm::dvec2 at = glm::mix(stroke.from, stroke.to, double(i) / double(kCasts));
        const std::optional<double> height = height_at(law.prepared->images.mesh->structure, at.x, at.y);
        if (!height)
            return std::nullopt;
        some.push_back(*height);
    }
    for (std::size_t i = 0; i <= steps; ++i) {
        const double place = double(i) / double(steps) * double(kCasts);
        const auto cell = std::min(static_cast<std::size_t>(place), kCasts - 1);
        heights.push_back(std::lerp(some[cell], some[cell + 1], place - double(cell)));
    }
    return heights;
}

// Adds the work between two places whose forces are known: Simpson's rule where the force in the middle is the mean.
template <typename ForceAt>
void add_between(LoopWork& sum, ForceAt& force, const glm::dvec3& from, const glm::dvec3& one, const glm::dvec3& to,
                 const glm::dvec3& two, int halvings) {
    constexpr double kSame = 5e-6; // of both forces: less bends no more than a smooth force does in a step
    const glm::dvec3 middle = 0.5 * (from + to), half = force(middle);
    if (halvings > 0 && glm::length(half - 0.5 * (one + two)) > kSame * (glm::length(one) + glm::length(two))) {
        add_between(sum, force, from, one, middle, half, halvings - 1);
        add_between(sum, force, middle, half, to, two, halvings - 1);
        return;
    }
    sum.add(glm::dot((one + 4.0 * half + two) / 6.0, to - from));
}

} // namespace

std::vector<Stroke> drawn_strokes(const StrokeRegion& region, std::size_t count) {
    const glm::dvec2 size = region.high - region.low;
    const double least = 0.25 * std::max(size.x, size.y);
    Random draw(3);
    const auto place = [&] {
        const double x = draw(region.low.x, region.high.x); // in this order
        return glm::dvec2(x, draw(region.low.y, region.high.y));
    };
    const auto depth = [&] { return region.deepest * std::pow(10, -draw(0, 1)); };
    std::vector<Stroke> strokes;
    while (strokes.size() < count) {
        Stroke stroke;
        stroke.from = place();
        stroke.to = place();
        stroke.out = depth();
        stroke.back = depth();
        if (glm::length(stroke.to - stroke.from) >= least)
            strokes.push_back(stroke);
    }
    return strokes;
}

std::optional<std::vector<glm::dvec3>> places_of_loop(const EnergyLaw& law, const Stroke& stroke, std::size_t steps) {
    const auto heights = heights_along(law, stroke, steps);
    if (!heights)
        return std::nullopt;
    std::vector<glm::dvec3> places;
    const auto add = [&](std::size_t i, double depth) {
        const glm::dvec2 at = glm::mix(stroke.from, stroke.to, double(i) / double(steps));
        places.emplace_back(at.x, at.y, (*heights)[i] - depth);
    };
    const std::size_t upright = std::max<std::size_t>(1, steps / 8);
    for (std::size_t i = 0; i <= steps; ++i)
        add(i, stroke.out);
    for (std::size_t i = 1; i <= upright; ++i)
        add(steps, std::lerp(stroke.out, stroke.back, double(i) / double(upright)));
    for (std::size_t i = steps; i-- > 0;)
        add(i, stroke.back);
    for (std::size_t i = 1; i <= upright; ++i)
        add(0, std::lerp(stroke.back, stroke.out, double(i) / double(upright)));
    return places;
}

std::optional<LoopWork> work_by_place(const EnergyLaw& law, const std::vector<glm::dvec3>& places) {
    constexpr int kHalvings = 24; // of a step: the error of a jump is a ten-millionth of its force times the step
    const CaseLaw<double> direct(*law.prepared);
    layout::uint hint = 0;
    bool touches = true;
    auto force = [&](const glm::dvec3& at) {
        const reference::Contact<double> contact = direct.at(at, hint);
        touches = touches && contact.facet != layout::kNoFacet;
        return glm::dvec3(contact.force);
    };
    LoopWork sum;
    glm::dvec3 before = force(places.front());
    for (std::size_t i = 1; i < places.size(); ++i) {
        const glm::dvec3 now = force(places[i]);
        add_between(sum, force, places[i - 1], before, places[i], now, kHalvings);
        before = now;
    }
    return touches ? std::optional(sum) : std::nullopt;
}

std::vector<glm::dvec3> path_of_loop(const EnergyLaw& law, const std::vector<glm::dvec3>& places) {
    constexpr std::size_t kDescent = 16;
    constexpr double kClear = 1e-3; // m: above an analytic surface
    const glm::dvec3& first = places.front();
    glm::dvec3 above = first;
    if (law.prepared->images.mesh) {
        const auto box = bounding_box(law.prepared->images.mesh->mesh.polygons);
        above.z = box.high[2] + (box.high[2] - box.low[2]) / 100;
    } else {
        above.z = reference::nominal_height(CaseLaw<double>(*law.prepared).law(), first.x) + kClear;
    }
    std::vector<glm::dvec3> path;
    for (std::size_t i = 0; i < kDescent; ++i)
        path.push_back(glm::mix(above, first, double(i) / kDescent));
    for (int round = 0; round < 2; ++round)
        path.insert(path.end(), places.begin() + (round > 0), places.end());
    return path;
}

LoopWork work_of_last(const std::vector<glm::dvec3>& path, const std::vector<glm::dvec3>& forces, std::size_t steps) {
    LoopWork sum;
    for (std::size_t i = path.size() - steps; i < path.size(); ++i)
        sum.add(glm::dot(0.5 * (forces[i - 1] + forces[i]), path[i] - path[i - 1]));
    return sum;
}

std::optional<LoopWork> work_by_history(const EnergyLaw& law, const std::vector<glm::dvec3>& places) {
    CaseProbe<double> probe(*law.prepared);
    const std::vector<glm::dvec3> path = path_of_loop(law, places);
    const std::size_t steps = places.size() - 1;
    std::vector<glm::dvec3> forces;
    bool touches = true;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const auto contact = probe.at(path[i]).contact;
        forces.emplace_back(contact.force);
        touches = touches && (i + steps < path.size() || contact.facet != layout::kNoFacet);
    }
    return touches ? std::optional(work_of_last(path, forces, steps)) : std::nullopt;
}

// Curl of a force field in a section, from the volume that an engine evaluates.
namespace {

constexpr std::size_t kBlock = 8; // cells of samples along a side of a cell of the section

// Samples of the scene's grid, which has one y.
template <typename T> SectionField evaluated_section(Engine& engine, const PreparedCase& prepared) {
    const GridSpec& grid = prepared.one.scene.grid;
    SectionField field;
    for (std::size_t i = 0; i < grid.size[0]; ++i)
        field.x.push_back(grid.at(0, i));
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        field.z.push_back(grid.at(2, k));
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
    return 2 * count >= kBlock * kBlock ? sum / static_cast<double>(count) : NAN;
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
                curls.push_back(NAN);
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
