// Experiments, their orders, and their data on the disk: whole, resumed, and damaged.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/experiment/run.h"
#include "host/output/reading.h"

namespace forceshade::experiment {
namespace {

namespace fs = std::filesystem;

class Folder {
public:
    explicit Folder(const std::string& name) : path(fs::temp_directory_path() / ("forceshade_experiment_" + name)) {
        fs::remove_all(path);
    }
    ~Folder() { fs::remove_all(path); }
    const fs::path path;
};

Experiment small(const std::string& more = "") {
    return parse_experiment(
        "[experiment]\ntrials = 2\n" + more +
            "[surface]\nradius = \"600 mil\"\nfacets = [1, 2, 3]\n[force]\nshading = \"reference\"\n",
        "small.toml");
}

std::string complaint(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

std::string complaint_of(const std::string& text) {
    return complaint([&] { parse_experiment(text, "e.toml"); });
}

TEST(Experiments, ThePapersHas504Trials) {
    const Experiment paper = read_experiment({});
    EXPECT_EQ(paper.study.cases.size(), 21u);
    EXPECT_EQ(paper.size(), 504u);
    std::map<std::string, int> right;
    for (const Case& one : paper.study.cases)
        ++right[paper.spec.answers[paper.correct_answer(one).value()].name];
    EXPECT_EQ(right, (std::map<std::string, int>{{"flat", 6}, {"two_poly", 6}, {"three_poly", 6}, {"cylinder", 3}}));
}

TEST(Experiments, ReadTheirResolvedText) {
    const Experiment one = small("practice = 3\nblocks = 2\norder = \"balanced\"\nfeedback = true\n"
                                 "longest_trial = \"500 ms\"\n[[experiment.answer]]\nname = \"few\"\ncorrect_for = "
                                 "\"*facets-[12]*\"\n[[experiment.answer]]\nname = \"many\"\nfacets = 3\n");
    EXPECT_EQ(one.spec.longest_trial, 0.5);
    EXPECT_EQ(one.correct_answer(one.study.cases[2]), 1u);
    const std::string text = resolved_toml(one);
    EXPECT_EQ(resolved_toml(parse_experiment(text, "again.toml")), text);
    EXPECT_EQ(parse_experiment(experiment_schema(), "schema").spec.trials, ExperimentSpec{}.trials);
}

TEST(Experiments, ComplainWithPlaceAndRemedy) {
    EXPECT_EQ(complaint_of("[experiment]\ntrails = 3\n"),
              "e.toml:2:1: unknown key \"trails\" in [experiment]; did you mean \"trials\"?");
    EXPECT_EQ(complaint_of("[experiment]\ntrials = 0\n"), "e.toml:2:10: trials is an integer from 1 to 10000, got 0");
    EXPECT_EQ(complaint_of("[experiment]\nlongest_trial = \"3 N\"\n").substr(0, 14), "e.toml:2:17: \"");
    EXPECT_NE(complaint_of("[experiment]\nfeedback = \"yes\"\n").find("true or false"), std::string::npos);
    EXPECT_NE(complaint_of("[experiment]\ntrials = 3\nblocks = 2\norder = \"balanced\"\n").find("multiple"),
              std::string::npos);
    EXPECT_NE(complaint_of("[[experiment.answer]]\nname = \"Two!\"\n").find("a to z"), std::string::npos);
    EXPECT_NE(complaint_of("[[experiment.answer]]\nname = \"one\"\n").find("2 to 9 answers"), std::string::npos);
    EXPECT_NE(complaint_of("[experimnt]\n").find("did you mean [experiment]?"), std::string::npos);
}

TEST(Orders, AreOfTheSubjectAndSessionAlone) {
    const Experiment paper = read_experiment({});
    const auto conditions = [&](const std::string& subject, std::uint64_t session) {
        std::vector<std::size_t> order;
        for (const Trial& trial : trials_of(paper, subject, session))
            order.push_back(trial.condition);
        return order;
    };
    const auto one = conditions("03", 1);
    EXPECT_EQ(one, conditions("03", 1));
    EXPECT_NE(one, conditions("03", 2));
    EXPECT_NE(one, conditions("04", 1));
    for (std::size_t condition = 0; condition < 21; ++condition)
        EXPECT_EQ(std::ranges::count(one, condition), 24);
}

TEST(Orders, BalancedBlocksHaveEveryConditionEquallyOften) {
    const Experiment one = small("practice = 4\nblocks = 2\norder = \"balanced\"\n");
    std::map<std::uint64_t, std::map<std::size_t, int>> counts;
    for (const Trial& trial : trials_of(one, "01", 1))
        ++counts[trial.block][trial.condition];
    EXPECT_EQ(counts[1], (std::map<std::size_t, int>{{0, 1}, {1, 1}, {2, 1}}));
    EXPECT_EQ(counts[1], counts[2]);
    EXPECT_EQ(counts[0].size(), 3u);
}

TrialOutcome answered(std::size_t answer) {
    TrialOutcome outcome;
    outcome.answer = answer;
    outcome.reaction = 1.5;
    return outcome;
}

TEST(SessionRecords, GoOnWhereTheyStopped) {
    const Folder folder("resume");
    const Experiment one = small();
    const SessionInfo info{"03", 1, "person", "test"};
    std::uint64_t second = 0;
    {
        SessionRecord record(folder.path, one, info);
        record.add(*record.next(), answered(0));
        second = record.next()->number;
        TrialOutcome failed;
        failed.status = "device lost";
        record.add(*record.next(), failed);
    }
    { // the line that a power loss cut off
        std::ofstream(data_files(folder.path)[0], std::ios::app) << "03-1-3,03,1,3,";
    }
    std::vector<std::uint64_t> numbers;
    {
        SessionRecord record(folder.path, one, info);
        EXPECT_NE(record.repaired().find("cut off"), std::string::npos);
        EXPECT_EQ(record.left(), 5u);
        while (const Trial* trial = record.next()) {
            numbers.push_back(trial->number);
            record.add(*trial, answered(1));
        }
    }
    EXPECT_EQ(numbers, (std::vector<std::uint64_t>{3, 4, 5, 6, second})) << "what failed comes at the end";
    const auto rows = read_rows(data_files(folder.path)[0]);
    ASSERT_EQ(rows.size(), 7u);
    EXPECT_EQ(std::ranges::count_if(rows, &TrialRow::counts), 6);
    EXPECT_EQ(rows[0].outcome.reaction, 1.5);
    EXPECT_NE(complaint([&] { SessionRecord(folder.path, one, info); }).find("is complete"), std::string::npos);
    SessionRecord(folder.path, one, {"03", 2, "person", "test"});
}

TEST(SessionRecords, RefuseWhatDoesNotBelong) {
    const Folder folder("refuse");
    const Experiment one = small();
    const SessionInfo info{"03", 1, "person", "test"};
    EXPECT_NE(complaint([&] {
                  SessionRecord(folder.path, one, {"a/b", 1, "", ""});
              }).find("letters and digits"),
              std::string::npos);
    SessionRecord first(folder.path, one, info);
    EXPECT_NE(complaint([&] { SessionRecord(folder.path, one, info); }).find("under way"), std::string::npos);
    EXPECT_NE(complaint([&] {
                  SessionRecord(folder.path, small("seed = 7\n"), {"04", 1, "person", "test"});
              }).find("another experiment"),
              std::string::npos);
    const fs::path data = data_files(folder.path)[0];
    std::ofstream(data, std::ios::app) << "damaged\n";
    EXPECT_NE(complaint([&] { read_rows(data); }).find("data.csv:2:1: is damaged"), std::string::npos);
    const Folder other("other");
    fs::create_directories(other.path);
    std::ofstream(other.path / "letter.txt") << "dear";
    EXPECT_NE(complaint([&] { SessionRecord(other.path, one, info); }).find("is not empty"), std::string::npos);
}

// The published rules: dataset_description.json, names of files, rows as wide as the header, columns described, ids
// that differ.
TEST(SessionRecords, KeepToPsychDs) {
    const Folder folder("psychds");
    const Experiment one = small();
    const auto observer = make_observer(one);
    run_session(one, *observer, {folder.path, {"03", 1, "observer", "simulated"}, true});
    const auto description = nlohmann::json::parse(read_file(folder.path / "dataset_description.json"));
    EXPECT_EQ(description.at("@context"), "https://schema.org");
    EXPECT_EQ(description.at("@type"), "Dataset");
    EXPECT_FALSE(description.at("name").get<std::string>().empty());
    EXPECT_FALSE(description.at("description").get<std::string>().empty());
    std::vector<std::string> variables;
    for (const auto& variable : description.at("variableMeasured"))
        variables.push_back(variable.at("name"));
    const auto files = data_files(folder.path);
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(files[0].filename(), "subject-03_session-1_data.csv");
    const std::string text = read_file(files[0]);
    std::string columns = text.substr(0, text.find('\n')), joined;
    for (const std::string& variable : variables)
        joined += (joined.empty() ? "" : ",") + variable;
    EXPECT_EQ(columns, joined);
    EXPECT_EQ(read_rows(files[0]).size(), 6u);
    EXPECT_TRUE(fs::exists(folder.path / "paths" / "subject-03_session-1_trial-6.csv"));
}

// Answers of many trials against the shares that they were drawn from.
TEST(SimulatedSessions, AnswerByTheObserversShares) {
    const Folder folder("shares");
    const Experiment one = parse_experiment("[experiment]\ntrials = 400\n[surface]\nradius = \"1000 mil\"\nfacets = "
                                            "[2, 3]\n[force]\nshading = [\"none\", \"reference\"]\n",
                                            "e.toml");
    const auto observer = make_observer(one);
    run_session(one, *observer, {folder.path, {"01", 1, "observer", "simulated"}, false});
    const auto rows = read_rows(data_files(folder.path)[0]);
    double chi = 0;
    int degrees = 0;
    for (const Case& stimulus : one.study.cases) {
        const PreparedCase prepared = CasePreparation().prepare(stimulus);
        const Manner manner = manner_of(stimulus.scene);
        const Shares shares =
            answer_shares(passes_over(feature_of(prepared), stroke(prepared, manner)), ObserverParameters{});
        for (std::size_t i = 0; i < kPictures; ++i) {
            const auto count = std::ranges::count_if(rows, [&](const TrialRow& row) {
                return row.condition == stimulus.name && row.answer == kPictureNames[i];
            });
            const double expected = 400 * shares[i];
            chi += (double(count) - expected) * (double(count) - expected) / expected;
        }
        degrees += 3;
    }
    EXPECT_LT(chi, degrees + 4 * std::sqrt(2.0 * degrees)) << degrees << " degrees of freedom";
    EXPECT_GT(chi, 1) << "drawn, not shared out";
}

} // namespace
} // namespace forceshade::experiment
