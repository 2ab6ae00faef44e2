#include "host/study/energy/notes.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/study/energy/scenes.h"

namespace forceshade::study {
namespace {

constexpr const char* kEffort =
    "Effort is the integral of |F dl| along a loop's own way with a scheme's own force: a share of it is of what that "
    "loop costs, and between loops of different ways or forces the same energy is another share.";
constexpr const char* kSuperposed =
    "\"superposed\" is plane and cylinder, each with the force that it has alone, added up (L2): K max(0, -z) up and "
    "K max(0, R - r) away from the axis, r from the axis; its loop is below the cylinder's circle. Its direction is "
    "meant to be another than the circle's normal where both are touched.";
constexpr const char* kHeightMap =
    "\"height map on the plane\" is the plane z = 0, touched below it, whose force is turned to the normal of the "
    "height map above the probe (L5); its loop is below the plane.";
constexpr const char* kHistory =
    "A mesh's static field is the force from the nearest place of the surface. The god-object has a history: its work "
    "is added up from sample to sample both ways about, the greater counts, and below 0 both ways take energy; its "
    "direction errors are those of the static field at the same places.";
constexpr const char* kPrecision =
    "Quadrature, samples and maps are in double precision, samples and maps in single where the device has no other: "
    "a scene's own precision is not asked.";

/// "out 2 mm deep and back 1 mm"; m.
std::string depths(double out, double back) {
    return fmt::format("out {:.4g} mm deep, up, back {:.4g} mm deep, and down to where it began", 1e3 * out,
                       1e3 * back);
}

/// The way below a surface: what depths are measured from.
std::string below(SurfaceKind surface) {
    switch (surface) {
    case SurfaceKind::bump:
        return "below the scene's own facets";
    case SurfaceKind::cylinder_bump:
        return "below the cylinder's circle, and the plane beside it";
    case SurfaceKind::height_map:
        return "below the plane z = 0";
    case SurfaceKind::mesh:
        break;
    }
    return "below what a probe that comes from above first meets, straight between 64 places";
}

} // namespace

std::vector<std::string> loop_notes() {
    const LoopCase one;
    return {fmt::format("Surfaces are touched with K = {} N/m. A loop begins below the bump's middle and goes {}; it "
                        "ends at {} of half the width of {:.4g} mm. Depths are vertical.",
                        kStiffness, depths(one.out, one.back), kLoopEnd, 2e3 * kHalfWidth),
            fmt::format("Loops of \"facets\" and \"shaded\" follow the bump's own facets, so that with other facets "
                        "their ways and efforts are others; loops of meshes follow the circle that their vertices lie "
                        "on, each the mean of two lines across no symmetry of the cells. {}",
                        kEffort),
            kSuperposed,
            fmt::format("{} \"plane mesh\" is the same plane as a mesh with the cylinder's normals at its vertices.",
                        kHeightMap),
            kHistory,
            kPrecision};
}

std::vector<std::string> scene_notes(const PreparedCase& scene, const std::vector<LoopCase>& loops) {
    const SurfaceKind surface = scene.one.scene.surface.kind;
    const auto from_to = [&](const char* which) {
        const Section& section = std::ranges::find(loops, which, &LoopCase::loop)->sections.front();
        return fmt::format("\"{}\" from x = {:.4g} mm to {:.4g} mm", which, 1e3 * section.breaks.front(),
                           1e3 * section.breaks.back());
    };
    std::vector<std::string> notes{
        fmt::format("K is {:.4g} N/m. Loops are {}, at y = {:.4g} mm: {}, {}. Each goes {}. Depths are vertical.",
                    scene.one.scene.force.stiffness, below(surface), 1e3 * loops.front().sections.front().y,
                    from_to("half"), from_to("whole"), depths(loops.front().out, loops.front().back)),
        kEffort};
    if (surface == SurfaceKind::cylinder_bump)
        notes.emplace_back(kSuperposed);
    if (surface == SurfaceKind::height_map)
        notes.emplace_back(kHeightMap);
    if (surface == SurfaceKind::mesh)
        notes.emplace_back(kHistory);
    notes.emplace_back(kPrecision);
    return notes;
}

} // namespace forceshade::study
