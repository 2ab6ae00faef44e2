// The hand-over between two threads: the newest value, whole, once, never an older one after a newer one.
#include <atomic>
#include <cstdint>
#include <thread>

#include <gtest/gtest.h>

#include "device/backends/back_end.h"

namespace forceshade::device::testing {
namespace {

struct Triple {
    std::uint64_t a = 0, b = 0, c = 0;
};

TEST(Newest, TellsTheLastValuePutAndTellsItOnce) {
    Newest<int> slot;
    int value = -1;
    EXPECT_FALSE(slot.take(value));
    EXPECT_EQ(value, -1);
    for (int round = 0; round < 10; ++round) {
        slot.put(3 * round);
        slot.put(3 * round + 1);
        slot.put(3 * round + 2);
        EXPECT_TRUE(slot.take(value));
        EXPECT_EQ(value, 3 * round + 2);
        EXPECT_FALSE(slot.take(value));
        EXPECT_EQ(value, 3 * round + 2);
    }
}

TEST(Newest, IsNeitherTornNorTurnedBackBetweenThreads) {
    constexpr std::uint64_t kLast = 200000;
    Newest<Triple> slot;
    std::thread writer([&] {
        for (std::uint64_t i = 1; i <= kLast; ++i)
            slot.put({i, 2 * i, 3 * i});
    });
    Triple seen;
    bool whole = true, forward = true;
    for (std::uint64_t last = 0; seen.a < kLast;) {
        if (!slot.take(seen)) {
            std::this_thread::yield();
            continue;
        }
        whole = whole && seen.b == 2 * seen.a && seen.c == 3 * seen.a;
        forward = forward && seen.a > last;
        last = seen.a;
    }
    writer.join();
    EXPECT_TRUE(whole);
    EXPECT_TRUE(forward);
}

} // namespace
} // namespace forceshade::device::testing
