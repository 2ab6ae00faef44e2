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

/// What tells one state of a file from another: which file it is, how long, and when it was written.
struct FileStamp {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0; /* of the last change */
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
/// The file's present state. Throws IoError.
FileStamp stamp_of(const std::filesystem::path& path);

class ReadableFile {
public:
    /// Throws IoError if the file is missing, unreadable or no regular file.
    explicit ReadableFile(std::filesystem::path path);
    ~ReadableFile();
    ReadableFile(const ReadableFile&) = delete;
    ReadableFile& operator=(const ReadableFile&) = delete;

    const std::filesystem::path& path() const noexcept { return path_; }
    std::uint64_t size() const noexcept { return stamp_.size; } /* bytes, when it was opened */
    const FileStamp& stamp() const noexcept { return stamp_; }  /* likewise */

    /// Reads up to bytes.size() from `offset` and returns how many there were: fewer only at the file's end. Throws
    /// IoError.
    std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    FileStamp stamp_;
};

} // namespace forceshade
