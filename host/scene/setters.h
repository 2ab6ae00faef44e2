// What the setters of the schema's keys have in common: a value's content as a member of a scene.
#pragma once

#include "host/scene/value.h"

#include <array>

namespace forceshade {

template <typename Enum> Enum choice(const Value& value) {
    return static_cast<Enum>(value.integers.at(0));
}

template <std::size_t n> std::array<double, n> components(const Value& value) {
    std::array<double, n> result;
    for (std::size_t i = 0; i < n; ++i)
        result[i] = value.numbers.at(i);
    return result;
}

} // namespace forceshade
