// In the place of height_exr.cpp, for the library without OpenEXR.
#include <fmt/core.h>

#include "host/error.h"
#include "host/output/height_exr.h"

namespace forceshade {

HeightImage read_height_exr(const ReadableFile& file) {
    throw UsageError(fmt::format("{}: this build reads no OpenEXR images: convert the height map to PNG, or build with "
                                 "FORCESHADE_LIBRARY_ONLY=OFF",
                                 file.path().string()));
}

} // namespace forceshade
