// Forces as they come out of a file of halves.
#pragma once

#include <span>
#include <vector>

#include "host/output/rows.h"
#include "host/study/error_time/volume.h"

namespace forceshade::study::error_time {

/// `forces`, N, of three numbers each; as the volumes' files round them.
inline void to_halves(std::span<const float> forces, std::vector<Half>& halves) {
    halves.resize(forces.size());
    encode_row(forces, PixelFormat::half, reinterpret_cast<std::byte*>(halves.data()));
}

/// In double, three numbers to a vector.
template <typename Stored> std::vector<glm::dvec3> vectors_of(std::span<const Stored> numbers) {
    std::vector<glm::dvec3> vectors;
    vectors.reserve(numbers.size() / 3);
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
        vectors.emplace_back(to_float(numbers[i]), to_float(numbers[i + 1]), to_float(numbers[i + 2]));
    return vectors;
}

} // namespace forceshade::study::error_time
