// Files written whole or not at all, their hashes, and errors that name the file, the reason and what to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/error.h"

namespace forceshade {

class WriteBehind;

/// `cannot write results/a.exr: No space left on device; free space there or choose another folder`.
/// `verb` is "write" or "read" (it decides the advice), `number` an errno. English in every locale.
IoError file_error(const char* verb, const std::filesystem::path& path, int number);

// Names of files in manifests, which any program may have written.

/// True for the name of a file right in its folder; another is foreign and not followed.
inline bool is_plain_name(const std::string& name) {
    return !name.empty() && name.front() != '.' && name.find_first_of(std::string("/\\\0", 3)) == std::string::npos;
}

// A file that appears under its own name only when it is complete and on disk.

/// Written as `.NAME.fs.HOST.PROCESS.<16 hex digits>.tmp` next to NAME and locked while alive, so that what a killed
/// process left can be distinguished from what a live one is writing, on the same machine. Several processes may write
/// the same NAME at once: the last rename stands. Every failure is an IoError that names NAME, and once one occurred
/// publish() fails, too. A thread of its own hands large files to the disk, some MiB behind write(), which may so throw
/// what an earlier call met.
class TemporaryFile {
public:
    /// `hashed`: sha256() will be asked for. `buffers` of 512 KiB each are held for the disk, at most.
    explicit TemporaryFile(std::filesystem::path final_path, bool hashed = false, std::size_t buffers = 3);
    /// Removes the temporary unless it was published.
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::span<const std::byte> bytes);
    void write(std::string_view text);
    void seek(std::uint64_t position); /* bytes from the start */
    std::uint64_t tell() const noexcept { return buffer_position_ + filled_; }

    /// Everything written so far is on the disk, and the kernel forgets its copy, so that reading reads the disk.
    /// \throws Interrupted too, of a file of 64 MiB or more.
    void flush_to_disk();
    /// flush_to_disk() if that is still due, then renames to the final name and makes the rename durable. Not
    /// `durable`: hands all to the kernel and renames.
    void publish(bool durable = true);
    /// Of all that was written, once, after flush_to_disk(). Reads the file if seek() was used.
    std::string sha256();

    const std::filesystem::path& path() const noexcept { return path_; }
    const std::filesystem::path& temporary_path() const noexcept { return temporary_path_; }

private:
    void open_unique();
    void lock_or_discard();
    void hand_over();
    void flush_buffer();
    void wait_for_disk();
    [[noreturn]] void fail(int number);
    void throw_if_failed() const;

    std::filesystem::path path_;
    std::filesystem::path temporary_path_;
    int descriptor_ = -1;
    std::size_t filled_ = 0;            /* bytes of the buffer */
    std::uint64_t buffer_position_ = 0; /* where in the file the buffer belongs */
    std::uint64_t size_ = 0;            /* bytes in the file */
    std::unique_ptr<WriteBehind> disk_;
    std::span<std::byte> buffer_; /* one of those */
    bool on_disk_ = false;
    bool published_ = false;
    std::optional<IoError> failure_;
};

/// From now on these files stay as they are: what is published under their names is dropped.
void keep_files(const std::vector<std::filesystem::path>& files);

/// Removes the temporaries of this machine's in `folder` that no live process holds; returns how many. Leaves
/// everything else alone, does not descend, and a folder that is missing or cannot be read counts as empty.
std::size_t clear_stale_temporaries(const std::filesystem::path& folder);

/// The names of those that other machines write, or left.
std::vector<std::string> temporaries_of_others(const std::filesystem::path& folder);

/// Makes a folder of the program's own in one that it writes results into, which is made if need be. \throws IoError if
/// it cannot be, or is a symbolic link: what that leads to is not the program's to change.
void make_subfolder(const std::filesystem::path& folder, const std::string& name);

/// The old file or the whole new one, never a part. Throws IoError.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);
void write_file_atomically(const std::filesystem::path& path, std::string_view text);

// SHA-256 of bytes and files, which the manifest records.

/// Of what arrives piece by piece.
class Sha256 {
public:
    Sha256();
    ~Sha256();
    void update(std::span<const std::byte> bytes);
    /// 64 lower-case hex digits; once, as the last call.
    std::string finish();

private:
    struct State; // OpenSSL's, or the library's own (sha256.cpp, without_openexr.cpp)
    std::unique_ptr<State> state_;
};

std::string sha256_of(std::span<const std::byte> bytes);
std::string sha256_of(std::string_view text);

/// Streamed: memory does not grow with the file. `also` sees the same bytes, block by block, the first of which is byte
/// `at`. Throws IoError.
std::string sha256_of_file(const std::filesystem::path& path,
                           const std::function<void(std::span<const std::byte>, std::uint64_t at)>& also = {});

/// True if the file is there and its SHA-256 is the expected one (64 hex digits). A file that cannot be read is not
/// intact.
bool file_is_intact(const std::filesystem::path& path, const std::string& expected_sha256);

/// A file as accounts name it.
struct FileRecord {
    std::string name; /* in its folder */
    std::string sha256;
    std::uint64_t bytes = 0;
};

/// "a.exr, a.vti and a.arrows.png"
std::string names_of(const std::vector<FileRecord>& files);

// Files opened for reading, and how much memory their contents may take: what a few bytes announce can be more than
// the machine has.

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
