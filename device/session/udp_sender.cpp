#include "device/session/udp_sender.h"

#include <algorithm>
#include <arpa/inet.h>
#include <bit>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <netinet/in.h>
#include <string_view>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "shaders/shared/law.h"

namespace forceshade::device {

namespace {

constexpr double kSendBuffered = 2;                       /* s: of samples, while this machine is busy */
constexpr auto kSendPause = std::chrono::milliseconds(1); // between checks of an empty ring

static_assert(std::endian::native == std::endian::little, "doubles go out as they lie in memory");

// The address as the system expects it; no length: it is invalid.
struct SocketAddress {
    sockaddr_storage storage{};
    ::socklen_t length = 0;

    explicit SocketAddress(const UdpAddress& address) {
        auto* const four = reinterpret_cast<sockaddr_in*>(&storage);
        auto* const six = reinterpret_cast<sockaddr_in6*>(&storage);
        if (::inet_pton(AF_INET, address.host.c_str(), &four->sin_addr) == 1) {
            storage.ss_family = AF_INET;
            four->sin_port = htons(address.port);
            length = sizeof *four;
        } else if (::inet_pton(AF_INET6, address.host.c_str(), &six->sin6_addr) == 1) {
            storage.ss_family = AF_INET6;
            six->sin6_port = htons(address.port);
            length = sizeof *six;
        }
    }
    const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

} // namespace

UdpAddress parse_udp_address(const std::string& text) {
    constexpr std::string_view kBegin = "udp:";
    UdpAddress address;
    const std::size_t colon = text.rfind(':');
    bool is_right = text.starts_with(kBegin);
    if (is_right && colon >= kBegin.size()) {
        address.host = text.substr(kBegin.size(), colon - kBegin.size());
        const bool has_brackets = address.host.starts_with('[') && address.host.ends_with(']');
        if (has_brackets)
            address.host = address.host.substr(1, address.host.size() - 2);
        is_right = has_brackets == (address.host.find(':') != std::string::npos);
    }
    const char* const end = text.data() + text.size();
    const auto [read, error] =
        std::from_chars(text.data() + (colon == std::string::npos ? 0 : colon + 1), end, address.port);
    if (!is_right || error != std::errc() || read != end || address.port == 0 || SocketAddress(address).length == 0)
        throw UsageError(
            fmt::format("--send {}: must be a port from 1 to 65535 of this machine, as in udp:5005, or an address "
                        "with a port, as in udp:192.168.1.20:5005 or udp:[::1]:5005",
                        text));
    return address;
}

std::string udp_text(const UdpAddress& address) {
    const bool is_six = address.host.find(':') != std::string::npos;
    return fmt::format("udp:{}:{}", is_six ? "[" + address.host + "]" : address.host, address.port);
}

UdpSender::UdpSender(const UdpAddress& address, double rate) : ring_(static_cast<std::size_t>(kSendBuffered * rate)) {
    const SocketAddress there(address);
    socket_ = ::socket(there.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    // Connected, so that the system reports a missing receiver.
    if (socket_ < 0 || ::connect(socket_, there.get(), there.length) != 0) {
        const std::string why = std::generic_category().message(errno);
        if (socket_ >= 0)
            ::close(socket_);
        throw IoError(fmt::format("--send {}: cannot send there: {}", udp_text(address), why));
    }
    thread_ = std::jthread([this](const std::stop_token& stop) {
        drain(ring_, stop, kSendPause, [this](std::span<const LiveSample> samples) { send(samples); });
    });
}

UdpSender::~UdpSender() {
    close();
}

void UdpSender::close() {
    if (!thread_.joinable())
        return;
    thread_.request_stop();
    thread_.join();
    int error = 0;
    ::socklen_t size = sizeof error;
    if (::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size) == 0 && error != 0)
        is_refused(error);
    ::close(socket_);
}

std::string UdpSender::failure() const {
    if (error_ == 0)
        return {};
    return std::generic_category().message(error_) + (error_ == ECONNREFUSED ? ": no receiver listens there" : "");
}

void UdpSender::send(std::span<const LiveSample> samples) {
    while (!samples.empty()) {
        const std::span<const LiveSample> some = samples.first(std::min(samples.size(), kTogether));
        double* to = records_.data();
        for (const LiveSample& sample : some) {
            *to++ = sample.time;
            for (const glm::dvec3& vector : {sample.probe, sample.proxy, sample.force, sample.commanded})
                for (int i = 0; i < 3; ++i)
                    *to++ = vector[i];
            *to++ = sample.depth;
            *to++ = sample.facet == layout::kNoFacet ? -1.0 : static_cast<double>(sample.facet);
            *to++ = static_cast<double>(sample.tick);
        }
        send_records(some.size());
        samples = samples.subspan(some.size());
    }
}

void UdpSender::send_records(std::size_t count) {
    const std::size_t bytes = count * kColumns * sizeof(double);
    const auto try_to = [&] { return ::send(socket_, records_.data(), bytes, MSG_NOSIGNAL) >= 0; };
    if (try_to() || (is_refused(errno) && try_to())) {
        sent_ += count;
        last_ = count;
    }
}

// The next call reports a missing receiver of the previous datagram, and then has no other effect.
bool UdpSender::is_refused(int error) {
    error_ = error;
    if (error != ECONNREFUSED)
        return false;
    sent_ -= std::exchange(last_, 0);
    return true;
}

} // namespace forceshade::device
