// The loops that plans spend their time in, several triangles at a time where the processor can: same operations, same
// bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// Of triangles: corners, circle.
template <typename T> using Columns = std::array<const T*, 10>;

/// The least over a triangle's corners q of |centre - q|^2 - |side . (q - w)|, side the box's, less the circle and the
/// limit: by how much the triangle is further than the witness w from that point of the box where it gains most.
void all_excesses(const Columns<float>& columns, std::size_t count, const reference::Vector<float>& centre,
                  const reference::Vector<float>& side, const reference::Vector<float>& witness, float limit,
                  float* result);
void all_excesses(const Columns<double>& columns, std::size_t count, const reference::Vector<double>& centre,
                  const reference::Vector<double>& side, const reference::Vector<double>& witness, double limit,
                  double* result);

/// Squared distances from a point to others.
void all_squares(const float* x, const float* y, const float* z, std::size_t count,
                 const reference::Vector<float>& point, float* result);
void all_squares(const double* x, const double* y, const double* z, std::size_t count,
                 const reference::Vector<double>& point, double* result);

/// The place of about the least of some numbers, none below 0: the more they are, the fewer of their digits count.
std::size_t near_least_of(const float* values, std::size_t count);
std::size_t near_least_of(const double* values, std::size_t count);

/// Eight rows of squared distances, from each corner of a box, x running fastest, to the nearest corner of each
/// triangle.
void all_squares_to_corners(const Columns<float>& columns, std::size_t count, const reference::Vector<float>& low,
                            const reference::Vector<float>& high, float* rows);
void all_squares_to_corners(const Columns<double>& columns, std::size_t count, const reference::Vector<double>& low,
                            const reference::Vector<double>& high, double* rows);

/// By how much each triangle, its circle less, is at least beyond the limits of all corners.
void all_beyond_limits(const float* rows, const float* circle, std::size_t count, const std::array<float, 8>& limits,
                       float* result);
void all_beyond_limits(const double* rows, const double* circle, std::size_t count, const std::array<double, 8>& limits,
                       double* result);

/// 1 where an excess is not above 0, else 0.
void mark_kept(const float* result, std::size_t count, std::uint8_t* marks);
void mark_kept(const double* result, std::size_t count, std::uint8_t* marks);

} // namespace forceshade
