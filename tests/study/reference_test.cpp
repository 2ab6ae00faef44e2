// The results that the README shows are whole, and the README says what they say.
#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/output/files.h"
#include "host/study/study_data.h"
#include "tests/io/folder.h"
#include "tests/places.h"

namespace forceshade::study {
namespace {

const std::filesystem::path kSource = in_source("");
const std::filesystem::path kReference = kSource / "results/reference";
constexpr const char* kStudies[] = {"error-time"};

// What the account names is there as it was written, and nothing else is.
TEST(Reference, HoldsWhatItsAccountsName) {
    for (const char* study : kStudies) {
        const StudyData data = read_data(kReference / study);
        EXPECT_EQ(data.files.size(), data.tables.size() + data.figures.size()) << study;
        std::set<std::string> named{"study.json"};
        for (const std::vector<FileRecord>* files : {&data.files, &data.volumes})
            for (const FileRecord& file : *files) {
                EXPECT_TRUE(file_is_intact(kReference / study / file.name, file.sha256)) << study << ' ' << file.name;
                named.insert(file.name);
            }
        for (const auto& entry : std::filesystem::directory_iterator(kReference / study))
            EXPECT_TRUE(!entry.is_regular_file() || named.contains(entry.path().filename().string())) << entry.path();
    }
}

TEST(Reference, ReadmeShowsThreeFindingsWordForWord) {
    const std::string text = testing::read_text(kSource / "README.md");
    std::size_t shown = 0;
    for (const char* study : kStudies)
        for (const Finding& finding : read_data(kReference / study).findings)
            shown += text.find("- " + finding.text + "\n") != std::string::npos;
    EXPECT_GE(shown, 3u);
}

TEST(Reference, PicturesOfTheReadmeAreThere) {
    const std::string text = testing::read_text(kSource / "README.md");
    std::size_t pictures = 0;
    for (std::size_t at = text.find("](results/reference/"); at != std::string::npos;
         at = text.find("](results/reference/", at + 1)) {
        const std::string name = text.substr(at + 2, text.find(')', at) - at - 2);
        EXPECT_TRUE(std::filesystem::is_regular_file(kSource / name)) << name;
        ++pictures;
    }
    EXPECT_GE(pictures, 2u);
}

} // namespace
} // namespace forceshade::study
