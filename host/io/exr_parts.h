// How a volume is laid out in an EXR's parts; only for the .cpp files of the volumes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>

#include "host/io/exr_volume.h"
#include "host/io/pixel_rows.h"

namespace forceshade::exr {

/// One part of a volume; its rows in memory are tight, samples interleaved by component.
struct Part {
    std::uint32_t channel = 0;         /* layout::kChannel... */
    std::vector<const char*> channels; /* names in the file, by component */
    const char* unit = "";             /* of the samples */
    PixelFormat format = PixelFormat::float32;

    std::size_t sample_bytes() const { return channels.size() * bytes_of(format); }
};

/// The parts of a volume in file order.
std::vector<Part> parts_of(const VolumeHeader& header);

/// Throws UsageError if no EXR can hold such a grid.
void require_possible(const VolumeHeader& header);

/// The part's header: nothing in it depends on the day or the machine.
Imf::Header make_header(const Part& part, const VolumeHeader& volume);

/// Describes `count` rows at `bytes`, the first of which is row `first`; pixel type as in the file.
Imf::FrameBuffer frame_of(const Part& part, std::uint64_t width, std::uint64_t first, std::uint64_t count,
                          const std::byte* bytes);

/// Rows that are handed to OpenEXR at once: a multiple of every compression's block, about 4 MiB of force.
/// It decides how the parts' blocks interleave in the file, so it may depend on nothing but the image's size.
std::uint64_t rows_per_group(std::uint64_t width, std::uint64_t rows);

/// What is inserted into a header alike for volumes and for paths.
void insert_text(Imf::Header& header, const Part& part, const std::string& scene, const std::string& version,
                 const std::string& omitted);
/// An empty image of the part: its name, channels and compression.
Imf::Header make_image_header(const Part& part, std::uint64_t width, std::uint64_t rows, Compression compression);

/// Sees to it that OpenEXR's workers, which all files share, are at least `threads`.
void require_workers(int threads);

/// An image of several parts, ready to be written.
struct Sheet {
    std::uint64_t width = 0, rows = 0;
    std::vector<Part> parts;
    std::vector<Imf::Header> headers; /* of the parts */
    int threads = 0;                  /* that compress this file; 0: it asks for no parallel work */
};

/// The checksum of the decoded pixels of each part, in file order, read from `file`. Throws IoError naming `path`.
std::vector<std::uint64_t> checksums_of(const std::filesystem::path& file, const std::filesystem::path& path,
                                        const Sheet& sheet);

} // namespace forceshade::exr
