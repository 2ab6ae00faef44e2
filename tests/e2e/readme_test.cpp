// Every block of a README that is marked toml, sh or python works as it stands there, in order, in a folder of its own.
#include <regex>

#include <fmt/format.h>

#include "tests/e2e/workplace.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

struct Block {
    std::string language, text;
    std::size_t line; // of the README
};

std::vector<Block> blocks_of(const std::string& text) {
    std::vector<Block> blocks;
    bool inside = false;
    std::size_t number = 0;
    for (const std::string& line : lines_of(text)) {
        ++number;
        if (line.starts_with("```")) {
            inside = !inside;
            if (inside)
                blocks.push_back({line.substr(3), "", number});
        } else if (inside) {
            blocks.back().text += line + "\n";
        }
    }
    EXPECT_FALSE(inside) << "the last block does not end";
    return blocks;
}

// Set-up commands install packages: not here. A step of a check may fail on a busy machine: device_check_test.
std::string to_be_run(const std::string& text) {
    const std::string here = std::regex_replace(text, std::regex("(^|\n)\\./(host|tests)/run[^\n]*"), "$1");
    return std::regex_replace(here, std::regex("forceshade device check [^\n]*"), "$& || test $? = 1");
}

class Readme : public Workplace, public ::testing::WithParamInterface<const char*> {
protected:
    Readme() : blocks_(blocks_of(read_text(page()))) {
        std::filesystem::create_directory(path("bin"));
        std::filesystem::create_symlink(in_build("forceshade"), path("bin/forceshade"));
        std::filesystem::create_directory(path("work"));
        for (const char* const folder : {"tests", "host"})
            std::filesystem::create_directory_symlink(std::filesystem::path(in_source("")) / folder,
                                                      path("work") / folder);
    }
    static std::filesystem::path page() { return std::filesystem::path(in_source("")) / GetParam(); }
    Outcome run_in_work(const std::string& program, const std::vector<std::string>& arguments) const {
        Launch launch = this->launch(arguments);
        launch.program = program;
        launch.folder = path("work");
        launch.environment["PATH"] = path("bin").string() + ":/usr/bin:/bin";
        launch.environment["PYTHONPATH"] = in_build("python");
        return run(launch);
    }
    std::vector<Block> blocks_;
};

TEST_P(Readme, EveryBlockSaysItsLanguage) {
    for (const Block& block : blocks_)
        EXPECT_NE(block.language, "") << "line " << block.line << ": say what it is";
}

TEST_P(Readme, ScenesAndStudiesAreAcceptedAndRun) {
    for (const Block& block : blocks_) {
        if (block.language != "toml")
            continue;
        write("work/block.toml", block.text);
        const std::string out = fmt::format("block-{}", block.line);
        const Outcome outcome = run_in_work(in_build("forceshade"), {"sweep", "block.toml", "--out", out});
        EXPECT_EQ(outcome.code, 0) << "line " << block.line << ": " << outcome.error;
        EXPECT_FALSE(says(outcome.error, "warning")) << "line " << block.line;
    }
}

TEST_P(Readme, CommandsAndScriptsWork) {
    for (const Block& block : blocks_) {
        if (block.language != "sh" && block.language != "python")
            continue;
        const bool shell = block.language == "sh";
        const Outcome outcome = shell ? run_in_work("/bin/sh", {"-e", "-u", "-c", to_be_run(block.text)})
                                      : run_in_work("/usr/bin/python3", {"-c", block.text});
        EXPECT_EQ(outcome.code, 0) << "line " << block.line << ": " << outcome.error;
    }
}

TEST_P(Readme, LinksLeadSomewhere) {
    const std::string text = read_text(page());
    const std::regex link("\\]\\(([^):#]+)\\)");
    for (auto found = std::sregex_iterator(text.begin(), text.end(), link); found != std::sregex_iterator(); ++found)
        EXPECT_TRUE(std::filesystem::exists(page().parent_path() / (*found)[1].str())) << (*found)[1];
}

INSTANTIATE_TEST_SUITE_P(Pages, Readme,
                         ::testing::Values("README.md", "device/README.md", "host/README.md",
                                           "host/experiment/README.md", "host/mesh/README.md", "host/output/README.md",
                                           "host/paths/README.md", "host/python/README.md", "host/referee/README.md",
                                           "host/score/README.md", "host/scene/README.md", "host/study/README.md",
                                           "host/sweep/README.md", "shaders/README.md"));

} // namespace
} // namespace forceshade::testing
