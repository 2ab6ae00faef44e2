#include <fmt/format.h>

#include "host/study/energy/tables.h"

namespace forceshade::study {
namespace {

constexpr double kCurlShown = 0.5; /* of K */

Figure scatter(std::string name, std::string title, const char* caption, FigureAxis x, FigureAxis y) {
    Figure figure;
    figure.name = std::move(name);
    figure.title = std::move(title);
    figure.caption = caption;
    figure.kind = FigureKind::scatter;
    figure.table = "loops";
    figure.x = std::move(x);
    figure.y = std::move(y);
    figure.series = "scheme";
    figure.joined = true;
    return figure;
}

} // namespace

std::vector<Figure> loop_figures() {
    constexpr const char* kFiles[] = {"bump", "mesh", "god_object"};
    std::vector<Figure> figures;
    for (std::size_t i = 0; i < std::size(kGroups); ++i) {
        const Where where{{"radius_mil", "1000"}, {"group", kGroups[i]}};
        figures.push_back(scatter(
            fmt::format("error_energy_{}", kFiles[i]),
            fmt::format("Energy that a loop gives against the error of the force's direction: {}", kGroups[i]),
            "Each point is a loop over half the bump of 1000 mil, out 2 mm deep and back 1 mm deep; points of a scheme "
            "are joined from few facets to many, though no surface lies between two of them and a scheme may go from "
            "taking energy to giving it there. Left is truer in direction, down gives less energy; the dashed line "
            "passes through the loops of all groups that no other beats in both. Values below 0.001 degrees or 1e-5 "
            "are shown there. Energy that is taken from the hand counts as much as energy given.",
            {"error_shown_deg", "direction error, RMS / deg", true}, {"eta_shown", "|gained energy| / effort", true}));
        figures.back().where = where;
        figures.back().label = "facets";
        figures.back().curves = {{"front", {}, "error_shown_deg", "eta_shown", "best of all", true}};
        figures.push_back(scatter(
            fmt::format("eta_facets_{}", kFiles[i]),
            fmt::format("Energy that a loop gives against the number of facets: {}", kGroups[i]),
            "The share of the effort that a round gives back, or takes, over the facets across the bump of 1000 mil. "
            "Where a curve levels out, more facets do not make the scheme conservative.",
            {"facets", "facets, or cells, over the width", true}, {"eta_shown", "|gained energy| / effort", true}));
        figures.back().where = where;
    }
    Figure bars;
    bars.name = "eta_bars";
    bars.title = "Energy that a loop gives, by scheme, with 8 facets over the width";
    bars.caption = "The share of the effort that a round gives back over the bump of 1000 mil, by the force from the "
                   "place alone and, of meshes, by the god-object; below 0 a round takes energy from the hand "
                   "whichever way it goes.";
    bars.kind = FigureKind::bars;
    bars.table = "loops";
    bars.where = {{"radius_mil", "1000"}, {"facets", "8"}};
    bars.x = {"law", "scheme"};
    bars.y = {"eta", "gained energy / effort"};
    bars.series = "history";
    figures.push_back(std::move(bars));
    return figures;
}

std::vector<Figure> scene_figures() {
    Figure bars;
    bars.name = "eta_bars";
    bars.title = "Energy that a loop gives, by scheme";
    bars.caption = "The share of the effort that a round gives back below the scene's surface; below 0 a round takes "
                   "energy from the hand whichever way it goes. Effort is the integral of |F dl|.";
    bars.kind = FigureKind::bars;
    bars.table = "loops";
    bars.x = {"scheme", "scheme"};
    bars.y = {"eta", "gained energy / effort"};
    bars.series = "loop";
    return {bars};
}

std::vector<Figure> curl_figures(const std::vector<nlohmann::ordered_json>& maps) {
    std::vector<Figure> figures;
    for (const nlohmann::ordered_json& map : maps) {
        Figure figure;
        const std::string title = map.at("map");
        std::string name = map.at("volumes")[0].at("name");
        figure.name = "curl_" + name.substr(0, name.size() - 4);
        figure.title = fmt::format("Curl of the force: {}", title);
        figure.caption =
            "A section of x and z; colour is the work round each cell over its area and K, wherever the probe touches. "
            "Without colour a loop gives no energy; the work round a loop is the sum of the cells inside it. All maps "
            "share a scale that ends at 0.5. Along a line where the force jumps, a cell has the jump's part along the "
            "line over its width, the more the narrower cells are; colours that alternate along a slanted line are "
            "a jump across it, between samples: they cancel and are no curl.";
        figure.kind = FigureKind::map;
        figure.table = "curl";
        figure.where = {{"map", title}};
        figure.x = {"x_mm", "x / mm"};
        figure.y = {"z_mm", "z / mm"};
        figure.value = "curl_per_K";
        figure.value_label = "curl_y F / K";
        figure.value_limit = kCurlShown;
        figures.push_back(std::move(figure));
    }
    return figures;
}

} // namespace forceshade::study
