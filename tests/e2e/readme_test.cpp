// Every block of the README that is marked toml, sh or python works as it stands there, in order, in one folder.
#include <regex>
#include <sstream>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

struct Block {
    std::string language, text;
    std::size_t line; // of the README
};

std::vector<Block> blocks_of(const std::string& text) {
    std::vector<Block> blocks;
    std::istringstream lines(text);
    bool inside = false;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
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

// Set-up commands install packages: not here.
std::string without_set_up(const std::string& text) {
    return std::regex_replace(text, std::regex("(^|\n)\\./(host|tests)/run[^\n]*"), "$1");
}

class Readme : public Workplace {
protected:
    Readme() : blocks_(blocks_of(read_text(FORCESHADE_SOURCE "/README.md"))) {
        std::filesystem::create_directory(path("bin"));
        std::filesystem::create_symlink(FORCESHADE_PROGRAM, path("bin/forceshade"));
        std::filesystem::create_directory(path("work"));
        std::filesystem::create_directory_symlink(FORCESHADE_SOURCE "/tests", path("work/tests"));
    }
    std::size_t count(const std::string& language) const {
        return static_cast<std::size_t>(std::count_if(blocks_.begin(), blocks_.end(),
                                                      [&](const Block& block) { return block.language == language; }));
    }
    Outcome run_in_work(const std::string& program, const std::vector<std::string>& arguments) const {
        Launch launch = this->launch(arguments);
        launch.program = program;
        launch.folder = path("work");
        launch.environment["PATH"] = path("bin").string() + ":/usr/bin:/bin";
        return run(launch);
    }
    std::vector<Block> blocks_;
};

TEST_F(Readme, has_examples) {
    EXPECT_GE(count("toml"), 1u);
    EXPECT_GE(count("sh"), 1u);
    EXPECT_GE(count("python"), 1u);
    for (const Block& block : blocks_)
        EXPECT_NE(block.language, "") << "line " << block.line << ": say what it is";
}

TEST_F(Readme, scenes_and_studies_are_accepted_and_run) {
    for (const Block& block : blocks_) {
        if (block.language != "toml")
            continue;
        write("work/block.toml", block.text);
        const Outcome outcome = run_in_work(FORCESHADE_PROGRAM, {"sweep", "block.toml", "--out", "block", "--fresh"});
        EXPECT_EQ(outcome.code, 0) << "line " << block.line << ": " << outcome.error;
        EXPECT_EQ(outcome.error.find("warning"), std::string::npos) << "line " << block.line << ": " << outcome.error;
    }
}

TEST_F(Readme, commands_and_scripts_work) {
    for (const Block& block : blocks_) {
        if (block.language != "sh" && block.language != "python")
            continue;
        const bool shell = block.language == "sh";
        const Outcome outcome = shell ? run_in_work("/bin/sh", {"-e", "-u", "-c", without_set_up(block.text)})
                                      : run_in_work("/usr/bin/python3", {"-c", block.text});
        EXPECT_EQ(outcome.code, 0) << "line " << block.line << ": " << outcome.error;
    }
}

TEST_F(Readme, links_lead_somewhere) {
    const std::string text = read_text(FORCESHADE_SOURCE "/README.md");
    const std::regex link("\\]\\(([^):#]+)\\)");
    for (auto found = std::sregex_iterator(text.begin(), text.end(), link); found != std::sregex_iterator(); ++found)
        EXPECT_TRUE(std::filesystem::exists(std::string(FORCESHADE_SOURCE "/") + (*found)[1].str())) << (*found)[1];
}

} // namespace
} // namespace forceshade::testing
