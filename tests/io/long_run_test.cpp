// An interrupt ends work that does not ask for it, in time and without a trace.
#include <chrono>
#include <csignal>
#include <thread>

#include <gtest/gtest.h>

#include "host/long_run.h"
#include "host/output/files.h"
#include "host/program.h"
#include "tests/io/folder.h"

namespace forceshade::testing {
namespace {

using namespace std::chrono_literals;

class LongRuns : public ::testing::Test {
protected:
    // Each in a process of its own, as the flag stays raised.
    LongRuns() { GTEST_FLAG_SET(death_test_style, "fast"); }

    [[noreturn]] void work_and_be_interrupted(int times) const {
        catch_interrupts();
        const LongRun run(true, "what is done stays");
        TemporaryFile kept(folder_ / "kept"), begun(folder_ / "begun");
        kept.write(std::string_view("whole"));
        kept.publish();
        begun.write(std::string_view("half"));
        for (int i = 0; i < times; ++i)
            std::raise(SIGINT);
        std::this_thread::sleep_for(20s); // a library that cannot be told to stop
        std::_Exit(1);
    }

    Folder folder_;
};

TEST_F(LongRuns, EndSoonAfterAnInterruptOrTwoAndLeaveWholeFilesAlone) {
    for (const int times : {1, 2}) {
        const auto start = std::chrono::steady_clock::now();
        EXPECT_EXIT(work_and_be_interrupted(times), ::testing::ExitedWithCode(130), "what is done stays\nerror: ");
        EXPECT_LT(std::chrono::steady_clock::now() - start, 5s) << times; // 0.3 s where the machine is free
        EXPECT_EQ(folder_.names(), std::vector<std::string>{"kept"}) << times;
    }
}

TEST_F(LongRuns, LeaveInOrderWhereTheWorkAsks) {
    const auto leave = [] {
        catch_interrupts();
        try {
            const LongRun run(true);
            std::raise(SIGINT);
            check_interrupt();
        } catch (const Interrupted&) {
            std::this_thread::sleep_for(400ms); // nobody ends the process any more
            std::_Exit(42);
        }
    };
    EXPECT_EXIT(leave(), ::testing::ExitedWithCode(42), "");
}

TEST(Stages, TellOfTheWholeRunAndOfWhatItIsAt) {
    EXPECT_EQ(progress_line(0, true), "");
    Stage cases("computing", 4, "cases");
    cases.update(1);
    Stage drawing("drawing", 2, "tiles");
    drawing.update(1);
    EXPECT_EQ(progress_line(70, false), "") << "what takes less than a second is not told of";
    std::this_thread::sleep_for(1050ms);
    EXPECT_EQ(progress_line(70, false), "1/4 cases, 1:10 so far, 0:02 left  drawing");
    EXPECT_EQ(progress_line(70, true), "[=========               ] 1/4 cases, 1:10 so far, 0:02 left  drawing");
    drawing.update(0);
    EXPECT_EQ(progress_line(70, true).substr(0, 11), "[========= ") << "a bar does not go back";
}

} // namespace
} // namespace forceshade::testing
