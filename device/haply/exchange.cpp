#include "device/haply/exchange.h"

#include <cerrno>
#include <chrono>
#include <cstring>

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "host/error.h"

namespace forceshade::device {

Exchange::Exchange(std::string zero_frame) : zero_frame_(std::move(zero_frame)) {
    wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    nothing_ = ::open("/dev/null", O_WRONLY | O_CLOEXEC); // no socket: sending to it fails, which is what it is for
    line_ = nothing_ < 0 ? -1 : ::fcntl(nothing_, F_DUPFD_CLOEXEC, 0);
    if (wake_ < 0 || line_ < 0) {
        const int error = errno;
        for (const int descriptor : {wake_, nothing_, line_})
            if (descriptor >= 0)
                ::close(descriptor);
        throw Error(ExitCode::io, fmt::format("haply: no descriptor to be had: {}", std::strerror(error)));
    }
}

Exchange::~Exchange() {
    for (const int descriptor : {wake_, nothing_, line_})
        ::close(descriptor);
}

void Exchange::wake() const noexcept {
    const int error = errno;
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one); // full: it is awake
    errno = error;
}

void Exchange::stop() noexcept {
    const int error = errno;
    if (!stopping.exchange(true)) {
        [[maybe_unused]] const auto sent =
            ::send(line_, zero_frame_.data(), zero_frame_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    }
    wake();
    errno = error;
}

void Exchange::lend_line(int socket) noexcept {
    ::dup3(socket < 0 ? nothing_ : socket, line_, O_CLOEXEC);
}

std::int64_t steady_now() noexcept {
    using namespace std::chrono;
    return duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count();
}

} // namespace forceshade::device
