#include "host/study/stability/linear_loop.h"

#include <algorithm>

#include <glm/geometric.hpp>

namespace forceshade::study {
namespace {

// By rows.
struct Square {
    std::size_t size;
    std::vector<double> values = std::vector<double>(size * size);

    double& operator()(std::size_t row, std::size_t column) { return values[row * size + column]; }
};

Square squared(const Square& a) {
    Square result{a.size};
    for (std::size_t i = 0; i < a.size; ++i)
        for (std::size_t k = 0; k < a.size; ++k)
            for (std::size_t j = 0; j < a.size; ++j)
                result(i, j) += a.values[i * a.size + k] * a.values[k * a.size + j];
    return result;
}

// The loop's map of (place, speed, the forces that are under way).
Square map_of(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope, double stiffness) {
    const glm::dmat3 axes = axes_of(hold);
    const std::array<Axis, 3> held = axes_of(hold, hand);
    const glm::dmat3 answer = -stiffness * (glm::transpose(axes) * slope * axes); // columns: places
    const std::size_t delay = hand.delay_samples;
    Square map{6 + 3 * delay};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = axis_map(held[i], 1 / rate);
        map(i, i) = 1 + axis.x_error;
        map(i, 3 + i) = axis.x_speed;
        map(3 + i, i) = axis.v_error;
        map(3 + i, 3 + i) = axis.v_speed;
        for (std::size_t j = 0; j < 3 && delay == 0; ++j) {
            map(i, j) += axis.x_force * answer[int(j)][int(i)];
            map(3 + i, j) += axis.v_force * answer[int(j)][int(i)];
        }
        if (delay == 0)
            continue;
        map(i, 6 + i) = axis.x_force; // the oldest
        map(3 + i, 6 + i) = axis.v_force;
        for (std::size_t age = 0; age + 1 < delay; ++age)
            map(6 + 3 * age + i, 6 + 3 * (age + 1) + i) = 1;
        for (std::size_t j = 0; j < 3; ++j)
            map(6 + 3 * (delay - 1) + i, j) = answer[int(j)][int(i)];
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

std::vector<Hold> holds_at(const glm::dvec3& force, const glm::dmat3& slope) {
    constexpr double kUpright = 1e-3; // rad: less is down
    constexpr double kHeld = 0.2;     // of the force, and of a wall's slope
    const glm::dvec3 against = glm::normalize(force);
    std::vector<Hold> holds{{"on all sides", glm::dvec3(0)}, {"down", {0, 0, 1}}};
    if (glm::length(against - glm::dvec3(0, 0, 1)) > kUpright)
        holds.push_back({"against the force", against});
    std::erase_if(holds, [&](const Hold& hold) {
        return hold.along != glm::dvec3(0) &&
               (glm::dot(hold.along, against) < kHeld || glm::dot(hold.along, slope * hold.along) < kHeld);
    });
    return holds;
}

bool grows(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope, double stiffness) {
    constexpr int kDoublings = 44;
    constexpr double kNone = 1e-10; // rounding error of a constant mode
    Square power = map_of(hand, rate, hold, slope, stiffness);
    const auto size = static_cast<double>(power.size);
    double growth = 0, share = 1; // the logarithm of the factor divided out, per sample
    for (int i = 0; i < kDoublings; ++i) {
        double most = 0, trace = 0;
        for (const double value : power.values)
            most = std::max(most, std::abs(value));
        growth += share * std::log(most);
        for (double& value : power.values)
            value /= most;
        const double log_scale = growth / share; // of the power
        if (log_scale + std::log(size) < 0)      // a bound of every eigenvalue's
            return false;
        for (std::size_t k = 0; k < power.size; ++k)
            trace += power(k, k);
        if (trace != 0 && log_scale + std::log(std::abs(trace) / size) > 1e-3)
            return true; // the mean of the eigenvalues
        share /= 2;
        power = squared(power);
    }
    return growth > kNone;
}

std::optional<double> linear_limit(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope) {
    constexpr double kClose = 1.0001;
    const double passive = passive_stiffness(hand.damping + hand.grip_damping, 1 / rate, hand.delay_samples);
    const auto at = [&](double stiffness) { return grows(hand, rate, hold, slope, stiffness); };
    return at(1e-4 * passive) ? 0.0 : least_growing(1e-4 * passive, 8 * passive, kClose, at);
}

double wall_limit(const HandSpec& hand, double rate) {
    glm::dmat3 wall(0);
    wall[2][2] = 1;
    return linear_limit(hand, rate, {"down", {0, 0, 1}}, wall).value_or(0);
}

} // namespace forceshade::study
