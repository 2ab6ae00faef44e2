#include "host/output/hash.h"

#include <array>
#include <stdexcept>
#include <vector>

#include <openssl/evp.h>
#include <xxhash.h>

#include "host/error.h"
#include "host/output/reading.h"

namespace forceshade {

namespace {

void require(bool succeeded) {
    if (!succeeded)
        throw std::runtime_error("OpenSSL offers no SHA-256");
}

} // namespace

struct Sha256::State {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
    ~State() { EVP_MD_CTX_free(context); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) {
    require(state_->context && EVP_DigestInit_ex(state_->context, EVP_sha256(), nullptr) == 1);
}
Sha256::~Sha256() = default;
Sha256::Sha256(Sha256&&) noexcept = default;
Sha256& Sha256::operator=(Sha256&&) noexcept = default;

void Sha256::update(std::span<const std::byte> bytes) {
    require(EVP_DigestUpdate(state_->context, bytes.data(), bytes.size()) == 1);
}

std::string Sha256::finish() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    require(EVP_DigestFinal_ex(state_->context, digest.data(), &size) == 1);
    constexpr std::string_view kHex = "0123456789abcdef";
    std::string text;
    for (unsigned i = 0; i < size; ++i) {
        text += kHex[digest[i] >> 4];
        text += kHex[digest[i] & 15];
    }
    return text;
}

std::string sha256_of(std::span<const std::byte> bytes) {
    Sha256 hash;
    hash.update(bytes);
    return hash.finish();
}

std::string sha256_of(std::string_view text) {
    return sha256_of(std::as_bytes(std::span(text)));
}

std::string sha256_of_file(const std::filesystem::path& path) {
    constexpr std::size_t kBlock = 1 << 18; /* bytes: fits the second-level cache */
    const ReadableFile file(path);
    std::vector<std::byte> block(kBlock);
    Sha256 hash;
    for (std::uint64_t offset = 0;;) {
        const std::size_t got = file.read_some(offset, block);
        hash.update(std::span(block).first(got));
        offset += got;
        if (got < block.size())
            return hash.finish();
    }
}

bool file_is_intact(const std::filesystem::path& path, const std::string& expected_sha256) {
    try {
        return sha256_of_file(path) == expected_sha256;
    } catch (const IoError&) {
        return false;
    }
}

struct PixelChecksum::State {
    XXH3_state_t* state = XXH3_createState();
    ~State() { XXH3_freeState(state); }
};

PixelChecksum::PixelChecksum() : state_(std::make_unique<State>()) {
    if (!state_->state)
        throw std::bad_alloc();
    XXH3_64bits_reset(state_->state);
}
PixelChecksum::~PixelChecksum() = default;
PixelChecksum::PixelChecksum(PixelChecksum&&) noexcept = default;
PixelChecksum& PixelChecksum::operator=(PixelChecksum&&) noexcept = default;

void PixelChecksum::update(std::span<const std::byte> bytes) {
    XXH3_64bits_update(state_->state, bytes.data(), bytes.size());
}

std::uint64_t PixelChecksum::value() const {
    return XXH3_64bits_digest(state_->state);
}

} // namespace forceshade
