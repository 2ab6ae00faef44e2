// Height maps that are OpenEXR images.
#pragma once

#include <cstdint>

#include "host/output/height_image.h"
#include "host/output/reading.h"

namespace forceshade {

/// Throws UsageError if an image announces too many samples, or more than fit into the memory that is allowed.
void require_height_size(const ReadableFile& file, std::uint64_t columns, std::uint64_t rows);

/// All but its SHA-256. Throws as read_height_image.
HeightImage read_height_exr(const ReadableFile& file);

} // namespace forceshade
