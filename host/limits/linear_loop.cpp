#include "host/limits/linear_loop.h"

#include <algorithm>
#include <complex>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <unsupported/Eigen/MatrixFunctions>

#include "host/field/case_law.h"
#include "host/touch/force_errors.h"

namespace forceshade {
namespace {

// What a sample's force and the lag of a virtual coupling become, by the place and the lag before, in a hand's axes;
// forces in units of mass / sample^2.
struct LoopForce {
    glm::dmat3 of_place; /* columns: places */
    glm::dvec3 of_lag{0}, lag_of_place{0};
    double lag_of_lag = 0;
};

// Through a coupling the tool follows the depth, and the force keeps the direction that the law gives at the probe.
LoopForce force_of(const HandSpec& hand, double period, const glm::dmat3& axes, const ForceAround& force,
                   double stiffness, double unit) {
    const glm::dmat3 depths = -(glm::transpose(axes) * force.slope * axes); // for 1 N/m, of places
    if (!hand.coupled())
        return {stiffness / unit * depths};
    const layout::Coupling<double> coupling = coupling_of<double>(hand, stiffness, period);
    const glm::dvec3 along = glm::normalize(glm::transpose(axes) * force.direction);
    const glm::dvec3 depth = along * depths; // what a place adds to the depth
    const double at_rest = coupled_share(hand, stiffness);
    LoopForce found;
    found.of_place =
        stiffness / unit * (at_rest * depths + (coupling.depth - at_rest) * glm::outerProduct(along, depth));
    found.of_lag = -stiffness / unit * coupling.lag * along;
    found.lag_of_place = (1 - coupling.kept) * (1 - coupling.depth) * depth;
    found.lag_of_lag = coupling.kept + (1 - coupling.kept) * coupling.lag;
    return found;
}

// axis_map(), kept for the hands and periods of the last calls: trials of couplings ask for the same over and over.
layout::AxisMap<double> known_axis_map(const Axis& axis, double period) {
    struct Known {
        Axis axis{};
        double period = 0;
        layout::AxisMap<double> map{};
    };
    thread_local std::array<Known, 4> known;
    thread_local std::size_t oldest = 0;
    for (const Known& one : known)
        if (one.period == period && one.axis.mass == axis.mass && one.axis.damping == axis.damping &&
            one.axis.stiffness == axis.stiffness)
            return one.map;
    Known& next = known[oldest++ % known.size()];
    next = {axis, period, axis_map(axis, period)};
    return next.map;
}

// A loop, linearised, at any stiffness.
class LinearLoop {
public:
    LinearLoop(const HandSpec& hand, double rate, const Hold& hold, const ForceAround& force, double lag)
        : hand_(hand), force_(force), axes_(axes_of(hold)), period_(1 / rate), unit_(hand.mass * rate * rate),
          lag_(lag) {
        const std::array<Axis, 3> held = axes_of(hold, hand);
        for (std::size_t i = 0; i < 3; ++i) {
            const bool known = i > 0 && held[i].stiffness == held[i - 1].stiffness; // all else is the same
            maps_[i] = known ? maps_[i - 1] : known_axis_map(held[i], period_);
            lags_[i] = known ? lags_[i - 1] : lag_map(held[i], period_, lag);
        }
    }

    bool grows(double stiffness) const;

private:
    Eigen::MatrixXd map_of(double stiffness) const;

    HandSpec hand_;
    ForceAround force_;
    glm::dmat3 axes_;
    double period_, unit_, lag_; /* s, N/m, s */
    std::array<layout::AxisMap<double>, 3> maps_{};
    std::array<LagMap, 3> lags_{};
};

// Of (place, speed times the sample, the forces under way in units of mass / sample^2, the lag of a virtual coupling,
// and the device's own force where it lags).
Eigen::MatrixXd LinearLoop::map_of(double stiffness) const {
    const LoopForce answer = force_of(hand_, period_, axes_, force_, stiffness, unit_);
    const HandSpec& hand = hand_;
    const auto delay = static_cast<Eigen::Index>(hand.delay_samples);
    const Eigen::Index forces = 6, lag = forces + 3 * delay, shown = lag + (hand.coupled() ? 1 : 0),
                       size = shown + (lag_ > 0 ? 3 : 0);
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(size, size);
    for (int j = 0; j < 3 && hand.coupled(); ++j)
        map(lag, j) = answer.lag_of_place[j];
    if (hand.coupled())
        map(lag, lag) = answer.lag_of_lag;
    for (int i = 0; i < 3; ++i) {
        const layout::AxisMap<double>& axis = maps_[static_cast<std::size_t>(i)];
        const double place_force = unit_ * axis.x_force, speed_force = period_ * unit_ * axis.v_force;
        map(i, i) = 1 + axis.x_error;
        map(i, 3 + i) = axis.x_speed / period_;
        map(3 + i, i) = axis.v_error * period_;
        map(3 + i, 3 + i) = axis.v_speed;
        const auto add_answer = [&](Eigen::Index row, double times) {
            for (int j = 0; j < 3; ++j)
                map(row, j) += times * answer.of_place[j][i];
            if (hand.coupled())
                map(row, lag) = times * answer.of_lag[i];
        };
        // The device is given the newest force, or the oldest under way; its own force follows.
        const LagMap& lagging = lags_[static_cast<std::size_t>(i)];
        const double place_lag = unit_ * lagging.place, speed_lag = period_ * unit_ * lagging.speed;
        const auto add_given = [&](Eigen::Index row, double times) {
            if (delay == 0)
                add_answer(row, times);
            else
                map(row, forces + i) += times;
        };
        add_given(i, place_force - place_lag);
        add_given(3 + i, speed_force - speed_lag);
        if (lag_ > 0) {
            map(i, shown + i) = place_lag;
            map(3 + i, shown + i) = speed_lag;
            add_given(shown + i, 1 - lagging.left);
            map(shown + i, shown + i) = lagging.left;
        }
        if (delay == 0)
            continue;
        for (Eigen::Index age = 0; age + 1 < delay; ++age)
            map(forces + 3 * age + i, forces + 3 * (age + 1) + i) = 1;
        add_answer(forces + 3 * (delay - 1) + i, 1); // the newest
    }
    return map;
}

// Whether a matrix has an eigenvalue beyond 1, as far as its powers show it: none if one of them has a norm below 1,
// some if the trace of one is larger than its rows are many. Far cheaper than eigenvalues, but for a matrix near both.
template <int rows> std::optional<bool> grows_by_powers(const Eigen::MatrixXd& map) {
    constexpr int kSquarings = 26;
    constexpr double kSure = 2; // against rounding errors
    Eigen::Matrix<double, rows, rows> power = map, square;
    for (int i = 0; i < kSquarings; ++i) {
        if (kSure * power.cwiseAbs().rowwise().sum().maxCoeff() < 1)
            return false;
        if (std::abs(power.trace()) > kSure * double(map.rows()))
            return true;
        square.noalias() = power.lazyProduct(power);
        power = square;
    }
    return std::nullopt;
}

bool LinearLoop::grows(double stiffness) const {
    constexpr double kNone = 1e-12; // rounding error of a constant mode
    const Eigen::MatrixXd map = map_of(stiffness);
    const auto sure = map.rows() == 6   ? grows_by_powers<6>(map)
                      : map.rows() == 7 ? grows_by_powers<7>(map)
                                        : grows_by_powers<Eigen::Dynamic>(map);
    if (sure)
        return *sure;
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(map, false);
    return !(solver.eigenvalues().cwiseAbs().maxCoeff() <= 1 + kNone);
}

} // namespace

glm::dmat3 axes_of(const Hold& hold) {
    if (hold.along == glm::dvec3(0))
        return glm::dmat3(1);
    const glm::dvec3 aside = std::abs(hold.along.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 first = glm::normalize(glm::cross(hold.along, aside));
    return {first, glm::cross(hold.along, first), hold.along};
}

std::array<Axis, 3> axes_of(const Hold& hold, const HandSpec& hand) {
    const Axis across{hand.mass, damping_of(hand), hand.grip_stiffness};
    const bool all_sides = hold.along == glm::dvec3(0);
    return {across, across, {hand.mass, across.damping, all_sides ? hand.grip_stiffness : 0}};
}

bool supports(const glm::dvec3& along, const glm::dvec3& force, const glm::dmat3& slope) {
    constexpr double kHeld = 0.2; // of the force, and of a wall's slope
    return glm::dot(along, glm::normalize(force)) >= kHeld && glm::dot(along, slope * along) >= kHeld;
}

Hold pressed_along(const glm::dvec3& along) {
    constexpr double kUpright = 1e-3; // rad: less is down
    const double tilt = std::atan2(std::hypot(along.x, along.y), along.z);
    return {tilt < kUpright ? "down" : fmt::format("{:.0f} deg from straight down", tilt / kDegree), along};
}

std::vector<Hold> usual_holds(const glm::dvec3& force, const glm::dmat3& slope) {
    std::vector<Hold> holds{{"on all sides", glm::dvec3(0)}};
    for (const glm::dvec3& along : {glm::dvec3(0, 0, 1), glm::normalize(force)})
        if (const Hold hold = pressed_along(along); supports(along, force, slope) && hold.name != holds.back().name)
            holds.push_back(hold);
    return holds;
}

std::vector<Hold> all_presses(const glm::dvec3& force, const glm::dmat3& slope) {
    constexpr int kTilts = 13, kTurns = 16;
    const glm::dmat3 frame = axes_of(Hold{"", glm::normalize(force)});
    std::vector<Hold> holds;
    for (int i = 1; i <= kTilts; ++i)
        for (int j = 0; j < kTurns; ++j) {
            const double tilt = i * 6 * kDegree, turn = 2 * std::numbers::pi * j / kTurns;
            const glm::dvec3 along =
                frame * glm::dvec3(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
            if (supports(along, force, slope))
                holds.push_back(pressed_along(along));
        }
    return holds;
}

LagMap lag_map(const Axis& axis, double period, double lag) {
    if (!(lag > 0))
        return {};
    Eigen::Matrix3d rates; // 1/s: of place, speed, and the force by which the device is above what it is given
    rates << 0, 1, 0, -axis.stiffness / axis.mass, -axis.damping / axis.mass, 1 / axis.mass, 0, 0, -1 / lag;
    const Eigen::Matrix3d after = (period * rates).exp();
    return {after(0, 2), after(1, 2), after(2, 2)};
}

bool grows(const HandSpec& hand, double rate, const Hold& hold, const ForceAround& force, double stiffness,
           double lag) {
    return LinearLoop(hand, rate, hold, force, lag).grows(stiffness);
}

std::optional<double> linear_limit(const HandSpec& hand, double rate, const Hold& hold, const ForceAround& force,
                                   double lag) {
    constexpr double kClose = 1.0001;
    const double passive = passive_stiffness(damping_of(hand), 1 / rate, hand.delay_samples);
    if (!(passive > 0)) // a held force feeds what nothing damps
        return 0.0;
    const LinearLoop loop(hand, rate, hold, force, lag);
    const auto at = [&](double stiffness) { return loop.grows(stiffness); };
    return at(1e-4 * passive) ? 0.0 : least_growing(1e-4 * passive, 8 * passive, kClose, at);
}

std::optional<double> grip_limit(const HandSpec& hand, const Hold& hold, const ForceAround& force) {
    constexpr double kTurns = 1e-6; // 1: of a slope; less is a plane, rounded
    const glm::dmat3 axes = axes_of(hold);
    const glm::dmat3 slope = glm::transpose(axes) * force.slope * axes; // columns first
    const bool all_sides = hold.along == glm::dvec3(0);
    Eigen::MatrixXd across(all_sides ? 3 : 2, all_sides ? 3 : 2); // where it presses, the depth follows the force
    for (int i = 0; i < across.rows(); ++i)
        for (int j = 0; j < across.cols(); ++j)
            across(i, j) = slope[j][i] - (all_sides ? 0 : slope[2][i] * slope[j][2] / slope[2][2]);
    double least = 0;
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(across, false);
    for (const std::complex<double>& value : solver.eigenvalues())
        if (std::abs(value.imag()) < kTurns)
            least = std::min(least, value.real());
    return least < -kTurns ? std::optional(-hand.grip_stiffness / least) : std::nullopt;
}

double wall_limit(const HandSpec& hand, double rate, double lag) {
    if (!(lag > 0))
        return critical_stiffness(hand.mass, damping_of(hand), 1 / rate, hand.delay_samples);
    ForceAround wall{glm::dmat3(0)};
    wall.slope[2][2] = 1;
    HandSpec bare = coupled(hand, 0, 0);
    bare.grip_stiffness = 0;
    return linear_limit(bare, rate, pressed_along({0, 0, 1}), wall, lag).value_or(NAN);
}

} // namespace forceshade
