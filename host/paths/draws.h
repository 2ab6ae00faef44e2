// The random numbers of a path: they follow from the seed and the path's number alone.
#pragma once

#include <array>
#include <cstdint>

#include "host/scene/scene.h"

namespace forceshade {

/// What a random number is for. A motion's points on the way (reference::via_point) have number 1.
enum class Draw : std::uint32_t {
    speed = 16,
    depth,
    depth_back,
    heading,
    offset,
    tremor_amplitude,
    tremor_frequency,
    tremor_phase,
    walk_frequency,
    walk_phase,
};

class PathDraws {
public:
    PathDraws(std::uint64_t seed, std::uint64_t path);

    /// The key of the path's own random numbers.
    std::array<std::uint32_t, 2> key() const { return key_; }

    std::uint32_t word(Draw draw, std::uint32_t index) const;
    /// Uniform between 0 and 1, neither of which it is.
    double uniform(Draw draw, std::uint32_t index) const;

    /// A value of a quantity that may differ from path to path; `positive`: values that are not are drawn again, and
    /// what is never positive is 0.
    double value(const Spread& spread, Draw draw, bool positive = false) const;

private:
    std::array<std::uint32_t, 4> words(Draw draw, std::uint32_t index) const;

    std::array<std::uint32_t, 2> key_;
};

} // namespace forceshade
