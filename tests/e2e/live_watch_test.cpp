// The scene's file while a loop runs: what is saved is felt, what is broken is not.
#include <fcntl.h>
#include <sys/stat.h>

#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

class LiveWatch : public LiveDevice {
protected:
    bool is_said(const std::string& word) const { return bool(says(text("stderr"), word)); }
    void save(const std::string& scene) const { write("plane.toml", scene + "[run]\nprecision = \"f64\"\n"); }
    // The rows of a path, with the header.
    std::string rows_of(const std::string& log, const std::string& number) const {
        std::string kept;
        for (const std::string& line : lines_of(text(log)))
            if (kept.empty() || line.starts_with(number + ","))
                kept += line + "\n";
        return kept;
    }
};

TEST_F(LiveWatch, AChangeIsANewPathThatItsKeptSceneReplays) {
    save("[force]\nstiffness = \"1 N/mm\"\n");
    Process process(felt({"--watch", "--log", "log.csv"}));
    ASSERT_TRUE(await(process, [&] { return is_pushing(); }));
    save("[force]\nstiffness = \"0.5 N/mm\"\n");
    ASSERT_TRUE(await(process, [&] { return is_said("log.scene-1.toml"); }));
    ASSERT_TRUE(await(process, [&] { return std::abs(record().back().size() - 0.5) < 1e-6; }));
    // Whatever is broken is refused, and the loop goes on with what it had.
    const std::vector<std::pair<std::string, std::string>> broken{
        {"[force]\nstiffness = \"2 N/mm\n", "plane.toml:2"},
        {"[force]\nstiffness = \"2 N\"\n", "plane.toml:2"},
        {"[surface]\nkind = \"mesh\"\nfile = \"nosuch.obj\"\n", "nosuch.obj"},
        {"[force]\nstiffness = [\"1 N/mm\", \"2 N/mm\"]\n", "plane.toml:2"},
        {"", "empty"},
        {"[run]\nprecision = \"f32\"\n", "run.precision cannot change"}};
    for (const auto& [scene, words] : broken) {
        std::filesystem::resize_file(path("stderr"), 0);
        if (scene.empty() || scene.starts_with("[run]"))
            write("plane.toml", scene);
        else
            save(scene);
        ASSERT_TRUE(await(process, [&] { return is_said("the scene stays as it was"); })) << scene;
        EXPECT_TRUE(is_said(words)) << text("stderr");
    }
    EXPECT_NEAR(record().back().size(), 0.5, 1e-6);
    save("[force]\nstiffness = \"0.25 N/mm\"\n");
    ASSERT_TRUE(await(process, [&] { return is_said("log.scene-2.toml"); }));
    ASSERT_TRUE(await(process, [&] { return std::abs(record().back().size() - 0.25) < 1e-6; }));
    process.send(SIGINT);
    EXPECT_EQ(process.wait().code, 130);
    EXPECT_EQ(record().back().size(), 0);
    EXPECT_EQ(read_json("log.live.json")["paths"], 3);
    EXPECT_EQ(read_json("log.live.json")["remarks"].size(), 8u);
    const nlohmann::json scenes = read_json("log.live.json")["scenes"];
    ASSERT_EQ(scenes.size(), 3u);
    for (const char* const number : {"0", "1", "2"}) {
        write("path.csv", rows_of("log.csv", number));
        EXPECT_GT(rows("path.csv").size(), 0u);
        const nlohmann::json& scene = scenes[std::stoul(number)];
        EXPECT_EQ(scene["toml"], text(fmt::format("log.scene-{}.toml", number)));
        for (const auto& row : rows("path.csv"))
            ASSERT_EQ(row.at("scene"), std::string(scene["sha256"]).substr(0, 16)) << number;
        expect_success(replayed(fmt::format("log.scene-{}.toml", number), "path.csv", "out.csv", "cpu", "f64"));
        EXPECT_TRUE(felt_in(text("path.csv")) == text("out.csv")) << number;
        EXPECT_NEAR(number_in(rows("path.csv").front(), "fz"), std::pow(0.5, std::stoi(number)), 1e-12);
    }
    EXPECT_FALSE(std::filesystem::exists(path("log.scene-3.toml")));
}

// A wall that is suddenly ten times as stiff, or elsewhere, does not hit the hand.
TEST_F(LiveWatch, TheForceOfAChangeComesUpAsAfterTheStart) {
    Process process(felt({"--watch", "--max-force", "5 N", "--quiet", "--unstable"}));
    ASSERT_TRUE(await(process, [&] { return is_pushing(); }));
    write("plane.toml", "[force]\nstiffness = \"10 N/mm\"\n");
    ASSERT_TRUE(await(process, [&] { return record().back().size() > 4.99; }));
    process.send(SIGINT);
    EXPECT_EQ(process.wait().code, 130);
    EXPECT_EQ(text("stderr"), "");
    double before = 0;
    bool fell = false, pushed = false;
    for (const Told& told : record()) {
        ASSERT_LE(told.size(), before + 10 * 0.021) << "10 N over 50 ms";
        before = told.size();
        pushed = pushed || before > 0.95;
        fell = fell || (pushed && before < 0.25);
    }
    EXPECT_TRUE(fell);
}

// The terminal or pipe that takes our words may stop taking them (Ctrl-S).
TEST_F(LiveWatch, WordsThatNobodyTakesDoNotKeepAForceUp) {
    ::mkfifo(path("words").c_str(), 0600);
    const int words = ::open(path("words").c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    std::string some(4096, '.');
    while (::write(words, some.data(), some.size()) > 0 || some.size() > 1)
        some.resize(std::max<std::size_t>(1, some.size() / 2));
    Launch launch = felt({"--watch"});
    launch.error = path("words");
    Process process(launch);
    ASSERT_TRUE(await(process, [&] { return is_pushing(); }));
    save("[force]\nstiffness = \"2 N/mm\"\n");
    ASSERT_TRUE(await(process, [&] { return record().back().size() > 1.9; }));
    std::this_thread::sleep_for(std::chrono::milliseconds(300)); // it says so, or tries to
    process.send(SIGINT);
    await(process, [&] { return record().back().size() == 0; });
    const std::size_t told = record().size();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_LE(record().size(), told + 5) << "the loop has ended";
    EXPECT_EQ(record().back().size(), 0);
    process.send(SIGINT);
    EXPECT_EQ(process.wait().code, 130);
    ::close(words);
}

TEST_F(LiveWatch, WithoutItTheFileIsLetBe) {
    Launch launch = felt({"--duration", "1 s"});
    Process process(launch);
    ASSERT_TRUE(await(process, [&] { return is_pushing(); }));
    save("[force]\nstiffness = \"0.5 N/mm\"\n");
    process.wait();
    for (const Told& told : record())
        EXPECT_TRUE(told.size() < 1e-9 || told.z <= 1 + 1e-9);
    EXPECT_FALSE(says(text("stderr"), "read again"));
}

} // namespace
} // namespace forceshade::testing
