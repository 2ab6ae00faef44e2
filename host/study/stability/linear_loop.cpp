#include "host/study/stability/linear_loop.h"

#include <cmath>

#include <glm/geometric.hpp>

#include "host/paths/scene_paths.h"
#include "host/study/stability/laws.h"

namespace forceshade::study {
namespace {

// The loop's map of (place, speed, the forces that are under way), by columns of any number.
class Square {
public:
    explicit Square(std::size_t size) : size_(size), values_(size * size) {}
    double& at(std::size_t row, std::size_t column) { return values_[row * size_ + column]; }
    std::size_t size() const { return size_; }

    Square squared() const {
        Square result(size_);
        for (std::size_t i = 0; i < size_; ++i)
            for (std::size_t k = 0; k < size_; ++k) {
                const double factor = values_[i * size_ + k];
                for (std::size_t j = 0; j < size_; ++j)
                    result.values_[i * size_ + j] += factor * values_[k * size_ + j];
            }
        return result;
    }
    double largest() const {
        double most = 0;
        for (const double value : values_)
            most = std::max(most, std::abs(value));
        return most;
    }
    double trace() const {
        double sum = 0;
        for (std::size_t i = 0; i < size_; ++i)
            sum += values_[i * size_ + i];
        return sum;
    }
    void divide(double by) {
        for (double& value : values_)
            value /= by;
    }

private:
    std::size_t size_;
    std::vector<double> values_;
};

Square map_of(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope, double stiffness) {
    const glm::dmat3 axes = axes_of(hold);
    const std::array<Axis, 3> held = axes_of(hold, hand);
    const glm::dmat3 answer = -stiffness * (glm::transpose(axes) * slope * axes); // columns: places
    const std::size_t delay = hand.delay_samples;
    Square map(6 + 3 * delay);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = axis_map(held[i], 1 / rate);
        map.at(i, i) = 1 + axis.x_error;
        map.at(i, 3 + i) = axis.x_speed;
        map.at(3 + i, i) = axis.v_error;
        map.at(3 + i, 3 + i) = axis.v_speed;
        for (std::size_t j = 0; j < 3 && delay == 0; ++j) {
            map.at(i, j) += axis.x_force * answer[int(j)][int(i)];
            map.at(3 + i, j) += axis.v_force * answer[int(j)][int(i)];
        }
        if (delay == 0)
            continue;
        map.at(i, 6 + i) = axis.x_force; // the oldest
        map.at(3 + i, 6 + i) = axis.v_force;
        for (std::size_t age = 0; age + 1 < delay; ++age)
            map.at(6 + 3 * age + i, 6 + 3 * (age + 1) + i) = 1;
        for (std::size_t j = 0; j < 3; ++j)
            map.at(6 + 3 * (delay - 1) + i, j) = answer[int(j)][int(i)];
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
    constexpr double kNone = 1e-10; // what rounding makes of a mode that stays
    Square power = map_of(hand, rate, hold, slope, stiffness);
    const auto size = static_cast<double>(power.size());
    double growth = 0, share = 1; // the logarithm of what was divided out, a sample
    for (int i = 0; i < kDoublings; ++i) {
        const double most = power.largest();
        growth += share * std::log(most);
        power.divide(most);
        const double log_scale = growth / share; // of the power
        if (log_scale + std::log(size) < 0)      // a bound of every eigenvalue's
            return false;
        if (const double trace = std::abs(power.trace()); trace > 0 && log_scale + std::log(trace / size) > 1e-3)
            return true; // the mean of the eigenvalues
        share /= 2;
        power = power.squared();
    }
    return growth > kNone;
}

std::optional<double> linear_limit(const HandSpec& hand, double rate, const Hold& hold, const glm::dmat3& slope) {
    constexpr double kStep = 1.1, kClose = 1.0001;
    const double passive =
        passive_stiffness(hand.damping + hand.grip_damping, 1 / rate, static_cast<int>(hand.delay_samples));
    double below = 1e-4 * passive, above = below;
    if (grows(hand, rate, hold, slope, below))
        return 0.0;
    while (!grows(hand, rate, hold, slope, above)) {
        below = above;
        above *= kStep;
        if (above > 8 * passive)
            return std::nullopt;
    }
    while (above > kClose * below) {
        const double middle = std::sqrt(below * above);
        (grows(hand, rate, hold, slope, middle) ? above : below) = middle;
    }
    return std::sqrt(below * above);
}

double wall_limit(const HandSpec& hand, double rate) {
    glm::dmat3 wall(0);
    wall[2][2] = 1;
    return linear_limit(hand, rate, {"down", {0, 0, 1}}, wall).value_or(0);
}

} // namespace forceshade::study
