#include "host/surface/map_gradients.h"

#include <algorithm>

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

} // namespace

template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height) {
    const double spacing_x = columns > 1 ? size_x / static_cast<double>(columns - 1) : 0.0;
    const double spacing_y = rows > 1 ? size_y / static_cast<double>(rows - 1) : 0.0;
    const auto u = [&](std::size_t column, std::size_t row) {
        return height * samples[(rows - 1 - row) * columns + column];
    };
    std::vector<T> gradients(2 * columns * rows);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column) {
            T* const pair = &gradients[2 * (row * columns + column)];
            pair[0] = static_cast<T>(slope(column, columns, spacing_x, [&](std::size_t i) { return u(i, row); }));
            pair[1] = static_cast<T>(slope(row, rows, spacing_y, [&](std::size_t i) { return u(column, i); }));
        }
    return gradients;
}

template std::vector<float> map_gradients<float>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                 double);
template std::vector<double> map_gradients<double>(std::span<const double>, std::size_t, std::size_t, double, double,
                                                   double);

} // namespace forceshade
