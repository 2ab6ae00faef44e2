// The list of haptic devices as a user sees it, with vendors' libraries that are stubs or are not there.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Devices : public Workplace {
protected:
    Outcome list(const std::map<std::string, std::string>& environment, bool as_json = false) const {
        Launch launch =
            this->launch(as_json ? std::vector<std::string>{"devices", "--json"} : std::vector<std::string>{"devices"});
        for (const char* name : {"FORCESHADE_DHD_LIBRARY", "FORCESHADE_HD_LIBRARY"})
            launch.environment[name] = "";
        for (const auto& [name, value] : environment)
            launch.environment[name] = value;
        Outcome outcome = run(launch);
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        EXPECT_EQ(outcome.error, "");
        return outcome;
    }

    json kind(const std::map<std::string, std::string>& environment, const std::string& option) const {
        const json all = json::parse(list(environment, true).out);
        for (const json& one : all)
            if (one["option"] == option)
                return one;
        ADD_FAILURE() << option << " is not among " << all;
        return {};
    }
};

TEST_F(Devices, are_listed_though_none_is_installed) {
    const std::string text = list({}).out;
    for (const char* word :
         {"sim ", "replay:FILE", "haply[:URL]", "ws://localhost:10001", "dhd[:INDEX]", "hd[:NAME]",
          "there: --device sim", "libdhd.so", "libHD.so", "FORCESHADE_HD_LIBRARY", "LD_LIBRARY_PATH"})
        EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
    EXPECT_EQ(kind({}, "sim")["devices"], json::array({"sim"}));
    EXPECT_EQ(kind({}, "dhd[:INDEX]")["devices"], json::array());
}

TEST_F(Devices, are_found_by_the_library_that_the_environment_names) {
    const json dhd = kind({{"FORCESHADE_DHD_LIBRARY", DHD_STUB}}, "dhd[:INDEX]");
    EXPECT_EQ(dhd["devices"], json::array({"dhd:0"}));
    EXPECT_EQ(dhd["software"], "DHD SDK 3.17.6.1");
    const std::string text = list({{"FORCESHADE_HD_LIBRARY", HD_STUB}}).out;
    EXPECT_NE(text.find("there: --device hd, Touch (serial number 8042)"), std::string::npos) << text;
    EXPECT_NE(text.find(HD_STUB), std::string::npos) << text;
}

TEST_F(Devices, are_found_where_the_linker_looks) {
    std::filesystem::create_directory(path("lib"));
    std::filesystem::create_symlink(DHD_STUB, path("lib/libdhd.so.3"));
    std::filesystem::create_symlink(HD_STUB, path("lib/libHD.so"));
    const std::map<std::string, std::string> environment{{"LD_LIBRARY_PATH", path("lib")}};
    EXPECT_EQ(kind(environment, "dhd[:INDEX]")["place"], path("lib/libdhd.so.3").string());
    EXPECT_EQ(kind(environment, "hd[:NAME]")["place"], path("lib/libHD.so").string());
}

TEST_F(Devices, that_fail_are_told_in_the_librarys_words) {
    std::map<std::string, std::string> environment{{"FORCESHADE_DHD_LIBRARY", DHD_STUB},
                                                   {"FORCESHADE_HD_LIBRARY", HD_STUB},
                                                   {"STUB_FAIL", "dhdGetDeviceCount,hdInitDevice"}};
    const std::string text = list(environment).out;
    EXPECT_NE(text.find("no driver found"), std::string::npos) << text;
    EXPECT_NE(text.find("Device fault"), std::string::npos) << text;
    EXPECT_NE(kind({{"FORCESHADE_DHD_LIBRARY", path("no.so")}}, "dhd[:INDEX]")["problem"].dump().find("no.so"),
              std::string::npos);
}

} // namespace
} // namespace forceshade::testing
