#include "host/output/height_image.h"

#include <array>
#include <cstring>
#include <string>

#include <fmt/core.h>

#include "host/error.h"
#include "host/output/files.h"

namespace forceshade {

void require_height_size(const ReadableFile& file, std::uint64_t columns, std::uint64_t rows) {
    constexpr std::uint64_t kMostHeightSamples = 1ull << 28;
    if (columns == 0 || rows == 0 || columns > kMostHeightSamples / rows)
        throw UsageError("{}: a height map of {} x {} samples cannot be used: between 1 and {} samples are possible",
                         file.path().string(), columns, rows, kMostHeightSamples);
    constexpr double kSampleBytes = 32; // measured: the sample, its gradients in both precisions, and the device's copy
    require_memory(file.path(), fmt::format("a height map of {} x {} samples", columns, rows),
                   kSampleBytes * static_cast<double>(columns * rows));
}

HeightImage read_height_image(const std::filesystem::path& path) {
    const ReadableFile file(path);
    constexpr std::array<unsigned char, 8> kPng{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    constexpr std::array<unsigned char, 4> kExr{0x76, 0x2f, 0x31, 0x01};
    std::array<std::byte, 8> magic{};
    if (file.read_some(0, magic) == 0)
        throw IoError("cannot read {}: it is empty", path.string());
    HeightImage image;
    if (std::memcmp(magic.data(), kPng.data(), kPng.size()) == 0)
        image = read_height_png(file);
    else if (std::memcmp(magic.data(), kExr.data(), kExr.size()) == 0)
        image = read_height_exr(file);
    else
        throw UsageError("{}: neither a PNG nor an OpenEXR image: convert the height map to one of them",
                         path.string());
    image.sha256 = sha256_of_file(path);
    return image;
}

} // namespace forceshade
