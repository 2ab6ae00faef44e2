// EXR files whose only block holds less than its pixels.
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include <zlib.h>

namespace forceshade::testing {

/// By their numbers in the file.
enum class Packing : char { none = 0, rle = 1, zips = 2, zip = 3, pxr24 = 5 };

inline std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             bytes.size());
    return packed.substr(0, size);
}

/// What a block of so many bytes of zeros is as packed; of none it is empty.
inline std::string packed_zeros(Packing packing, std::size_t size) {
    if (size == 0)
        return {};
    std::string differences(size, '\x80'); // of each byte from the one before, plus 128
    differences[0] = 0;
    switch (packing) {
    case Packing::none:
        return std::string(size, '\0');
    case Packing::pxr24:
        return deflated(std::string(size, '\0'));
    case Packing::zips:
    case Packing::zip:
        return deflated(differences);
    case Packing::rle:
        break;
    }
    std::string runs;
    for (std::size_t at = 0; at < size;) {
        std::size_t end = at + 1;
        while (end < size && end - at < 128 && differences[end] == differences[at])
            ++end;
        runs += {static_cast<char>(end - at - 1), differences[at]};
        at = end;
    }
    return runs;
}

/// The file, of one part and one block, with other contents of that block.
inline std::string with_block(const std::string& file, const std::string& contents, bool tiled = false) {
    const auto word = [&](std::size_t at) {
        std::uint64_t value = 0;
        std::memcpy(&value, file.data() + at, sizeof value);
        return value;
    };
    for (std::size_t block = 8; block + 8 <= file.size(); ++block) // behind the table, which has its place
        if (word(block - 8) == block) {
            const auto size = static_cast<std::uint32_t>(contents.size());
            std::string changed = file.substr(0, block + (tiled ? 16 : 4)); // its place in the image, then its size
            changed.append(reinterpret_cast<const char*>(&size), sizeof size);
            return changed + contents;
        }
    throw std::runtime_error("the file has no table of one block");
}

} // namespace forceshade::testing
