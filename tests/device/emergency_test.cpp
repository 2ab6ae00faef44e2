// Which signals halt the device, and for how long. What the device sees of it: tests/e2e/live_fault_test.cpp.
#include <csignal>

#include <gtest/gtest.h>

#include "device/session/session.h"
#include "tests/device/scripted_device.h"

namespace forceshade::device {
namespace {

auto action_of(int signal) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    return action.sa_handler;
}

TEST(Emergency, LeavesIgnoredSignalsAloneAndGivesTheOthersBack) {
    std::signal(SIGQUIT, SIG_IGN);
    const auto before = action_of(SIGABRT);
    testing::ScriptedDevice device(nullptr, 0);
    {
        const Emergency emergency(device);
        EXPECT_EQ(action_of(SIGQUIT), SIG_IGN);
        EXPECT_NE(action_of(SIGABRT), before);
    }
    EXPECT_EQ(action_of(SIGABRT), before);
    EXPECT_FALSE(device.halted);
    std::signal(SIGQUIT, SIG_DFL);
}

} // namespace
} // namespace forceshade::device
