#include <algorithm>

#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>

#include "host/io/exr_parts.h"
#include "host/io/exr_stream.h"
#include "host/io/hash.h"
#include "host/io/readable_file.h"

namespace forceshade::exr {

std::vector<std::uint64_t> checksums_of(const std::filesystem::path& file, const std::filesystem::path& path,
                                        const Sheet& sheet) {
    const ReadableFile source(file);
    ReadStream stream(source, path);
    const std::uint64_t group = rows_per_group(sheet.width, sheet.rows);
    return guarded(stream, "read back", path, [&] {
        Imf::MultiPartInputFile input(stream, sheet.threads, false);
        std::vector<std::uint64_t> checksums;
        const std::vector<Part>& parts = sheet.parts;
        for (std::size_t i = 0; i < parts.size() && static_cast<int>(i) < input.parts(); ++i) {
            Imf::InputPart pixels(input, static_cast<int>(i));
            const std::size_t row_bytes = sheet.width * parts[i].sample_bytes();
            std::vector<std::byte> rows(std::min(group, sheet.rows) * row_bytes);
            PixelChecksum checksum;
            for (std::uint64_t first = 0; first < sheet.rows; first += group) {
                const std::uint64_t count = std::min(group, sheet.rows - first);
                pixels.setFrameBuffer(frame_of(parts[i], sheet.width, first, count, rows.data()));
                pixels.readPixels(static_cast<int>(first), static_cast<int>(first + count - 1));
                checksum.update(std::span(rows).first(count * row_bytes));
            }
            checksums.push_back(checksum.value());
        }
        return checksums;
    });
}

} // namespace forceshade::exr
