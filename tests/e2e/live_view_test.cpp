// The page of a live loop in headless Chromium: what is felt is seen, and who looks changes nothing.
#include "tests/device/page_connection.h"
#include "tests/e2e/live_workplace.h"
#include "tests/report/browser.h"

namespace forceshade::testing {
namespace {

constexpr const char* kViewed = "document.body.dataset.phase";
constexpr const char* kPictures = "['time', 'place'].map((id) => document.getElementById(id).toDataURL()).join()";

class LiveView : public Live {
protected:
    // By the clock, with a log; the page's address is said even by --quiet.
    std::unique_ptr<Process> viewed(const std::string& scene, const std::vector<std::string>& further) {
        Launch launch = this->launch(with(live(scene, {"--view", "--log", "log.csv", "--json", "--quiet"}), further));
        launch.error = path("stderr");
        std::filesystem::remove(path("stderr")); // an earlier run's address
        auto process = std::make_unique<Process>(launch);
        await(*process, [&] {
            const std::string said = text("stderr");
            const std::size_t begin = said.find("view: http://127.0.0.1:");
            if (begin == std::string::npos || said.find('\n', begin) == std::string::npos)
                return false;
            address = said.substr(begin + 6, said.find('\n', begin) - begin - 6);
            return true;
        });
        return process;
    }
    bool is_in(Browser& browser, const std::string& phase) const {
        return browser.wait_for(fmt::format("{} === '{}'", kViewed, phase));
    }
    static double number(Browser& browser, const std::string& expression) {
        const nlohmann::json value = browser.evaluate(expression);
        return value.is_number() ? value.get<double>() : -1;
    }
    void expect_undisturbed(const Outcome& outcome, std::size_t samples) const {
        EXPECT_EQ(outcome.code, 0) << text("stderr");
        const nlohmann::json said = nlohmann::json::parse(outcome.out);
        EXPECT_EQ(said["samples"], samples);
        EXPECT_EQ(said["log"]["lost"], 0);
        EXPECT_EQ(rows("log.csv").size(), samples);
    }

    std::string address;
};

TEST_F(LiveView, ShowsTheForceOverTimeAndPlaceAndHowTheRunEnded) {
    Browser browser;
    const auto process = viewed("bump.toml", {"--duration", "6 s"});
    browser.open_address(address);
    ASSERT_TRUE(is_in(browser, "running"));
    EXPECT_TRUE(browser.wait_for("points.length > 500 && points.at(-1).sent.size > 0.5"));
    EXPECT_TRUE(browser.wait_for("parseFloat(document.getElementById('sent').textContent) > 0.5"));
    EXPECT_TRUE(browser.wait_for("parseFloat(document.getElementById('rate').textContent) > 900"));
    EXPECT_EQ(browser.text("document.getElementById('scene').textContent"), "bump.toml");
    EXPECT_TRUE(says(browser.text("document.getElementById('device').textContent"), "1000 Hz"));
    const std::string before = browser.text(kPictures);
    EXPECT_TRUE(browser.wait_for(fmt::format("points.at(-1).t > {}", 0.3 + number(browser, "points.at(-1).t"))));
    EXPECT_NE(browser.text(kPictures), before) << "it scrolls";
    ASSERT_TRUE(is_in(browser, "ended"));
    EXPECT_EQ(browser.text("document.getElementById('state').textContent"),
              "The run has ended: after the requested time");
    expect_undisturbed(process->wait(), 6000);

    // What stays is what was felt.
    const Rows log = rows("log.csv");
    EXPECT_NEAR(number(browser, "points.at(-1).t"), number_in(log.back(), "t"), 1e-12);
    EXPECT_NEAR(number(browser, "points.at(-1).sent.size"), size_in(log.back(), "cx", "cy", "cz"), 1e-12);
    EXPECT_NEAR(number(browser, "points.at(-1).law.size"), size_in(log.back(), "fx", "fy", "fz"), 1e-12);
    EXPECT_NEAR(number(browser, "points.at(-1).place.x"), 1e3 * number_in(log.back(), "x"), 1e-9);
    EXPECT_NEAR(number(browser, "points.at(-1).depth"), 1e3 * number_in(log.back(), "depth"), 1e-9);
    const std::string last = browser.text(kPictures);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(browser.text(kPictures), last) << "the last picture stays";
    EXPECT_EQ(browser.text(kViewed), "ended") << "the program is gone, and that is no trouble";
    for (const char* const choice : {"axis", "show"}) {
        const std::string place = browser.text("document.getElementById('place').toDataURL()");
        browser.set("#" + std::string(choice), "e.options[1].value");
        EXPECT_TRUE(browser.wait_for("!wanted"));
        EXPECT_NE(browser.text("document.getElementById('place').toDataURL()"), place) << choice;
    }
    EXPECT_EQ(browser.complaints(), std::vector<std::string>{});
}

TEST_F(LiveView, WhoLooksAndGoesDoesNotChangeTheRun) {
    Browser first, second;
    const auto process = viewed("hand.toml", {"--duration", "5 s"});
    first.open_address(address);
    second.open_address(address);
    ASSERT_TRUE(first.wait_for("points.length > 100"));
    ASSERT_TRUE(second.wait_for("points.length > 100"));
    first.open_address("data:text/html,gone");
    EXPECT_TRUE(is_in(second, "ended"));
    expect_undisturbed(process->wait(), 5000);
}

// Fifty at a time that begin a request and do not end it: the loop is not later than without them, no memory piles up
// (all of it is locked), and who asks properly is answered.
TEST_F(LiveView, HalfRequestsDoNotMakeTheLoopLate) {
    const auto late = [](const Outcome& outcome) {
        return 1e-3 * nlohmann::json::parse(outcome.out)["late"]["p99_ns"].get<double>(); // us
    };
    const Outcome alone = viewed("bump.toml", {"--duration", "5 s"})->wait();
    expect_undisturbed(alone, 5000);
    const auto process = viewed("bump.toml", {"--duration", "8 s", "--overwrite"});
    const test::Place place(address);
    const auto open_halves = [&] {
        std::vector<int> halves;
        for (int i = 0; i < 50; ++i)
            halves.push_back(test::connection_to(place, "GET /", 0, false));
        return halves;
    };
    const auto close_all = [](const std::vector<int>& halves) { std::ranges::for_each(halves, ::close); };
    for (int second = 0; second < 4; ++second) {
        const std::vector<int> halves = open_halves();
        std::this_thread::sleep_for(std::chrono::seconds(1));
        close_all(halves);
    }
    std::ifstream status("/proc/" + std::to_string(process->id()) + "/status");
    std::size_t locked = 0; // KiB
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmLck:"))
            locked = std::stoul(line.substr(6));
    EXPECT_LT(locked, 256u * 1024);
    const int asking =
        test::connection_to(place, fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", place.path, place.host));
    std::string answer(15, '\0');
    EXPECT_EQ(::recv(asking, answer.data(), answer.size(), MSG_WAITALL), 15);
    EXPECT_EQ(answer, "HTTP/1.1 200 OK");
    ::close(asking);
    const Outcome beside = process->wait();
    expect_undisturbed(beside, 8000);
    fmt::print("late, p99: {:.0f} us alone, {:.0f} us with 50 half requests at a time; {} KiB locked\n", late(alone),
               late(beside), locked);
}

// At 10 kHz a part of the samples is shown; a force of one sample is among them.
TEST_F(LiveView, ThinsOutAFastLoopAndKeepsItsPeaks) {
    constexpr int kRows = 60'000, kPeak = 43'217;
    std::string table = "path,t,x,y,z\n";
    for (int i = 0; i < kRows; ++i)
        table += fmt::format("0,{},0,0,{}\n", 1e-4 * i, i == kPeak ? -0.0015 : -0.001);
    write("peak.csv", table);
    Browser browser;
    const auto process =
        viewed("plane.toml", {"--device", "replay:peak.csv", "--rate", "10 kHz", "--max-speed", "none"});
    browser.open_address(address);
    ASSERT_TRUE(is_in(browser, "ended")) << browser.text(kViewed);
    expect_undisturbed(process->wait(), kRows);
    const double shown = number(browser, "points.length / (points.at(-1).t - points[0].t)"); // Hz
    EXPECT_GT(shown, 500);
    EXPECT_LT(shown, 2100);
    EXPECT_NEAR(number(browser, "Math.max(...points.map((point) => point.law.size))"), 1.5, 1e-9);
    EXPECT_EQ(number(browser, "points.filter((point) => point.law.size > 1.2).length"), 1);
}

TEST_F(LiveView, SaysWhyThereIsNoForce) {
    Browser browser;
    const auto process = viewed("plane.toml", {"--device", "sim:1@0 s..1 s", "--dead-man", "1", "--duration", "60 s"});
    browser.open_address(address);
    ASSERT_TRUE(browser.wait_for("document.getElementById('state').textContent === 'no force: dead_man'"));
    EXPECT_TRUE(browser.evaluate("document.body.hasAttribute('data-trouble')").get<bool>());
    process->send(SIGINT);
    EXPECT_TRUE(browser.wait_for("document.getElementById('state').textContent === 'The run has ended: interrupted'"));
    EXPECT_EQ(process->wait().code, 130);
}

TEST_F(LiveView, TellsThatTheProgramWasKilled) {
    Browser browser;
    const auto process = viewed("plane.toml", {});
    browser.open_address(address);
    ASSERT_TRUE(is_in(browser, "running"));
    process->send(SIGKILL);
    EXPECT_TRUE(is_in(browser, "gone"));
}

} // namespace
} // namespace forceshade::testing
