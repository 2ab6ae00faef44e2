#include "host/io/exr_scan.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "host/error.h"

namespace forceshade::exr {
namespace {

constexpr std::uint32_t kMagic = 20000630;
constexpr std::uint32_t kFlagTiled = 0x200;
constexpr std::uint32_t kFlagDeep = 0x800;
constexpr std::uint32_t kFlagMultipart = 0x1000;
constexpr std::size_t kLongestName = 255;
constexpr std::uint64_t kMostBlockBytes = 1ull << 30;

/// Lines in a block, by the compression's number in the file: NONE, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
constexpr std::array<std::uint64_t, 10> kBlockLines{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};

class Scanner {
public:
    Scanner(const ReadableFile& file, const std::filesystem::path& name) : file_(file), name_(name) {}

    [[noreturn]] void damaged(const char* what) const {
        throw IoError(fmt::format("cannot read {}: no valid EXR file, {}", name_.string(), what));
    }

    void read(std::span<std::byte> bytes) {
        if (file_.read_some(position_, bytes) != bytes.size())
            damaged("it ends within the header");
        position_ += bytes.size();
    }

    std::uint32_t read_word() {
        std::uint32_t word = 0;
        read(std::as_writable_bytes(std::span(&word, 1)));
        return word;
    }

    std::string read_name() {
        std::string name;
        for (std::byte c{};;) {
            read(std::span(&c, 1));
            if (c == std::byte{0})
                return name;
            name += static_cast<char>(c);
            if (name.size() > kLongestName)
                damaged("a name in its header has no end");
        }
    }

    void skip(std::uint64_t bytes) { position_ += bytes; }
    std::uint64_t left() const { return file_.size() - std::min(position_, file_.size()); }
    std::uint64_t file_size() const { return file_.size(); }
    bool part_follows() { // the list of parts ends in an empty header
        std::byte c{};
        read(std::span(&c, 1));
        --position_;
        return c != std::byte{0};
    }

private:
    const ReadableFile& file_;
    const std::filesystem::path& name_;
    std::uint64_t position_ = 0;
};

/// What a part's header says about its blocks.
struct Announced {
    std::array<std::int32_t, 4> window{0, 0, -1, -1}; /* data window: x and y of the first, of the last pixel */
    std::uint64_t pixel_bytes = 0;
    std::uint64_t block_lines = 1;
    std::uint64_t tile_width = 0, tile_height = 0;
    std::int32_t chunks = 0;
    bool tiled = false;
};

std::uint64_t bytes_of_channels(std::span<const std::byte> list, const Scanner& scanner) {
    std::uint64_t bytes = 0;
    for (std::size_t at = 0; at < list.size() && list[at] != std::byte{0};) {
        while (at < list.size() && list[at] != std::byte{0})
            ++at;
        std::int32_t type = 0;
        if (at + 1 + 16 > list.size())
            scanner.damaged("its list of channels is cut off");
        std::memcpy(&type, list.data() + at + 1, sizeof type);
        bytes += type == 1 ? 2 : 4; // half, or float and uint
        at += 1 + 16;
    }
    return bytes;
}

void read_attribute(Scanner& scanner, const std::string& name, std::uint64_t size, Announced& part) {
    const bool wanted =
        name == "dataWindow" || name == "compression" || name == "channels" || name == "tiles" || name == "chunkCount";
    if (!wanted)
        return scanner.skip(size);
    std::vector<std::byte> value(static_cast<std::size_t>(size));
    scanner.read(value);
    const auto copy = [&](auto& target, std::size_t offset) {
        if (offset + sizeof target > value.size())
            scanner.damaged("an attribute is too short");
        std::memcpy(&target, value.data() + offset, sizeof target);
    };
    if (name == "dataWindow") {
        copy(part.window, 0);
    } else if (name == "compression") {
        std::uint8_t number = 0;
        copy(number, 0);
        if (number >= kBlockLines.size())
            scanner.damaged("its compression is unknown");
        part.block_lines = kBlockLines[number];
    } else if (name == "channels") {
        part.pixel_bytes = bytes_of_channels(value, scanner);
    } else if (name == "chunkCount") {
        copy(part.chunks, 0);
    } else {
        std::array<std::uint32_t, 2> tile{};
        copy(tile, 0);
        part.tile_width = tile[0];
        part.tile_height = tile[1];
    }
}

Announced read_part(Scanner& scanner) {
    Announced part;
    for (std::string name = scanner.read_name(); !name.empty(); name = scanner.read_name()) {
        const std::string type = scanner.read_name();
        const std::uint64_t size = scanner.read_word();
        if (size > scanner.left())
            scanner.damaged("an attribute is larger than the file");
        if (name == "type" && type == "string" && size >= 4 && size <= kLongestName) {
            std::string value(static_cast<std::size_t>(size), '\0');
            scanner.read(std::as_writable_bytes(std::span(value)));
            if (value.starts_with("deep"))
                scanner.damaged("or a deep image, which is not supported");
            part.tiled = value == "tiledimage";
        } else {
            read_attribute(scanner, name, size, part);
        }
    }
    return part;
}

void require_possible(const Scanner& scanner, const Announced& part, bool by_tiles) {
    const std::int64_t width = std::int64_t{part.window[2]} - part.window[0] + 1;
    const std::int64_t height = std::int64_t{part.window[3]} - part.window[1] + 1;
    if (width < 1 || height < 1 || part.pixel_bytes == 0)
        scanner.damaged("its data window or its channels are missing or empty");
    const auto columns = static_cast<std::uint64_t>(width), rows = static_cast<std::uint64_t>(height);
    if (by_tiles && (part.tile_width == 0 || part.tile_height == 0))
        scanner.damaged("its tiles are empty");
    const std::uint64_t block_columns = by_tiles ? part.tile_width : columns;
    const std::uint64_t block_rows = by_tiles ? part.tile_height : part.block_lines;
    const std::uint64_t most = kMostBlockBytes / part.pixel_bytes;
    if (block_columns > most || block_rows > most || block_columns * block_rows > most)
        scanner.damaged("a block of pixels would take more than 1 GiB");
    const std::uint64_t blocks =
        by_tiles ? ((columns - 1) / block_columns + 1) * ((rows - 1) / block_rows + 1) : (rows - 1) / block_rows + 1;
    constexpr std::uint64_t kBlockOverhead = 16; // its offset in the table (8 bytes), its first line and its size
    if (blocks > scanner.file_size() / kBlockOverhead || part.chunks < 0 ||
        static_cast<std::uint64_t>(part.chunks) > scanner.file_size() / kBlockOverhead)
        scanner.damaged("it is too short for the pixels that it announces");
}

} // namespace

void require_plausible(const ReadableFile& file, const std::filesystem::path& name) {
    Scanner scanner(file, name);
    if (scanner.file_size() < 8 || scanner.read_word() != kMagic)
        scanner.damaged("it does not begin as one");
    const std::uint32_t version = scanner.read_word();
    if ((version & 0xffu) != 2)
        scanner.damaged("its version is not 2");
    if (version & kFlagDeep)
        scanner.damaged("or a deep image, which is not supported");
    const bool multipart = version & kFlagMultipart;
    do {
        const Announced part = read_part(scanner);
        require_possible(scanner, part, multipart ? part.tiled : (version & kFlagTiled) != 0);
    } while (multipart && scanner.part_follows());
}

} // namespace forceshade::exr
