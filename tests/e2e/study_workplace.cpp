#include "tests/e2e/study_workplace.h"

#include <charconv>

#include "host/output/files.h"

namespace forceshade::testing {
namespace {

using Json = nlohmann::json;

bool is_same(const Json& cell, const std::string& text) {
    if (cell.is_null())
        return text.empty();
    if (cell.is_string())
        return cell.get<std::string>() == text;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() && number == cell.get<double>();
}

// Every name that a figure speaks of is there.
void expect_columns(const Json& data, const Json& figure) {
    const std::string name = figure["name"];
    EXPECT_NE(figure["caption"], "") << name;
    EXPECT_NE(figure["x"]["label"], "") << name;
    EXPECT_NE(figure["y"]["label"], "") << name;
    for (const Json& table : data["tables"]) {
        if (table["name"] != figure["table"])
            continue;
        std::set<std::string> columns{""};
        for (const Json& column : table["columns"])
            columns.insert(column["name"].get<std::string>());
        for (const Json& named : {figure["x"]["column"], figure["y"]["column"], figure["series"], figure["label"],
                                  figure["low"], figure["high"], figure["value"]})
            EXPECT_TRUE(columns.contains(named.get<std::string>())) << name << ": " << named;
        return;
    }
    ADD_FAILURE() << "no table for figure " << name;
}

} // namespace

Outcome Study::run_study(std::vector<std::string> arguments) const {
    Launch launch = this->launch(std::move(arguments));
    launch.timeout = kStudyPatience;
    return run(launch);
}

void Study::expect_study(std::vector<std::string> arguments) const {
    const Outcome outcome = run_study(std::move(arguments));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
}

std::vector<Json> column_of(const Json& table, std::size_t column) {
    const Json& cells = table["cells"][column];
    if (cells.is_array())
        return cells;
    std::vector<Json> all;
    for (const Json& at : cells["at"])
        all.push_back(cells["of"][at.get<std::size_t>()]);
    return all;
}

void Study::expect_csv_as_json(const std::string& folder, const Json& table) const {
    const std::string name = table["name"];
    const std::vector<std::string> lines = lines_of(read_text(path(folder) / (name + ".csv")));
    const std::vector<std::string> header = cells_of(lines[0]);
    ASSERT_EQ(header.size(), table["columns"].size());
    for (std::size_t column = 0; column < header.size(); ++column) {
        EXPECT_EQ(header[column], table["columns"][column]["name"]);
        EXPECT_NE(table["columns"][column]["meaning"], "") << header[column];
    }
    for (std::size_t column = 0; column < header.size(); ++column) {
        const std::vector<Json> cells = column_of(table, column);
        ASSERT_EQ(lines.size(), cells.size() + 1) << name;
        for (std::size_t row = 0; row < cells.size(); ++row) {
            const std::vector<std::string> line = cells_of(lines[row + 1]);
            ASSERT_EQ(line.size(), header.size()) << lines[row + 1];
            EXPECT_TRUE(is_same(cells[row], line[column])) << name << ' ' << header[column] << ": " << line[column];
        }
    }
}

void Study::expect_whole(const std::string& folder, const std::string& study) const {
    const Json data = read_json(folder + "/study.json");
    EXPECT_EQ(data["study"], study);
    EXPECT_FALSE(data["findings"].empty());
    for (const Json& finding : data["findings"]) {
        const std::string text = finding["text"];
        EXPECT_TRUE(text.ends_with('.')) << text;
        for (const char* wrong : {"nan", "inf ", "{}", "  "})
            EXPECT_FALSE(says(text, wrong)) << wrong;
    }
    EXPECT_FALSE(data["tables"].empty());
    for (const Json& table : data["tables"])
        expect_csv_as_json(folder, table);
    EXPECT_TRUE(!data["figures"].empty() || study == "omission") << "of costs, if any is told from a control";
    for (const Json& figure : data["figures"])
        expect_columns(data, figure);
    std::set<std::string> named{"study.json"};
    for (const char* files : {"files", "volumes"})
        for (const Json& file : data[files]) {
            const std::string content = read_text(path(folder) / file["name"].get<std::string>());
            EXPECT_EQ(sha256_of(content), file["sha256"]) << file["name"];
            EXPECT_EQ(content.size(), file["bytes"]);
            named.insert(file["name"].get<std::string>());
        }
    EXPECT_EQ(data["files"].size(), data["tables"].size() + data["figures"].size());
    for (const auto& entry : std::filesystem::directory_iterator(path(folder)))
        EXPECT_TRUE(!entry.is_regular_file() || named.contains(entry.path().filename().string()))
            << entry.path() << " is not named";
    EXPECT_EQ(temporaries_in(path(folder)), std::vector<std::string>{});
}

} // namespace forceshade::testing
