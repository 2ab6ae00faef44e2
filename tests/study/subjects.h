// Subjects and engines for tests of error-time.
#pragma once

#include <algorithm>
#include <memory>
#include <string>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {

inline Extents few() {
    return {{4, 64}, {8}, {0.8e-3, 0.4e-3}, 400, 60, 3, 6, 1};
}

inline std::unique_ptr<Engine> cpu_engine(unsigned threads = 0) {
    EngineOptions options;
    options.cpu = true;
    options.threads = threads;
    return make_engine(options);
}

inline const Variant& variant_named(const Subject& subject, const std::string& name) {
    return *std::ranges::find_if(subject.variants, [&](const Variant& one) { return one.name == name; });
}

} // namespace forceshade::study::error_time
