// Pages for browsers: one that takes nothing holds up neither who sends nor the others.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/server/page_server.h"
#include "tests/device/page_connection.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using test::connection_to;
using test::Place;
using testing::says;

/// A WebSocket of a page, connected, of which little waits to be read.
class PageClient {
public:
    explicit PageClient(const Place& page)
        : socket_(connection_to(
              page,
              fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                          "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n",
                          page.path, page.host),
              4096)) {}
    ~PageClient() { ::close(socket_); }

    /// How many bytes came until the server closed it.
    std::size_t read_all() const {
        std::vector<char> room(1 << 16);
        std::size_t all = 0;
        for (ssize_t got = 0; (got = ::recv(socket_, room.data(), room.size(), 0)) > 0;)
            all += static_cast<std::size_t>(got);
        return all;
    }

private:
    int socket_;
};

TEST(PageServer, WhoTakesNothingIsClosedAndWaitedForByNobody) {
    constexpr int kTexts = 25;
    const std::string text(1'000'000, 'x');
    std::atomic<int> closed = 0;
    std::optional<PageServer> server(std::in_place, std::vector<ServedPage>{{"view", "<p>a page</p>"}},
                                     std::uint16_t{0}, [&](const std::string&) { ++closed; });
    const Place view(server->address("view"));
    const PageClient stuck(view), reader(view);
    std::size_t got = 0;
    std::jthread reading([&] { got = reader.read_all(); });
    for (int opened = 0; opened < 2;)
        opened += server->next_event().has_value();
    double longest = 0; /* s */
    const auto seconds_since = [](auto begin) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    for (int i = 0; i < kTexts; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        server->send("view", text);
        longest = std::max(longest, seconds_since(begin));
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    EXPECT_EQ(closed, 1) << "the one that took nothing";
    server->send("view", "the last words");
    const auto end = std::chrono::steady_clock::now();
    server.reset();
    reading.join();
    EXPECT_LT(seconds_since(end), 2);
    EXPECT_LT(longest, 0.2);
    EXPECT_GT(got, kTexts * text.size() + 14) << "all that was sent, to the last word";
}

// What the server answers to a request, to the end.
std::string answer_to(const std::string& address) {
    const Place page(address);
    const int client = connection_to(page, fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", page.path, page.host));
    std::string all, room(4096, '\0');
    for (ssize_t got = 0; (got = ::recv(client, room.data(), room.size(), 0)) > 0;)
        all.append(room, 0, static_cast<std::size_t>(got));
    ::close(client);
    return all;
}

TEST(PageServer, EachPageHasAnAddressThatTheOthersDoNotTell) {
    PageServer server({{"person", "<script>1</script>", true},
                       {"operator", "<p>secret</p>"},
                       {"edge.svg", "<svg/>", false, "image/svg+xml"}},
                      0);
    const std::string person = server.address("person");
    const std::string page = answer_to(person);
    EXPECT_TRUE(says(page, "200 OK"));
    const std::size_t nonce = page.find("<script nonce=\"") + 15;
    EXPECT_TRUE(says(page, "'nonce-" + page.substr(nonce, page.find('"', nonce) - nonce) + "'"));
    EXPECT_NE(answer_to(person).substr(nonce, 32), page.substr(nonce, 32)) << "another each time";
    const std::string folder = person.substr(0, person.rfind('/') + 1);
    EXPECT_FALSE(says(answer_to(folder + "operator"), "secret"));
    EXPECT_TRUE(says(answer_to(server.address("operator")), "secret"));
    EXPECT_TRUE(says(answer_to(folder + "edge.svg"), "sandbox"));
}

// Browsers, or what is none, that begin requests and never end them: they hold few threads with small stacks, and after
// two seconds none.
TEST(PageServer, HalfRequestsDoNotKeepTheOthersOut) {
    PageServer server({{"view", "<p>here</p>"}}, 0);
    const std::string address = server.address("view");
    std::vector<int> halves;
    for (int i = 0; i < 200; ++i)
        halves.push_back(connection_to(Place(address), "GET /"));
    std::size_t threads = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task"))
        threads += !task.path().empty();
    EXPECT_LT(threads, 50u);
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    EXPECT_TRUE(says(answer_to(address), "here"));
    for (const int half : halves)
        ::close(half);
}

} // namespace
} // namespace forceshade
