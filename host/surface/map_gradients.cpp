#include "host/surface/map_gradients.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade {
namespace {

// The slope at node i of `count`, `spacing` metres apart, from the values at its neighbours.
template <typename Value> double slope(std::size_t i, std::size_t count, double spacing, const Value& value) {
    if (count < 2)
        return 0.0;
    const std::size_t low = i > 0 ? i - 1 : i;
    const std::size_t high = std::min(i + 1, count - 1);
    return (value(high) - value(low)) / (spacing * static_cast<double>(high - low));
}

template <typename T>
[[noreturn]] void refuse(double gradient, std::size_t row, std::size_t column, const std::string& file) {
    constexpr bool kSingle = sizeof(T) == 4;
    const bool double_holds = kSingle && std::abs(gradient) <= kSteepestGradient<double>;
    throw UsageError(fmt::format(
        "{}: a slope of {:.3g} m/m at row {}, column {} is too steep: {} allows {:g}; make the map's height smaller or "
        "its size larger{}",
        file, gradient, row, column, kSingle ? "f32" : "f64", kSteepestGradient<T>,
        double_holds ? ", or use precision f64" : ""));
}

} // namespace

template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height, const std::string& file) {
    const double spacing_x = columns > 1 ? size_x / static_cast<double>(columns - 1) : 0.0;
    const double spacing_y = rows > 1 ? size_y / static_cast<double>(rows - 1) : 0.0;
    const auto u = [&](std::size_t column, std::size_t row) {
        return height * samples[(rows - 1 - row) * columns + column];
    };
    std::vector<T> gradients(2 * columns * rows);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            const double pair[] = {slope(column, columns, spacing_x, [&](std::size_t i) { return u(i, row); }),
                                   slope(row, rows, spacing_y, [&](std::size_t i) { return u(column, i); })};
            for (std::size_t i = 0; i < 2; ++i) {
                if (!(std::abs(pair[i]) <= kSteepestGradient<T>))
                    refuse<T>(pair[i], rows - 1 - row, column, file);
                gradients[2 * (row * columns + column) + i] = static_cast<T>(pair[i]);
            }
        }
    return gradients;
}

template std::vector<float> map_gradients<float>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                 double, const std::string&);
template std::vector<double> map_gradients<double>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                   double, const std::string&);

} // namespace forceshade
