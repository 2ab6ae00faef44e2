// Rows to the blocks of an OpenEXR file, byte for byte as OpenEXR packs them (its file layout; ImfZip.cpp and
// ImfPxr24Compressor.cpp of 3.1): its C++ library packs what repeats along y again and again, and its C library cannot
// interleave parts.
#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include "host/output/exr_image.h"
#include "host/output/raw_formats.h"

namespace forceshade::exr {
namespace {

static_assert(std::endian::native == std::endian::little, "as the numbers of the file are");

// Rows of interleaved components to components one after the other in each row, those in `order`.
template <typename Word, std::size_t N>
void separate(const std::byte* rows, std::size_t count, std::size_t width, const std::vector<std::size_t>& order,
              std::byte* to) {
    const auto* from = reinterpret_cast<const Word*>(rows);
    auto* into = reinterpret_cast<Word*>(to);
    for (std::size_t row = 0; row < count; ++row, from += N * width)
        for (std::size_t c = 0; c < N; ++c, into += width) {
            const Word* const component = from + order[c];
#pragma GCC ivdep
            for (std::size_t x = 0; x < width; ++x)
                into[x] = component[N * x];
        }
}

// Even bytes, then odd ones, each as its difference from the one before: numbers that change little become small ones.
void predict(std::span<const std::byte> raw, std::vector<std::byte>& split, std::vector<std::byte>& to) {
    split.resize(raw.size());
    to.resize(raw.size());
    const std::size_t half = raw.size() / 2, even = raw.size() - half;
    const auto* from = reinterpret_cast<const std::uint8_t*>(raw.data());
    auto* parts = reinterpret_cast<std::uint8_t*>(split.data());
    auto* odd = parts + even;
#pragma GCC ivdep
    for (std::size_t i = 0; i < half; ++i) {
        parts[i] = from[2 * i];
        odd[i] = from[2 * i + 1];
    }
    if (even > half)
        parts[half] = from[2 * half];
    auto* differences = reinterpret_cast<std::uint8_t*>(to.data());
    differences[0] = parts[0];
#pragma GCC ivdep
    for (std::size_t i = 1; i < raw.size(); ++i)
        differences[i] = static_cast<std::uint8_t>(parts[i] - parts[i - 1] + 128);
}

// Differences along a row, their highest bytes first: of floats, rounded to 24 bits before, three bytes.
template <typename Word, int kBytes, int kDropped>
void differences_by_byte(const std::byte* values, std::size_t width, std::byte* to) {
    const auto* from = reinterpret_cast<const Word*>(values);
    auto* planes = reinterpret_cast<std::uint8_t*>(to);
    std::uint32_t before = 0;
    for (std::size_t x = 0; x < width; ++x) {
        const std::uint32_t value = std::uint32_t{from[x]} >> kDropped, step = value - before;
        before = value;
        for (std::size_t byte = 0; byte < kBytes; ++byte)
            planes[byte * width + x] = static_cast<std::uint8_t>(step >> 8 * (kBytes - 1 - byte));
    }
}

} // namespace

BlockPacker::BlockPacker(const Part& part, std::uint64_t width, Compression compression)
    : part_(part), width_(width), compression_(compression), order_(part.channels.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::sort(order_, {}, [&](std::size_t c) { return std::string_view(part_.channels[c]); }); // as in the file
}

std::uint64_t BlockPacker::rows() const {
    return compression_ == Compression::zip || compression_ == Compression::pxr24 ? 16 : 1;
}

void BlockPacker::pack(std::span<const std::byte> rows, Scratch& scratch, std::vector<std::byte>& packed) const {
    const std::size_t count = rows.size() / (width_ * part_.sample_bytes());
    scratch.raw.resize(rows.size());
    const auto separated = [&]<typename Word>(Word) {
        (order_.size() == 3 ? separate<Word, 3> : separate<Word, 1>)(rows.data(), count, width_, order_,
                                                                     scratch.raw.data());
    };
    if (part_.format == PixelFormat::half)
        separated(std::uint16_t{});
    else
        separated(std::uint32_t{});
    if (compression_ == Compression::none) {
        packed = scratch.raw;
        return;
    }
    if (compression_ == Compression::pxr24)
        split_bytes(count, scratch);
    else
        predict(scratch.raw, scratch.split, scratch.ready);
    deflate(scratch.ready, packed);
    if (packed.size() >= rows.size())
        packed = scratch.raw;
}

void BlockPacker::split_bytes(std::size_t count, Scratch& scratch) const {
    const bool is_float = part_.format == PixelFormat::float24;
    const std::size_t bytes = bytes_of(part_.format), kept = is_float ? bytes - 1 : bytes; // of a value
    scratch.ready.resize(count * order_.size() * width_ * kept);
    void (*const split)(const std::byte*, std::size_t, std::byte*) =
        part_.format == PixelFormat::half ? differences_by_byte<std::uint16_t, 2, 0>
        : is_float                        ? differences_by_byte<std::uint32_t, 3, 8>
                                          : differences_by_byte<std::uint32_t, 4, 0>;
    for (std::size_t line = 0; line < count * order_.size(); ++line)
        split(&scratch.raw[line * width_ * bytes], width_, &scratch.ready[line * width_ * kept]);
}

} // namespace forceshade::exr
