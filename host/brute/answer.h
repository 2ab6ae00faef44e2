// What a referee says of one probe position.
#pragma once

#include <array>
#include <cstdint>

namespace forceshade::brute {

using Real = long double;

struct Answer {
    std::array<Real, 3> force{};    /* N */
    std::array<Real, 3> unshaded{}; /* N */
    std::array<Real, 3> proxy{};    /* m */
    Real depth = 0;                 /* m */
    std::uint32_t facet = 0xFFFFFFFFu;
};

} // namespace forceshade::brute
