// The end report's files: all three, whole, or an error that names the one that could not be written.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "device/report/report.h"
#include "host/error.h"
#include "tests/device/report_cases.h"

namespace forceshade::device::test {
namespace {

namespace fs = std::filesystem;

class ReportFiles : public ::testing::Test {
protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "report_files_XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string read(const std::string& name) const {
        std::ifstream stream(folder_ / name, std::ios::binary);
        return (std::ostringstream() << stream.rdbuf()).str();
    }

    fs::path folder_;
};

TEST_F(ReportFiles, are_the_text_the_json_and_the_page) {
    const LiveOutcome outcome = usual(1000);
    write_live_report(outcome, folder_ / "run.1");
    EXPECT_EQ(read("run.1.txt"), report_text(outcome));
    EXPECT_EQ(read("run.1.json"), report_json(outcome).dump(2) + "\n");
    EXPECT_EQ(read("run.1.html"), live_page(outcome));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 3) << "and nothing else";
}

TEST_F(ReportFiles, an_error_names_what_could_not_be_written) {
    try {
        write_live_report(usual(1000), folder_ / "missing" / "run");
        FAIL() << "there is no such folder";
    } catch (const IoError& error) {
        EXPECT_NE(std::string(error.what()).find("missing/run.txt"), std::string::npos) << error.what();
    }
    fs::create_directories(folder_ / "run.html" / "in_the_way");
    EXPECT_THROW(write_live_report(usual(1000), folder_ / "run"), IoError);
    EXPECT_EQ(read("run.txt"), report_text(usual(1000))) << "the others are there";
}

} // namespace
} // namespace forceshade::device::test
