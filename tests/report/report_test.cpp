// report.html: one file that needs nothing else, whatever lies in the folder.
#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>

#include <sys/stat.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/report/report.h"
#include "host/report/sections.h"
#include "tests/io/folder.h"
#include "tests/report/sample_folder.h"

namespace forceshade::report {
namespace {

using namespace testing;

class Report : public ::testing::Test {
protected:
    std::filesystem::path path(const std::string& name = "") const { return folder_.path() / name; }

    ReportResult write() {
        const ReportResult result = write_report(path());
        html_ = read_text(result.file);
        EXPECT_TRUE(html_.starts_with("<!DOCTYPE html>"));
        EXPECT_TRUE(html_.ends_with("</html>\n"));
        return result;
    }
    // As a bool: a failure does not print the whole page.
    bool says(const std::string& words) const { return html_.find(words) != std::string::npos; }
    // Expects one trouble, which holds the words, and that the page tells it.
    void expect_trouble(const std::string& words) {
        const ReportResult result = write();
        EXPECT_TRUE(testing::says(fmt::format("{}", fmt::join(result.troubles, "\n")), words));
        EXPECT_TRUE(says("What is missing or damaged"));
        EXPECT_TRUE(says(words)) << words;
    }

    Folder folder_;
    std::string html_;
};

TEST_F(Report, OfASweepAndAStudyIsWholeAndLeadsToItsFiles) {
    write_sample_sweep(path());
    write_sample_study(path("energy"));
    const ReportResult result = write();
    EXPECT_EQ(result.troubles.size(), 0u);
    EXPECT_GE(result.findings, 3u);
    for (const char* words : {"class=\"findings\"", "The largest force is ", "class=\"study\"", "a processor, 2 cores",
                              "quick: coarse", "These numbers are made up.", "id=\"viewer\"", "Time by stage"})
        EXPECT_TRUE(says(words)) << words;
    const std::regex link("href=\"([^#\"][^\"]*)\"");
    std::size_t links = 0;
    for (std::sregex_iterator it(html_.begin(), html_.end(), link), end; it != end; ++it) {
        if ((*it)[1] == "data:,")
            continue;
        ++links;
        EXPECT_TRUE(std::filesystem::exists(path((*it)[1]))) << (*it)[1];
    }
    EXPECT_GE(links, 15u);
}

TEST_F(Report, FindsWhatLiesTwoFoldersBelow) {
    std::filesystem::create_directory(path("paper"));
    write_sample_sweep(path("paper"));
    write_sample_study(path("reference/energy"));
    std::filesystem::create_directories(path("paper/deeper/energy"));
    std::filesystem::create_directories(path("photos/more"));
    EXPECT_EQ(write().troubles.size(), 0u);
    EXPECT_TRUE(says("Sweep paper"));
    EXPECT_TRUE(says("Energy (reference/energy)"));
}

TEST_F(Report, PassesByWhatMayNotBeLookedAt) {
    write_sample_sweep(path());
    for (const char* folder : {"odd", "other/odd"}) {
        std::filesystem::create_directories(path(folder));
        for (const char* name : {"manifest.json", "study.json"})
            std::filesystem::create_symlink(name, path(folder) / name); // to itself: an error, not an absence
    }
    EXPECT_EQ(write().troubles, std::vector<std::string>{});
}

TEST_F(Report, LoadsNothing) {
    write_sample_sweep(path());
    write_sample_study(path("energy"));
    write();
    // Names of XML, and what stands in comments of d3 and three.js.
    const std::vector<std::string> kNamed{"www.w3.org/",       "d3js.org",   "github.com/",   "graphics.stanford.edu/",
                                          "alteredqualia.com", "mrdoob.com", "erichaines.com"};
    for (std::size_t at = 0; (at = html_.find("://", at + 1)) != std::string::npos;)
        EXPECT_TRUE(std::ranges::any_of(kNamed, [&](const std::string& name) {
            return html_.compare(at + 3, name.size(), name) == 0;
        })) << html_.substr(at - 10, 50);
    EXPECT_FALSE(says(" src="));
    EXPECT_TRUE(says("default-src 'none'"));
}

TEST_F(Report, IsTheSameForTheSameFolder) {
    write_sample_sweep(path());
    write_sample_study(path("energy"));
    write();
    const std::string first = html_;
    write();
    EXPECT_EQ(html_, first);
}

TEST_F(Report, ShowsMarkupInNamesAsText) {
    const std::string evil = "<script>alert(1)<!--\"'&";
    std::vector<CaseRecord> records{write_sample_case(path(), {.name = evil})};
    records[0].parameters = {{evil, "</td><script>"}};
    records[0].omitted = {"<script>"};
    write_sample_manifest(path(), records);
    std::filesystem::create_directory(path("<script>alert(2)"));
    write_sample_study(path("<script>alert(2)"));
    write();
    EXPECT_FALSE(says("<script>alert"));
    EXPECT_FALSE(says("</td><script>"));
    EXPECT_TRUE(says("&lt;script&gt;alert(1)"));
    EXPECT_TRUE(says("\\u003cscript>alert(1)"));
    EXPECT_TRUE(says("href=\"%3Cscript%3Ealert%281%29%3C%21--%22%27%26.exr\""));
}

TEST_F(Report, ReplacesNoPageOfSomebodyElse) {
    folder_.write("report.html", "mine");
    expect_trouble("report.html: another program wrote it");
    EXPECT_EQ(folder_.read("report.html"), "mine");
    EXPECT_TRUE(std::filesystem::exists(path("forceshade-report.html")));
}

TEST_F(Report, OfNoFolderIsAnError) {
    EXPECT_THROW(write_report(path("nothing")), IoError);
    folder_.write("file", "");
    EXPECT_THROW(write_report(path("file")), IoError);
}

TEST_F(Report, OfAnEmptyFolderSaysSo) {
    expect_trouble("The folder holds no manifest.json of a sweep and no study.json of a study.");
    EXPECT_TRUE(says("This folder has no sweep and no study that this program can read."));
}

TEST_F(Report, TellsOfManifestsThatAreNone) {
    folder_.write("manifest.json", "{\"cases\": [");
    expect_trouble("manifest.json: it is damaged");
    folder_.write("manifest.json", "{\"short_name\": \"an app\"}");
    expect_trouble("manifest.json: not a sweep manifest");
    folder_.write("manifest.json", "[]");
    expect_trouble("manifest.json: not a sweep manifest");
    write_sample_manifest(path(), {});
    expect_trouble("manifest.json: it holds no case");
}

// The report would copy and print them a level a call, until the stack ends.
TEST_F(Report, TellsOfAccountsThatAreNestedDeeply) {
    const std::string deep = std::string(300000, '[') + std::string(300000, ']');
    for (const std::string& text : {"{\"cases\":[" + deep + "]}", "{\"format\":" + deep + ",\"cases\":[]}",
                                    "{\"last_run\":" + deep + ",\"cases\":[]}"}) {
        folder_.write("manifest.json", text);
        expect_trouble("manifest.json: it is damaged");
    }
    std::filesystem::create_directory(path("manifest.d"));
    folder_.write("manifest.d/a.json", deep);
    expect_trouble("manifest.d/a.json: this case cannot be understood");
    for (const std::string& text :
         {"{\"study\":\"energy\",\"format\":" + deep + "}", "{\"study\":" + deep + ",\"format\":1}"}) {
        folder_.write("study.json", text);
        expect_trouble("study.json: it is damaged");
    }
}

TEST_F(Report, WaitsForNoPipe) {
    std::filesystem::create_directory(path("manifest.d"));
    for (const char* name : {"manifest.json", "manifest.d/a.json", "study.json", "report.html"})
        ASSERT_EQ(::mkfifo(path(name).c_str(), 0600), 0);
    const ReportResult written = write_report(path());
    EXPECT_EQ(written.file.filename(), "forceshade-report.html") << "what is no page is left alone";
    for (const char* name : {"manifest.json", "manifest.d/a.json", "study.json"})
        EXPECT_TRUE(std::ranges::any_of(written.troubles, [&](const std::string& trouble) {
            return trouble.starts_with(std::string(name) + ": ") && testing::says(trouble, "not a regular file");
        })) << name;
}

TEST_F(Report, OfAnOldManifestShowsWhatCanBeUnderstood) {
    write_sample_sweep(path());
    std::string text = folder_.read("manifest.json");
    text.replace(text.find("\"format\": 1"), 11, "\"format\": 0");
    folder_.write("manifest.json", text);
    expect_trouble("its format is 0, this program writes 1");
    EXPECT_TRUE(says("bump_shading-reference"));
    text.replace(text.find("\"voxels\""), 8, "\"volume\"");
    text.replace(text.find("\"cases_of_study\": 2"), 19, "\"cases_of_study\":-1");
    folder_.write("manifest.json", text);
    expect_trouble("manifest.json, case 1: this case cannot be understood");
    EXPECT_TRUE(says("bump_shading-reference"));
}

TEST_F(Report, TakesCasesFromTheirRecordsWhereTheManifestIsDamaged) {
    const std::vector<CaseRecord> records = write_sample_sweep(path());
    std::filesystem::create_directory(path("manifest.d"));
    for (const CaseRecord& record : records)
        write_record(path(), record);
    folder_.write("manifest.d/foreign.json", "{}");
    folder_.write("manifest.json", "");
    expect_trouble("manifest.json: it is damaged; the cases are taken from manifest.d");
    EXPECT_TRUE(says("manifest.d/foreign.json: this case cannot be understood"));
    EXPECT_TRUE(says("\"bump_shading-reference\""));
}

TEST_F(Report, TellsOfVolumesThatAreMissingDamagedOrForeign) {
    std::vector<CaseRecord> records = write_sample_sweep(path());
    const std::string whole = folder_.read("bump_shading-none.exr");
    std::filesystem::remove(path("bump_shading-none.exr"));
    expect_trouble("bump_shading-none.exr: it is missing");
    folder_.write("bump_shading-none.exr", whole.substr(0, whole.size() / 2));
    expect_trouble("bump_shading-none.exr: the viewer cannot show it");
    EXPECT_TRUE(says("bytes where"));
    std::string flipped = whole;
    flipped[whole.size() / 2] = static_cast<char>(~flipped[whole.size() / 2]);
    folder_.write("bump_shading-none.exr", flipped);
    expect_trouble("bump_shading-none.exr: its contents are not what was written");
    folder_.write("bump_shading-none.exr", whole);
    folder_.write("foreign.exr", "");
    expect_trouble("foreign.exr: not listed in the manifest");
    records[0].files[0].name = "../outside.exr";
    write_sample_manifest(path(), records);
    expect_trouble("../outside.exr: it lies outside of the folder");
    EXPECT_FALSE(says("href=\"../"));
}

TEST_F(Report, TellsOfStudiesThatCannotBeRead) {
    write_sample_study(path("energy"));
    const std::string whole = folder_.read("energy/study.json");
    folder_.write("energy/study.json", whole.substr(0, whole.size() / 2));
    expect_trouble("energy/study.json: it is damaged");
    std::string text = whole;
    text.replace(text.find("0.1.0+sample") - 1, 14, "NaN");
    folder_.write("energy/study.json", text);
    expect_trouble("energy/study.json: it is damaged");
    text = whole;
    text.replace(text.find("\"name\":\"time_ratio\""), 19, "\"name\":\"other_ratio\"");
    folder_.write("energy/study.json", text);
    expect_trouble("the figure error_time cannot be drawn: table points has no column time_ratio");
    EXPECT_TRUE(says("Where the loop is stable")) << "the other figures are shown";
    text = whole;
    text.replace(text.find("\"study\":\"energy\""), 16, "\"study\":\"<b>luck\"");
    folder_.write("energy/study.json", text);
    write();
    EXPECT_FALSE(says("<b>luck"));
}

// As of volumes: a file of the same length with other contents is noticed, too.
TEST_F(Report, TellsOfTablesAndFiguresThatAreMissingOrAltered) {
    write_sample_study(path("energy"));
    write();
    EXPECT_FALSE(says("it is missing"));
    EXPECT_FALSE(says("what was written"));
    for (const char* name : {"energy/points.csv", "energy/error_time.svg"}) {
        const std::string whole = folder_.read(name);
        std::string altered = whole;
        altered[whole.size() / 2] = altered[whole.size() / 2] == '1' ? '2' : '1';
        folder_.write(name, altered);
        expect_trouble(std::string(name) + ": its contents are not what was written");
        folder_.write(name, whole.substr(0, whole.size() - 1));
        expect_trouble(fmt::format("{}: it has {} bytes where {} were written", name, whole.size() - 1, whole.size()));
        std::filesystem::remove(path(name));
        expect_trouble(std::string(name) + ": it is missing");
        EXPECT_FALSE(says(std::string("href=\"") + name + '"')) << "no link to what is not there";
        folder_.write(name, whole);
        write();
        EXPECT_FALSE(says(std::string(name) + ": it")) << "all is well again";
    }
}

TEST_F(Report, OpensWithFindingsAndThenWords) {
    const auto expect_order = [&](const std::vector<std::string>& ids) {
        write();
        std::size_t last = 0;
        for (const std::string& id : ids) {
            const std::size_t at = html_.find("<section id=\"" + id);
            EXPECT_NE(at, std::string::npos) << id;
            EXPECT_GT(at, last) << id;
            last = at;
        }
    };
    write_sample_study(path("energy"));
    expect_order({"study-energy", "words", "device"});
    write_sample_sweep(path());
    expect_order({"study-energy", "words", "sweep-", "viewer", "device"});
    write_sample_study(path("stability"));
    expect_order({"glance", "words", "study-energy", "study-stability", "sweep-", "viewer", "device"});
    std::filesystem::remove_all(path("energy"));
    std::filesystem::remove_all(path("stability"));
    expect_order({"sweep-", "viewer", "words", "device"});
}

TEST_F(Report, ExplainsTheWordsThatOccur) {
    write_sample_study(path("energy"));
    write();
    EXPECT_TRUE(says("<dt>loop</dt>"));
    for (const char* word : {"hollow", "lag", "tricubic", "pop-through"})
        EXPECT_FALSE(says(fmt::format("<dt>{}</dt>", word))) << word;
    write_sample_study(path("energy"), "# In hollows: Tricubic, with a flag; gap-through, lag_s");
    write();
    EXPECT_TRUE(says("<dt>hollow</dt>"));
    EXPECT_TRUE(says("<dt>tricubic</dt>"));
    EXPECT_FALSE(says("<dt>lag</dt>"));
}

TEST_F(Report, CountsNoDifferencesOfTheOracleFromItself) {
    std::vector<CaseRecord> records = write_sample_sweep(path());
    records[0].engine.engine = "cpu";
    write_sample_manifest(path(), records);
    write();
    EXPECT_TRUE(says("\"differing\""));
    EXPECT_TRUE(says("[null,0.0]")) << "of the other case alone";
    records[1].engine.engine = "cpu";
    write_sample_manifest(path(), records);
    write();
    EXPECT_FALSE(says("\"differing\""));
    EXPECT_FALSE(says("\"beyond bound\""));
}

// Of a study that --only chose a part of, nothing is missing.
TEST_F(Report, CallsAPartThatWasChosenNoDamage) {
    write_sample_sweep(path());
    std::string text = folder_.read("manifest.json");
    text.replace(text.find("\"cases_of_study\": 2"), 19, "\"cases_of_study\": 5");
    folder_.write("manifest.json", text);
    EXPECT_EQ(write().troubles.size(), 0u);
    EXPECT_TRUE(says("2 of 5; the same sweep without --only computes the rest"));
}

TEST_F(Report, TellsOfVolumesThatAStudyDoesNotName) {
    write_sample_study(path("energy"));
    folder_.write("energy/left.exr", "");
    expect_trouble("energy/left.exr: not listed in study.json");
}

// Of 21 paths at forces of 0 to 20 N at each moment the 5th percentile is 1 N, the 95th 19 N.
TEST(RunPage, ShowsTheSpreadOfAllPathsAndAFewOfThem) {
    const Folder folder;
    for (const int paths : {21, 4}) {
        std::string csv = "path,t,x,y,z,fx,fy,fz\n";
        for (int path = 0; path < paths; ++path)
            for (int step = 0; step < 10; ++step)
                csv += fmt::format("{},{},{},0,{},0,0,{}\n", 100 + path, step, 0.001 * step, -0.001 * path, path);
        folder.write("run.csv", csv);
        study::StudyData data;
        add_samples(data, folder / "run.csv");
        std::set<std::string> shown;
        for (const std::vector<study::Cell>& row : data.table("samples").rows)
            shown.insert(row[0].text());
        ASSERT_EQ(data.figures.size(), 6u);
        if (paths == 4) {
            EXPECT_EQ(shown.size(), 4u);
            EXPECT_EQ(data.tables.size(), 1u) << "too few for percentiles";
            EXPECT_TRUE(data.figures[0].curves.empty());
            continue;
        }
        EXPECT_EQ(shown, (std::set<std::string>{"path 100", "path 106", "path 112", "path 118"}));
        for (const char* name : {"over_time", "over_place"}) {
            const study::Table& table = data.table(name);
            std::size_t full = 0;
            for (std::size_t row = 0; row < table.rows.size(); ++row) {
                if (table.needed(row, "samples") == 0) {
                    EXPECT_FALSE(table.number(row, "median_force_N"));
                    continue;
                }
                ++full;
                EXPECT_EQ(table.needed(row, "samples"), 21);
                EXPECT_DOUBLE_EQ(table.needed(row, "p05_force_N"), 1);
                EXPECT_DOUBLE_EQ(table.needed(row, "median_force_N"), 10);
                EXPECT_DOUBLE_EQ(table.needed(row, "p95_force_N"), 19);
                EXPECT_NEAR(table.needed(row, "p05_z_mm"), -19, 1e-9);
                EXPECT_EQ(table.needed(row, "median_direction_deg"), 0) << "of the 20 with a force";
            }
            EXPECT_EQ(full, 10u);
        }
        for (const study::Figure& figure : data.figures) {
            ASSERT_EQ(figure.curves.size(), 1u);
            EXPECT_EQ(figure.curves[0].low, "p05_" + figure.y.column);
        }
    }
}

TEST(Addresses, StayBelowTheFolder) {
    EXPECT_EQ(address("energy/curl.exr"), "energy/curl.exr");
    EXPECT_EQ(address("javascript:alert(1)"), "javascript%3Aalert%281%29");
    EXPECT_EQ(address("//host/a"), "%2F/host/a");
    EXPECT_EQ(address("a b?c#d%"), "a%20b%3Fc%23d%25");
    EXPECT_EQ(link("a<b", "a<b"), "<a href=\"a%3Cb\">a&lt;b</a>");
}

} // namespace
} // namespace forceshade::report
