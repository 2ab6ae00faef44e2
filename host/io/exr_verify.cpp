#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include "host/io/exr_parts.h"
#include "host/io/exr_stream.h"
#include "host/io/hash.h"
#include "host/io/readable_file.h"

namespace forceshade::exr {

std::vector<std::uint64_t> checksums_of(const std::filesystem::path& file, const std::filesystem::path& path,
                                        const VolumeHeader& header) {
    const ReadableFile source(file);
    ReadStream stream(source, path);
    const std::uint64_t all = header.size[1] * header.size[2], group = rows_per_group(header);
    return guarded(stream, "read back", path, [&] {
        Imf::MultiPartInputFile input(stream, header.threads, false);
        std::vector<std::uint64_t> checksums;
        const std::vector<Part> parts = parts_of(header);
        for (std::size_t i = 0; i < parts.size() && static_cast<int>(i) < input.parts(); ++i) {
            Imf::InputPart pixels(input, static_cast<int>(i));
            const std::size_t row_bytes = header.size[0] * parts[i].sample_bytes();
            std::vector<std::byte> rows(group * row_bytes);
            PixelChecksum checksum;
            for (std::uint64_t first = 0; first < all; first += group) {
                const std::uint64_t count = std::min(group, all - first);
                pixels.setFrameBuffer(frame_of(parts[i], header.size[0], first, count, rows.data()));
                pixels.readPixels(static_cast<int>(first), static_cast<int>(first + count - 1));
                checksum.update(std::span(rows).first(count * row_bytes));
            }
            checksums.push_back(checksum.value());
        }
        return checksums;
    });
}

} // namespace forceshade::exr
