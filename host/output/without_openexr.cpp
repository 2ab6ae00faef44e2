// What stands in the place of sha256.cpp, exr_image.cpp and perhaps png_image.cpp in the library, which does without
// OpenSSL and OpenEXR, and without libpng where that is missing: SHA-256 (FIPS 180-4), slower, with the same digits.
#include <algorithm>
#include <array>
#include <bit>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"

namespace forceshade {

namespace {

constexpr std::array<std::uint32_t, 64> kRounds{
    0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5, 0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5,
    0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3, 0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174,
    0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc, 0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da,
    0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7, 0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967,
    0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13, 0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85,
    0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3, 0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070,
    0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5, 0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3,
    0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208, 0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2};

std::uint32_t big_endian(const std::byte* at) {
    return std::to_integer<std::uint32_t>(at[0]) << 24 | std::to_integer<std::uint32_t>(at[1]) << 16 |
           std::to_integer<std::uint32_t>(at[2]) << 8 | std::to_integer<std::uint32_t>(at[3]);
}

} // namespace

struct Sha256::State {
    static constexpr std::size_t kBlock = 64; /* bytes */

    void compress() {
        std::array<std::uint32_t, 64> words{};
        for (std::size_t i = 0; i < 16; ++i)
            words[i] = big_endian(&block[4 * i]);
        for (std::size_t i = 16; i < 64; ++i) {
            const std::uint32_t one = words[i - 15], two = words[i - 2];
            words[i] = words[i - 16] + (std::rotr(one, 7) ^ std::rotr(one, 18) ^ one >> 3) + words[i - 7] +
                       (std::rotr(two, 17) ^ std::rotr(two, 19) ^ two >> 10);
        }
        auto [a, b, c, d, e, f, g, h] = hash;
        for (std::size_t i = 0; i < 64; ++i) {
            const std::uint32_t first = h + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                                        ((e & f) ^ (~e & g)) + kRounds[i] + words[i];
            const std::uint32_t second =
                (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) + ((a & b) ^ (a & c) ^ (b & c));
            h = g, g = f, f = e, e = d + first, d = c, c = b, b = a, a = first + second;
        }
        const std::array<std::uint32_t, 8> last{a, b, c, d, e, f, g, h};
        for (std::size_t i = 0; i < 8; ++i)
            hash[i] += last[i];
    }

    void add(std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const std::size_t count = std::min(bytes.size(), kBlock - filled);
            std::copy_n(bytes.begin(), count, &block[filled]);
            bytes = bytes.subspan(count);
            filled += count;
            if (filled == kBlock) {
                compress();
                filled = 0;
            }
        }
    }

    std::array<std::uint32_t, 8> hash{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
    std::array<std::byte, kBlock> block{};
    std::size_t filled = 0;
    std::uint64_t size = 0; /* bytes in all */
};

Sha256::Sha256() : state_(std::make_unique<State>()) {}
Sha256::~Sha256() = default;

void Sha256::update(std::span<const std::byte> bytes) {
    state_->size += bytes.size();
    state_->add(bytes);
}

std::string Sha256::finish() {
    const std::uint64_t bits = 8 * state_->size;
    std::array<std::byte, State::kBlock + 8> end{std::byte{0x80}};
    const std::size_t padding = (State::kBlock + 55 - state_->filled) % State::kBlock + 1;
    for (std::size_t i = 0; i < 8; ++i)
        end[padding + i] = static_cast<std::byte>(bits >> (56 - 8 * i));
    state_->add(std::span(end).first(padding + 8));
    return fmt::format("{:08x}", fmt::join(state_->hash, ""));
}

HeightImage read_height_exr(const ReadableFile& file) {
    throw UsageError("{}: this build reads no OpenEXR images: convert the height map to PNG, or build with "
                     "FORCESHADE_LIBRARY_ONLY=OFF",
                     file.path().string());
}

#ifdef FORCESHADE_WITHOUT_PNG
HeightImage read_height_png(const ReadableFile& file) {
    throw UsageError("{}: this build reads no PNG images: build it where libpng is installed", file.path().string());
}
#endif

} // namespace forceshade
