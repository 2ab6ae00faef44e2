// zlib's one-call functions by libdeflate. OpenEXR asks for them by name and finds the program's own first: its ZIP and
// PXR24 blocks are then compressed and unpacked several times as fast, in the same format, and with the same bytes on
// every machine. What was packed is unpacked at once and compared.
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

// The last block and what became of it: what repeats along y is worked on once.
struct LastBlock {
    std::vector<Bytef> from, to;
    int level = 0;

    bool is(Bytes block, int at_level) const {
        return !to.empty() && level == at_level && std::ranges::equal(from, block);
    }
};

int give(const LastBlock& last, Bytef* to, uLongf* room) {
    if (last.to.size() > *room)
        return Z_BUF_ERROR;
    std::memcpy(to, last.to.data(), last.to.size());
    *room = last.to.size();
    return Z_OK;
}

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

int unpack(Bytef* to, uLongf* room, Bytes from) {
    thread_local LastBlock last;
    if (last.is(from, 0))
        return give(last, to, room);
    const int result = unpack_anew(to, room, from);
    if (result == Z_OK)
        last = {{from.begin(), from.end()}, {to, to + *room}, 0};
    return result;
}

int pack(Bytef* to, uLongf* room, Bytes from, int level) {
    thread_local std::unique_ptr<libdeflate_compressor, Free> packer;
    thread_local LastBlock last;
    if (last.is(from, level))
        return give(last, to, room);
    if (!packer || last.level != level)
        packer.reset(libdeflate_alloc_compressor(level));
    if (!packer)
        return Z_MEM_ERROR;
    last.level = level;
    last.to.resize(libdeflate_zlib_compress_bound(packer.get(), from.size())); // a little more than zlib's
    const std::size_t size =
        libdeflate_zlib_compress(packer.get(), from.data(), from.size(), last.to.data(), last.to.size());
    last.to.resize(size);
    last.from.resize(from.size());
    uLongf found = last.from.size();
    if (size == 0)
        return Z_BUF_ERROR;
    if (unpack_anew(last.from.data(), &found, last.to) != Z_OK ||
        !std::ranges::equal(std::span(last.from).first(found), from)) {
        last.to.clear();
        return Z_DATA_ERROR; // the memory is bad
    }
    return give(last, to, room);
}

} // namespace

std::string deflate_name() {
    return fmt::format("libdeflate {}", LIBDEFLATE_VERSION_STRING);
}

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
    return libdeflate_crc32(before, bytes.data(), bytes.size());
}

void deflate(std::span<const std::byte> from, std::vector<std::byte>& to) {
    to.resize(libdeflate_zlib_compress_bound(nullptr, from.size()));
    uLongf size = to.size();
    const int result = pack(reinterpret_cast<Bytef*>(to.data()), &size,
                            {reinterpret_cast<const Bytef*>(from.data()), from.size()}, kDeflateLevel);
    if (result == Z_MEM_ERROR)
        throw std::bad_alloc();
    if (result != Z_OK)
        throw std::runtime_error("a block that was compressed does not unpack to what it was; check the memory");
    to.resize(size);
}

} // namespace forceshade

extern "C" {
#pragma GCC visibility push(default) // or OpenEXR would not find them

int compress2(Bytef* to, uLongf* room, const Bytef* from, uLong size, int level) {
    constexpr int kDefault = 6, kHighest = 9; // zlib's
    return forceshade::pack(to, room, {from, size}, level < 0 ? kDefault : std::min(level, kHighest));
}

int compress(Bytef* to, uLongf* room, const Bytef* from, uLong size) {
    return compress2(to, room, from, size, forceshade::kDeflateLevel); // of PXR24
}

int uncompress(Bytef* to, uLongf* room, const Bytef* from, uLong size) {
    return forceshade::unpack(to, room, {from, size});
}

#pragma GCC visibility pop
}
