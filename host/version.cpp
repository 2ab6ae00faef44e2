#include "host/version.h"

#include "forceshade_version.h"

namespace forceshade {

std::string version() {
    return FORCESHADE_VERSION;
}

} // namespace forceshade
