#include "host/output/files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fcntl.h>
#include <random>
#include <regex>
#include <set>
#include <stdexcept>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "host/long_run.h"
#include "host/output/write_behind.h"
#include "host/program.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

std::string advice(const std::filesystem::path& path, bool writing, int number) {
    switch (number) {
    case ENOSPC:
    case EDQUOT:
        return "; free space there or choose another folder";
    case EFBIG:
        return "; the file system or a limit of this process (ulimit -f) forbids a file of that size";
    case EROFS:
        return "; choose a folder on a disk that can be written";
    case EACCES:
    case EPERM:
        return writing ? "; make the folder writable or choose another" : "; make the file readable";
    case ENOENT:
        return writing ? "; create its folder first" : missing_file_advice(path);
    case ENOTDIR:
        return "; a part of its path is a file, not a folder";
    case EISDIR:
        return "; a folder has that name";
    case ENAMETOOLONG:
        return "; choose a shorter name";
    case EIO:
        return "; the disk reports an error: check it, or choose another";
    case EMFILE:
    case ENFILE:
        return "; too many files are open (ulimit -n)";
    default:
        return "";
    }
}

constexpr std::size_t kLongestName = 170; /* bytes of NAME kept in a temporary's name: file systems allow 255 in all */
constexpr std::size_t kLongestHost = 32;

// Letters, digits and "-" of the machine's name; of one that is longer or has others the beginning and a hash.
const std::string& this_host() {
    static const std::string name = [] {
        std::array<char, HOST_NAME_MAX + 1> text{};
        ::gethostname(text.data(), HOST_NAME_MAX);
        const std::string whole(text.data());
        std::string host = whole.substr(0, kLongestHost);
        for (char& c : host)
            c = std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
        if (host == whole && !host.empty())
            return host;
        constexpr std::size_t kHash = 8;
        return host.substr(0, kLongestHost - kHash - 1) + "-" + sha256_of(whole).substr(0, kHash);
    }();
    return name;
}

std::string temporary_name(const std::filesystem::path& path) {
    std::random_device source;
    const std::uint64_t unique = (std::uint64_t{source()} << 32) | source();
    return fmt::format(".{}.fs.{}.{}.{:016x}.tmp", path.filename().string().substr(0, kLongestName), this_host(),
                       ::getpid(), unique);
}

struct TemporaryName {
    std::string of, host; /* the file's own name, where it was not too long; the machine */
};

// Empty for the name of another file.
std::optional<TemporaryName> temporary_name_in(const std::string& name) {
    static const std::regex form(R"(\.([\s\S]+)\.fs\.([^.]+)\.[0-9]+\.[0-9a-f]{16}\.tmp)");
    std::smatch found;
    return std::regex_match(name, found, form) ? std::optional(TemporaryName{found[1], found[2]}) : std::nullopt;
}

// What a file is called, or will be.
std::string final_name(const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    const auto temporary = temporary_name_in(name);
    return temporary ? temporary->of : name;
}

std::set<std::filesystem::path>& kept_files() {
    static auto* const files = new std::set<std::filesystem::path>;
    return *files;
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

/// Waits for the lock if `wait`. False if another holds it; true too where the file system knows no locks and `wait`.
bool lock(int descriptor, bool wait) {
    int result = 0;
    do
        result = ::flock(descriptor, LOCK_EX | (wait ? 0 : LOCK_NB));
    while (result != 0 && errno == EINTR);
    return result == 0 || wait;
}

/// 0, or the errno. File systems that cannot flush a folder say EINVAL, which is ignored.
int flush_folder(const std::filesystem::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0)
        return errno == EACCES ? 0 : errno; // a folder may be writable and not readable
    const int number = ::fsync(descriptor) == 0 ? 0 : errno;
    ::close(descriptor);
    return number == EINVAL || number == ENOTSUP ? 0 : number;
}

} // namespace

IoError file_error(const char* verb, const std::filesystem::path& path, int number) {
    const char* reason = ::strerrordesc_np(number);
    const bool writing = std::string_view(verb) == "write";
    return IoError("cannot {} {}: {}{}", verb, path.string(), reason ? reason : "unknown error",
                   advice(path, writing, number));
}

TemporaryFile::TemporaryFile(std::filesystem::path final_path, bool hashed, std::size_t buffers)
    : path_(std::move(final_path)) {
    const std::string name = path_.filename().string();
    struct stat status {};
    if (name.empty() || name == "." || name == ".." || (::stat(path_.c_str(), &status) == 0 && S_ISDIR(status.st_mode)))
        throw file_error("write", path_, EISDIR); // now rather than after an hour of computing
    while (descriptor_ < 0) {
        open_unique();
        lock_or_discard();
    }
    disk_ = std::make_unique<WriteBehind>(descriptor_, hashed, buffers);
    buffer_ = disk_->free_buffer();
}

void TemporaryFile::open_unique() {
    const auto hold = hold_end();
    do {
        temporary_path_ = folder_of(path_) / temporary_name(path_);
        descriptor_ = ::open(temporary_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
    if (descriptor_ < 0)
        throw file_error("write", path_, errno);
    remove_at_end(temporary_path_);
}

// Between open and lock another process may take the file for a stale one and remove it: then start over.
void TemporaryFile::lock_or_discard() {
    lock(descriptor_, true);
    struct stat status {};
    if (::fstat(descriptor_, &status) == 0 && status.st_nlink == 0) {
        ::close(descriptor_);
        descriptor_ = -1;
        const auto hold = hold_end();
        keep_at_end(temporary_path_);
    }
}

TemporaryFile::~TemporaryFile() {
    if (!published_) {
        const auto hold = hold_end();
        ::unlink(temporary_path_.c_str());
        keep_at_end(temporary_path_);
    }
    disk_.reset();
    ::close(descriptor_);
}

void TemporaryFile::fail(int number) {
    failure_ = file_error("write", path_, number);
    throw *failure_;
}

void TemporaryFile::throw_if_failed() const {
    if (failure_)
        throw *failure_;
}

void TemporaryFile::hand_over() {
    if (const int number = disk_->hand_over(buffer_.first(filled_), buffer_position_); number != 0)
        fail(number);
    buffer_ = disk_->free_buffer();
    buffer_position_ += std::exchange(filled_, 0);
    size_ = std::max(size_, buffer_position_);
}

void TemporaryFile::flush_buffer() {
    if (const int number = disk_->put(buffer_.first(filled_), buffer_position_); number != 0)
        fail(number);
    buffer_position_ += std::exchange(filled_, 0);
    size_ = std::max(size_, buffer_position_);
}

// Buffers end at multiples of their size, wherever one begins.
void TemporaryFile::write(std::span<const std::byte> bytes) {
    throw_if_failed();
    on_disk_ = false;
    while (!bytes.empty()) {
        const std::size_t most = buffer_.size() - buffer_position_ % buffer_.size();
        const std::size_t part = std::min(bytes.size(), most - filled_);
        std::memcpy(&buffer_[filled_], bytes.data(), part);
        filled_ += part;
        bytes = bytes.subspan(part);
        if (filled_ == most)
            hand_over();
    }
}

void TemporaryFile::write(std::string_view text) {
    write(std::as_bytes(std::span(text)));
}

void TemporaryFile::seek(std::uint64_t position) {
    throw_if_failed();
    if (position == tell())
        return;
    flush_buffer();
    buffer_position_ = position;
}

// fsync cannot be interrupted, even by the end of the process: of a large file it finds little left to do.
void TemporaryFile::wait_for_disk() {
    constexpr std::uint64_t kPiece = std::uint64_t(8) << 20, kLarge = 8 * kPiece; // bytes
    const Stage stage("waiting for the disk");
    for (std::uint64_t from = 0; size_ >= kLarge && from < size_; from += kPiece) {
        check_interrupt();
        ::sync_file_range(descriptor_, static_cast<off_t>(from), kPiece,
                          SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER);
    }
}

void TemporaryFile::flush_to_disk() {
    throw_if_failed();
    flush_buffer();
    wait_for_disk();
    int result = 0;
    do
        result = ::fsync(descriptor_);
    while (result != 0 && errno == EINTR);
    if (result != 0)
        fail(errno);
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_DONTNEED);
    on_disk_ = true;
}

std::string TemporaryFile::sha256() {
    const std::string hash = disk_->sha256(size_);
    return hash.empty() ? sha256_of_file(temporary_path_) : hash;
}

void TemporaryFile::publish(bool durable) {
    throw_if_failed();
    if (!durable) {
        flush_buffer();
        wait_for_disk();
    } else if (!on_disk_) {
        flush_to_disk();
    }
    {
        const auto hold = hold_end();
        if (kept_files().count(std::filesystem::absolute(path_))
                ? ::unlink(temporary_path_.c_str()) != 0
                : ::rename(temporary_path_.c_str(), path_.c_str()) != 0)
            fail(errno);
        keep_at_end(temporary_path_);
    }
    published_ = true;
    if (const int number = durable ? flush_folder(folder_of(path_)) : 0; number != 0)
        fail(number);
}

void keep_files(const std::vector<std::filesystem::path>& files) {
    const auto hold = hold_end();
    for (const std::filesystem::path& file : files)
        kept_files().insert(std::filesystem::absolute(file));
}

namespace {

// Calls use(path, temporary) for the temporaries right in a folder.
template <typename Use> void for_each_temporary(const std::filesystem::path& folder, const Use& use) {
    std::error_code error;
    for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if (const auto temporary = temporary_name_in(name))
            use(entry->path(), *temporary);
    }
}

} // namespace

std::size_t clear_stale_temporaries(const std::filesystem::path& folder) {
    std::size_t removed = 0;
    for_each_temporary(folder, [&](const std::filesystem::path& path, const TemporaryName& temporary) {
        if (temporary.host != this_host())
            return; // file systems of a cluster may keep locks to the machine that took them
        const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        struct stat status {};
        if (descriptor < 0)
            return;
        if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) && lock(descriptor, false))
            removed += ::unlink(path.c_str()) == 0;
        ::close(descriptor);
    });
    return removed;
}

std::vector<std::string> temporaries_of_others(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    for_each_temporary(folder, [&](const std::filesystem::path& path, const TemporaryName& temporary) {
        if (temporary.host != this_host())
            names.push_back(path.filename().string());
    });
    return names;
}

void make_subfolder(const std::filesystem::path& folder, const std::string& name) {
    const std::filesystem::path subfolder = folder / name;
    std::error_code error;
    if (std::filesystem::is_symlink(subfolder, error))
        throw IoError("cannot write into {}: it is a symbolic link, and what it leads to may be another's; "
                      "remove the link, or choose another folder for the results",
                      subfolder.string());
    std::filesystem::create_directories(subfolder, error);
    if (error)
        throw IoError("cannot make the folder {}: {}", subfolder.string(), error.message());
}

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    TemporaryFile file(path);
    file.write(bytes);
    file.publish();
}

void write_file_atomically(const std::filesystem::path& path, std::string_view text) {
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::string sha256_of(std::span<const std::byte> bytes) {
    Sha256 hash;
    hash.update(bytes);
    return hash.finish();
}

std::string sha256_of(std::string_view text) {
    return sha256_of(std::as_bytes(std::span(text)));
}

std::string sha256_of_file(const std::filesystem::path& path,
                           const std::function<void(std::span<const std::byte>, std::uint64_t at)>& also) {
    constexpr std::uint64_t kMegabyte = 1000000;
    constexpr std::size_t kBlock = 1 << 18; /* bytes: fits the second-level cache */
    const ReadableFile file(path);
    Stage stage("checking " + final_name(path), file.size() / kMegabyte, "MB");
    std::vector<std::byte> block(kBlock);
    Sha256 hash;
    for (std::uint64_t offset = 0;;) {
        check_interrupt();
        const std::size_t got = file.read_some(offset, block);
        hash.update(std::span(block).first(got));
        if (also)
            also(std::span(block).first(got), offset);
        offset += got;
        stage.update(offset / kMegabyte);
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

std::string names_of(const std::vector<FileRecord>& files) {
    std::string text;
    for (const FileRecord& file : files)
        text += (&file == files.data() ? "" : &file == &files.back() ? " and " : ", ") + file.name;
    return text;
}

} // namespace forceshade
