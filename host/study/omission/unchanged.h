// That switching a feature changed nothing that it does not concern.
#pragma once

#include <string>

#include "host/study/omission/side.h"

namespace forceshade::study {

struct Unchanged {
    std::uint64_t compared = 0;   /* samples */
    std::uint64_t in_contact = 0; /* of them, those with a force */
    std::uint64_t differing = 0;  /* of them, those with something that had to be the same and was not */
    double largest = 0;           /* 1: of |F|, relative, where magnitudes were compared */
};

/// Every sample of the captured fields, by what the comparison says must be the same.
template <typename T>
Unchanged compare(const Comparison& comparison, const Captured<T>& with, const Captured<T>& without);

/// In words, for readers: "force and depth bit for bit".
std::string what_is_compared(const Comparison& comparison);

extern template Unchanged compare<float>(const Comparison&, const Captured<float>&, const Captured<float>&);
extern template Unchanged compare<double>(const Comparison&, const Captured<double>&, const Captured<double>&);

} // namespace forceshade::study
