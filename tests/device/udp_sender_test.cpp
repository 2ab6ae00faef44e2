// Samples in datagrams: where they may go, how they lie in them, and receivers that are not there.
#include <arpa/inet.h>
#include <chrono>
#include <netinet/in.h>
#include <sstream>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "device/session/readers.h"
#include "host/error.h"
#include "shaders/shared/law.h"
#include "tests/io/folder.h"

namespace forceshade::device {
namespace {

using forceshade::testing::message_of;
using forceshade::testing::says;

/// A socket of 127.0.0.1 with a port of its own.
class Inbox {
public:
    explicit Inbox(std::uint16_t wanted = 0) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in here{};
        here.sin_family = AF_INET;
        here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        here.sin_port = htons(wanted);
        EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&here), sizeof here), 0);
        ::socklen_t size = sizeof here;
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&here), &size);
        port = ntohs(here.sin_port);
    }
    ~Inbox() { ::close(socket_); }

    /// The datagrams that are there.
    std::vector<std::vector<double>> take() const {
        std::vector<std::vector<double>> all;
        std::vector<double> room(1000);
        for (ssize_t got = 0; (got = ::recv(socket_, room.data(), 8 * room.size(), MSG_DONTWAIT)) >= 0;) {
            EXPECT_LE(got, 1200) << "bytes";
            EXPECT_EQ(got % 128, 0) << "whole samples";
            all.emplace_back(room.begin(), room.begin() + got / 8);
        }
        return all;
    }

    std::uint16_t port = 0;

private:
    int socket_;
};

LiveSample numbered(std::uint64_t tick) {
    LiveSample sample;
    sample.tick = tick;
    sample.time = 0.1 * double(tick);
    sample.probe = {1, 2, 3};
    sample.proxy = {4, 5, 6};
    sample.force = {7, 8, 9};
    sample.commanded = {10, 11, 12};
    sample.depth = 13;
    sample.facet = tick % 2 == 0 ? 14 : layout::kNoFacet;
    return sample;
}

TEST(UdpAddress, IsAPortOrAnAddressInDigits) {
    const auto said = [](const std::string& text) { return udp_text(parse_udp_address(text)); };
    EXPECT_EQ(said("udp:5005"), "udp:127.0.0.1:5005");
    EXPECT_EQ(said("udp:65535"), "udp:127.0.0.1:65535");
    EXPECT_EQ(said("udp:192.168.1.20:1"), "udp:192.168.1.20:1");
    EXPECT_EQ(said("udp:[::1]:5005"), "udp:[::1]:5005");
    EXPECT_EQ(said("udp:[2001:db8::7]:5005"), "udp:[2001:db8::7]:5005");
    std::istringstream all(
        "|5005|udp|udp:|udp:0|udp:-1|udp:65536|udp:99999999999|udp:50 05|udp:5005 |udp:5005x|udp::5005|"
        "udp:localhost:5005|udp:example.org:5005|udp:1.2.3:5005|udp:1.2.3.4.5:5005|udp:1.2.3.4|"
        "udp:1.2.3.4:|udp:::1:5005|udp:[::1]|udp:[::1]5005|udp:[1.2.3.4]:5005|udp:[:5005|"
        "udp:[]:5005|tcp:5005|UDP:5005|udp:[::1]:0");
    for (std::string wrong; std::getline(all, wrong, '|');)
        EXPECT_TRUE(says(message_of<UsageError>([&] { parse_udp_address(wrong); }), "udp:192.168.1.20:5005")) << wrong;
}

TEST(UdpSender, SendsWholeSamplesInOrder) {
    const Inbox inbox;
    UdpSender sender({"127.0.0.1", inbox.port}, 1000);
    for (std::uint64_t tick = 0; tick < 100; ++tick)
        ASSERT_TRUE(sender.ring().put(numbered(tick)));
    sender.close();
    EXPECT_EQ(sender.sent(), 100u);
    EXPECT_EQ(sender.failure(), "");
    std::vector<double> all;
    for (const std::vector<double>& one : inbox.take())
        all.insert(all.end(), one.begin(), one.end());
    ASSERT_EQ(all.size(), 1600u);
    for (std::size_t tick = 0; tick < 100; ++tick) {
        std::vector<double> wanted{0.1 * double(tick)};
        for (int i = 1; i <= 13; ++i)
            wanted.push_back(i);
        wanted.push_back(tick % 2 == 0 ? 14 : -1);
        wanted.push_back(double(tick));
        const std::vector<double> got(all.begin() + std::ptrdiff_t(16 * tick),
                                      all.begin() + std::ptrdiff_t(16 * tick + 16));
        ASSERT_EQ(got, wanted) << tick;
    }
}

TEST(UdpSender, CountsWhatAReceiverThatIsNotThereDoesNotGet) {
    const std::uint16_t port = Inbox().port; // closed again
    UdpSender sender({"127.0.0.1", port}, 1000);
    const auto put = [&](std::uint64_t from) { // one datagram each
        for (std::uint64_t tick = from; tick < from + 20; ++tick) {
            sender.ring().put(numbered(tick));
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    };
    put(0);
    std::size_t got = 0;
    {
        const Inbox late(port);
        put(100);
        for (int i = 0; i < 1000 && got < 20; ++i) { // on a busy machine the sender is late
            got += late.take().size();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        EXPECT_EQ(got, 20u) << "whoever comes later gets what comes then";
    }
    put(200);
    sender.close();
    EXPECT_EQ(sender.sent(), got);
    EXPECT_TRUE(says(sender.failure(), "no receiver listens there"));
}

TEST(UdpSender, ToWhereNothingCanBeSentIsRefusedAtOnce) {
    EXPECT_TRUE(says(message_of<IoError>([] {
                         UdpSender({"255.255.255.255", 5005}, 1000);
                     }),
                     "--send udp:255.255.255.255:5005: cannot send there"));
}

} // namespace
} // namespace forceshade::device
