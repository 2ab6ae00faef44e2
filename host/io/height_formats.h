// The two decoders behind read_height_image, and what they agree on.
#pragma once

#include <cstdint>

#include "host/io/height_image.h"
#include "host/io/readable_file.h"

namespace forceshade {

constexpr std::uint64_t kMostHeightSamples = 1ull << 28;

/// Both leave `sha256` empty.
HeightImage read_height_png(const ReadableFile& file);
HeightImage read_height_exr(const ReadableFile& file);

/// Throws UsageError if an image announces too many samples, or more than fit into the memory that is allowed.
void require_height_size(const ReadableFile& file, std::uint64_t columns, std::uint64_t rows);

} // namespace forceshade
