// G3: the gradients of a sampled height map at its nodes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host/scene/limits.h"

namespace forceshade {

/// The steepest gradient: its square is a normal number of T. The scene's check holds analytic maps to the same.
template <typename T> inline constexpr double kSteepestGradient = sizeof(T) == 4 ? kSteepestF32 : kSteepestF64;

/// (dU/dx, dU/dy) pairs of a grid of samples that spans size_x by size_y metres between its outermost nodes. `samples`
/// are of 1 = `height` metres, rows * columns, row 0 at the largest y (image order); the result has row 0 at the
/// smallest y. Central differences, one-sided at the border; 0 along an axis of a single sample. Computed in double and
/// rounded once to T. \throws UsageError that names `file`, row and column of the image if a gradient is steeper than
/// kSteepestGradient<T> or no number.
template <typename T>
std::vector<T> map_gradients(std::span<const double> samples, std::size_t columns, std::size_t rows, double size_x,
                             double size_y, double height, const std::string& file);

extern template std::vector<float> map_gradients<float>(std::span<const double>, std::size_t, std::size_t, double,
                                                        double, double, const std::string&);
extern template std::vector<double> map_gradients<double>(std::span<const double>, std::size_t, std::size_t, double,
                                                          double, double, const std::string&);

} // namespace forceshade
