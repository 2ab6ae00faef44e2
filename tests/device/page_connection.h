// Connections to the pages of a program, without a browser.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>

#include <gtest/gtest.h>

namespace forceshade::test {

/// Of "http://HOST:PORT/PATH".
struct Place {
    explicit Place(const std::string& address) {
        const std::size_t colon = address.find(':', 5) + 1, slash = address.find('/', colon);
        path = address.substr(slash);
        host = address.substr(7, slash - 7);
        port = static_cast<std::uint16_t>(std::stoi(address.substr(colon)));
    }
    std::string path, host;
    std::uint16_t port;
};

/// A connection that has sent `asked`; unless it `waits`, what the server does not take at once comes later or never.
inline int connection_to(const Place& place, const std::string& asked, int receive_buffer = 0, bool waits = true) {
    const int client = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | (waits ? 0 : SOCK_NONBLOCK), 0);
    if (receive_buffer > 0)
        ::setsockopt(client, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    there.sin_port = htons(place.port);
    const int connected = ::connect(client, reinterpret_cast<sockaddr*>(&there), sizeof there);
    const auto sent = ::send(client, asked.data(), asked.size(), MSG_NOSIGNAL);
    if (waits) {
        EXPECT_EQ(connected, 0);
        EXPECT_EQ(sent, std::ssize(asked));
    }
    return client;
}

} // namespace forceshade::test
