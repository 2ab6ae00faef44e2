// Results of the loops as tables, figures and notes.
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "host/study/stability/stability.h"
#include "host/touch/force_errors.h"

namespace forceshade::study {
namespace {

// Of a row that has a place: `first`, where it is, `then`.
template <typename Row>
std::vector<ColumnOf<Row>> place_columns(std::vector<ColumnOf<Row>> first, std::initializer_list<ColumnOf<Row>> then) {
    first.insert(first.end(), {{"kind", "",
                                "flat, crest, hollow (nearly upright, turning inwards), slope; edge and foot: the "
                                "direction of the force jumps outwards or inwards",
                                [](const Row& r) { return name_of(r.place.kind); }},
                               {"depth_mm", "mm", "of the probe: force over stiffness, its depth in a wall",
                                [](const Row& r) { return 1e3 * r.place.depth; }},
                               {"x_mm", "mm", "of the probe", [](const Row& r) { return 1e3 * r.place.at.x; }},
                               {"y_mm", "mm", "of the probe", [](const Row& r) { return 1e3 * r.place.at.y; }},
                               {"z_mm", "mm", "of the probe", [](const Row& r) { return 1e3 * r.place.at.z; }},
                               {"beside_um", "um", "from a jump of the direction, if the place was found by one",
                                [](const Row& r) { return 1e6 * r.place.edge_distance.value_or(NAN); }}});
    first.insert(first.end(), then);
    return first;
}

std::string series_of(const AtlasPoint& point) {
    return fmt::format("{}, {}", point.least.surface, name_of(point.least.place.kind));
}

Table limit_table(const LoopResults& results) {
    using R = LeastLimit;
    return table_of<R>(
        "loop_limits", "Largest stable stiffness, the minimum over many places",
        place_columns<R>(
            {{"surface", "", "pressed by the hand", &R::surface}},
            {{"hold", "", "boundary condition: the hand's spring acts across this direction, or on all sides",
              [](const R& r) { return r.hold.name; }},
             {"damping_N_s_per_m", "N s/m", "b of device and hand together",
              [](const R& r) { return damping_of(r.cell.hand); }},
             {"grip_N_per_m", "N/m", "stiffness of the spring that holds the hand across",
              [](const R& r) { return r.cell.hand.grip_stiffness; }},
             {"rate_Hz", "Hz", "samples a second, 1 / T", [](const R& r) { return r.cell.rate; }},
             {"delay_samples", "1", "from measurement to force", [](const R& r) { return r.cell.hand.delay_samples; }},
             {"hand", "", "own: damping, grip, rate and delay are the hand's own; around: varied",
              [](const R& r) { return r.own ? "own" : "around"; }},
             {"limit_N_per_m", "N/m",
              "the least stiffness at which the linearised loop grows, of all places of this kind and depth and all "
              "holds; 0: at any; empty: none below eight times b / (T (1/2 + delay))",
              &R::limit},
             {"any_press_N_per_m", "N/m",
              "the same of a hand that presses in any direction that the surface supports; of the hand's own at all "
              "places, of the others where the hand's own has its least and where their own limit is least",
              [](const R& r) { return r.any_press ? Cell(r.any_press->limit) : Cell(); }},
             {"any_press", "", "that direction", [](const R& r) { return r.any_press ? r.any_press->hold.name : ""; }},
             {"any_press_simulated_N_per_m", "N/m", "as simulated_N_per_m, of that",
              [](const R& r) { return r.any_press ? Cell(r.any_press->simulated) : Cell(); }},
             {"wall_N_per_m", "N/m", "K_crit of a wall with this hand, rate and delay", &R::wall},
             {"of_wall_1", "1", "limit over the wall's", [](const R& r) { return r.limit.value_or(NAN) / r.wall; }},
             {"simulated_N_per_m", "N/m",
              "the limit of the loop stepped through the surface's own force, where that was done", &R::simulated},
             {"kick_um", "um",
              "of 0.1, 0.2, 0.5, 1 ... 100 um the largest displacement that decays at half the limit, where that was "
              "stepped",
              [](const R& r) { return 1e6 * r.kick.value_or(NAN); }},
             {"places", "1", "examined", &R::places}}),
        results.limits);
}

Table edge_limit_table(const LoopResults& results) {
    using R = LeastLimit;
    return table_of<R>(
        "loop_mesh_edges", "Largest stable stiffness by edges and vertices of meshes",
        place_columns<R>(
            {{"surface", "", "pressed by the hand", &R::surface},
             {"by", "", "an edge: next to a jump of the force's direction; a vertex: below one, or next to it",
              [](const R& r) { return r.place.by_vertex ? "a vertex" : "an edge"; }}},
            {{"hold", "", "as in loop_limits", [](const R& r) { return r.hold.name; }},
             {"limit_N_per_m", "N/m", "of the linearised loop with the hand's own, over depths and holds", &R::limit},
             {"simulated_N_per_m", "N/m", "the limit of the loop stepped along the mesh's own force", &R::simulated},
             {"wall_N_per_m", "N/m", "K_crit of a wall", &R::wall},
             {"places", "1", "examined", &R::places}}),
        results.by_edges);
}

Table tessellation_table(const LoopResults& results) {
    using R = TessellatedLimit;
    return table_of<R>(
        "loop_tessellations", "Largest stable stiffness on meshes of the same cells, tessellated anew",
        {{"surface", "", "pressed by the hand", [](const R& r) { return r.least.surface; }},
         {"tessellation", "1", "0: that of loop_limits; others are turned and moved at random", &R::tessellation},
         {"kind", "", "of place", [](const R& r) { return name_of(r.least.place.kind); }},
         {"depth_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.least.place.depth; }},
         {"limit_N_per_m", "N/m", "as in loop_limits, with the hand's own", [](const R& r) { return r.least.limit; }},
         {"any_press_N_per_m", "N/m", "as in loop_limits",
          [](const R& r) { return r.least.any_press ? Cell(r.least.any_press->limit) : Cell(); }},
         {"simulated_N_per_m", "N/m", "as in loop_limits, of the least of all kinds and depths",
          [](const R& r) { return r.least.simulated; }},
         {"x_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.least.place.at.x; }},
         {"y_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.least.place.at.y; }}},
        results.tessellated);
}

Table basin_table(const LoopResults& results) {
    using R = BasinRow;
    const auto hand = [](double HandSpec::*of) { return [of](const R& r) { return r.there.cell.hand.*of; }; };
    return table_of<R>(
        "loop_basins", "Kicks that friction alone lets die out",
        {{"surface", "", "pressed by the hand", [](const R& r) { return r.there.surface; }},
         {"kind", "", "of place, the worst of its kind with the hand's own",
          [](const R& r) { return name_of(r.there.place.kind); }},
         {"depth_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.depth; }},
         {"x_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.x; }},
         {"hold", "", "as in loop_limits", [](const R& r) { return r.there.hold.name; }},
         {"grip_N_per_m", "N/m", "stiffness of the grip's spring; no damping", hand(&HandSpec::grip_stiffness)},
         {"delay_samples", "1", "from measurement to force",
          [](const R& r) { return r.there.cell.hand.delay_samples; }},
         {"stiffness_N_per_m", "N/m", "K of the surface", [](const R& r) { return r.there.cell.stiffness; }},
         {"w_T_1", "rad", "sqrt(K / m) times sample",
          [](const R& r) { return std::sqrt(r.there.cell.stiffness / r.there.cell.hand.mass) / r.there.cell.rate; }},
         {"friction_N", "N",
          "Coulomb friction on each axis: as much as makes the closed form a hundredth of the depth, or a twentieth of "
          "the way to a jump of the direction",
          hand(&HandSpec::coulomb)},
         {"kick_um", "um", "straight down, up to which it dies out: by harmonic balance along the force",
          [](const R& r) { return 1e6 * r.foreseen; }},
         {"stepped_um", "um", "of loops with kicks; empty: none from a quarter to four times that",
          [](const R& r) { return 1e6 * r.stepped.value_or(NAN); }},
         {"K_kick_over_f_1", "1", "stepped, times K over friction",
          [](const R& r) { return r.stepped.value_or(NAN) * r.there.cell.stiffness / r.there.cell.hand.coulomb; }},
         {"off_percent", "%", "stepped over the closed form, less 1",
          [](const R& r) { return 100 * (r.stepped.value_or(NAN) / r.foreseen - 1); }}},
        results.basins);
}

Table disagreement_table(const LoopResults& results) {
    using R = SteppedCheck;
    std::vector<R> apart;
    for (R& one : stepped_checks(results))
        if (one.apart())
            apart.push_back(std::move(one));
    return table_of<R>(
        "loop_disagreements", "Stepped loops that differ by more than 1 % from the linearised loop or a closed form",
        {{"what", "", "limit / (N/m), or the kick that dies out / m, and what it is of", &R::what},
         {"surface", "", "pressed by the hand", [](const R& r) { return r.there.surface; }},
         {"kind", "", "of place", [](const R& r) { return name_of(r.there.place.kind); }},
         {"depth_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.depth; }},
         {"x_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.x; }},
         {"y_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.y; }},
         {"z_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.there.place.at.z; }},
         {"hold", "", "as in loop_limits", [](const R& r) { return r.there.hold.name; }},
         {"grip_N_per_m", "N/m", "stiffness of the grip's spring",
          [](const R& r) { return r.there.cell.hand.grip_stiffness; }},
         {"delay_samples", "1", "from measurement to force",
          [](const R& r) { return r.there.cell.hand.delay_samples; }},
         {"value", "SI", "of what is varied, as in loop_atlas; of a kick K / (N/m)", &R::value},
         {"foreseen", "SI", "by the linearised loop or the closed form", &R::foreseen},
         {"stepped", "SI", "through the surface's own force; empty: no limit within the range of the search",
          &R::stepped},
         {"off_percent", "%", "stepped over foreseen, less 1", [](const R& r) { return 100 * r.off(); }}},
        apart);
}

Table atlas_table(const LoopResults& results) {
    using R = AtlasPoint;
    return table_of<R>(
        "loop_atlas", "The limit over one quantity of hand and loop at a time",
        {{"surface", "", "pressed by the hand", [](const R& r) { return r.least.surface; }},
         {"kind", "", "of place, the worst of its kind with the hand's own",
          [](const R& r) { return name_of(r.least.place.kind); }},
         {"series", "", "surface and kind", [](const R& r) { return series_of(r); }},
         {"worst", "", "yes: of the surface's kinds the one with the lowest limit",
          [&](const R& r) {
              return worst_of(results.limits, r.least.surface)->place.kind == r.least.place.kind ? "yes" : "no";
          }},
         {"depth_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.least.place.depth; }},
         {"varied", "", "quantity that is varied; all else is the hand's own", &R::quantity},
         {"value", "SI", "of that quantity: kg, N/m, N s/m, Hz, samples or s", &R::value},
         {"b_T_over_m_1", "1", "damping times sample over mass", &R::mass_group},
         {"kg_T_over_b_1", "1", "the grip's stiffness times sample over damping", &R::grip_group},
         {"delay_samples", "1", "from measurement to force",
          [](const R& r) { return r.least.cell.hand.delay_samples; }},
         {"d_over_R_1", "1",
          "depth over the radius by which the force's direction turns there; below 0: it turns inwards",
          &R::depth_group},
         {"fc_T_over_b_quantum_1", "1",
          "Coulomb friction times sample over damping and step of the measured position, where it is measured in steps",
          &R::friction_group},
         {"lag_over_T_1", "1", "time constant with which the device's force follows, over a sample", &R::lag_group},
         {"limit_N_per_m", "N/m",
          "as in loop_limits, at that place; with steps and friction min(2 f_c / quantum, K_crit with friction's "
          "describing function)",
          [](const R& r) { return r.least.limit; }},
         {"hold", "", "of that limit, as in loop_limits", [](const R& r) { return r.least.hold.name; }},
         {"grip_limit_N_per_m", "N/m",
          "closed form: where the balance of the surface's force and the grip's spring turns in that hold, whatever "
          "the sampling; empty: the force turns nowhere outwards",
          [](const R& r) { return grip_limit(r.least.cell.hand, r.least.hold, r.least.place.force_around()); }},
         {"K_d_over_kg_R_1", "1",
          "the limit times d / R over the grip's stiffness: cos(t)^2, t between hold and force, where the grip gives "
          "way; empty: the force turns nowhere outwards",
          &R::balance_group},
         {"K_T_over_b_1", "1", "the limit times sample over damping; 2 is passive without delay", &R::limit_group},
         {"of_wall_1", "1", "of K_crit of a wall with this hand, rate, delay and lag",
          [](const R& r) { return r.least.limit.value_or(NAN) / r.least.wall; }},
         {"simulated_N_per_m", "N/m",
          "the limit of the loop stepped through the surface's own force, where that was done",
          [](const R& r) { return r.least.simulated; }}},
        results.atlas);
}

Table swing_table(const LoopResults& results) {
    using R = EdgeSwing;
    const auto micro = [](double LoopOutcome::*length) {
        return [length](const R& r) { return r.outcome.left ? NAN : 1e6 * r.outcome.*length; };
    };
    return table_of<R>(
        "loop_edges", "Probes that rest on a jump of the direction",
        place_columns<R>({{"surface", "", "pressed by the hand", &R::surface},
                          {"series", "", "surface, kind and depth",
                           [](const R& r) {
                               return fmt::format("{}, {}, {:.3g} mm", r.surface, name_of(r.place.kind),
                                                  1e3 * r.place.depth);
                           }}},
                         {{"jump_deg", "deg", "between the directions of the force on both sides",
                           [](const R& r) { return r.place.jump / kDegree; }},
                          {"stiffness_N_per_m", "N/m", "of the surface", &R::stiffness},
                          {"state", "", "as in loop_states; slid aside: at rest more than a tenth of its depth away",
                           [](const R& r) {
                               const bool slid =
                                   r.outcome.state == LoopState::stable && r.outcome.moved > 0.1 * r.place.depth;
                               return slid ? "slid aside" : word_of(r.outcome.state);
                           }},
                          {"moved_um", "um", "from its place to the middle of that swing; empty: the probe left",
                           micro(&LoopOutcome::moved)},
                          {"swing_um", "um",
                           "between the farthest positions in the last quarter of the time, along the axis of the "
                           "largest; empty: the probe left",
                           micro(&LoopOutcome::swing)}}),
        results.swings);
}

Table coupling_table(const LoopResults& results) {
    using R = CouplingRow;
    return table_of<R>(
        "loop_couplings", "Virtual couplings with which stiff scenes are stable",
        {{"surface", "", "pressed by the hand", &R::surface},
         {"scene_N_per_m", "N/m", "the scene's stiffness K", &R::scene},
         {"coupling", "",
          "own: the scene's; safe: the stiffest spring alone, at rest everywhere, and passive: in line with a wall "
          "this hand gets no energy; stiffest: with any damper up to the mass over the sample, at rest everywhere, but "
          "impacts may give energy; "
          "filtered: the same with a filter of the damper's speed",
          &R::which},
         {"coupling_N_per_m", "N/m", "hand.coupling.stiffness k", [](const R& r) { return r.coupling.stiffness; }},
         {"coupling_N_s_per_m", "N s/m", "hand.coupling.damping", [](const R& r) { return r.coupling.damping; }},
         {"filter_ms", "ms", "hand.coupling.filter", [](const R& r) { return 1e3 * r.filter; }},
         {"displayed_N_per_m", "N/m", "K k / (K + k), of a contact at rest",
          [](const R& r) { return displayed_stiffness(r.scene, r.coupling.stiffness); }},
         {"rests", "", "at all places, by the linearised loop", [](const R& r) { return r.rests ? "yes" : "no"; }},
         {"weakest", "", "kind of the place where a stiffer coupling grows; empty: something else limits it",
          [](const R& r) { return r.coupling.weakest ? name_of(r.coupling.weakest->place.kind) : ""; }},
         {"stepped", "",
          "through the surface's own force at that place: as foreseen, if a coupling 2 % softer rests and one 2 % "
          "stiffer grows",
          [](const R& r) { return !r.foreseen   ? ""
                                  : *r.foreseen ? "as foreseen"
                                                : "otherwise"; }}},
        results.couplings);
}

Table state_table(const LoopResults& results) {
    using R = DiagramLoop;
    return table_of<R>(
        "loop_states", "States of sampled loops",
        {{"diagram", "",
          "damping: over stiffness and damping at the surface's lowest limit; coupling: over stiffness and damping of "
          "a virtual coupling to a scene of 1e7 N/m; rounding: over the step of the measured position and friction; "
          "basin: over stiffness and kick, without damping",
          &R::diagram},
         {"surface", "", "pressed by the hand", &R::surface},
         {"stiffness_N_per_m", "N/m", "K of the surface", [](const R& r) { return r.cell.stiffness; }},
         {"damping_N_s_per_m", "N s/m", "b of device and hand together",
          [](const R& r) { return damping_of(r.cell.hand); }},
         {"coupling_N_per_m", "N/m", "stiffness of a virtual coupling; 0: none",
          [](const R& r) { return r.cell.hand.coupling_stiffness; }},
         {"coupling_N_s_per_m", "N s/m", "its damping", [](const R& r) { return r.cell.hand.coupling_damping; }},
         {"quantum_um", "um", "step of the measured position",
          [](const R& r) { return 1e6 * r.cell.hand.quantisation; }},
         {"friction_N", "N", "Coulomb friction on each axis", [](const R& r) { return r.cell.hand.coulomb; }},
         {"kick_um", "um", "how far too deep the probe begins, where that is varied",
          [](const R& r) { return r.kick > 0 ? 1e6 * r.kick : NAN; }},
         {"b_over_K_T_1", "1", "damping over stiffness and sample: 1/2 is passive without delay",
          [](const R& r) { return damping_of(r.cell.hand) / r.cell.stiffness * r.cell.rate; }},
         {"fc_over_K_quantum_1", "1", "friction over stiffness and quantum: from 1/2 on it holds a quantum",
          [](const R& r) {
              const HandSpec& hand = r.cell.hand;
              return hand.quantisation > 0 ? hand.coulomb / (r.cell.stiffness * hand.quantisation) : NAN;
          }},
         {"state", "",
          "stable: decays or comes to rest; quantisation limit cycle: the measured position changes by one quantum at "
          "most; limit cycle: stays within the bound; unstable: leaves the bound",
          [](const R& r) { return word_of(r.outcome.state); }},
         {"foreseen", "",
          "rests or grows, by the linearised loop; with rounding: rests where K <= min(2 b / T, 2 f_c / quantum); "
          "basin: by describing functions",
          [](const R& r) { return r.foreseen                ? Cell("rests")
                                  : r.diagram == "rounding" ? Cell()
                                                            : Cell("grows"); }}},
        results.diagrams);
}

Table curve_table(const LoopResults& results) {
    using R = CurvePoint;
    return table_of<R>(
        "loop_curves", "Closed forms over the diagrams",
        {{"diagram", "", "over which diagram", &R::diagram},
         {"curve", "", "which closed form", &R::curve},
         {"stiffness_N_per_m", "N/m", "K of the surface", &R::stiffness},
         {"damping_N_s_per_m", "N s/m", "b", &R::damping},
         {"coupling_N_per_m", "N/m", "stiffness of a virtual coupling", &R::coupling},
         {"coupling_N_s_per_m", "N s/m", "its damping", &R::coupling_damping},
         {"quantum_um", "um", "step of the measured position", [](const R& r) { return 1e6 * r.quantum; }},
         {"friction_N", "N", "Coulomb friction", &R::friction},
         {"kick_um", "um", "how far too deep the probe begins", [](const R& r) { return 1e6 * r.kick; }}},
        results.curves);
}

// Of the surfaces of the verdict, or of a scene.
bool is_drawn(const LoopResults& results, const std::string& surface) {
    constexpr const char* kDrawn[] = {"plane", "shaded bump of 2 facets", "bump of 8 facets", "shaded bump of 8 facets",
                                      "mesh",  "barycentric mesh"};
    return results.surfaces.size() == 1 || std::ranges::count(kDrawn, surface) > 0;
}

Table press_table(const LoopResults& results) {
    using R = PressLimit;
    return table_of<R>(
        "loop_presses", "Limits by the direction of the press, where that of any press is least",
        {{"surface", "", "pressed by the hand", &R::surface},
         {"press_deg", "deg", "of the press, from straight down towards the one of the least limit", &R::turn},
         {"limit_N_per_m", "N/m", "of the linearised loop; 0: it grows at any stiffness", &R::limit},
         {"counts", "", "supported: the surface supports the press with a fifth of its force and of a wall's stiffness",
          [](const R& r) { return r.counts ? "supported" : "hardly supported"; }},
         {"kind", "", "of the place", [](const R& r) { return name_of(r.place.kind); }},
         {"x_mm", "mm", "its x", [](const R& r) { return 1e3 * r.place.at.x; }},
         {"drawn", "", "in the figure", [&](const R& r) { return is_drawn(results, r.surface) ? "yes" : "no"; }}},
        results.presses);
}

Table profile_table(const LoopResults& results) {
    using R = ProfilePoint;
    return table_of<R>("loop_profile", "The shape integrated from the force's directions, through the box's middle",
                       {{"surface", "", "of the shape", &R::surface},
                        {"x_mm", "mm", "across", [](const R& r) { return 1e3 * r.x; }},
                        {"z_mm", "mm", "height, 0 where the box begins", [](const R& r) { return 1e3 * r.z; }}},
                       results.profile);
}

// The worst place of each surface with a limit below a wall's.
Table worst_table(const LoopResults& results) {
    struct R {
        std::string surface, label;
        double x, z, limit;
    };
    std::vector<R> rows;
    for (const LoopSurface& surface : results.surfaces)
        if (const LeastLimit* worst = worst_of(results.limits, surface.name);
            worst && !surface.limits_alone && *worst->limit < 0.99 * worst->wall) {
            const double x = worst->place.at.x;
            const ProfilePoint* nearest = nullptr;
            for (const ProfilePoint& point : results.profile)
                if (point.surface == surface.name && (!nearest || std::abs(point.x - x) < std::abs(nearest->x - x)))
                    nearest = &point;
            rows.push_back(
                {surface.name, fmt::format("{:.0f} N/m", *worst->limit), x, nearest ? nearest->z : 0, *worst->limit});
        }
    return table_of<R>("loop_worst", "Place of each surface's lowest limit",
                       {{"surface", "", "pressed by the hand", &R::surface},
                        {"label", "", "the limit", &R::label},
                        {"x_mm", "mm", "of the probe", [](const R& r) { return 1e3 * r.x; }},
                        {"z_mm", "mm", "on the shape of loop_profile", [](const R& r) { return 1e3 * r.z; }},
                        {"limit_N_per_m", "N/m", "with the hand's own damping, rate and delay", &R::limit}},
                       rows);
}

// The minimum over all places of a kind.
Table kind_table(const LoopResults& results) {
    std::vector<const LeastLimit*> rows;
    for (const LoopSurface& surface : results.surfaces)
        for (const PlaceKind kind : kPlaceKinds)
            if (const LeastLimit* least = worst_of(results.limits, surface.name, {}, kind))
                rows.push_back(least);
    using R = const LeastLimit*;
    return table_of<R>("loop_kinds", "The least stiffness at which loops grow, by the kind of place",
                       {{"surface", "", "pressed by the hand", [](R r) { return r->surface; }},
                        {"kind", "", "of place", [](R r) { return name_of(r->place.kind); }},
                        {"limit_N_per_m", "N/m", "with the hand's own damping, rate and delay, over depths and holds",
                         [](R r) { return r->limit; }},
                        {"of_wall_1", "1", "of K_crit of a wall", [](R r) { return *r->limit / r->wall; }}},
                       rows);
}

// Of one of the diagrams, with the lines that it has.
Figure diagram_figure(const LoopResults& results, const std::string& diagram, const std::string& title,
                      const FigureAxis& x, const FigureAxis& y) {
    Figure figure =
        make_figure("loop-" + diagram, title, "The state of each loop, the hand pressed down. Lines: closed forms.",
                    FigureKind::cells, "loop_states", {{"diagram", diagram}}, x, y, "", "",
                    {.value = "state",
                     .value_label = "the loop",
                     .value_words = {"stable", "quantisation limit cycle", "limit cycle", "unstable"}});
    for (const std::string curve : {"K_crit", "passive", "linearised", "filter of 5 samples", "filter of 20 samples",
                                    "f_c = K quantum / 2", "8 f_c / (pi K T w)"})
        if (const Where where{{"diagram", diagram}, {"curve", curve}}; std::ranges::any_of(
                results.curves, [&](const CurvePoint& one) { return one.diagram == diagram && one.curve == curve; }))
            figure.curves.push_back({"loop_curves", where, x.column, y.column,
                                     curve == "linearised" ? "linearised there" : curve,
                                     curve == "K_crit" || curve == "passive"});
    return figure;
}

std::vector<Figure> figures_of(const LoopResults& results) {
    const LoopSurface& first = results.surfaces.front();
    std::vector<Figure> figures{
        make_figure("loop-kinds", "Largest stable stiffness, by the kind of place",
                    fmt::format("With a {}: the minimum over all places of a kind, depths of {:.2g} to {:.2g} mm and "
                                "boundary conditions. Places where the direction jumps are in another figure.",
                                hand_text(first), 1e3 * first.depths().front(), 1e3 * first.deepest),
                    FigureKind::bars, "loop_kinds", {}, {"surface", "surface"},
                    {"limit_N_per_m", "largest stable stiffness / (N/m)"}, "kind"),
        make_figure("loop-places", "Place of each surface's lowest limit",
                    "Lines: the shape integrated from the force's directions. Points: the place of the lowest limit, "
                    "if below a wall's.",
                    FigureKind::scatter, "loop_worst", {}, {"x_mm", "x / mm"}, {"z_mm", "height / mm"}, "surface",
                    "label")};
    for (const LoopSurface& surface : results.surfaces)
        figures.back().curves.push_back({"loop_profile", {{"surface", surface.name}}, "x_mm", "z_mm", surface.name});
    if (!results.presses.empty())
        figures.push_back(make_figure(
            "loop-presses", "Largest stable stiffness by the direction of the press, at each surface's weakest place",
            fmt::format(
                "With a {}. A press counts for a limit where the surface supports it with a fifth of its force and of "
                "a wall's stiffness; further aside the limit of a curved or shaded one may fall to 0.",
                hand_text(first)),
            FigureKind::scatter, "loop_presses", {{"drawn", "yes"}}, {"press_deg", "press, from straight down / deg"},
            {"limit_N_per_m", "largest stable stiffness / (N/m)"}, "surface", "", {.shape = "counts", .joined = true}));
    if (!results.swings.empty())
        figures.push_back(make_figure("loop-edges", "Swing of a probe that rests on a jump of the direction",
                                      "Peak to peak over the surface's stiffness, the hand pressed down. A point that "
                                      "is missing: the probe left its place.",
                                      FigureKind::scatter, "loop_edges",
                                      {{"kind", "foot"}, {"depth_mm", Cell(1e3 * first.depths()[2]).text()}},
                                      {"stiffness_N_per_m", "stiffness / (N/m)", true},
                                      {"swing_um", "swing / um", true}, "series", "", {.joined = true}));
    const auto any = [&](const char* diagram) {
        return std::ranges::find(results.diagrams, diagram, &DiagramLoop::diagram);
    };
    if (const auto loop = any("damping"); loop != results.diagrams.end())
        figures.push_back(diagram_figure(results, "damping",
                                         fmt::format("Loops over stiffness and damping: {}{}", loop->surface,
                                                     results.diagram_kind.empty() ? "" : ", " + results.diagram_kind),
                                         {"stiffness_N_per_m", "stiffness / (N/m)", true},
                                         {"damping_N_s_per_m", "damping / (N s/m)", true}));
    // Over a quantity in groups without units.
    const std::tuple<const char*, const char*, FigureAxis> groups[] = {
        {"mass", "The limit over the hand's mass, 1 g to 10 kg", {"b_T_over_m_1", "b T / m", true}},
        {"grip", "The limit over the grip's stiffness, 20 to 5000 N/m", {"kg_T_over_b_1", "k_g T / b", true}},
        {"delay", "The limit over the delay", {"delay_samples", "delay / samples"}},
        {"lag", "The limit over the lag of the device's force, 0.01 to 100 ms", {"lag_over_T_1", "lag / T", true}},
        {"quantum",
         "The limit on flat places over the step of the measured position, 1 to 200 um",
         {"fc_T_over_b_quantum_1", "f_c T / (b quantum)", true}}};
    for (const auto& [quantity, title, x] : groups)
        if (!results.atlas.empty())
            figures.push_back(make_figure(
                fmt::format("loop-atlas-{}", quantity), title,
                "At the worst place of each surface with the hand's own; T is a sample, b the damping of device and "
                "hand. 2 is what is passive without delay. The table has the worst place of each kind.",
                FigureKind::scatter, "loop_atlas", {{"varied", quantity}, {"worst", "yes"}}, x,
                {"K_T_over_b_1", "limit K T / b", true}, "surface", "", {.joined = true}));
    if (!results.atlas.empty())
        figures.push_back(
            make_figure("loop-atlas-depth", "Where the grip gives way: the limit over depth, in groups without units",
                        "At the worst place of each surface with the hand's own, where the force turns outwards with "
                        "radius R. cos(t)^2 is where the grip's spring gives way, t the angle between hold and force; "
                        "less: the sampled loop grows before. On a flat wall nothing turns.",
                        FigureKind::scatter, "loop_atlas", {{"varied", "depth"}, {"worst", "yes"}},
                        {"d_over_R_1", "depth d / R", true}, {"K_d_over_kg_R_1", "limit K d / (k_g R)"}, "surface", "",
                        {.joined = true}));
    if (!results.couplings.empty())
        figures.push_back(
            make_figure("loop-couplings", "Stiffness displayed through a virtual coupling, in a scene of 1e7 N/m",
                        "At rest, through the stiffest coupling that holds. Safe: a spring alone, passive on a wall; "
                        "stiffest: with a damper, too, but its impacts may give energy; filtered: the damper's speed "
                        "through a low pass of 5 samples. All at rest at all places.",
                        FigureKind::bars, "loop_couplings", {{"scene_N_per_m", Cell(1e7).text()}},
                        {"surface", "surface"}, {"displayed_N_per_m", "displayed / (N/m)", true}, "coupling"));
    if (const auto loop = any("coupling"); loop != results.diagrams.end())
        figures.push_back(diagram_figure(results, "coupling",
                                         fmt::format("Z-width: virtual couplings to a {} of 1e7 N/m", loop->surface),
                                         {"coupling_N_per_m", "coupling's stiffness / (N/m)", true},
                                         {"coupling_N_s_per_m", "coupling's damping / (N s/m)", true}));
    if (const auto loop = any("basin"); loop != results.diagrams.end())
        figures.push_back(diagram_figure(results, "basin",
                                         fmt::format("Kicks of a device without damping: {}, {:.3g} N of friction",
                                                     loop->surface, loop->cell.hand.coulomb),
                                         {"stiffness_N_per_m", "stiffness / (N/m)", true},
                                         {"kick_um", "kick / um", true}));
    if (const auto loop = any("rounding"); loop != results.diagrams.end())
        figures.push_back(diagram_figure(
            results, "rounding",
            fmt::format("Loops over rounding and friction, {}, K = {:.4g} N/m", loop->surface, loop->cell.stiffness),
            {"quantum_um", "step of the measured position / um", true}, {"friction_N", "friction / N", true}));
    return figures;
}

} // namespace

namespace {

std::string disagreement_note(const LoopResults& results) {
    std::size_t limits = 0, kicks = 0, apart = 0, other = 0;
    for (const SteppedCheck& one : stepped_checks(results)) {
        const bool kick = one.what.starts_with("kick");
        (kick ? kicks : limits) += 1;
        (kick ? other : apart) += one.apart();
    }
    return fmt::format("Of {} limits that were stepped {} differ by more than 1 % from the linearised loop or the "
                       "closed form{}; of {} kicks that friction alone lets die out {} do, from the closed form, which "
                       "has one mode along the force. loop_disagreements lists both.",
                       limits, apart, apart == 0 ? " (none of loop_limits, loop_mesh_edges and loop_atlas)" : "", kicks,
                       other);
}

} // namespace

void add_loops(StudyData& data, const LoopResults& results) {
    data.tables = {kind_table(results),         limit_table(results), atlas_table(results),    basin_table(results),
                   disagreement_table(results), swing_table(results), worst_table(results),    profile_table(results),
                   state_table(results),        curve_table(results), coupling_table(results), press_table(results)};
    if (!results.by_edges.empty())
        data.tables.push_back(edge_limit_table(results));
    if (!results.tessellated.empty())
        data.tables.push_back(tessellation_table(results));
    data.figures = figures_of(results);
    data.notes = {
        fmt::format(
            "The hand is that of {}: {}. A constant force presses it to its depth and balances the surface's force "
            "there; its spring acts across the direction of the hold, or on all sides. Presses along which it has less "
            "than a fifth of that force, or of a wall's stiffness, are left out: further aside limits of what is "
            "curved or shaded may fall to 0. The device's largest force is left out.",
            data.scene.empty() ? "a scene that names none" : "the scene", hand_text(results.surfaces.front())),
        "A limit is the least stiffness at which a mode of the linearised loop grows, hand and device stepped exactly "
        "and the force held over a sample. At the worst place of each kind the loop is stepped through the surface's "
        "own force, too, from a disturbance of a millionth of the depth; kick_um is the largest one that decays at "
        "half the limit, which is small close to a jump of the direction.",
        "Where the direction jumps there is no linearised loop: the hand balances the mean of both sides' forces, and "
        "the probe's swing is given instead.",
        "A loop of a diagram begins a tenth of its depth too deep and a little aside, half of it with rounding and "
        "friction. It is unstable if it moves further than three depths from its place, stable if it decays or its "
        "measured position does not change any more; with rounding, the hand presses to a depth midway between two "
        "quanta, the worst case. Without damping, friction alone brings it to rest: a kick dies out if friction takes "
        "more in a cycle than the held force feeds. The grip's spring alone lets no kick die out: the limit is 0.",
        disagreement_note(results)};
}

} // namespace forceshade::study
