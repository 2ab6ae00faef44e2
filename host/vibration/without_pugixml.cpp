// What stands in the place of read_vibration.cpp in the library where pugixml is missing.
#include "host/error.h"
#include "host/vibration/vibration.h"

namespace forceshade {

VibrationModels read_vibration(const std::filesystem::path& file) {
    throw UsageError("{}: this build reads no models of vibration: build it where pugixml is installed", file.string());
}

} // namespace forceshade
