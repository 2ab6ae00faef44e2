// The study of the limits of loops and numbers: loops run by an engine; their limits for hands like the surface's own,
// by damping, rate and delay, and over what sets a limit, one quantity at a time; and diagrams of the loops' states
// over stiffness and damping at the lowest limit of a surface, over the step of the measured position and friction, and
// over kicks of a device without damping.
#pragma once

#include <cmath>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/accuracy/accuracy.h"
#include "host/limits/limits.h"
#include "host/study/study_run.h"

namespace forceshade::study {

/// The final state of a loop. stable: its largest speed in the last quarter of the time is less than 3/4 of that in the
/// second, or negligible against the disturbance, or falls and is too slow to move a tenth of the disturbance in that
/// quarter, or the measured position does not change any more. unstable: it left its bound. limit_cycle: neither.
/// quantisation_cycle: a limit cycle in which the measured position changes by one quantum at most.
enum class LoopState { stable, quantisation_cycle, limit_cycle, unstable };

const char* word_of(LoopState state);

struct LoopRun {
    double disturbance = 0.1; /* of the depth: how far too deep the probe begins */
    double bound = 3;         /* depths: a probe further from its place than this has left; a late force is missing
                                 in the first sample, and the resulting swing is added twice */
    double patience = 400;    /* 1: how long a path is, in times that damping takes */
    std::size_t steps = 0;    /* of each path; 0: settling_steps of the slowest */
    bool all_sides = false;   /* the grip's spring holds the hand along z, too */
    bool swings = false;      /* measure LoopOutcome::swing */
};

/// The outcome of a loop.
struct LoopOutcome {
    LoopState state = LoopState::stable;
    double early = 0, late = 0; /* m/s: largest speeds in the second quarter of the time and in the last */
    bool left = false;          /* its bound */
    bool at_rest = false;       /* its speed is negligible against the disturbance's */
    double moved = 0; /* m: from its place to the middle of the farthest positions of the last quarter; as swing */
    double swing = 0; /* m: between its farthest measured positions, along the axis of the most, in the last
                         quarter; with LoopRun::swings or where the hand measures in quanta */
};

/// All cells at once, in double where the engine has it.
std::vector<LoopOutcome> run_cells(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                   const std::vector<LoopCell>& cells, const LoopRun& run);

/// The surface's own hand, linear, then others around it.
std::vector<LoopCell> settings_of(const LoopSurface& surface, bool quick);

/// The oscillation of a probe that rests on a jump of the direction.
struct EdgeSwing {
    std::string surface;
    RestPlace place;
    double stiffness = 0; /* N/m */
    LoopOutcome outcome;
};

/// Of the eight sharpest jumps of each kind and depth, the one with the largest swing, over stiffnesses; with the
/// surface's own hand pressed down.
std::vector<EdgeSwing> edge_swings(Engine& engine, const LoopSurface& surface, const std::vector<RestPlace>& places);

/// A loop of a diagram.
struct DiagramLoop {
    std::string diagram, surface; /* "damping", "coupling", "rounding", "basin" */
    LoopCell cell;
    LoopOutcome outcome{};
    bool foreseen = false; /* to come to rest: by the linearised loop; with rounding by
                              K <= min(2 b / T, 2 f_c / quantum), which is enough on a wall */
    double kick = 0;       /* m: where kicks are varied */
};

/// Value number i of `count` in even ratios from `low` to `high`, with four digits: what is chosen freely is chosen
/// short.
double short_between(double low, double high, int i, int count);

/// The loop with this damping, N s/m, of device and hand together.
LoopCell damped(LoopCell cell, double damping);

/// Over stiffness and damping at a limit's place; its hold must be one that paths have: down or on all sides.
std::vector<DiagramLoop> damping_diagram(Engine& engine, const LoopSurface& surface, const LeastLimit& least,
                                         bool quick);

/// Over stiffness and damping of a virtual coupling (the Z-width of Colgate & Brown 1994), pressed down onto a scene of
/// 1e7 N/m there.
std::vector<DiagramLoop> coupling_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                          bool quick);

/// Over quantum and friction, the hand pressed down there. The stiffness is the scene's, or 1000 N/m.
std::vector<DiagramLoop> rounding_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                          bool quick);

/// Loops on a wall without damping, over stiffness and kick; `foreseen` by friction_basin.
std::vector<DiagramLoop> basin_diagram(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

/// How far friction alone lets kicks die out at a place, with and without the grip's spring.
struct BasinRow {
    LeastLimit there;              /* place, hold and loop, without damping, with its stiffness; the friction is that by
                                      which `foreseen` is a small share of the depth: both are proportional */
    double foreseen = 0;           /* m: friction_basin */
    std::optional<double> stepped; /* m: dying_kick */
};

/// At the worst place of each kind with the surface's own hand, zero to two samples late; of least_limits of that
/// surface. Without a grip only where the surface turns nowhere outwards. At half the stiffness at most that the grip
/// holds.
std::vector<BasinRow> basins_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick);

/// A point of a line over a diagram.
struct CurvePoint {
    std::string diagram, curve; /* "K_crit" */
    /* SI; NaN: does not apply */
    double stiffness = NAN, damping = NAN, quantum = NAN, friction = NAN, kick = NAN;
    double coupling = NAN, coupling_damping = NAN; /* N/m, N s/m: of a virtual coupling */
};

/// K_crit and the linearised loop over damping; the linearised loop, with filters, too, and what is passive over
/// couplings; f_c = K quantum / 2 over quantum, friction_basin over stiffness: within the diagrams.
std::vector<CurvePoint> curves_over(const std::vector<DiagramLoop>& loops, const LeastLimit& least);

/// A place, and what one quantity makes of its limit; all else is the surface's own hand.
struct AtlasPoint {
    LeastLimit least;     /* over the usual holds there; simulated where that takes few steps */
    std::string quantity; /* "mass" */
    double value = 0;     /* SI */

    /// 1: the groups on which a limit depends, besides the delay in samples: K T / b, b T / m, k_g T / b.
    double limit_group() const;
    double mass_group() const;
    double grip_group() const;
    double lag_group() const;      // the lag over a sample
    double depth_group() const;    // the depth over the radius by which the force turns there; below 0 in a hollow
    double balance_group() const;  // K d / (k_g R), 1 where the hand presses against the force; NaN if nothing turns
    double friction_group() const; // f_c T / (b quantum); half of K T / b where friction just holds a quantum
};

/// What is varied: mass from a gram to 10 kg, grip from 20 to 5000 N/m, damping from 0.03 to 100 N s/m, rate from 100
/// Hz to 100 kHz, delay from 0 to 8 samples, lag of the device's force from 10 us to 0.1 s, depth from a hundredth of
/// the deepest on. On flat places step of the measured position from 1 to 200 um and Coulomb friction from 0.5 mN to 5
/// N.
struct Quantity {
    const char *name, *unit;
    double low, high; /* SI; of the depth over the deepest */
    void (*set)(LoopCell&, double);
};
std::span<const Quantity> quantities();

/// The row with the least limit of those with the hand's own damping, rate and delay; of all surfaces where `surface`
/// is empty, of all depths (m) and kinds without one. Null: none.
const LeastLimit* worst_of(const std::vector<LeastLimit>& limits, const std::string& surface = {},
                           std::optional<double> depth = {}, std::optional<PlaceKind> kind = {});

/// At the worst place of each kind with the surface's own hand: of least_limits of that surface. Steps of the measured
/// position and friction are varied where there is an engine to step them, from a kick of half the deepest, on flat
/// places: they have none within such a kick where the direction jumps.
std::vector<AtlasPoint> atlas_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick,
                                 Engine* engine = nullptr);

/// A point of direction_profile().
struct ProfilePoint {
    std::string surface;
    double x, z; /* m */
};

/// A virtual coupling through which the surface's own hand may feel a stiffness.
struct CouplingRow {
    std::string surface, which;   /* "own": the scene's; "safe", "stiffest", "filtered" */
    double scene = 0;             /* N/m */
    HoldingCoupling coupling;     /* N/m, N s/m */
    double filter = 0;            /* s: of the damper's speed */
    bool rests = true;            // at all places
    std::optional<bool> foreseen; /* stepped at its weakest place: 2 % softer rests, 2 % stiffer grows */
};

/// Samples: the filter of "filtered", a low pass of 32 Hz at 1 kHz.
inline constexpr int kUsualFilter = 5;

/// Of 1e4, 1e5, 1e6 and 1e7 N/m and the scene's own, if that is another. Of the stiffest scene with a filter, too.
std::vector<CouplingRow> couplings_on(const LoopSurface& surface, const std::vector<RestPlace>& places);

/// With the program's default hand: plane, the same textured, bump of 2 facets with and without shading, height map of
/// a bump and of a dip, mesh of 8 cells with and without shading; of the bump with 8 facets and of the other shadings
/// of a mesh the limits alone.
std::vector<LoopSurface> own_surfaces();

/// The limit at the place of a surface's least limit of any press, of a hand that presses in another direction.
struct PressLimit {
    std::string surface;
    double turn = 0;     /* deg: from straight down, towards the press of the least limit */
    double limit = 0;    /* N/m */
    bool counts = false; // whether the surface supports it
    RestPlace place;
};

/// A limit with the hand's own on a mesh that was tessellated anew.
struct TessellatedLimit {
    std::size_t tessellation = 0; /* 0: the surface's own */
    LeastLimit least;
};

struct LoopResults {
    std::vector<LoopSurface> surfaces;
    std::vector<LeastLimit> limits;
    std::vector<TessellatedLimit> tessellated; /* of the study's own meshes */
    std::vector<LeastLimit> by_edges; /* of meshes: the least by an edge and at a vertex, of each kind of place */
    std::vector<AtlasPoint> atlas;
    std::vector<BasinRow> basins;
    std::vector<EdgeSwing> swings;
    std::vector<CouplingRow> couplings;
    std::vector<DiagramLoop> diagrams;
    std::vector<CurvePoint> curves;
    std::string diagram_kind; /* of the place of the diagram over damping */
    std::vector<ProfilePoint> profile;
    std::vector<PressLimit> presses;
    std::vector<WeakPlace> weak; /* of the study's own surfaces */
};

/// A limit, or a kick, by the linearised loop or a closed form, and stepped.
struct SteppedCheck {
    std::string what; /* "limit", "limit of any press", "limit by an edge", "limit over mass", "kick that dies out" */
    LeastLimit there;
    double value = NAN;               /* of what is varied; SI */
    double foreseen = 0, stepped = 0; /* N/m, or m of a kick */

    double off() const { return stepped / foreseen - 1; }
    bool apart() const { return !(std::abs(off()) <= 0.01); }
};

/// All of them.
std::vector<SteppedCheck> stepped_checks(const LoopResults& results);

/// Adds tables, figures and notes of the loops.
void add_loops(StudyData& data, const LoopResults& results);

/// Their findings: at most six.
std::vector<Finding> loop_findings(const LoopResults& results);

/// Up to which stiffness a loop with a renderer's force is stable, next to the scene's own law, both stepped alike.
struct RendererLimit {
    std::string renderer; /* "mine:fast", "own law with friction" */
    LeastLimit there;     /* place, hold and hand; its limit is of the linearised loop */
    SteppedLimit limit;
    SteppedRest rest{};        /* at the scene's stiffness */
    SteppedLimit own;          /* of the scene's own law */
    std::string status = "ok"; /* or what the renderer did wrong, which ended its process */
};

/// The surface's own law, of 1 N/m, with the history that a path has. `surface` must outlive it.
MakePathForce own_path_law(const LoopSurface& surface);

/// Of run.rubbing() and the renderers, at the worst place of each kind with the scene's own hand, and at the worst of
/// all over the hand's damping. \throws as StudyRun::run.
std::vector<RendererLimit> renderer_limits(StudyRun& run, const LoopSurface& surface,
                                           const std::vector<LeastLimit>& limits);

/// Adds a table, a figure, a note and a finding for each; nothing without one.
void add_renderer_limits(StudyData& data, const LoopSurface& surface, const std::vector<RubbingLaw>& rubbing,
                         const std::vector<RendererLimit>& limits);

/// "1166 N/m"
std::string newtons(double stiffness);

// Differences between single and double precision: of forces over sizes, stiffnesses and distances, one parameter of a
// plain scene after the other, to the limits of the numbers; and the worst that a search finds.

/// A surface with one parameter of a plain scene at one value: the errors of its fields count together. Axes:
/// "radius_ratio", "facets", "stiffness", "origin", "spacing", "depth"; SI. From draw 1 on its grids are moved at
/// random.
using NumberCase = std::vector<FieldAtHome>;
NumberCase number_case(const std::string& surface, const std::string& axis, double value, std::uint64_t draw = 0);
std::vector<std::string> number_surfaces();

/// A surface with one parameter at one value, in a precision.
struct NumberRow {
    std::string surface, axis;
    double value = 0; /* SI */
    std::string precision;
    PrecisionErrors errors{}; /* the largest of the draws */
    double least = NAN;       /* 1: errors.force of the draw where it is least */
};

/// A part for each surface and axis; `found` must outlive them and receives the rows of each.
std::vector<Part> number_parts(Engine& engine, bool quick, std::deque<std::vector<NumberRow>>& found);

/// Adds table, figures and notes.
void add_numbers(StudyData& data, const std::vector<NumberRow>& rows);

/// The worst of a law.
struct LawRounding : WorstRounding {
    std::string law; /* "morgenbesser mesh, god-object" */
};

/// A part for each law of the study's own, or of the scene; `found` must outlive them and receives two a law, at most:
/// the worst of the same facet, and of another one.
std::vector<Part> worst_rounding_parts(const PreparedCase* scene, bool quick,
                                       std::deque<std::vector<LawRounding>>& found);

/// Adds the table and its finding. `own`: of the study's laws, not of a scene's.
void add_worst_rounding(StudyData& data, const std::vector<LawRounding>& found, bool own);

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_stability(StudyRun& run);

} // namespace forceshade::study
