#include "host/study/stability/tables.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/data/data_files.h"
#include "host/study/data/study_data.h"
#include "host/study/error_time/angle.h"

namespace forceshade::study {
namespace {

template <typename Row> std::vector<ColumnOf<Row>> place_columns(const RestPlace& (*place)(const Row&)) {
    return {
        {{"kind", "",
          "flat, crest, hollow (nearly upright, turning inwards), slope; edge and foot: the direction "
          "of the force jumps outwards or inwards"},
         [place](const Row& row) { return Cell(name_of(place(row).kind)); }},
        {{"depth_mm", "mm", "how deep the probe is pressed: force over stiffness, as deep as it would go into a wall"},
         [place](const Row& row) { return cell(1e3 * place(row).depth); }},
        {{"x_mm", "mm", "of the probe"}, [place](const Row& row) { return cell(1e3 * place(row).at.x); }},
        {{"y_mm", "mm", "likewise"}, [place](const Row& row) { return cell(1e3 * place(row).at.y); }},
        {{"z_mm", "mm", "likewise"}, [place](const Row& row) { return cell(1e3 * place(row).at.z); }},
        {{"beside_um", "um", "from a jump of the direction, where the place was found by one"},
         [place](const Row& row) { return place(row).beside ? cell(1e6 * *place(row).beside) : Cell(); }}};
}

Table limit_table(const LoopResults& results) {
    using R = LeastLimit;
    std::vector<ColumnOf<R>> columns{
        {{"surface", "", "what the hand is pressed into"}, [](const R& r) { return Cell(r.surface); }}};
    std::ranges::move(place_columns<R>([](const R& r) -> const RestPlace& { return r.place; }),
                      std::back_inserter(columns));
    std::ranges::move(
        std::vector<ColumnOf<R>>{
            {{"hold", "", "how the hand holds the probe there: its spring acts across this direction, or on all sides"},
             [](const R& r) { return Cell(r.hold.name); }},
            {{"damping_N_s_per_m", "N s/m", "b of device and hand together"},
             [](const R& r) { return cell(damping_of(r.cell)); }},
            {{"rate_Hz", "Hz", "samples a second, 1 / T"}, [](const R& r) { return cell(r.cell.rate); }},
            {{"delay_samples", "1", "from measurement to force"},
             [](const R& r) { return cell(double(r.cell.hand.delay_samples)); }},
            {{"hand", "", "own: damping, rate and delay are the hand's own; around: varied"},
             [](const R& r) { return Cell(r.own ? "own" : "around"); }},
            {{"limit_N_per_m", "N/m",
              "the least stiffness at which the linearised loop grows, of all places of this kind and depth and all "
              "holds; 0: at any; nothing: none below eight times b / (T (1/2 + delay))"},
             [](const R& r) { return cell_of(r.limit); }},
            {{"wall_N_per_m", "N/m", "K_crit of a wall with this hand, rate and delay"},
             [](const R& r) { return cell(r.wall); }},
            {{"of_wall_1", "1", "limit over the wall's"},
             [](const R& r) { return r.limit ? cell(*r.limit / r.wall) : Cell(); }},
            {{"simulated_N_per_m", "N/m",
              "the limit of the loop stepped through the surface's own force, where that was done"},
             [](const R& r) { return cell_of(r.simulated); }},
            {{"kick_um", "um",
              "of 0.1, 0.2, 0.5, 1 ... 100 um the largest displacement that dies out at half the limit, where that was "
              "stepped"},
             [](const R& r) { return r.kick ? cell(1e6 * *r.kick) : Cell(); }},
            {{"places", "1", "that were looked at"}, [](const R& r) { return cell(double(r.places)); }}},
        std::back_inserter(columns));
    return table_of<R>("loop_limits", "The stiffness up to which loops rest, the least of many places", columns,
                       results.limits);
}

Table swing_table(const LoopResults& results) {
    using R = EdgeSwing;
    std::vector<ColumnOf<R>> columns{
        {{"surface", "", "what the hand is pressed into"}, [](const R& r) { return Cell(r.surface); }},
        {{"series", "", "surface, kind and depth"}, [](const R& r) {
             return Cell(fmt::format("{}, {}, {:.3g} mm", r.surface, name_of(r.place.kind), 1e3 * r.place.depth));
         }}};
    std::ranges::move(place_columns<R>([](const R& r) -> const RestPlace& { return r.place; }),
                      std::back_inserter(columns));
    std::ranges::move(
        std::vector<ColumnOf<R>>{
            {{"jump_deg", "deg", "between the directions of the force on both sides"},
             [](const R& r) { return cell(r.place.jump / kDegree); }},
            {{"stiffness_N_per_m", "N/m", "of the surface"}, [](const R& r) { return cell(r.stiffness); }},
            {{"state", "", "as in loop_map; slid aside: at rest more than a tenth of its depth away"},
             [](const R& r) {
                 const bool slid = r.outcome.state == LoopState::stable && r.outcome.moved > 0.1 * r.place.depth;
                 return Cell(slid ? "slid aside" : word_of(r.outcome.state));
             }},
            {{"moved_um", "um", "from its place to the middle of that swing; nothing where the probe left"},
             [](const R& r) { return r.outcome.left ? Cell() : cell(1e6 * r.outcome.moved); }},
            {{"swing_um", "um",
              "between the farthest positions in the last quarter of the time, along the axis of the most; nothing "
              "where the probe left"},
             [](const R& r) { return r.outcome.left ? Cell() : cell(1e6 * r.outcome.swing); }}},
        std::back_inserter(columns));
    return table_of<R>("loop_edges", "Probes that rest on a jump of the direction", columns, results.swings);
}

Table map_table(const LoopResults& results) {
    using R = MapLoop;
    return table_of<R>(
        "loop_map", "What sampled loops come to",
        {{{"map", "",
           "damping: over stiffness and damping where the surface bears least; rounding: over the step of "
           "the measured position and friction"},
          [](const R& r) { return Cell(r.map); }},
         {{"surface", "", "what the hand is pressed into"}, [](const R& r) { return Cell(r.surface); }},
         {{"stiffness_N_per_m", "N/m", "K of the surface"}, [](const R& r) { return cell(r.cell.stiffness); }},
         {{"damping_N_s_per_m", "N s/m", "b of device and hand together"},
          [](const R& r) { return cell(damping_of(r.cell)); }},
         {{"quantum_um", "um", "step of the measured position"},
          [](const R& r) { return cell(1e6 * r.cell.hand.quantisation); }},
         {{"friction_N", "N", "Coulomb friction on each axis"}, [](const R& r) { return cell(r.cell.hand.coulomb); }},
         {{"state", "",
           "stable: decays or comes to rest; one quantum: goes on, but the measured position changes by one quantum at "
           "most; limit cycle: goes on within the bound; unstable: leaves the bound"},
          [](const R& r) { return Cell(word_of(r.outcome.state)); }},
         {{"foreseen", "",
           "rests or grows, by the linearised loop; with rounding: rests where K <= min(2 b / T, 2 f_c / quantum)"},
          [](const R& r) { return r.foreseen           ? Cell("rests")
                                  : r.map == "damping" ? Cell("grows")
                                                       : Cell(); }}},
        results.maps);
}

Table curve_table(const LoopResults& results) {
    using R = MapCurvePoint;
    return table_of<R>(
        "loop_curves", "Closed forms over the maps",
        {{{"map", "", "over which map"}, [](const R& r) { return Cell(r.map); }},
         {{"curve", "", "which closed form"}, [](const R& r) { return Cell(r.curve); }},
         {{"stiffness_N_per_m", "N/m", "K of the surface"}, [](const R& r) { return cell(r.stiffness); }},
         {{"damping_N_s_per_m", "N s/m", "b"}, [](const R& r) { return cell(r.damping); }},
         {{"quantum_um", "um", "step of the measured position"}, [](const R& r) { return cell(1e6 * r.quantum); }},
         {{"friction_N", "N", "Coulomb friction"}, [](const R& r) { return cell(r.friction); }}},
        results.curves);
}

Table profile_table(const LoopResults& results) {
    using R = ProfilePoint;
    return table_of<R>("loop_profile", "The shape that the directions of the force stand for, through the box's middle",
                       {{{"surface", "", "whose"}, [](const R& r) { return Cell(r.surface); }},
                        {{"x_mm", "mm", "across"}, [](const R& r) { return cell(1e3 * r.x); }},
                        {{"z_mm", "mm", "height, 0 where the box begins"}, [](const R& r) { return cell(1e3 * r.z); }}},
                       results.profile);
}

// The worst place of each surface that somewhere bears less than a wall.
Table worst_table(const LoopResults& results) {
    struct R {
        std::string surface, label;
        double x, z, limit;
    };
    std::vector<R> rows;
    for (const LoopSurface& surface : results.surfaces)
        if (const LeastLimit* worst = results.worst(surface.name); worst && *worst->limit < 0.99 * worst->wall) {
            const double x = worst->place.at.x;
            const ProfilePoint* nearest = nullptr;
            for (const ProfilePoint& point : results.profile)
                if (point.surface == surface.name && (!nearest || std::abs(point.x - x) < std::abs(nearest->x - x)))
                    nearest = &point;
            rows.push_back(
                {surface.name, fmt::format("{:.0f} N/m", *worst->limit), x, nearest ? nearest->z : 0, *worst->limit});
        }
    return table_of<R>("loop_worst", "Where each surface bears least",
                       {{{"surface", "", "what the hand is pressed into"}, [](const R& r) { return Cell(r.surface); }},
                        {{"label", "", "the limit"}, [](const R& r) { return Cell(r.label); }},
                        {{"x_mm", "mm", "of the probe"}, [](const R& r) { return cell(1e3 * r.x); }},
                        {{"z_mm", "mm", "on the shape of loop_profile"}, [](const R& r) { return cell(1e3 * r.z); }},
                        {{"limit_N_per_m", "N/m", "with the hand's own damping, rate and delay"},
                         [](const R& r) { return cell(r.limit); }}},
                       rows);
}

// The least of all places of a kind.
Table kind_table(const LoopResults& results) {
    struct R {
        std::string surface, kind;
        double limit, share;
    };
    std::vector<R> rows;
    for (const LoopSurface& surface : results.surfaces)
        for (const PlaceKind kind : kPlaceKinds) {
            const LeastLimit* least = nullptr;
            for (const LeastLimit& one : results.limits)
                if (one.own && one.surface == surface.name && one.place.kind == kind && one.limit &&
                    (!least || *one.limit < *least->limit))
                    least = &one;
            if (least)
                rows.push_back({surface.name, name_of(kind), *least->limit, *least->limit / least->wall});
        }
    return table_of<R>("loop_kinds", "The least stiffness at which loops grow, by the kind of place",
                       {{{"surface", "", "what the hand is pressed into"}, [](const R& r) { return Cell(r.surface); }},
                        {{"kind", "", "of place"}, [](const R& r) { return Cell(r.kind); }},
                        {{"limit_N_per_m", "N/m", "with the hand's own damping, rate and delay, over depths and holds"},
                         [](const R& r) { return cell(r.limit); }},
                        {{"of_wall_1", "1", "of K_crit of a wall"}, [](const R& r) { return cell(r.share); }}},
                       rows);
}

std::string hand_words(const LoopSurface& surface) {
    return fmt::format("{:.3g} kg, {:.3g} N s/m, a grip of {:.4g} N/m, {:.4g} Hz{}", surface.hand.mass,
                       surface.hand.damping + surface.hand.grip_damping, surface.hand.grip_stiffness, surface.rate,
                       surface.hand.delay_samples > 0 ? fmt::format(", {} samples late", surface.hand.delay_samples)
                                                      : "");
}

std::vector<Figure> figures_of(const LoopResults& results) {
    const LoopSurface& first = results.surfaces.front();
    std::vector<Figure> figures;
    Figure kinds;
    kinds.name = "loop-kinds";
    kinds.title = "Largest stable stiffness, by the kind of place";
    kinds.caption =
        fmt::format("Hand: {}. The least over all places of a kind, depths of {:.2g} to {:.2g} mm and ways of "
                    "holding. Places where the direction jumps are in another figure.",
                    hand_words(first), 1e3 * first.depths().front(), 1e3 * first.deepest);
    kinds.kind = FigureKind::bars;
    kinds.table = "loop_kinds";
    kinds.x = {"surface", "surface", false};
    kinds.y = {"limit_N_per_m", "largest stable stiffness / (N/m)", false};
    kinds.series = "kind";
    figures.push_back(kinds);

    Figure places;
    places.name = "loop-places";
    places.title = "Where each surface bears least";
    places.caption =
        "Lines: the shape that the directions of the force stand for. Points: the place of the least limit, where that "
        "is less than a wall's.";
    places.table = "loop_worst";
    places.x = {"x_mm", "x / mm", false};
    places.y = {"z_mm", "height / mm", false};
    places.series = "surface";
    places.label = "label";
    for (const LoopSurface& surface : results.surfaces)
        places.curves.push_back({"loop_profile", {{"surface", surface.name}}, "x_mm", "z_mm", surface.name, false});
    figures.push_back(places);

    if (!results.swings.empty()) {
        Figure edges;
        edges.name = "loop-edges";
        edges.title = "How far a probe swings that rests on a jump of the direction";
        edges.caption =
            "Peak to peak over the surface's stiffness, the hand pressed down. A point that is missing: the "
            "probe left its place.";
        edges.table = "loop_edges";
        edges.x = {"stiffness_N_per_m", "stiffness / (N/m)", true};
        edges.y = {"swing_um", "swing / um", true};
        edges.series = "series";
        edges.where = {{"kind", "foot"}, {"depth_mm", Cell(1e3 * first.depths()[2]).text()}};
        edges.joined = true;
        figures.push_back(edges);
    }
    const auto add_map = [&](const char* map, const FigureAxis& x, const FigureAxis& y, std::string title) {
        Figure figure;
        figure.name = fmt::format("loop-{}", map);
        figure.title = std::move(title);
        figure.caption = "What each loop comes to, the hand pressed down. Lines: closed forms.";
        figure.kind = FigureKind::map;
        figure.table = "loop_map";
        figure.where = {{"map", map}};
        figure.x = x;
        figure.y = y;
        figure.value = "state";
        figure.value_label = "the loop";
        figure.value_words = {"stable", "one quantum", "limit cycle", "unstable"};
        for (const char* curve : {"K_crit", "linearised", "f_c = K quantum / 2"})
            if (std::ranges::any_of(results.curves,
                                    [&](const MapCurvePoint& one) { return one.map == map && one.curve == curve; }))
                figure.curves.push_back({"loop_curves",
                                         {{"map", map}, {"curve", curve}},
                                         x.column,
                                         y.column,
                                         curve == std::string("linearised") ? "linearised there" : curve,
                                         curve == std::string("K_crit")});
        figures.push_back(std::move(figure));
    };
    for (const MapLoop& loop : results.maps) {
        const std::string name = "loop-" + loop.map;
        if (std::ranges::find(figures, name, &Figure::name) != figures.end())
            continue;
        if (loop.map == "damping")
            add_map("damping", {"stiffness_N_per_m", "stiffness / (N/m)", true},
                    {"damping_N_s_per_m", "damping / (N s/m)", true},
                    fmt::format("Loops over stiffness and damping: {}{}", loop.surface,
                                results.map_kind.empty() ? "" : ", " + results.map_kind));
        else
            add_map(
                "rounding", {"quantum_um", "step of the measured position / um", true},
                {"friction_N", "friction / N", true},
                fmt::format("Loops over rounding and friction, {}, K = {:.4g} N/m", loop.surface, loop.cell.stiffness));
    }
    return figures;
}

} // namespace

const LeastLimit* LoopResults::worst(const std::string& surface, std::optional<double> depth) const {
    const LeastLimit* least = nullptr;
    for (const LeastLimit& one : limits)
        if (one.own && one.limit && (surface.empty() || one.surface == surface) &&
            (!depth || one.place.depth == *depth) && (!least || *one.limit < *least->limit))
            least = &one;
    return least;
}

void add_loops(StudyData& data, const LoopResults& results) {
    for (Table& table :
         std::vector<Table>{kind_table(results), limit_table(results), swing_table(results), worst_table(results),
                            profile_table(results), map_table(results), curve_table(results)})
        data.tables.push_back(std::move(table));
    std::ranges::move(figures_of(results), std::back_inserter(data.figures));
    const LoopSurface& first = results.surfaces.front();
    data.notes.push_back(fmt::format(
        "The hand is that of {}: {}. A constant force presses it to its depth and balances the surface's force there; "
        "its spring acts across the direction of the hold, or on all sides. Holds along which the surface gives way "
        "are left out, for no probe rests there at any stiffness. The device's largest force is left out.",
        data.scene.empty() ? "a scene that names none" : "the scene", hand_words(first)));
    data.notes.push_back(
        "A limit is the least stiffness at which a mode of the linearised loop grows, hand and device stepped exactly "
        "and the force held over a sample. At the worst place of each kind the loop is stepped through the "
        "surface's own force, too, from a disturbance of a millionth of the depth; what larger one dies out at half "
        "the "
        "limit is told beside it, for close to a jump of the direction little does.");
    data.notes.push_back(
        "Where the direction jumps there is no linearised loop: the hand balances the mean of both sides' forces, and "
        "how far the probe swings is told instead.");
    data.notes.push_back(
        "A loop of a map begins a tenth of its depth too deep and a little aside, half of it with rounding and "
        "friction. "
        "It is unstable if it comes further than three depths from its place, stable if it decays or its measured "
        "position does not change any more; with rounding, the hand presses to a depth midway between two quanta, the "
        "worst case.");
}

} // namespace forceshade::study
