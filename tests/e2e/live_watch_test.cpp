// The scene's file while a loop runs: what is saved is felt, what is broken is not.
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

class LiveWatch : public LiveDevice {
protected:
    bool is_said(const std::string& word) const { return text("stderr").find(word) != std::string::npos; }
    void save(const std::string& scene) const { write("plane.toml", scene + "[run]\nprecision = \"f64\"\n"); }
    // The rows of a path, with the header.
    std::string rows_of(const std::string& log, const std::string& number) const {
        std::istringstream lines(text(log));
        std::string line, kept;
        std::getline(lines, line);
        kept = line + "\n";
        while (std::getline(lines, line))
            if (line.starts_with(number + ","))
                kept += line + "\n";
        return kept;
    }
};

TEST_F(LiveWatch, a_change_is_a_new_path_that_its_kept_scene_replays) {
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
        {"[run]\nprecision = \"f32\"\n", "run.precision cannot change"}};
    for (const auto& [scene, words] : broken) {
        std::filesystem::resize_file(path("stderr"), 0);
        if (scene.starts_with("[run]"))
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
    EXPECT_EQ(read_json("log.live.json")["remarks"].size(), 7u);
    for (const char* const number : {"0", "1", "2"}) {
        write("path.csv", rows_of("log.csv", number));
        EXPECT_GT(rows("path.csv").size(), 0u);
        expect_success(replayed(fmt::format("log.scene-{}.toml", number), "path.csv", "out.csv", "cpu", "f64"));
        EXPECT_TRUE(felt_in(text("path.csv")) == text("out.csv")) << number;
        EXPECT_NEAR(number_in(rows("path.csv").front(), "fz"), std::pow(0.5, std::stoi(number)), 1e-12);
    }
    EXPECT_FALSE(std::filesystem::exists(path("log.scene-3.toml")));
}

TEST_F(LiveWatch, without_it_the_file_is_let_be) {
    Launch launch = felt({"--duration", "1 s"});
    Process process(launch);
    ASSERT_TRUE(await(process, [&] { return is_pushing(); }));
    save("[force]\nstiffness = \"0.5 N/mm\"\n");
    process.wait();
    for (const Told& told : record())
        EXPECT_TRUE(told.size() < 1e-9 || told.z <= 1 + 1e-9);
    EXPECT_EQ(text("stderr").find("read again"), std::string::npos);
}

} // namespace
} // namespace forceshade::testing
