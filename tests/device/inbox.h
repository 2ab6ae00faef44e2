// A receiver of the samples that a live loop sends in UDP datagrams.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

namespace forceshade::testing {

/// A socket of this machine, at a port of its own unless one is wanted.
class Inbox {
public:
    explicit Inbox(bool is_six = false, std::uint16_t wanted = 0)
        : socket_(::socket(is_six ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in four{};
        four.sin_family = AF_INET;
        four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        four.sin_port = htons(wanted);
        sockaddr_in6 six{};
        six.sin6_family = AF_INET6;
        six.sin6_addr = in6addr_loopback;
        six.sin6_port = htons(wanted);
        sockaddr* const here = is_six ? reinterpret_cast<sockaddr*>(&six) : reinterpret_cast<sockaddr*>(&four);
        ::socklen_t size = is_six ? sizeof six : sizeof four;
        is_there = ::bind(socket_, here, size) == 0;
        ::getsockname(socket_, here, &size);
        port = ntohs(is_six ? six.sin6_port : four.sin_port);
    }
    ~Inbox() { ::close(socket_); }

    /// Keeps the samples that have come, in order.
    void take() {
        std::array<double, 200> room;
        for (ssize_t got = 0; (got = ::recv(socket_, room.data(), sizeof room, MSG_DONTWAIT)) >= 0;) {
            EXPECT_LE(got, 1200) << "bytes";
            EXPECT_EQ(got % ssize_t(sizeof(Sample)), 0) << "whole samples";
            for (const double* at = room.data(); at + kNumbers <= room.data() + got / 8; at += kNumbers)
                std::copy_n(at, kNumbers, samples.emplace_back().begin());
        }
    }

    static constexpr std::size_t kNumbers = 16;
    using Sample = std::array<double, kNumbers>;

    bool is_there = false; // stays so if the machine has no IPv6
    std::uint16_t port = 0;
    std::vector<Sample> samples;

private:
    int socket_;
};

} // namespace forceshade::testing
