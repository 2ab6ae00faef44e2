// A user whose numbers have commas gets the same bytes. The locale is made by the test (package locales).
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

class Locale : public Workplace {
protected:
    Locale() {
        write("study.toml", small_study());
        write("wrong.toml", "[surface]\nradius = \"0,6 mm\"\n");
        const Outcome made = run({.arguments = {"-i", "de_DE", "-f", "UTF-8", path("de_DE.UTF-8").string()},
                                  .program = "/usr/bin/localedef"});
        german_ = {{"LOCPATH", folder_.path().string()}, {"LC_ALL", "de_DE.UTF-8"}, {"LANG", "de_DE.UTF-8"}};
        EXPECT_EQ(made.code, 0) << "package locales is missing? " << made.error;
    }
    Outcome speak_german(std::vector<std::string> arguments) const {
        Launch launch = this->launch(std::move(arguments));
        launch.environment.insert(german_.begin(), german_.end());
        return run(launch);
    }
    std::map<std::string, std::string> german_;
};

TEST_F(Locale, is_there) {
    Launch launch{.arguments = {"%.2f", "1,5"}, .environment = german_, .program = "/usr/bin/printf"};
    EXPECT_EQ(run(launch).out, "1,50") << "else these tests test nothing";
}

TEST_F(Locale, german_changes_no_byte_of_a_sweep) {
    const std::vector<std::string> arguments{"sweep",  "study.toml",      "--only", "*1000mil*",
                                             "--also", "npy,vti,vtp,png", "--out"};
    auto here = arguments, there = arguments;
    here.push_back("plain");
    there.push_back("german");
    expect_success(here);
    EXPECT_EQ(speak_german(there).code, 0);
    EXPECT_EQ(differences(results_in(path("plain")), results_in(path("german"))), std::set<std::string>{});
    // Each reads what the other wrote.
    here.back() = "german";
    here.push_back("--json");
    EXPECT_EQ(nlohmann::json::parse(expect_success(here).out)["kept"], 17);
    EXPECT_EQ(speak_german(there).error.find("17 cases: 0 computed"), 0u);
}

TEST_F(Locale, german_changes_no_word_of_the_output) {
    for (const std::vector<std::string>& arguments :
         std::vector<std::vector<std::string>>{{"schema"},
                                               {"schema", "--json"},
                                               {"schema", "--default-study"},
                                               {"gpus"},
                                               {"doctor"},
                                               {"--help"},
                                               {"validate", "study.toml", "--only", "*facets-2*"},
                                               {"validate", "study.toml", "--only", "*facets-2*", "--json"},
                                               {"validate", "wrong.toml"},
                                               {"validate", "nosuch.toml"},
                                               {"field", "study.toml", "--out", "a.exr"}}) {
        const Outcome plain = forceshade(arguments), german = speak_german(arguments);
        EXPECT_EQ(plain.out, german.out);
        EXPECT_EQ(plain.code, german.code);
        if (plain.code != 0) {
            EXPECT_EQ(plain.error, german.error);
        }
    }
}

} // namespace
} // namespace forceshade::testing
