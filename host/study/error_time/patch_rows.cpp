#include "host/study/error_time/patch_rows.h"

#include "host/study/error_time/patch_errors.h"

namespace forceshade::study::error_time {
namespace {

struct Printed {
    double rms;
    std::optional<double> largest, jump;
};

struct PatchMesh {
    const SmoothSurface* smooth;
    Cells kind;
    unsigned cells;
    Printed flat, morgenbesser, exact; /* deg */
};

constexpr double kNone = 0; // a continuous shading's jump

const PatchMesh kMeshes[] = {
    {&kUnitCylinder, Cells::triangles, 8, {2.12, 3.77, 7.42}, {1.26, 3.76, 3.47}, {0.076, 0.131, kNone}},
    {&kUnitCylinder, Cells::triangles, 32, {0.538, 0.98, 1.99}, {0.318, 0.97, 0.898}, {0.0064, 0.0135, kNone}},
    {&kUnitCylinder, Cells::quads, 8, {2.12, 3.76, 7.42}, {1.81, 3.34, 6.48}, {0.076, 0.131, kNone}},
    {&kUnitCylinder, Cells::hexagons, 8, {1.94, 3.85, 7.57}, {1.78, 3.64, 7.03}, {0.065, 0.133, kNone}},
    {&kUnitSphere, Cells::triangles, 8, {3.01, {}, {}}, {1.79, {}, {}}, {0.200, {}, {}}},
    {&kSaddle, Cells::triangles, 8, {2.74, {}, {}}, {1.64, {}, {}}, {0.098, {}, {}}},
};

constexpr layout::uint kShadings[] = {layout::kShadingNone, layout::kShadingMorgenbesser, layout::kShadingBarycentric,
                                      layout::kShadingMeanValue};
constexpr const char* kCellNames[] = {"triangles", "quads", "hexagons"};

} // namespace

std::size_t patch_meshes() {
    return std::size(kMeshes);
}

std::vector<PatchRow> patch_rows(std::size_t mesh) {
    const PatchMesh& one = kMeshes[mesh];
    const PatchStudy study(*one.smooth, one.kind, one.cells);
    std::vector<PatchRow> rows;
    for (std::size_t i = 0; i < std::size(kShadings); ++i) {
        if (kShadings[i] == layout::kShadingBarycentric && one.kind != Cells::triangles)
            continue;
        const PatchErrors errors = study.errors(kShadings[i]);
        const Printed& printed = i == 0 ? one.flat : i == 1 ? one.morgenbesser : one.exact;
        rows.push_back({one.smooth->name,
                        kCellNames[static_cast<std::size_t>(one.kind)],
                        kPatchShadings[i],
                        one.cells,
                        {errors.rms, errors.largest, errors.jump},
                        {printed.rms, printed.largest, printed.jump}});
    }
    return rows;
}

std::vector<double> patch_rms(unsigned cells) {
    const PatchStudy study(kUnitCylinder, Cells::triangles, cells, 0.375);
    std::vector<double> rms;
    for (const layout::uint shading : kShadings)
        rms.push_back(study.errors(shading).rms);
    return rms;
}

} // namespace forceshade::study::error_time
