// A file as accounts name it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace forceshade {

struct FileRecord {
    std::string name; /* in its folder */
    std::string sha256;
    std::uint64_t bytes = 0;
};

// SHA-256 of bytes and files (what the manifest records), and a fast checksum for pixels that are read back.

/// 64 lower-case hex digits.
std::string sha256_of(std::span<const std::byte> bytes);
std::string sha256_of(std::string_view text);

/// Streamed: memory does not grow with the file. Throws IoError.
std::string sha256_of_file(const std::filesystem::path& path);

/// True if the file is there and its SHA-256 is the expected one (64 hex digits). A file that cannot be read is not
/// intact.
bool file_is_intact(const std::filesystem::path& path, const std::string& expected_sha256);

/// SHA-256 of what arrives piece by piece.
class Sha256 {
public:
    Sha256();
    ~Sha256();
    Sha256(Sha256&&) noexcept;
    Sha256& operator=(Sha256&&) noexcept;
    void update(std::span<const std::byte> bytes);
    /// 64 lower-case hex digits; once, and nothing may follow.
    std::string finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// XXH3-64 of what arrives piece by piece: catches damage, not malice.
class PixelChecksum {
public:
    PixelChecksum();
    ~PixelChecksum();
    PixelChecksum(PixelChecksum&&) noexcept;
    PixelChecksum& operator=(PixelChecksum&&) noexcept;
    void update(std::span<const std::byte> bytes);
    std::uint64_t value() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade
