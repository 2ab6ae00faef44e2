// A file opened for reading at any offset, with errors that name it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace forceshade {

/// The whole file as bytes. Throws IoError.
std::string read_file(const std::filesystem::path& path);

class ReadableFile {
public:
    /// Throws IoError if the file is missing, unreadable or no regular file.
    explicit ReadableFile(std::filesystem::path path);
    ~ReadableFile();
    ReadableFile(const ReadableFile&) = delete;
    ReadableFile& operator=(const ReadableFile&) = delete;

    const std::filesystem::path& path() const noexcept { return path_; }
    std::uint64_t size() const noexcept { return size_; } /* bytes, when it was opened */

    /// Reads up to bytes.size() from `offset` and returns how many there were: fewer only at the file's end. Throws
    /// IoError.
    std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

} // namespace forceshade
