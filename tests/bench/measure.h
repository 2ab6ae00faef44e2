// Medians of paired measurements.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace forceshade::bench {

template <typename Work> double seconds(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

} // namespace forceshade::bench
