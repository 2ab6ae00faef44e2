#include "host/paths/draws.h"

#include <cmath>
#include <numbers>

#include "host/reference/philox.h"

namespace forceshade {
namespace {

constexpr std::uint32_t low(std::uint64_t word) {
    return static_cast<std::uint32_t>(word);
}
constexpr std::uint32_t high(std::uint64_t word) {
    return static_cast<std::uint32_t>(word >> 32);
}

// 53 bits, in the middle of their interval.
double between(std::uint32_t one, std::uint32_t other) {
    const std::uint64_t bits = (std::uint64_t(one) << 20) ^ (other >> 12);
    return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

} // namespace

PathDraws::PathDraws(std::uint64_t seed, std::uint64_t path) {
    const auto words = reference::philox({low(path), high(path), 0, 0}, {low(seed), high(seed)});
    key_ = {words[0], words[1]};
}

std::array<std::uint32_t, 4> PathDraws::words(Draw draw, std::uint32_t index) const {
    return reference::philox({index, static_cast<std::uint32_t>(draw), 0, 0}, key_);
}

std::uint32_t PathDraws::word(Draw draw, std::uint32_t index) const {
    return words(draw, index)[0];
}

double PathDraws::uniform(Draw draw, std::uint32_t index) const {
    const auto drawn = words(draw, index);
    return between(drawn[0], drawn[1]);
}

double PathDraws::value(const Spread& spread, Draw draw, bool positive) const {
    constexpr std::uint32_t kTries = 1000;
    for (std::uint32_t i = 0; i < kTries; ++i) {
        const auto drawn = words(draw, i);
        const double share = between(drawn[0], drawn[1]);
        double value = spread.value;
        if (spread.shape == Spread::Shape::uniform)
            value = spread.low + share * (spread.high - spread.low);
        if (spread.shape == Spread::Shape::normal) // Box & Muller 1958
            value += spread.sd * std::sqrt(-2 * std::log(share)) *
                     std::cos(2 * std::numbers::pi * between(drawn[2], drawn[3]));
        if (!positive || value > 0)
            return value;
    }
    return 0;
}

} // namespace forceshade
