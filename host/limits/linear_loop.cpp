#include "host/limits/linear_loop.h"

#include <algorithm>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/touch/angle.h"

namespace forceshade {
namespace {

// The loop's map of (place, speed times the sample, the forces under way in units of mass / sample^2).
Eigen::MatrixXd map_of(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope, double stiffness) {
    const glm::dmat3 axes = axes_of(hold);
    const std::array<Axis, 3> held = axes_of(hold, hand);
    const double period = 1 / rate, unit = hand.mass * rate * rate;                      /* s, N/m */
    const glm::dmat3 answer = -stiffness / unit * (glm::transpose(axes) * slope * axes); // columns: places
    const auto delay = static_cast<Eigen::Index>(hand.delay_samples);
    Eigen::MatrixXd map = Eigen::MatrixXd::Zero(6 + 3 * delay, 6 + 3 * delay);
    for (int i = 0; i < 3; ++i) {
        const auto axis = axis_map(held[static_cast<std::size_t>(i)], period);
        const double place_force = unit * axis.x_force, speed_force = period * unit * axis.v_force;
        map(i, i) = 1 + axis.x_error;
        map(i, 3 + i) = axis.x_speed / period;
        map(3 + i, i) = axis.v_error * period;
        map(3 + i, 3 + i) = axis.v_speed;
        for (int j = 0; j < 3 && delay == 0; ++j) {
            map(i, j) += place_force * answer[j][i];
            map(3 + i, j) += speed_force * answer[j][i];
        }
        if (delay == 0)
            continue;
        map(i, 6 + i) = place_force; // the oldest
        map(3 + i, 6 + i) = speed_force;
        for (Eigen::Index age = 0; age + 1 < delay; ++age)
            map(6 + 3 * age + i, 6 + 3 * (age + 1) + i) = 1;
        for (int j = 0; j < 3; ++j)
            map(6 + 3 * (delay - 1) + i, j) = answer[j][i];
    }
    return map;
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
    const Axis across{hand.mass, hand.damping + hand.grip_damping, hand.grip_stiffness};
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
    return {tilt < kUpright ? "down" : fmt::format("{:.0f} deg off down", tilt / kDegree), along};
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

bool grows(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope, double stiffness) {
    constexpr double kNone = 1e-12; // rounding error of a constant mode
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(map_of(hand, rate, hold, slope, stiffness), false);
    return !(solver.eigenvalues().cwiseAbs().maxCoeff() <= 1 + kNone);
}

std::optional<double> linear_limit(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope) {
    constexpr double kClose = 1.0001;
    const double passive = passive_stiffness(damping_of(hand), 1 / rate, hand.delay_samples);
    const auto at = [&](double stiffness) { return grows(hand, rate, hold, slope, stiffness); };
    return at(1e-4 * passive) ? 0.0 : least_growing(1e-4 * passive, 8 * passive, kClose, at);
}

} // namespace forceshade
