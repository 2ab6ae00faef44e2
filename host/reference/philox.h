// Random numbers by counter (Philox 4x32-10: Salmon, Moraes, Dror & Shaw 2011): the same for a key and a counter
// wherever they are drawn. Step for step as shaders/laws/philox.glsl.
#pragma once

#include <array>

#include "shaders/shared/layout.h"

namespace forceshade::reference {

/// Four random words for a key and a counter.
inline std::array<layout::uint, 4> philox(std::array<layout::uint, 4> counter,
                                          std::array<layout::uint, 2> key) noexcept {
    constexpr int kRounds = 10;
    for (int i = 0; i < kRounds; ++i) {
        const std::uint64_t one = std::uint64_t(0xD2511F53U) * counter[0];
        const std::uint64_t other = std::uint64_t(0xCD9E8D57U) * counter[2];
        counter = {static_cast<layout::uint>(other >> 32) ^ counter[1] ^ key[0], static_cast<layout::uint>(other),
                   static_cast<layout::uint>(one >> 32) ^ counter[3] ^ key[1], static_cast<layout::uint>(one)};
        key[0] += 0x9E3779B9U;
        key[1] += 0xBB67AE85U;
    }
    return counter;
}

} // namespace forceshade::reference
