#include "host/study/energy/energy.h"

#include <fmt/format.h>

#include "host/program.h"
#include "host/study/energy/curl_maps.h"
#include "host/study/energy/energy_findings.h"
#include "host/study/energy/loop_cases.h"
#include "host/study/energy/notes.h"
#include "host/study/energy/scene_loops.h"
#include "host/study/energy/scenes.h"
#include "host/study/energy/tables.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

struct Form {
    std::vector<unsigned> facets, cells;
    unsigned plane_cells;
    std::uint64_t columns; /* of a curl map */
};

Form form_of(bool quick) {
    if (quick)
        return {{1, 2, 8, 32}, {4, 8}, 64, 163};
    return {{1, 2, 3, 4, 8, 16, 32, 128, 512}, {4, 8, 16, 32, 64}, 256, 1297};
}

Json rows_of(const std::vector<LoopCase>& loops, Engine& engine) {
    Json rows = Json::array();
    for (const LoopCase& one : loops)
        rows.push_back(loop_row(one, engine));
    return rows;
}

/// A step a loop, which of a scene may take long.
std::vector<Step> scene_steps(StudyRun& run, const std::vector<LoopCase>& loops) {
    std::vector<Step> steps;
    for (std::size_t i = 0; i < loops.size(); ++i)
        steps.push_back({fmt::format("scene-{}", i),
                         [&run, one = loops[i]] { return Json::array({loop_row(one, run.engine())}); }});
    return steps;
}

std::vector<Step> loop_steps(StudyRun& run, const Form& form) {
    std::vector<Step> steps;
    for (const double radius : kPaperRadii) {
        steps.push_back({fmt::format("bump-{}", radius),
                         [&run, radius, form] { return rows_of(bump_loops(radius, form.facets), run.engine()); }});
        steps.push_back({fmt::format("plane-mesh-{}", radius), [&run, radius, form] {
                             return rows_of(plane_mesh_loops(radius, form.plane_cells), run.engine());
                         }});
    }
    for (const MeshCells kind : {MeshCells::triangles, MeshCells::quads})
        for (const unsigned cells : form.cells)
            steps.push_back({fmt::format("{}-{}", kind == MeshCells::quads ? "quads" : "triangles", cells),
                             [&run, kind, cells] { return rows_of(mesh_loops(kind, cells), run.engine()); }});
    return steps;
}

std::vector<Step> curl_steps(StudyRun& run, const Form& form) {
    std::vector<Step> steps;
    for (const CurlMap& map : run.scene() ? scene_curl_maps(*run.scene(), form.columns) : curl_maps(form.columns))
        steps.push_back(
            {"curl-" + map.name, [&run, map] { return curl_result(map, run.engine(), run.options().folder); }});
    return steps;
}

} // namespace

StudyData study_energy(StudyRun& run) {
    const Form form = form_of(run.options().quick);
    const std::vector<LoopCase> of_scene = run.scene() ? scene_loops(*run.scene()) : std::vector<LoopCase>();
    std::vector<Step> loops = run.scene() ? scene_steps(run, of_scene) : loop_steps(run, form);
    std::vector<Step> curls = curl_steps(run, form), all = loops;
    all.insert(all.end(), curls.begin(), curls.end());
    const std::vector<Json> results = run.run_steps(all);
    const auto middle = results.begin() + static_cast<std::ptrdiff_t>(loops.size());
    std::vector<Json> rows, maps(middle, results.end());
    for (auto result = results.begin(); result != middle; ++result)
        rows.insert(rows.end(), result->begin(), result->end());
    StudyData data = run.data();
    data.notes = run.scene() ? scene_notes(*run.scene(), of_scene) : loop_notes();
    data.tables.push_back(loops_table(rows));
    const Table table = data.tables.front();
    if (!run.scene()) {
        data.tables.push_back(laws_table(table));
        data.tables.push_back(equal_error_table(table));
        data.tables.push_back(front_table(table));
    }
    data.tables.push_back(curl_maps_table(maps));
    data.tables.push_back(curl_table(maps));
    data.figures = run.scene() ? scene_figures() : loop_figures();
    for (Figure& figure : curl_figures(maps))
        data.figures.push_back(std::move(figure));
    for (const Json& map : maps)
        for (const Json& volume : map.at("volumes"))
            data.volumes.push_back({volume.at("name"), volume.at("sha256"), volume.at("bytes")});
    data.findings = energy_findings(data);
    return data;
}

} // namespace forceshade::study
