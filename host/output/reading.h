// Files opened for reading, and how much memory their contents may take: what a few bytes announce can be more than
// the machine has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace forceshade {

inline constexpr std::uint64_t kDefaultMemory = 4ull << 30; /* bytes */

/// "4 GiB", "500 MB": a number and kB, MB, GB, TB, KiB, MiB, GiB or TiB. \throws UsageError
std::uint64_t parse_memory(const std::string& text);

/// For the whole process; kDefaultMemory until it is set.
void set_memory_limit(std::uint64_t bytes);

/// \throws UsageError `FILE: WHAT needs about 8.6 GB of memory, more than ...` if `bytes`, expected from the file's
/// header or size, are more than the limit. To be called before anything of that size is allocated.
void require_memory(const std::filesystem::path& file, const std::string& what, double bytes);

// A file opened for reading at any offset, with errors that name it.

/// The whole file as bytes. Throws IoError.
std::string read_file(const std::filesystem::path& path);

/// Identifies a state of a file: which file it is, how long, and when it was written.
struct FileStamp {
    std::uint64_t device = 0, inode = 0, size = 0;
    std::int64_t seconds = 0, nanoseconds = 0; /* of the last change */
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
/// The file's present state. Throws IoError.
FileStamp stamp_of(const std::filesystem::path& path);

class ReadableFile {
public:
    /// Throws IoError if the file is missing, unreadable or not a regular file.
    explicit ReadableFile(std::filesystem::path path);
    ~ReadableFile();
    ReadableFile(const ReadableFile&) = delete;
    ReadableFile& operator=(const ReadableFile&) = delete;

    const std::filesystem::path& path() const noexcept { return path_; }
    std::uint64_t size() const noexcept { return stamp_.size; } /* bytes, when it was opened */
    const FileStamp& stamp() const noexcept { return stamp_; }  /* when it was opened */

    /// Reads up to bytes.size() from `offset` and returns how many there were: fewer only at the file's end. Throws
    /// IoError.
    std::size_t read_some(std::uint64_t offset, std::span<std::byte> bytes) const;

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    FileStamp stamp_;
};

} // namespace forceshade
