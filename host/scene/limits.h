// What a scene may ask for: what an EXR image can hold, and slopes whose squares are still numbers.
#pragma once

#include <cstdint>

namespace forceshade {

/// Most samples along x: OpenEXR holds a block of 16 rows of three floats in half of 2^31 bytes.
inline constexpr std::uint64_t kMostColumns = (2147483647u / 2) / (16 * 3 * sizeof(float));
/// Most rows, y times z: OpenEXR refuses images that are higher.
inline constexpr std::uint64_t kMostRows = 2147483647u / 2 - 1;

/// The steepest gradient of a height map in f32 and in f64.
inline constexpr double kSteepestF32 = 1e15;
inline constexpr double kSteepestF64 = 1e150;

} // namespace forceshade
