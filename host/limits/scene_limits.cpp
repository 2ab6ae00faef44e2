// Whether a scene is stable with its hand, and through which virtual couplings.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/limits.h"
#include "host/touch/force_errors.h"

namespace forceshade {
namespace {

constexpr double kSoftest = 1e-3, kStiffest = 32; // springs of a coupling, of what is passive

double passive_with(const HandSpec& hand, double rate) {
    return passive_stiffness(damping_of(hand), 1 / rate, hand.delay_samples);
}

// The stiffest spring with that damper, from a stiffness `low`, with which it rests, to at most `high`.
HoldingCoupling stiffest_with(RestTrials& trials, const HandSpec& hand, double damping, double low, double high) {
    constexpr double kClose = 1.001;
    const auto rests = [&](double stiffness) { return trials.all_rest(coupled(hand, stiffness, damping)); };
    if (rests(high))
        return {high, damping, {}};
    std::tie(low, high) = narrowed(low, high, kClose, rests);
    HoldingCoupling found{low, damping, {}};
    if (!rests(high)) // the last trial that failed
        found.weakest = trials.failed(coupled(hand, low, damping));
    return found;
}

struct Touched {
    LoopSurface surface;
    std::vector<RestPlace> places;
};

// As deep as a force of `most` N presses into `stiffness`, N/m of the scene; no places where nothing is touched.
Touched touched(const PreparedCase& prepared, double rate, double most, double stiffness) {
    constexpr std::size_t kPoints = 60, kPointsOfMesh = 40;
    Touched found;
    try {
        found.surface = scene_surface(prepared);
        found.surface.rate = rate;
        found.surface.deepest = std::min(found.surface.deepest, most / stiffness);
        found.places =
            searched_places(found.surface, found.surface.is_mesh() ? kPointsOfMesh : kPoints, Searched::of_all);
    } catch (const UsageError&) { // nothing to touch in the scene's box
    }
    return found;
}

} // namespace

RestTrials::RestTrials(double rate, double stiffness, const std::vector<RestPlace>& places)
    : rate_(rate), stiffness_(stiffness) {
    for (const RestPlace& place : places)
        if (!jumps(place.kind))
            for (const Hold& hold : usual_holds(place.force, place.slope))
                trials_.push_back({&place, hold});
}

bool RestTrials::all_rest(const HandSpec& hand) {
    const auto failed = std::ranges::find_if(
        trials_, [&](const Trial& one) { return grows(hand, rate_, one.hold, one.place->force_around(), stiffness_); });
    if (failed == trials_.end())
        return true;
    std::rotate(trials_.begin(), failed, failed + 1);
    return false;
}

LeastLimit RestTrials::failed(const HandSpec& hand) const {
    LeastLimit found;
    found.place = *trials_.front().place;
    found.hold = trials_.front().hold;
    found.cell = {hand, rate_, stiffness_};
    found.limit = stiffness_;
    return found;
}

std::optional<HoldingCoupling> safe_coupling(const HandSpec& hand, double rate, double stiffness,
                                             const std::vector<RestPlace>& places) {
    RestTrials trials(rate, stiffness, places);
    const double passive = passive_with(hand, rate), softest = kSoftest * passive;
    if (trials.empty() || !(passive > 0) || !trials.all_rest(coupled(hand, softest, 0)))
        return std::nullopt;
    return stiffest_with(trials, hand, 0, softest, // in line with the scene no stiffer
                         stiffness > passive ? stiffness * passive / (stiffness - passive) : kStiffest * passive);
}

std::optional<HoldingCoupling> stiffest_coupling(const HandSpec& hand, double rate, double stiffness,
                                                 const std::vector<RestPlace>& places) {
    constexpr int kDampings = 40;
    constexpr double kLeastDamping = 1e-4; // of the largest
    RestTrials trials(rate, stiffness, places);
    const double passive = passive_with(hand, rate);
    std::optional<HoldingCoupling> found;
    for (int i = 0; i <= kDampings && !trials.empty() && passive > 0; ++i) {
        const double damping = i == 0 ? 0 : hand.mass * rate * std::pow(kLeastDamping, 1 - double(i) / kDampings);
        const double least = found ? 1.01 * found->stiffness : kSoftest * passive;
        if (trials.all_rest(coupled(hand, least, damping)))
            found = stiffest_with(trials, hand, damping, least, std::max(kStiffest * passive, least));
    }
    return found;
}

SceneLimits scene_limits(const PreparedCase& prepared, double rate, double most, double scale) {
    const Scene& scene = prepared.one.scene;
    const HandSpec bare = coupled(scene.hand, 0, 0);
    SceneLimits found;
    found.stiffness = scale * scene.force.stiffness;
    if (!(damping_of(scene.hand) > 0 && found.stiffness > 0))
        return found;
    found.wall = wall_limit(bare, rate);
    LoopSurface surface;
    surface.hand = bare;
    surface.rate = rate;
    found.hand = hand_text(surface);
    const Touched as_it_is = touched(prepared, rate, most, scene.force.stiffness);
    for (const LeastLimit& one : least_limits(as_it_is.surface, as_it_is.places, {{bare, rate, 1}}, true)) {
        if (one.limit && (!found.least || *one.limit < *found.least->limit))
            found.least = one;
        if (one.any_press && (!found.turned || one.any_press->limit < found.turned->limit))
            found.turned = one.any_press;
    }
    for (const RestPlace& place : as_it_is.places)
        if (place.kind == PlaceKind::foot)
            found.foot = std::max(found.foot, place.jump);
    if (scene.hand.quantisation > 0)
        found.buzz = held_by_friction(scene.hand);
    // On a wall, too. Deeper, where a coupling gives way: for one that is not yet known as deep as it may be.
    const auto with_wall = [&](double stiffness) {
        std::vector<RestPlace> places = touched(prepared, rate, most, stiffness).places;
        places.push_back(wall_place());
        return places;
    };
    if (scene.hand.coupled()) {
        found.coupling = scene.hand.coupling_stiffness;
        const double share = coupled_share(scene.hand, found.stiffness);
        found.coupled_rests =
            RestTrials(rate, found.stiffness, with_wall(share * scene.force.stiffness)).all_rest(scene.hand);
    }
    if (scene.friction)
        found.bristle = coupled_share(scene.hand, found.stiffness) * scale * scene.friction->stiffness;
    if (!found.presses_stably())
        if (const auto safe = safe_coupling(bare, rate, found.stiffness, with_wall(0)))
            found.safe = safe->stiffness;
    return found;
}

namespace {

// N: by which the hand of the scene's own closed loop presses, at most.
double most_press(const Scene& scene) {
    const PathsSpec paths = scene.paths.value_or(PathsSpec{});
    return paths.drive == PathDrive::press ? paths.press : scene.hand.max_force;
}

} // namespace

SceneLimits scene_limits(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    return scene_limits(prepared, scene.paths.value_or(PathsSpec{}).rate, most_press(scene));
}

std::vector<WeakPlace> weak_places(const std::string& name, const std::vector<LeastLimit>& limits) {
    std::vector<WeakPlace> weak;
    const auto add = [&](const RestPlace& place, const Hold& hold, bool usual) {
        if (std::ranges::none_of(
                weak, [&](const WeakPlace& one) { return one.place.at == place.at && one.hold.along == hold.along; }))
            weak.push_back({name, place, hold, usual});
    };
    for (const LeastLimit& one : limits) {
        if (one.limit)
            add(one.place, one.hold, true);
        if (one.any_press)
            add(one.any_press->place, one.any_press->hold, false);
    }
    return weak;
}

std::vector<WeakPlace> weak_places(const std::string& name, const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    if (!(damping_of(scene.hand) > 0 && scene.force.stiffness > 0))
        return {};
    const double rate = scene.paths.value_or(PathsSpec{}).rate;
    const Touched found = touched(prepared, rate, most_press(scene), scene.force.stiffness);
    std::vector<LoopCell> cells;
    for (const double grip : {1.0, 10.0, 0.1}) {
        cells.push_back({coupled(scene.hand, 0, 0), rate, 1});
        cells.back().hand.grip_stiffness *= grip;
    }
    return weak_places(name, least_limits(found.surface, found.places, cells, true));
}

std::string SceneLimits::text() const {
    if (!(wall > 0))
        return "without damping no sampled loop comes to rest at any stiffness";
    std::string place;
    if (least && least->limit && *least->limit < 0.99 * wall)
        place = fmt::format(" ({}, {:.2g} mm deep, held {}; on a wall below {:.4g} N/m)", name_of(least->place.kind),
                            1e3 * least->place.depth, least->hold.name, wall);
    const std::string through =
        coupling ? fmt::format(", displayed as {:.4g} N/m through a virtual coupling of {:.4g} N/m, {}",
                               displayed_stiffness(stiffness, *coupling), *coupling,
                               coupled_rests ? "at rest everywhere" : "not at rest everywhere")
                 : "";
    std::string text = fmt::format("{:.6g} N/m{}; a {} comes to rest below {:.4g} N/m{}{}", stiffness, through, hand,
                                   limit(), place, coupling ? " without coupling" : "");
    if (turned && turned->limit < 0.99 * limit())
        text += fmt::format("; pressed {} ({}) below {:.4g} N/m", turned->hold.name, name_of(turned->place.kind),
                            turned->limit);
    if (foot > 0)
        text += fmt::format("; not where the surface turns inwards (by {:.0f} deg), as at the foot of a bump",
                            foot / kDegree);
    if (buzz && stiffness > *buzz)
        text += fmt::format("; above {:.4g} N/m friction does not hold a step of the measured position", *buzz);
    if (!bristle_rests())
        text += fmt::format("; the bristle of [friction] is a spring of {:.4g} N/m along the surface, where that hand "
                            "comes to rest below {:.4g} N/m",
                            *bristle, wall);
    return text;
}

std::string SceneLimits::remedy() const {
    if (!(wall > 0))
        return "set hand.damping or hand.grip_damping";
    if (presses_stably())
        return "a lower friction.stiffness would hold";
    if (coupling && stiffness < limit())
        return "leave out hand.coupling, which this scene does not need";
    const std::string other = "a lower force.stiffness, more damping, a faster loop or less delay would hold";
    return !safe ? other
                 : fmt::format("{}, or a virtual coupling without damper (hand.coupling.stiffness = \"{:.4g} N/m\": "
                               "displayed as {:.4g} N/m)",
                               other, 0.99 * *safe, displayed_stiffness(stiffness, 0.99 * *safe));
}

std::string SceneLimits::warning() const {
    if (stable() || !(stiffness > 0))
        return {};
    return fmt::format("this loop is unstable: force.stiffness is {}; {}", text(), remedy());
}

} // namespace forceshade
