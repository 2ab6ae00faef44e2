#include "host/io/readable_file.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host/io/file_error.h"

namespace forceshade {
namespace {

FileStamp stamp_of(const struct stat& status) {
    return {status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size), status.st_mtim.tv_sec,
            status.st_mtim.tv_nsec};
}

} // namespace

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
        throw IoError(fmt::format("cannot read {}: it is not a regular file", path_.string()));
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
