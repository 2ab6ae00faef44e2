#include "host/io/file_error.h"

#include <cerrno>
#include <cstring>
#include <string_view>

#include <fmt/core.h>

namespace forceshade {
namespace {

const char* advice(bool writing, int number) {
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
        return writing ? "; create its folder first" : "; check the name, relative to where it is written";
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

} // namespace

IoError file_error(const char* verb, const std::filesystem::path& path, int number) {
    const char* reason = ::strerrordesc_np(number);
    const bool writing = std::string_view(verb) == "write";
    return IoError(fmt::format("cannot {} {}: {}{}", verb, path.string(), reason ? reason : "unknown error",
                               advice(writing, number)));
}

} // namespace forceshade
