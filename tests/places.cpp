#include "tests/places.h"

namespace forceshade {

std::string in_source(const std::string& name) {
    return name.empty() ? FORCESHADE_SOURCE : FORCESHADE_SOURCE "/" + name;
}

std::string in_build(const std::string& name) {
    return FORCESHADE_BUILD "/" + name;
}

} // namespace forceshade
