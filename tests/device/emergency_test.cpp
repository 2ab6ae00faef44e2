// A process that dies halts the device first, and dies of what it would have died of.
#include <csignal>
#include <cstdlib>

#include <gtest/gtest.h>
#include <unistd.h>

#include "device/session/session.h"

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

/// Does so while a device is to be halted, and comes back only from what does not end the process.
template <typename Work> void with_a_device(const Work& work) {
    Telling device;
    const Emergency emergency(device);
    work();
    std::_Exit(0);
}

TEST(EmergencyDeathTest, EverySignalThatEndsTheProcessHaltsTheDevice) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizer has the signals";
#endif
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGQUIT, SIGXCPU, SIGALRM,
                             SIGUSR1, SIGUSR2, SIGIO, SIGPWR})
        EXPECT_EXIT(with_a_device([&] { ::raise(signal); }), ::testing::KilledBySignal(signal), "^halted\n$") << signal;
    EXPECT_EXIT(with_a_device([] { std::abort(); }), ::testing::KilledBySignal(SIGABRT), "^halted\n$");
}

TEST(EmergencyDeathTest, WhatIsIgnoredStaysIgnored) {
    const auto ignored = [] {
        std::signal(SIGQUIT, SIG_IGN);
        with_a_device([] { ::raise(SIGQUIT); });
    };
    EXPECT_EXIT(ignored(), ::testing::ExitedWithCode(0), "^$");
}

TEST(EmergencyDeathTest, AfterItsEndNothingIsHalted) {
    const auto outlived = [] {
        Telling device;
        { const Emergency emergency(device); }
        std::abort();
    };
    EXPECT_EXIT(outlived(), ::testing::KilledBySignal(SIGABRT), "^$");
}

} // namespace
} // namespace forceshade::device
