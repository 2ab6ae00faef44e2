// zlib's one-call functions by ISA-L. OpenEXR asks for them by name and finds the program's own first: its ZIP and
// PXR24 blocks are then compressed and unpacked several times as fast, in the same format, and with the same bytes on
// every processor with CRC-32 instructions, as all x86-64 since 2008 has them. What was packed is unpacked at once and
// compared.
#include "host/output/raw_formats.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <isa-l.h>
#include <zconf.h>
#include <zlib.h>

namespace forceshade {
namespace {

using Bytes = std::span<const Bytef>;

constexpr std::size_t kMostBytes = std::numeric_limits<std::uint32_t>::max(); // that ISA-L takes at once

// The last block and what became of it: what repeats along y is worked on once.
struct LastBlock {
    std::vector<Bytef> from, to;

    bool is(Bytes block) const { return !to.empty() && std::ranges::equal(from, block); }
};

int give(const LastBlock& last, Bytef* to, uLongf* room) {
    if (last.to.size() > *room)
        return Z_BUF_ERROR;
    std::memcpy(to, last.to.data(), last.to.size());
    *room = last.to.size();
    return Z_OK;
}

int unpack_anew(Bytef* to, uLongf* room, Bytes from) {
    if (from.size() > kMostBytes)
        return Z_DATA_ERROR;
    inflate_state state;
    isal_inflate_init(&state);
    state.crc_flag = ISAL_ZLIB;
    state.next_in = const_cast<Bytef*>(from.data()); // only read
    state.avail_in = static_cast<std::uint32_t>(from.size());
    state.next_out = to;
    state.avail_out = static_cast<std::uint32_t>(std::min(*room, kMostBytes));
    const int result = isal_inflate_stateless(&state);
    *room = state.total_out;
    return result == ISAL_DECOMP_OK ? Z_OK : result == ISAL_OUT_OVERFLOW ? Z_BUF_ERROR : Z_DATA_ERROR;
}

int unpack(Bytef* to, uLongf* room, Bytes from) {
    thread_local LastBlock last;
    if (last.is(from))
        return give(last, to, room);
    const int result = unpack_anew(to, room, from);
    if (result == Z_OK)
        last = {{from.begin(), from.end()}, {to, to + *room}};
    return result;
}

int pack_anew(std::vector<Bytef>& to, Bytes from) {
    thread_local std::vector<Bytef> tokens(ISAL_DEF_LVL2_DEFAULT);
    constexpr std::size_t kStored = 65535, kHeader = 5, kRest = 64; // what cannot be made smaller is stored
    to.resize(from.size() + kHeader * (from.size() / kStored + 1) + kRest);
    if (to.size() > kMostBytes)
        return Z_BUF_ERROR;
    isal_zstream stream;
    isal_deflate_stateless_init(&stream);
    stream.hist_bits = 0; // the largest window: the initialization leaves what was there
    stream.level = 2;     // the fastest on a field's blocks
    stream.level_buf = tokens.data();
    stream.level_buf_size = static_cast<std::uint32_t>(tokens.size());
    stream.gzip_flag = IGZIP_ZLIB;
    stream.end_of_stream = 1;
    stream.next_in = const_cast<Bytef*>(from.data()); // only read
    stream.avail_in = static_cast<std::uint32_t>(from.size());
    stream.next_out = to.data();
    stream.avail_out = static_cast<std::uint32_t>(to.size());
    const int result = isal_deflate_stateless(&stream);
    to.resize(stream.total_out);
    return result == COMP_OK ? Z_OK : Z_BUF_ERROR;
}

int pack(Bytef* to, uLongf* room, Bytes from) {
    thread_local LastBlock last;
    if (last.is(from))
        return give(last, to, room);
    if (const int result = pack_anew(last.to, from); result != Z_OK) {
        last.to.clear();
        return result;
    }
    last.from.resize(from.size());
    uLongf found = last.from.size();
    if (unpack_anew(last.from.data(), &found, last.to) != Z_OK ||
        !std::ranges::equal(std::span(last.from).first(found), from)) {
        last.to.clear();
        return Z_DATA_ERROR; // the memory is bad
    }
    return give(last, to, room);
}

} // namespace

std::string deflate_name() {
    return fmt::format("ISA-L {}.{}.{}", ISAL_MAJOR_VERSION, ISAL_MINOR_VERSION, ISAL_PATCH_VERSION);
}

std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before) {
    return crc32_gzip_refl(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
}

void deflate(std::span<const std::byte> from, std::vector<std::byte>& to) {
    to.resize(compressBound(from.size()));
    uLongf size = to.size();
    const int result =
        pack(reinterpret_cast<Bytef*>(to.data()), &size, {reinterpret_cast<const Bytef*>(from.data()), from.size()});
    if (result == Z_MEM_ERROR)
        throw std::bad_alloc();
    if (result != Z_OK)
        throw std::runtime_error("a block that was compressed does not unpack to what it was; check the memory");
    to.resize(size);
}

} // namespace forceshade

extern "C" {
#pragma GCC visibility push(default) // or OpenEXR would not find them

int compress2(Bytef* to, uLongf* room, const Bytef* from, uLong size, int) { // of ZIP, at whatever level
    return forceshade::pack(to, room, {from, size});
}

int compress(Bytef* to, uLongf* room, const Bytef* from, uLong size) { // of PXR24
    return forceshade::pack(to, room, {from, size});
}

int uncompress(Bytef* to, uLongf* room, const Bytef* from, uLong size) {
    return forceshade::unpack(to, room, {from, size});
}

#pragma GCC visibility pop
}
