#include "host/mesh/weld.h"

#include <bit>

namespace forceshade {
namespace {

constexpr std::uint32_t kFree = 0xFFFFFFFFu;

std::uint64_t mixed(std::uint64_t hash, double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value + 0.0)) * 0x9E3779B97F4A7C15u; // + 0.0: -0 is 0
    return hash ^ (hash >> 29);
}

} // namespace

std::vector<std::uint32_t> weld(std::span<const double> vertices) {
    const std::size_t count = vertices.size() / 3;
    const std::size_t slots = std::bit_ceil(2 * count + 1);
    std::vector<std::uint32_t> table(slots, kFree), places(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double* at = &vertices[3 * i];
        std::size_t slot = mixed(mixed(mixed(0, at[0]), at[1]), at[2]) & (slots - 1);
        const auto differs = [&](std::uint32_t other) {
            const double* there = &vertices[3 * std::size_t(other)];
            return at[0] != there[0] || at[1] != there[1] || at[2] != there[2];
        };
        while (table[slot] != kFree && differs(table[slot]))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == kFree)
            table[slot] = static_cast<std::uint32_t>(i);
        places[i] = table[slot];
    }
    return places;
}

std::vector<std::uint32_t> weld(const PolygonSoup& polygons) {
    if (polygons.vertices.empty())
        return {};
    return weld(std::span(&polygons.vertices[0].x, 3 * polygons.vertices.size()));
}

} // namespace forceshade
