// Samples in datagrams: where they may go, how they lie in them, and receivers that are not there.
#include <chrono>
#include <sstream>
#include <thread>

#include "device/session/readers.h"
#include "host/error.h"
#include "shaders/shared/law.h"
#include "tests/device/inbox.h"
#include "tests/io/folder.h"

namespace forceshade::device {
namespace {

using forceshade::testing::Inbox;
using forceshade::testing::message_of;
using forceshade::testing::says;

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
    std::istringstream all("|5005|udp|udp:|udp:0|udp:-1|udp:65536|udp:99999999999|udp:50 05|udp:5005 "
                           "|udp:5005x|udp::5005|udp:localhost:5005|udp:example.org:5005|udp:1.2.3:5005|udp:1.2.3.4.5:"
                           "5005|udp:1.2.3.4|udp:1.2.3.4:|udp:::1:5005|udp:[::1]|udp:[::1]5005|udp:[1.2.3.4]:5005|udp:["
                           ":5005|udp:[]:5005|tcp:5005|UDP:5005|udp:[::1]:0");
    for (std::string wrong; std::getline(all, wrong, '|');)
        EXPECT_TRUE(says(message_of<UsageError>([&] { parse_udp_address(wrong); }), "udp:192.168.1.20:5005")) << wrong;
}

TEST(UdpSender, SendsWholeSamplesInOrder) {
    Inbox inbox;
    UdpSender sender({"127.0.0.1", inbox.port}, 1000);
    for (std::uint64_t tick = 0; tick < 100; ++tick)
        ASSERT_TRUE(sender.ring().put(numbered(tick)));
    sender.close();
    EXPECT_EQ(sender.sent(), 100u);
    EXPECT_EQ(sender.failure(), "");
    inbox.take();
    ASSERT_EQ(inbox.samples.size(), 100u);
    for (std::size_t i = 0; i < 100; ++i) {
        const double tick = double(i), facet = i % 2 == 0 ? 14 : -1;
        EXPECT_EQ(inbox.samples[i],
                  (Inbox::Sample{0.1 * tick, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, facet, tick}));
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
    {
        Inbox late(false, port);
        put(100);
        for (int i = 0; i < 1000 && late.samples.size() < 20; ++i) { // on a busy machine the sender is late
            late.take();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        EXPECT_EQ(late.samples.size(), 20u) << "whoever comes later gets what comes then";
    }
    put(200);
    sender.close();
    EXPECT_EQ(sender.sent(), 20u);
    EXPECT_TRUE(says(sender.failure(), "no receiver listens there"));
}

} // namespace
} // namespace forceshade::device
