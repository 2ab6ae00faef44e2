// Packs and unpacks zlib's format by libdeflate, several times as fast, with the same bytes on every machine. What was
// packed is unpacked at once and compared. OpenEXR asks for zlib's `uncompress` by name and finds the program's own
// first.
#include "host/output/raw_formats.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <libdeflate.h>
#include <zconf.h>
#include <zlib.h>

namespace forceshade {
namespace {

using Bytes = std::span<const Bytef>;

struct Free {
    void operator()(libdeflate_compressor* one) const { libdeflate_free_compressor(one); }
    void operator()(libdeflate_decompressor* one) const { libdeflate_free_decompressor(one); }
};

int unpack_anew(Bytef* to, uLongf* room, Bytes from) {
    thread_local const std::unique_ptr<libdeflate_decompressor, Free> unpacker(libdeflate_alloc_decompressor());
    if (!unpacker)
        return Z_MEM_ERROR;
    std::size_t size = 0;
    switch (libdeflate_zlib_decompress(unpacker.get(), from.data(), from.size(), to, *room, &size)) {
    case LIBDEFLATE_SUCCESS:
        break;
    case LIBDEFLATE_INSUFFICIENT_SPACE:
        return Z_BUF_ERROR;
    default:
        return Z_DATA_ERROR;
    }
    *room = size;
    return Z_OK;
}

// What repeats along y is unpacked once.
int unpack(Bytef* to, uLongf* room, Bytes from) {
    thread_local std::vector<Bytef> last_from, last_to;
    if (!last_to.empty() && last_from.size() == from.size() &&
        std::memcmp(last_from.data(), from.data(), from.size()) == 0) {
        if (last_to.size() > *room)
            return Z_BUF_ERROR;
        std::ranges::copy(last_to, to);
        *room = last_to.size();
        return Z_OK;
    }
    const int result = unpack_anew(to, room, from);
    if (result == Z_OK) {
        last_from.assign(from.begin(), from.end());
        last_to.assign(to, to + *room);
    }
    return result;
}

} // namespace

std::string deflate_name() {
    return fmt::format("libdeflate {}", LIBDEFLATE_VERSION_STRING);
}

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
    return libdeflate_crc32(before, bytes.data(), bytes.size());
}

void deflate(std::span<const std::byte> from, std::vector<std::byte>& to, int level) {
    thread_local std::unique_ptr<libdeflate_compressor, Free> packer;
    thread_local int packer_level = -1;
    thread_local std::vector<Bytef> again;
    if (!packer || packer_level != level)
        packer.reset(libdeflate_alloc_compressor(level));
    if (!packer)
        throw std::bad_alloc();
    packer_level = level;
    to.resize(libdeflate_zlib_compress_bound(packer.get(), from.size()));
    to.resize(libdeflate_zlib_compress(packer.get(), from.data(), from.size(), to.data(), to.size()));
    again.resize(from.size());
    uLongf size = again.size();
    if (unpack_anew(again.data(), &size, {reinterpret_cast<const Bytef*>(to.data()), to.size()}) != Z_OK ||
        size != from.size() || std::memcmp(again.data(), from.data(), size) != 0)
        throw std::runtime_error("a block that was compressed does not unpack to what it was; check the memory");
}

} // namespace forceshade

extern "C" {
#pragma GCC visibility push(default) // or OpenEXR would not find it

int uncompress(Bytef* to, uLongf* room, const Bytef* from, uLong size) {
    return forceshade::unpack(to, room, {from, size});
}

#pragma GCC visibility pop
}
