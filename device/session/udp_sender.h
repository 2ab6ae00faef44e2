// The samples of the live loop in UDP datagrams, for tools of one's own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <thread>

#include "device/loop/sample.h"

namespace forceshade::device {

struct UdpAddress {
    std::string host = "127.0.0.1"; /* IPv4 or IPv6, in digits */
    std::uint16_t port = 0;
};

/// "udp:5005", "udp:192.168.1.20:5005" or "udp:[::1]:5005". \throws UsageError for anything else.
UdpAddress parse_udp_address(const std::string& text);
/// "udp:127.0.0.1:5005"
std::string udp_text(const UdpAddress& address);

/// Each datagram holds one to nine samples, oldest first, without a header. A sample is 16 doubles, little-endian: t
/// (s), x y z (m: probe), gx gy gz (m: proxy), fx fy fz (N: the law's force), cx cy cz (N: sent to the device), depth
/// (m), facet (-1 out of contact), tick: the numbers of the columns of LiveLog of that name.
///
/// No sample is sent twice or waited for: datagrams that the network does not take, or that a missing receiver refuses,
/// are lost.
class UdpSender {
public:
    /// Starts a thread that sends until close(). `rate`: Hz. \throws IoError if it cannot send there.
    UdpSender(const UdpAddress& address, double rate);
    ~UdpSender();
    UdpSender(const UdpSender&) = delete;
    UdpSender& operator=(const UdpSender&) = delete;

    /// For the loop. A sample that finds no room there is not sent.
    SampleRing& ring() noexcept { return ring_; }

    /// When no more is put on the ring: sends the rest.
    void close();

    /// After close(): samples that left this machine, unless their receiver is known to have been absent.
    std::uint64_t sent() const noexcept { return sent_; }
    /// After close(): why others did not; empty: the network refused none.
    std::string failure() const;

private:
    static constexpr std::size_t kColumns = 16, kTogether = 9; // 1152 bytes: every network takes them whole

    void send(std::span<const LiveSample> samples);
    void send_records(std::size_t count);
    bool is_refused(int error);

    SampleRing ring_;
    int socket_ = -1;
    std::array<double, kColumns * kTogether> records_{};
    std::uint64_t sent_ = 0, last_ = 0; // samples: all, in the last datagram
    int error_ = 0;                     // the last one
    std::jthread thread_;
};

} // namespace forceshade::device
