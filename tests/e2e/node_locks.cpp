// A library to be preloaded: the machine is called NODE, and locks are those of a file system that keeps them to the
// machine that took them: processes of another NODE do not meet them.
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace {

const char* node() {
    const char* const name = std::getenv("NODE");
    return name != nullptr ? name : "node";
}

} // namespace

extern "C" {

int gethostname(char* name, size_t length) noexcept {
    std::strncpy(name, node(), length);
    return 0;
}

// One byte of the file for each node.
int flock(int descriptor, int operation) noexcept {
    struct flock lock {};
    lock.l_type = (operation & LOCK_UN) != 0 ? F_UNLCK : F_WRLCK;
    lock.l_whence = SEEK_SET;
    lock.l_start = off_t(1) << 40;
    for (const char* c = node(); *c != '\0'; ++c)
        lock.l_start += *c;
    lock.l_len = 1;
    const int result = ::fcntl(descriptor, (operation & LOCK_NB) != 0 ? F_OFD_SETLK : F_OFD_SETLKW, &lock);
    if (result != 0 && (errno == EACCES || errno == EAGAIN))
        errno = EWOULDBLOCK;
    return result;
}
}
