// "My device": what the page computes the limits of any hand's loop from.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/limits/limits.h"
#include "host/output/json.h"
#include "host/program.h"
#include "host/report/sections.h"
#include "host/scene/study.h"

namespace forceshade::report {
namespace {

// Where a loop on the surfaces of the scenes is the least stable: of the first scene with shading and the first
// without; null if there are scenes, but the files of none.
Json weak_places_data(std::span<const NamedScene> scenes) {
    Json all = scenes.empty() ? Json::array() : Json();
    bool known[2]{};
    CasePreparation preparation; // both may be of the same mesh
    for (const auto& [name, scene, weak_places] : scenes) {
        check_interrupt();
        const std::optional<Case> stated = stated_scene(scene); // else a study's own surfaces
        if (stated && std::exchange(known[stated->scene.force.shading != Shading::none], true))
            continue;
        try {
            const Json places = Json::parse(
                weak_places.empty() ? weak_places_text(forceshade::weak_places(name, preparation.prepare(*stated)))
                                    : weak_places);
            for (const Json& place : places)
                all.push_back(place);
            all = all.is_null() ? Json::array() : all;
        } catch (const Error&) { // a file that is not there or has changed
        } catch (const Json::exception&) {
        }
    }
    return all;
}

} // namespace

Json loop_data(const std::string& scene) {
    const std::optional<Case> one = stated_scene(scene);
    if (!one)
        return {};
    const HandSpec& hand = one->scene.hand;
    const double stiffness = one->scene.force.stiffness; /* N/m */
    return {{"mass", hand.mass},
            {"damping", hand.damping},
            {"grip", hand.grip_damping},
            {"spring", hand.grip_stiffness},
            {"delay", hand.delay_samples},
            {"period", 1 / (one->scene.paths ? one->scene.paths->rate : PathsSpec().rate)},
            {"stiffness", coupled_share(hand, stiffness) * stiffness}};
}

std::string device_section(std::vector<NamedScene> scenes) {
    const auto is_stated = [](const NamedScene& one) { return stated_scene(one.scene).has_value(); };
    std::erase_if(scenes, [&](const NamedScene& one) { return !is_stated(one) && one.weak_places.empty(); });
    Json data{{"scene", std::ranges::any_of(scenes, is_stated)}, {"loop", nullptr}, {"weak", weak_places_data(scenes)}};
    for (const NamedScene& one : scenes)
        if (data["loop"].is_null())
            data["loop"] = loop_data(one.scene);
    return fmt::format("<section id=\"device\">\n<h2>My device</h2>\n<script type=\"application/json\" "
                       "id=\"device-data\">{}</script>\n</section>\n",
                       script_text(data));
}

} // namespace forceshade::report
