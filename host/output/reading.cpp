#include "host/output/files.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <fcntl.h>
#include <string_view>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include <fmt/core.h>

#include "host/error.h"

namespace forceshade {

namespace {

std::atomic<std::uint64_t> limit = kDefaultMemory;

constexpr std::array<std::pair<std::string_view, double>, 8> kUnits{{{"kB", 1e3},
                                                                     {"MB", 1e6},
                                                                     {"GB", 1e9},
                                                                     {"TB", 1e12},
                                                                     {"KiB", 0x1p10},
                                                                     {"MiB", 0x1p20},
                                                                     {"GiB", 0x1p30},
                                                                     {"TiB", 0x1p40}}};

/// Rounded to whole MiB or tenths of a GiB: what is needed up, what is allowed down, so that they differ.
std::string in_words(double bytes, double (*rounded)(double)) {
    return bytes < 0x1p30 ? fmt::format("{:.0f} MiB", rounded(bytes / 0x1p20))
                          : fmt::format("{:.1f} GiB", rounded(bytes / 0x1p30 * 10) / 10);
}

FileStamp stamp_of(const struct stat& status) {
    return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec,
            status.st_mtim.tv_nsec};
}

} // namespace

std::uint64_t parse_memory(const std::string& text) {
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
    for (const auto& [name, bytes] : kUnits)
        if (error == std::errc() && (unit == name || (unit.starts_with(' ') && unit.substr(1) == name)))
            if (const double all = number * bytes; all >= 1 && all < 0x1p63)
                return static_cast<std::uint64_t>(all);
    throw UsageError("--max-memory {}: it is a number with kB, MB, GB, TB, KiB, MiB, GiB or TiB, for example \"8 GiB\"",
                     text);
}

void set_memory_limit(std::uint64_t bytes) {
    limit = bytes;
}

void require_memory(const std::filesystem::path& file, const std::string& what, double bytes) {
    if (const auto most = static_cast<double>(limit.load()); bytes > most)
        throw UsageError("{}: {} needs about {} of memory, more than the {} that are allowed: make it "
                         "smaller, or say --max-memory \"{}\"",
                         file.string(), what, in_words(bytes, std::ceil), in_words(most, std::floor),
                         in_words(bytes, std::ceil));
}

FileStamp stamp_of(const std::filesystem::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0)
        throw file_error("read", path, errno);
    return stamp_of(status);
}

ReadableFile::ReadableFile(std::filesystem::path path) : path_(std::move(path)) {
    // Without O_NONBLOCK a named pipe would wait for its writer.
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0)
        throw file_error("read", path_, errno);
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) {
        const int number = errno;
        ::close(descriptor_);
        throw file_error("read", path_, number);
    }
    if (!S_ISREG(status.st_mode)) {
        ::close(descriptor_);
        throw IoError("cannot read {}: it is not a regular file", path_.string());
    }
    stamp_ = stamp_of(status);
}

ReadableFile::~ReadableFile() {
    ::close(descriptor_);
}

std::size_t ReadableFile::read_some(std::uint64_t offset, std::span<std::byte> bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got =
            ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            throw file_error("read", path_, errno);
        if (got == 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return done;
}

std::string read_file(const std::filesystem::path& path) {
    const ReadableFile file(path);
    std::string text(static_cast<std::size_t>(file.size()), '\0');
    text.resize(file.read_some(0, std::as_writable_bytes(std::span(text))));
    return text;
}

} // namespace forceshade
