#include "host/limits/limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "host/field/case_law.h"
#include "host/limits/critical_stiffness.h"
#include "host/reference/path_step.h"
#include "host/touch/force_errors.h"

namespace forceshade {
namespace {

TouchPlace touched_at(const RestPlace& place) {
    return {place.at, place.normal, place.below};
}

// The disturbance of a loop, and what counts as far and as gone.
struct Disturbance {
    double size;           // of the depth
    double far;            // of the disturbance: the loop grows
    double gone;           // of its energy: the loop has come to rest
    bool anywhere = false; // at any place, as friction may hold it: its speed alone counts
};
constexpr Disturbance kLinear{1e-6, 1e4, 1e-6}; // by which a loop is still linear

// Around a place, m: of a mesh the god-object's, which has come down to it and goes on from there.
class ForceThere {
public:
    ForceThere(const LoopSurface& surface, const RestPlace& place)
        : at_(place.at), mesh_(surface.is_mesh()), probe_(surface.prepared),
          descent_(descent(touched_at(place), surface.scale())) {}

    void begin() {
        if (mesh_)
            force_after(probe_, descent_);
    }
    glm::dvec3 operator()(const glm::dvec3& aside) {
        return glm::dvec3(mesh_ ? probe_.at(at_ + aside).contact.force : probe_.law().at(at_ + aside).force);
    }

private:
    glm::dvec3 at_;
    bool mesh_;
    CaseProbe<double> probe_;
    std::vector<glm::dvec3> descent_;
};

// How a disturbance of a loop grows: the logarithm of its energy late over early.
class Simulation {
public:
    /// Over the stiffness, m: of the law at a distance, m, from the place.
    using Force = std::function<glm::dvec3(const glm::dvec3& aside)>;

    Simulation(const LoopSurface& surface, const LeastLimit& least)
        : Simulation(least, std::make_shared<ForceThere>(surface, least.place), surface.is_mesh() ? 100 : 400) {}

    /// `rest` is the force at the place, which the hand balances.
    Simulation(const LeastLimit& least, std::size_t steps, const Disturbance& disturbance, Force force,
               const glm::dvec3& rest)
        : force_(std::move(force)), rest_(rest), least_(least), axes_(axes_of(least.hold)), disturbance_(disturbance),
          steps_(steps) {
        const std::array<Axis, 3> held = axes_of(least.hold, least.cell.hand);
        for (std::size_t i = 0; i < 3; ++i) {
            maps_[i] = axis_map(held[i], 1 / least.cell.rate);
            lags_[i] = lag_map(held[i], 1 / least.cell.rate, least.cell.lag);
            springs_[i] = held[i].stiffness;
        }
    }

    /// With the hand's Coulomb friction on each axis, and `steps`; without a lag.
    static Simulation with_friction(const LoopSurface& surface, const LeastLimit& there, std::size_t steps) {
        Simulation simulation(surface, there);
        simulation.coulomb_ = there.cell.hand.coulomb;
        simulation.steps_ = steps;
        simulation.disturbance_.anywhere = true;
        return simulation;
    }

    // `disturbance`, m, in the hand's axes.
    double growth(double stiffness, const glm::dvec3& disturbance) {
        constexpr double kFarthest = 3; // depths
        constexpr double kStill = 0.01;
        constexpr std::size_t kLongStill = 100;
        const double begins = reference::length(disturbance);
        const double far = std::min(disturbance_.far * begins, kFarthest * least_.place.depth);
        glm::dvec3 at = disturbance, speed(0), shown(0);
        std::vector<glm::dvec3> late(least_.cell.hand.delay_samples + 1, glm::dvec3(0));
        const double quick = stiffness / least_.cell.hand.mass; // 1 / s^2
        const HandSpec& hand = least_.cell.hand;
        const auto coupling = coupling_of<double>(hand, stiffness, 1 / least_.cell.rate);
        const double share = coupled_share(hand, stiffness);
        double lag = (1 - share) * reference::length(rest_); /* m */
        double early = 0, last = 0, squares = 0;
        glm::dvec3 begin(0), sum(0); // of the last quarter, from its begin
        std::size_t still = 0;       // samples in a row with next to no energy
        if (begin_)
            begin_();
        rest_found_ = {INFINITY, INFINITY};
        for (std::size_t step = 0; step < steps_; ++step) {
            const glm::dvec3 force = force_(axes_ * at); /* m: for each N/m */
            const glm::dvec3 coupled_force =
                reference::through_coupling(coupling, force, reference::length(force), lag);
            late[step % late.size()] = stiffness * glm::transpose(axes_) * (coupled_force - share * rest_);
            const glm::dvec3 given = late[(step + 1) % late.size()], excess = shown - given;
            for (int i = 0; i < 3; ++i) {
                const auto& map = maps_[static_cast<std::size_t>(i)];
                if (coulomb_ > 0) {
                    const auto motion = reference::advance_axis_with_friction(
                        map, {at[i], speed[i], given[i], springs_[static_cast<std::size_t>(i)]}, coulomb_,
                        1 / least_.cell.rate);
                    at[i] += motion.shift;
                    speed[i] = motion.speed;
                    continue;
                }
                const LagMap& lag_of = lags_[static_cast<std::size_t>(i)];
                const double before = at[i];
                at[i] +=
                    map.x_error * before + map.x_speed * speed[i] + map.x_force * given[i] + lag_of.place * excess[i];
                speed[i] =
                    map.v_error * before + map.v_speed * speed[i] + map.v_force * given[i] + lag_of.speed * excess[i];
                shown[i] = given[i] + lag_of.left * excess[i];
            }
            const double moving = glm::dot(speed, speed), away = quick * glm::dot(at, at);
            if (moving + away > quick * far * far)
                return 1;
            const double energy = moving + (disturbance_.anywhere ? 0 : away);
            const double left = coulomb_ > 0 ? moving : moving + away; // friction may hold it anywhere
            still = left < kStill * disturbance_.gone * quick * begins * begins ? still + 1 : 0;
            if (still > kLongStill + late.size() && (coulomb_ > 0 || !disturbance_.anywhere) && least_.cell.lag == 0)
                return -1;
            if (step >= steps_ / 4 && step < steps_ / 2)
                early = std::max(early, energy);
            if (step >= steps_ - steps_ / 4) {
                if (step == steps_ - steps_ / 4)
                    begin = at;
                last = std::max(last, energy);
                sum += at - begin;
                squares += glm::dot(at - begin, at - begin);
            }
        }
        const std::size_t samples = steps_ / 4;
        const glm::dvec3 mean = sum / double(samples);
        rest_found_ = {std::sqrt(std::max(0.0, squares / double(samples) - glm::dot(mean, mean))),
                       glm::length(begin + mean)};
        const bool gone = last < disturbance_.gone * quick * begins * begins;
        return gone ? -1 : std::log(last / early);
    }
    double growth(double stiffness) {
        return growth(stiffness, disturbance_.size * least_.place.below * glm::dvec3(0.5, 0.3, -1));
    }
    const SteppedRest& rest_found() const { return rest_found_; } // of the last

private:
    Simulation(const LeastLimit& least, const std::shared_ptr<ForceThere>& there, double patience)
        : Simulation(
              least, settling_steps(least.cell, patience), kLinear,
              [there](const glm::dvec3& aside) { return (*there)(aside); }, least.place.force) {
        begin_ = [there] { there->begin(); };
    }

    Force force_;
    std::function<void()> begin_; // a path, if its force has a history
    SteppedRest rest_found_;
    glm::dvec3 rest_; /* m */
    const LeastLimit& least_;
    glm::dmat3 axes_;
    Disturbance disturbance_;
    std::array<layout::AxisMap<double>, 3> maps_{};
    std::array<LagMap, 3> lags_{};
    std::array<double, 3> springs_{}; /* N/m */
    double coulomb_ = 0;              /* N */
    std::size_t steps_;
};

// The lower of a limit at a hold and the least so far; only where that is not stable up to the least so far.
void take_lower(std::optional<HoldLimit>& least, const LoopCell& cell, const RestPlace& place, const Hold& hold,
                double share = 0.9999) {
    if (least && !grows(cell.hand, cell.rate, hold, place.force_around(), share * least->limit, cell.lag))
        return;
    const auto limit = linear_limit(cell.hand, cell.rate, hold, place.force_around(), cell.lag);
    if (limit && (!least || *limit < least->limit))
        least = HoldLimit{*limit, hold, place};
}

// A press, turned to where its place's limit is least.
HoldLimit turned_to_least(const HoldLimit& from, const LoopCell& cell) {
    std::optional<HoldLimit> least = from;
    for (double step = 8 * kDegree; step > 0.1 * kDegree; step /= 2)
        for (double before = 0; before != least->limit;) {
            before = least->limit;
            const glm::dmat3 frame = axes_of(least->hold);
            for (int turn = 0; turn < 8; ++turn) {
                const double angle = turn * 45 * kDegree;
                const glm::dvec3 side = std::cos(angle) * frame[0] + std::sin(angle) * frame[1];
                const Hold hold = pressed_along(std::cos(step) * frame[2] + std::sin(step) * side);
                if (supports(hold.along, least->place.force, least->place.slope))
                    take_lower(least, cell, RestPlace(least->place), hold, 0.999);
            }
        }
    return *least;
}

// Of all places, pressed in any direction: from the least of some directions of each place that has one near the least
// of all, and of `lowest`, turned to where it is least. Limits have several least ones over the directions.
std::optional<HoldLimit> least_of_any_press(const LoopCell& cell, const std::vector<const RestPlace*>& places,
                                            const std::optional<HoldLimit>& lowest) {
    constexpr double kNear = 1.5; // times the least
    constexpr std::size_t kMost = 12;
    std::optional<HoldLimit> least = lowest;
    std::vector<HoldLimit> begins;
    if (lowest)
        begins.push_back(*lowest);
    for (const RestPlace* place : places) {
        std::optional<HoldLimit> own;
        for (const Hold& hold : all_presses(place->force, place->slope))
            if (!least || grows(cell.hand, cell.rate, hold, place->force_around(), kNear * least->limit, cell.lag))
                take_lower(own, cell, *place, hold);
        if (!own)
            continue;
        begins.push_back(*own);
        if (!least || own->limit < least->limit)
            least = own;
    }
    std::erase_if(begins, [](const HoldLimit& one) { return one.hold.along == glm::dvec3(0); });
    std::ranges::stable_sort(begins, {}, &HoldLimit::limit);
    for (std::size_t i = 0; i < std::min(begins.size(), kMost); ++i)
        if (const HoldLimit turned = turned_to_least(begins[i], cell); turned.limit < least->limit)
            least = turned;
    return least;
}

// Walks along the surface, in steps of twice the depth and less, as long as `lower` finds a lower limit there.
template <typename Lower> void walk_down(NearbyPlaces& nearby, std::optional<HoldLimit>& least, const Lower& lower) {
    constexpr std::size_t kMost = 240; // places
    const double depth = least->place.depth;
    std::size_t tried = 0;
    for (double step = 2 * depth; step > depth / 50; step /= 2)
        for (double before = NAN; before != least->limit && least->limit > 0 && tried < kMost;) {
            before = least->limit;
            const RestPlace from = least->place;
            const auto [u, v] = directions_across(from.normal);
            for (int turn = 0; turn < 8; ++turn, ++tried) {
                const double angle = turn * 45 * kDegree;
                const auto place = nearby.aside(from, step * (std::cos(angle) * u + std::sin(angle) * v));
                if (place && place->kind == from.kind)
                    lower(*place);
            }
        }
}

} // namespace

std::vector<RestPlace> searched_places(const LoopSurface& surface, std::size_t count, Searched from) {
    std::vector<RestPlace> places = rest_places(surface, count);
    const LoopCell own{surface.hand, surface.rate, 1};
    std::map<std::pair<PlaceKind, double>, std::optional<HoldLimit>> least; // by kind and depth
    for (const RestPlace& place : places)
        if (!jumps(place.kind))
            for (const Hold& hold : usual_holds(place.force, place.slope))
                take_lower(from == Searched::of_all ? least[{}] : least[{place.kind, place.depth}], own, place, hold);
    NearbyPlaces nearby(surface);
    for (auto& entry : least) {
        std::optional<HoldLimit>& one = entry.second;
        if (!one)
            continue;
        walk_down(nearby, one, [&](const RestPlace& place) {
            for (const Hold& hold : usual_holds(place.force, place.slope))
                take_lower(one, own, place, hold, 0.999);
        });
        places.push_back(one->place);
        if (one->hold.along == glm::dvec3(0))
            continue;
        one = turned_to_least(*one, own);
        walk_down(nearby, one, [&](const RestPlace& place) {
            if (supports(one->hold.along, place.force, place.slope))
                take_lower(one, own, place, one->hold, 0.999);
        });
        places.push_back(one->place);
    }
    return places;
}

std::size_t settling_steps(const LoopCell& cell, double patience) {
    constexpr double kLeast = 2000, kMost = 1e6;
    const double loses = -std::expm1(-damping_of(cell.hand) / (cell.rate * cell.hand.mass));
    return static_cast<std::size_t>(std::clamp(patience / loses, kLeast, kMost));
}

LeastLimit least_of(const LoopSurface& surface, const std::vector<const RestPlace*>& places, const LoopCell& cell) {
    std::optional<HoldLimit> lowest;
    for (const RestPlace* place : places)
        for (const Hold& hold : usual_holds(place->force, place->slope))
            take_lower(lowest, cell, *place, hold);
    LeastLimit one;
    one.surface = surface.name;
    one.place = lowest ? lowest->place : *places.front();
    if (lowest) {
        one.hold = lowest->hold;
        one.limit = lowest->limit;
    }
    one.cell = cell;
    one.places = places.size();
    one.wall = wall_limit(cell.hand, cell.rate, cell.lag);
    return one;
}

std::vector<LeastLimit> least_limits(const LoopSurface& surface, const std::vector<RestPlace>& places,
                                     const std::vector<LoopCell>& cells, bool any_press) {
    std::vector<LeastLimit> least;
    for (const PlaceKind kind : kPlaceKinds)
        for (const double depth : surface.depths()) {
            std::vector<const RestPlace*> some;
            for (const RestPlace& place : places)
                if (place.kind == kind && !jumps(kind) && place.depth == depth)
                    some.push_back(&place);
            std::optional<HoldLimit> own_press;
            for (const LoopCell& cell : cells) {
                if (some.empty())
                    continue;
                LeastLimit& one = least.emplace_back(least_of(surface, some, cell));
                one.own = &cell == &cells.front();
                if (!any_press)
                    continue;
                std::optional<HoldLimit> lowest;
                if (one.limit)
                    lowest = HoldLimit{*one.limit, one.hold, one.place};
                if (one.own) {
                    own_press = one.any_press = least_of_any_press(cell, some, lowest);
                    continue;
                }
                std::vector<const RestPlace*> likely{&one.place};
                if (own_press && own_press->place.at != one.place.at)
                    likely.push_back(&own_press->place);
                one.any_press = least_of_any_press(cell, likely, lowest);
            }
        }
    return least;
}

std::optional<double> simulated_limit(const LoopSurface& surface, const LeastLimit& least) {
    constexpr double kFrom = 0.3, kTo = 3, kClose = 1.0005; // of the linearised loop's limit
    constexpr double kBelow = 0.98, kAbove = 1.02;          // where it is looked for first
    if (!least.limit || !(*least.limit > 0))
        return std::nullopt;
    Simulation simulation(surface, least);
    const auto grows_at = [&](double stiffness) { return !(simulation.growth(stiffness) < 0); };
    const bool near = std::ranges::none_of(std::array{kFrom, 0.6, 0.9, kBelow},
                                           [&](double share) { return grows_at(share * *least.limit); }) &&
                      grows_at(kAbove * *least.limit);
    return least_growing((near ? kBelow : kFrom) * *least.limit, kTo * *least.limit, kClose, grows_at);
}

bool decays(const LoopSurface& surface, const LeastLimit& there) {
    return Simulation(surface, there).growth(there.cell.stiffness) < 0;
}

namespace {

// Loops of a law's forces on paths that come down to a place and are kicked there.
class KickedLoop {
public:
    KickedLoop(const LoopSurface& surface, const LeastLimit& there, const MakePathForce& make, double far)
        : there_(there), make_(make), kick_{1e-3, far, 1e-4, true}, place_(touched_at(there.place)),
          descent_(descent(place_, surface.scale())) {
        constexpr double kTimes = 10, kMostSteps = 1e5; // of the time in which the grip brings the probe back
        const HandSpec& hand = there.cell.hand;
        double slowest = 0; /* s */
        if (hand.grip_stiffness > 0)
            slowest = damping_of(hand) / hand.grip_stiffness;
        else // into the surface alone: nothing brings it back from aside
            way_ = -glm::normalize(glm::transpose(axes_of(there.hold)) * there.place.force);
        steps_ = std::max(settling_steps(there.cell, 100),
                          static_cast<std::size_t>(std::min(kTimes * slowest * there.cell.rate, kMostSteps)));
    }

    // As Simulation::growth; empty without a force at the place.
    std::optional<double> growth(double stiffness) {
        const PathForce force = make_(stiffness);
        glm::dvec3 rest(0);
        for (const glm::dvec3& probe : descent_)
            rest = force(probe) / stiffness;
        if (rest == glm::dvec3(0))
            return std::nullopt;
        Simulation simulation(
            there_, steps_, kick_, [&](const glm::dvec3& from) { return force(place_.at + from) / stiffness; }, rest);
        const double growth = simulation.growth(stiffness, kick_.size * place_.depth * way_);
        rest_found_ = simulation.rest_found();
        return growth;
    }
    const SteppedRest& rest_found() const { return rest_found_; } // of the last

private:
    const LeastLimit& there_;
    const MakePathForce& make_;
    Disturbance kick_; // beyond the rounding errors of single precision
    TouchPlace place_;
    std::vector<glm::dvec3> descent_;
    glm::dvec3 way_{0.5, 0.3, -1}; // in the hand's axes
    std::size_t steps_ = 0;
    SteppedRest rest_found_;
};

} // namespace

SteppedRest stepped_rest(const LoopSurface& surface, const LeastLimit& there, const MakePathForce& make,
                         double stiffness) {
    KickedLoop loop(surface, there, make, INFINITY);
    return loop.growth(stiffness) ? loop.rest_found() : SteppedRest{};
}

SteppedLimit stepped_limit(const LoopSurface& surface, const LeastLimit& there, const MakePathForce& make) {
    constexpr double kLow = 10, kHigh = 1e7, kClose = 1.01; /* N/m; of a stiffness */
    constexpr double kDecays = -0.05; // moves a limit by a thousandth; less is a steady vibration, rounded
    constexpr double kFar = 30;       // of the kick: there it has left the place
    KickedLoop loop(surface, there, make, kFar);
    bool touches = true;
    const auto rests = [&](double stiffness) {
        const std::optional<double> growth = loop.growth(stiffness);
        touches = touches && growth;
        return touches && *growth < kDecays;
    };
    if (rests(kHigh))
        return {kHigh, LimitEnd::above};
    const bool within = touches && rests(kLow);
    const auto [below, above] = within ? narrowed(kLow, kHigh, kClose, rests) : std::pair<double, double>();
    if (!touches)
        return {NAN, LimitEnd::no_force};
    return within ? SteppedLimit{std::sqrt(below * above), LimitEnd::within} : SteppedLimit{kLow, LimitEnd::below};
}

std::optional<double> largest_kick(const LoopSurface& surface, const LeastLimit& least) {
    constexpr double kShare = 0.5, kDies = -0.7; // of the limit; halves its energy
    if (!least.limit || !(*least.limit > 0))
        return std::nullopt;
    Simulation simulation(surface, least);
    double largest = 0;
    for (const double kick : {0.1e-6, 0.2e-6, 0.5e-6, 1e-6, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6}) {
        for (const double way : {-kick, kick})
            if (simulation.growth(kShare * *least.limit, way / std::sqrt(3.0) * glm::dvec3(1)) > kDies)
                return largest;
        largest = kick;
    }
    return largest;
}

std::optional<double> dying_kick(const LoopSurface& surface, const LeastLimit& there, double expected) {
    constexpr double kRange = 4, kClose = 1.001;
    constexpr double kPatience = 80, kMost = 30000; // a kick 1 % beyond has grown by e^(80 / 4) of that
    const double turn = std::sqrt(there.cell.stiffness / there.cell.hand.mass) / there.cell.rate; // rad: w T
    Simulation simulation =
        Simulation::with_friction(surface, there, static_cast<std::size_t>(std::min(kPatience / (turn * turn), kMost)));
    const glm::dvec3 down = glm::transpose(axes_of(there.hold)) * glm::dvec3(0, 0, -1);
    const auto dies = [&](double kick) { return simulation.growth(there.cell.stiffness, kick * down) < 0; };
    if (!dies(expected / kRange) || dies(expected * kRange))
        return std::nullopt;
    const auto [low, high] = narrowed(expected / kRange, expected * kRange, kClose, dies);
    return std::sqrt(low * high);
}

double friction_basin(double mass, double friction, double stiffness, double sample_time, std::uint64_t delay) {
    const double late = (0.5 + static_cast<double>(delay)) * sample_time; // s
    return 4 * friction / (std::numbers::pi * stiffness * late * std::sqrt(stiffness / mass));
}

double friction_basin(const LoopCell& cell, const RestPlace& place, const Hold& hold) {
    const HandSpec& hand = cell.hand;
    const glm::dvec3 way = place.force / glm::length(place.force);
    const double held = cell.stiffness * glm::dot(way, place.slope * way); // N/m: along the force
    const double pressed = hold.along == glm::dvec3(0) ? 0 : glm::dot(way, hold.along);
    const double grip = hand.grip_stiffness * (1 - pressed * pressed); // N/m
    const double samples = 0.5 + static_cast<double>(hand.delay_samples);
    double turn = std::sqrt((grip + held) / hand.mass) / cell.rate, share = 1; // rad a sample; of what is held
    for (int i = 0; i < 40; ++i) {
        share = std::sin(turn / 2) / (turn / 2);
        turn = std::sqrt((grip + held * share * std::cos(samples * turn)) / hand.mass) / cell.rate;
    }
    const double friction = hand.coulomb * (std::abs(way.x) + std::abs(way.y) + std::abs(way.z));
    const double amplitude = 4 * friction / (std::numbers::pi * held * share * std::sin(samples * turn));
    return amplitude / std::abs(way.z);
}

double rounded_limit(const LoopCell& cell, double kick) {
    const HandSpec& hand = cell.hand;
    const double still = held_by_friction(hand);
    double limit = still;
    for (int i = 0; i < 60; ++i) {
        const double slides = 4 * hand.coulomb / (std::numbers::pi * std::sqrt(limit / hand.mass) * kick); // N s/m
        const double next = critical_stiffness(hand.mass, damping_of(hand) + slides, 1 / cell.rate, hand.delay_samples);
        limit = std::sqrt(limit * next);
    }
    return std::min(still, limit);
}

std::string weak_places_text(const std::vector<WeakPlace>& places) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const WeakPlace& weak : places) {
        nlohmann::ordered_json slope = nlohmann::ordered_json::array(); // columns
        for (int i = 0; i < 9; ++i)
            slope.push_back(weak.place.slope[i / 3][i % 3]);
        const glm::dvec3& along = weak.hold.along;
        all.push_back({{"surface", weak.surface},
                       {"place", name_of(weak.place.kind)},
                       {"depth_m", weak.place.depth},
                       {"held", weak.hold.name},
                       {"along", {along.x, along.y, along.z}},
                       {"usual", weak.usual},
                       {"slope", std::move(slope)}});
    }
    return all.dump();
}

} // namespace forceshade
