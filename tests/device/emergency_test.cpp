// A process that dies halts the device first, and dies of what it would have died of.
#include <csignal>
#include <cstdlib>

#include <gtest/gtest.h>
#include <unistd.h>

#include "device/session/signals.h"

namespace forceshade::device {
namespace {

// Tells when it is halted.
class Telling final : public BackEnd {
public:
    const DeviceFacts& facts() const noexcept override { return facts_; }
    Reading read() noexcept override { return {}; }
    bool write(const glm::dvec3&) noexcept override { return true; }
    void halt() noexcept override {
        if (::write(STDERR_FILENO, "halted\n", 7) != 7)
            ::_exit(9);
    }
    const char* error_text() const noexcept override { return nullptr; }

private:
    DeviceFacts facts_;
};

TEST(EmergencyDeathTest, EverySignalThatEndsTheProcessHaltsTheDevice) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizer has the signals";
#endif
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGQUIT, SIGXCPU, SIGALRM,
                             SIGUSR1, SIGUSR2, SIGIO, SIGPWR})
        EXPECT_EXIT(
            {
                Telling device;
                const Emergency emergency(device);
                ::raise(signal);
                std::_Exit(0);
            },
            ::testing::KilledBySignal(signal), "^halted\n$")
            << signal;
    EXPECT_EXIT(
        {
            Telling device;
            const Emergency emergency(device);
            std::abort();
        },
        ::testing::KilledBySignal(SIGABRT), "^halted\n$");
}

TEST(EmergencyDeathTest, WhatIsIgnoredStaysIgnored) {
    EXPECT_EXIT(
        {
            std::signal(SIGQUIT, SIG_IGN);
            Telling device;
            const Emergency emergency(device);
            ::raise(SIGQUIT);
            std::_Exit(0);
        },
        ::testing::ExitedWithCode(0), "^$");
}

TEST(EmergencyDeathTest, AfterItsEndNothingIsHalted) {
    EXPECT_EXIT(
        {
            Telling device;
            { const Emergency emergency(device); }
            std::abort();
        },
        ::testing::KilledBySignal(SIGABRT), "^$");
}

} // namespace
} // namespace forceshade::device
