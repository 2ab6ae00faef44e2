#include "host/study/stability/loop.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include "host/study/stability/loop_limits.h"
#include "host/study/stability/loop_maps.h"
#include "host/study/stability/loop_tables.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

std::vector<LoopPlace> places_of(const StudyRun& run) {
    return run.scene() ? std::vector{scene_place(*run.scene())} : own_places();
}

void add_limits(std::vector<Step>& steps, StudyRun& run, const std::shared_ptr<const LoopPlace>& place) {
    const std::vector<LoopCell> cells = limit_cells(*place, run.options().quick);
    constexpr std::size_t kCells = 10; // some seconds
    for (std::size_t first = 0; first < cells.size(); first += kCells) {
        const std::vector<LoopCell> some(cells.begin() + static_cast<std::ptrdiff_t>(first),
                                         cells.begin() +
                                             static_cast<std::ptrdiff_t>(std::min(first + kCells, cells.size())));
        steps.push_back({"loop-" + place->name + "-limits-" + std::to_string(first / kCells),
                         [&run, place, some] { return limits_result(run.engine(), *place, some); }});
    }
}

void add_maps(std::vector<Step>& steps, StudyRun& run, const std::shared_ptr<const LoopPlace>& place) {
    for (const LoopMap& map : maps_of(*place, run.options().quick))
        steps.push_back({"loop-" + map.name, [&run, place, map] { return map_result(run.engine(), *place, map); }});
}

} // namespace

std::vector<Step> loop_steps(StudyRun& run) {
    std::vector<Step> steps;
    for (LoopPlace& one : places_of(run)) {
        const auto place = std::make_shared<const LoopPlace>(std::move(one));
        add_limits(steps, run, place);
        add_maps(steps, run, place);
    }
    return steps;
}

void add_loop(StudyData& data, const std::vector<Json>& results) {
    std::vector<Json> maps, limits;
    for (const Json& result : results)
        (result.contains("map") ? maps : limits).push_back(result);
    data.tables.push_back(limit_table(limits));
    data.tables.push_back(map_table(maps));
    data.tables.push_back(curve_table(maps));
    std::ranges::move(limit_figures(limits, maps), std::back_inserter(data.figures));
    std::ranges::move(map_figures(maps), std::back_inserter(data.figures));
    std::ranges::move(loop_notes(results), std::back_inserter(data.notes));
}

} // namespace forceshade::study
