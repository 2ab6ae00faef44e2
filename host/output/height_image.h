// Height maps from pictures: PNG with 8 or 16 bits (and fewer), OpenEXR with half, float or integer pixels.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace forceshade {

class ReadableFile;

struct HeightImage {
    std::size_t columns = 0;
    std::size_t rows = 0;
    std::vector<double> samples; /* 1: rows x columns, row 0 is the image's top row, the largest y */
    std::string sha256;          /* of the file's bytes, lower-case hex */
};

/// Reads a grey image; its contents decide the format. Integers are fractions of their full scale (a white PNG
/// pixel is 1), without gamma; floats are used as they are. Of an EXR the channel Y is used, else its only channel,
/// else R if the colours are equal. The map covers the display window: pixels outside of the data window are 0. At most
/// 2^28 samples, and what fits into the memory that is allowed (require_memory). Throws IoError for files that
/// are missing, truncated or damaged; UsageError for pictures that are not a height map, with the row and column (from
/// 0) of a coloured, infinite or NaN pixel.
HeightImage read_height_image(const std::filesystem::path& path);

/// Throws UsageError if an image announces too many samples, or more than fit into the memory that is allowed.
void require_height_size(const ReadableFile& file, std::uint64_t columns, std::uint64_t rows);

/// A PNG or an OpenEXR image, all but its SHA-256 (png_image.cpp, exr_image.cpp, without_openexr.cpp). Throw as
/// read_height_image.
HeightImage read_height_png(const ReadableFile& file);
HeightImage read_height_exr(const ReadableFile& file);

} // namespace forceshade
