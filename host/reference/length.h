// How long a vector is, rounded as the kernels do it.
#pragma once

#include <cmath>

#include "host/reference/vector.h"

namespace forceshade::reference {

/// sqrt(v . v): overflows where v . v does.
template <typename T> T length(const Vector<T>& v) noexcept {
    return std::sqrt(dot(v, v));
}

} // namespace forceshade::reference
