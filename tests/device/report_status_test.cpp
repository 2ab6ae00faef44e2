// The status line, on a terminal and without one.
#include <array>
#include <cstdio>
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <stdexcept>
#include <unistd.h>

#include <sys/ioctl.h>

#include <gtest/gtest.h>

#include "device/run_report/text.h"

namespace forceshade::device {
namespace {

LiveStatus status_at(double seconds) {
    return {seconds, 999.7, 1.234, 0.52e-3, 3, 12, 0, "ramping"};
}

// A stream and what came out of it.
class Watched {
public:
    // `columns` of a terminal; 0: none, a pipe.
    explicit Watched(unsigned short columns) {
        int end = -1;
        if (columns > 0) {
            winsize size{24, columns, 0, 0};
            if (::openpty(&reading_, &end, nullptr, nullptr, &size) != 0)
                throw std::runtime_error("no pseudo-terminal");
        } else {
            int ends[2];
            if (::pipe(ends) != 0)
                throw std::runtime_error("no pipe");
            reading_ = ends[0];
            end = ends[1];
        }
        stream = ::fdopen(end, "w");
    }
    ~Watched() {
        std::fclose(stream);
        ::close(reading_);
    }

    std::string seen(int patience = 50 /* ms */) {
        std::fflush(stream);
        std::string text;
        for (pollfd poll{reading_, POLLIN, 0}; ::poll(&poll, 1, patience) > 0 && (poll.revents & POLLIN);) {
            char buffer[4096];
            const ssize_t size = ::read(reading_, buffer, sizeof buffer);
            if (size <= 0)
                break;
            text.append(buffer, static_cast<std::size_t>(size));
        }
        return text;
    }

    std::FILE* stream = nullptr;

private:
    int reading_ = -1;
};

std::size_t occurrences(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
        ++count;
    return count;
}

TEST(StatusLine, IsRewrittenOnATerminalAtMostTenTimesASecondAndErased) {
    Watched terminal(120);
    {
        StatusLine line(false, terminal.stream);
        std::string seen;
        for (int i = 0; i < 1000; ++i) {
            line.update(status_at(i * 1e-3));
            if (i % 20 == 19) // a terminal holds only so much
                seen += terminal.seen(0);
        }
        seen += terminal.seen();
        EXPECT_GE(occurrences(seen, "\r\033[K"), 9u);
        EXPECT_LE(occurrences(seen, "\r\033[K"), 10u);
        EXPECT_EQ(occurrences(seen, "\n"), 0u);
        EXPECT_EQ(occurrences(seen, "ramping"), occurrences(seen, "\r\033[K"));
    }
    EXPECT_EQ(terminal.seen(), "\r\033[K");
}

TEST(StatusLine, IsCutAtTheTerminalsWidth) {
    Watched terminal(30);
    StatusLine line(false, terminal.stream);
    LiveStatus status = status_at(1);
    line.update(status);
    EXPECT_EQ(terminal.seen(), "\r\033[K" + status_text(status).substr(0, 29));
}

TEST(StatusLine, LetsALineStandAboveIt) {
    Watched terminal(100);
    StatusLine line(false, terminal.stream);
    line.update(status_at(1));
    terminal.seen();
    line.say("the scene was refused");
    EXPECT_EQ(terminal.seen(), "\r\033[Kthe scene was refused\r\n") << "the terminal adds the carriage's return";
    line.update(status_at(1.01));
    EXPECT_EQ(occurrences(terminal.seen(), "ramping"), 1u) << "again at once";
}

TEST(StatusLine, IsALineNowAndThenWithoutATerminal) {
    Watched pipe(0);
    {
        StatusLine line(false, pipe.stream);
        for (int i = 0; i <= 350; ++i)
            line.update(status_at(i * 0.1));
        line.say("said");
    }
    const std::string seen = pipe.seen();
    EXPECT_EQ(occurrences(seen, "ramping\n"), 3u) << seen;
    EXPECT_EQ(occurrences(seen, "\033"), 0u);
    EXPECT_TRUE(seen.ends_with("said\n"));
}

TEST(StatusLine, IsSilentIfQuiet) {
    for (const auto columns : std::array<unsigned short, 2>{0, 80}) {
        Watched watched(columns);
        {
            StatusLine line(true, watched.stream);
            line.update(status_at(100));
            line.say("nothing");
        }
        EXPECT_EQ(watched.seen(), "");
    }
}

} // namespace
} // namespace forceshade::device
