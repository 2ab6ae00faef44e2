#include <set>

#include <fmt/format.h>

#include "host/study/stability/loop_maps.h"
#include "host/study/stability/loop_tables.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

const LoopAxisWords& axis_words(const Json& range) {
    return words_of(static_cast<LoopAxis>(range.at("axis").get<std::size_t>()));
}

FigureAxis axis_of(const Json& range) {
    const LoopAxisWords& words = axis_words(range);
    return {words.column, words.label, true};
}

std::string held_values(const Json& map) {
    std::string text;
    for (std::size_t i = 0; i < kLoopAxes; ++i) {
        const LoopAxisWords& words = words_of(static_cast<LoopAxis>(i));
        const double value = map.at("nominal").at(i).get<double>() * words.in_column;
        const bool varies = axis_words(map.at("x")).name == words.name || axis_words(map.at("y")).name == words.name;
        const bool follows = std::string_view(axis_words(map.at("y")).name) == "delay" &&
                             std::string_view(words.name) == "rate"; // a delay of one sample
        if (!varies && !follows && value != 0)
            text += fmt::format("{}{} {:.4g} {}", text.empty() ? "" : ", ", words.name, value, words.unit);
    }
    return text;
}

// Rounding or friction is along its side, or a hand that rounds was given.
bool is_rounded(const Json& map) {
    const auto along = [&](LoopAxis axis) { return axis_words(map.at("y")).name == words_of(axis).name; };
    return along(LoopAxis::quantum) || along(LoopAxis::friction) ||
           map.at("nominal").at(static_cast<std::size_t>(LoopAxis::quantum)).get<double>() > 0;
}

// "2 mm deep at x = 6.5 mm, y = 0 mm, where a spring of 200 N/m holds it sideways"
std::string place_of(const Json& pressed) {
    const double grip = pressed.at("grip");
    return fmt::format("{:.4g} mm deep at x = {:.4g} mm, y = {:.4g} mm, where {}",
                       1e3 * pressed.at("depth").get<double>(), 1e3 * pressed.at("rest").at(0).get<double>(),
                       1e3 * pressed.at("rest").at(1).get<double>(),
                       grip > 0 ? fmt::format("a spring of {:.4g} N/m holds it{}", grip,
                                              pressed.at("held").get<bool>() ? "" : " sideways")
                                : std::string("nothing holds it sideways"));
}

std::string caption_of(const Json& map) {
    std::string text = fmt::format("Each cell is a loop of its own, a hand of {:.4g} kg pressed into the {} ({}) and "
                                   "pushed off its place; held fixed: {}. ",
                                   map.at("mass").get<double>(), map.at("title").get<std::string>(),
                                   place_of(map.at("pressed")), held_values(map));
    if (is_rounded(map) && map.at("place") == "plane")
        return text + "Left of the curves for damping and for friction every loop is to come to rest; right of the "
                      "latter positions chatter between two quanta, which friction no longer holds.";
    if (is_rounded(map))
        return text +
               "The curves for damping and for friction are a wall's, left of which every loop comes to rest there; "
               "where the colour changes left of both, this surface gives way sooner than a wall.";
    return text +
           "Loops left of the curve of the closed form decay, those right of it go on, bounded or not: where the "
           "colour changes on the curve, closed form and paths agree.";
}

Figure map_figure(const Json& map) {
    Figure figure;
    figure.kind = FigureKind::map;
    figure.name = "loop-" + map.at("map").get<std::string>();
    figure.title = fmt::format("{}: {} and {}", map.at("title").get<std::string>(), axis_words(map.at("x")).name,
                               axis_words(map.at("y")).name);
    figure.caption = caption_of(map);
    figure.table = "loop_map";
    figure.where = {{"map", map.at("map").get<std::string>()}};
    figure.x = axis_of(map.at("x"));
    figure.y = axis_of(map.at("y"));
    figure.value = "state";
    figure.value_label = "comes to";
    figure.value_words = is_rounded(map) ? std::vector<std::string>{"stable", "limit cycle", "unstable", "one quantum"}
                                         : std::vector<std::string>{"stable", "limit cycle", "unstable"};
    for (const Json& curve : map.at("curves"))
        figure.curves.push_back({"loop_curves",
                                 {{"map", map.at("map").get<std::string>()}, {"curve", curve.at("name")}},
                                 figure.x.column,
                                 figure.y.column,
                                 curve.at("label"),
                                 curve.at("dashed").get<bool>()});
    return figure;
}

Figure disagreement_figure() {
    Figure figure;
    figure.name = "loop-disagreement";
    figure.title = "Limits found by paths against closed forms";
    figure.caption =
        "Each point is a hand, a rate and a surface: how far the stiffness at which paths stop decaying "
        "lies from K_crit on the plane, from the linearised loop elsewhere. Points below 1 % keep what the "
        "study promises of the plane; those of shaped surfaces rise where a disturbance is not small.";
    figure.table = "loop_limits";
    figure.x = {"closed_form_N_per_m", "limit of the closed form / (N/m)", true};
    figure.y = {"disagreement_size_percent", "relative disagreement / %", true};
    figure.series = "series";
    return figure;
}

Figure bearing_figure(const Json& point) {
    Figure figure;
    figure.name = "loop-limits";
    figure.title = "What stiffness each surface bears";
    figure.caption = fmt::format("The limit found by paths over damping, with {} kg at {} Hz. A wall bears in "
                                 "proportion to damping, as K_crit says; a surface whose shaded direction turns "
                                 "with the place may bear far less, or no more for any damping.",
                                 point.at("mass").get<double>(), point.at("rate").get<double>());
    figure.table = "loop_limits";
    figure.where = {{"mass_kg", fmt::format("{}", point.at("mass").get<double>())},
                    {"rate_Hz", fmt::format("{}", point.at("rate").get<double>())},
                    {"delay_samples", "0"}};
    figure.x = {"damping_N_s_per_m", "damping / (N s/m)", true};
    figure.y = {"measured_N_per_m", "largest stable stiffness / (N/m)", true};
    figure.series = "series";
    figure.joined = true;
    return figure;
}

// Closed forms that some map over stiffness and damping has, each once.
void add_forms(Figure& figure, const std::vector<Json>& maps) {
    std::set<std::string> drawn;
    for (const Json& map : maps) {
        if (axis_words(map.at("y")).name != words_of(LoopAxis::damping).name)
            continue;
        for (const Json& curve : map.at("curves")) {
            const std::string name = curve.at("name");
            if ((name == "K_crit" || name == "flutter") && drawn.insert(name).second)
                figure.curves.push_back({"loop_curves",
                                         {{"map", map.at("map").get<std::string>()}, {"curve", name}},
                                         words_of(LoopAxis::damping).column,
                                         words_of(LoopAxis::stiffness).column,
                                         curve.at("label"),
                                         true});
        }
    }
}

} // namespace

std::vector<std::string> loop_notes(const std::vector<Json>& results) {
    std::vector<std::string> notes{
        "Every loop is one path of a kernel of paths: a mass with damping that a constant force presses into the "
        "surface, "
        "the surface's force sampled and held, hand and device stepped exactly. The device's largest force is left "
        "out.",
        "A loop of a map begins a tenth of its depth too deep and a little aside, half of it with rounding and "
        "friction. "
        "It is stable if its largest speed in the last quarter of the time is below 3/4 of that in the second, or "
        "below "
        "a millionth of the disturbance's (in single precision a hundredth), or falls and is too slow to come a tenth "
        "of "
        "the disturbance in that quarter, or if the measured position does not change any more; unstable if it comes "
        "further than three depths from its place (a force that comes late is not there in the first sample, and twice "
        "the swing that this makes is allowed beyond); else a limit cycle, and if the measured position goes no "
        "further "
        "than one quantum on any axis, a chatter of one quantum.",
        "Limits are found by paths alone: by the growth of a disturbance of a ten-thousandth of the depth (in single "
        "precision a fiftieth), between "
        "neighbours that lie less than 0.1 % apart.",
        "A delay is none or one sample, as long as the rate makes it. With rounding, the hand presses to a depth "
        "midway "
        "between two quanta, the worst case.",
    };
    const auto with_precision =
        std::ranges::find_if(results, [](const Json& one) { return one.contains("precision"); });
    if (with_precision != results.end()) {
        notes.push_back(
            fmt::format("Paths were taken in {} precision.", with_precision->at("precision").get<std::string>()));
        if (with_precision->contains("hand"))
            notes.push_back(with_precision->at("hand"));
    }
    std::vector<std::string> places;
    for (const Json& result : results)
        if (std::string place =
                fmt::format("{}: {}", result.at("title").get<std::string>(), place_of(result.at("pressed")));
            std::ranges::find(places, place) == places.end())
            places.push_back(std::move(place));
    notes.push_back(fmt::format("Where the hand is pressed in: {}.", fmt::join(places, "; ")));
    return notes;
}

std::vector<Figure> limit_figures(const std::vector<Json>& limits, const std::vector<Json>& maps) {
    std::vector<Figure> figures{disagreement_figure()};
    for (const Json& one : limits) // of a shaped surface: its hand is the one that all have
        if (!one.at("flat").get<bool>() && !one.at("points").empty()) {
            figures.push_back(bearing_figure(one.at("points").at(0)));
            add_forms(figures.back(), maps);
            break;
        }
    return figures;
}

std::vector<Figure> map_figures(const std::vector<Json>& maps) {
    std::vector<Figure> figures;
    for (const Json& map : maps)
        figures.push_back(map_figure(map));
    return figures;
}

} // namespace forceshade::study
