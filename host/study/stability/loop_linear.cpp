#include "host/study/stability/loop_linear.h"

#include <array>
#include <cmath>

namespace forceshade::study {
namespace {

constexpr std::size_t kSize = 9; // place, speed, late force
using Square = std::array<std::array<double, kSize>, kSize>;

Square product(const Square& a, const Square& b) {
    Square c{};
    for (std::size_t i = 0; i < kSize; ++i)
        for (std::size_t k = 0; k < kSize; ++k)
            for (std::size_t j = 0; j < kSize; ++j)
                c[i][j] += a[i][k] * b[k][j];
    return c;
}

double largest(const Square& a) {
    double size = 0;
    for (const auto& row : a)
        for (const double value : row)
            size = std::max(size, std::abs(value));
    return size;
}

// The force of a stiffness, by the place that it hangs on.
double answer(const LinearLoop& loop, double stiffness, std::size_t force, std::size_t place) {
    return -stiffness * loop.slope[static_cast<int>(place)][static_cast<int>(force)];
}

Square map_of(const LinearLoop& loop, double stiffness) {
    const auto lateral = axis_map(loop.lateral, loop.period), vertical = axis_map(loop.vertical, loop.period);
    Square map{};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& axis = i == 2 ? vertical : lateral;
        map[i][i] = 1 + axis.x_error;
        map[i][3 + i] = axis.x_speed;
        map[3 + i][i] = axis.v_error;
        map[3 + i][3 + i] = axis.v_speed;
        for (std::size_t j = 0; j < 3; ++j) {
            const double force = answer(loop, stiffness, i, j);
            map[6 + i][j] = force;
            if (loop.delay == 0) {
                map[i][j] += axis.x_force * force;
                map[3 + i][j] += axis.v_force * force;
            }
        }
        if (loop.delay != 0) {
            map[i][6 + i] = axis.x_force;
            map[3 + i][6 + i] = axis.v_force;
        }
    }
    return map;
}

} // namespace

double growth_of(const LinearLoop& loop, double stiffness) {
    constexpr int kDoublings = 44; // the map's power: its size tells its largest eigenvalue's
    Square power = map_of(loop, stiffness);
    double growth = 0, share = 1;
    for (int i = 0; i < kDoublings; ++i) {
        const double size = largest(power);
        for (auto& row : power)
            for (double& value : row)
                value /= size;
        growth += share * std::log(size);
        share /= 2;
        power = product(power, power);
    }
    return growth;
}

std::optional<double> linear_limit(const LinearLoop& loop, double low, double high) {
    constexpr double kStep = 1.05, kNone = 1e-10; // 1: of the stiffness; what rounding makes of a mode that stays
    double below = low, above = low;
    if (growth_of(loop, low) > kNone)
        return 0.0;
    while (growth_of(loop, above) <= kNone) {
        below = above;
        above *= kStep;
        if (above > high)
            return std::nullopt;
    }
    for (int i = 0; i < 24; ++i) {
        const double middle = std::sqrt(below * above);
        (growth_of(loop, middle) <= kNone ? below : above) = middle;
    }
    return std::sqrt(below * above);
}

} // namespace forceshade::study
