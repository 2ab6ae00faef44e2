// Experiments, their orders, and their data on the disk: whole, resumed, and damaged.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/error.h"
#include "host/experiment/run.h"
#include "host/output/files.h"
#include "host/random.h"
#include "tests/io/folder.h"

namespace forceshade::experiment {
namespace {

namespace fs = std::filesystem;
using forceshade::testing::cells_of;
using forceshade::testing::Folder;
using forceshade::testing::lines_of;
using forceshade::testing::says;
using forceshade::testing::write_text;

Experiment small(const std::string& more = "") {
    return parse_experiment(
        "[experiment]\ntrials = 2\n" + more +
            "[surface]\nradius = \"600 mil\"\nfacets = [1, 2, 3]\n[force]\nshading = \"reference\"\n",
        "small.toml");
}

template <typename Act> std::string complaint(const Act& act) {
    return forceshade::testing::message_of<Error>(act);
}

std::string complaint_of(const std::string& text) {
    return complaint([&] { parse_experiment(text, "e.toml"); });
}

const SessionInfo kSession{"03", 1, "person", "test"};

std::string refusal(const fs::path& folder, const Experiment& one, const SessionInfo& session = kSession) {
    return complaint([&] { SessionRecord(folder, one, session); });
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
    for (const auto& key : experiment_schema_json()) {
        const std::string path = key.at("key"), name = path.substr(path.rfind('.') + 1);
        const bool of_answer = path.find(".answer.") != std::string::npos;
        EXPECT_TRUE(says(experiment_schema(), of_answer ? "# " + name + ": " : name + " = ")) << path;
    }
}

TEST(Experiments, ComplainWithPlaceAndRemedy) {
    EXPECT_EQ(complaint_of("[experiment]\ntrails = 3\n"),
              "e.toml:2:1: unknown key \"trails\" in [experiment]; did you mean \"trials\"?");
    EXPECT_EQ(complaint_of("[experiment]\ntrials = 0\n"), "e.toml:2:10: trials must be from 1 to 10000, got 0");
    EXPECT_EQ(complaint_of("[experiment]\nlongest_trial = \"3 N\"\n").substr(0, 14), "e.toml:2:17: \"");
    EXPECT_TRUE(says(complaint_of("[experiment]\nfeedback = \"yes\"\n"), "true or false"));
    EXPECT_TRUE(says(complaint_of("[experiment]\ntrials = 3\nblocks = 2\norder = \"balanced\"\n"), "multiple"));
    EXPECT_TRUE(says(complaint_of("[[experiment.answer]]\nname = \"Two!\"\n"), "a to z"));
    EXPECT_TRUE(says(complaint_of("[[experiment.answer]]\nname = \"one\"\n"), "2 to 9 answers"));
    EXPECT_TRUE(says(complaint_of("[experimnt]\n"), "did you mean [experiment]?"));
}

// Bumps of so many facets, shaded or not, each against the cylinder of its radius.
Experiment comparison(const std::string& more = "", const std::string& radii = "\"600 mil\"") {
    return parse_experiment("[experiment]\ntask = \"compare\"\nstandard = \"cylinder_bump*\"\ntrials = 4\n" + more +
                                "[surface]\nradius = [" + radii +
                                "]\n[[variant]]\nsurface.kind = \"cylinder_bump\"\n[[variant]]\nsurface.kind = "
                                "\"bump\"\nsurface.facets = [2, 3, 5]\nforce.shading = [\"none\", \"reference\"]\n",
                            "compare.toml");
}

TEST(Comparisons, AreOfEachStimulusWithTheStandardMostLikeIt) {
    const Experiment one = comparison("", "\"600 mil\", \"1000 mil\"");
    ASSERT_EQ(one.conditions.size(), 12u);
    for (const Condition& condition : one.conditions)
        EXPECT_EQ(one.study.cases[*condition.standard].scene.surface.radius,
                  one.stimulus(condition).scene.surface.radius);
    EXPECT_EQ(one.spec.question, "Which one is smoother?");
    EXPECT_EQ(one.correct_answer(Trial{1, 1, 0, 0, true}), 0u) << "the cylinder came first";
    EXPECT_EQ(one.correct_answer(Trial{1, 1, 0, 0, false}), 1u);
    const Experiment shaded = comparison("correct = \"*reference\"\nquestion = \"Which is shaded?\"\n");
    EXPECT_EQ(shaded.correct_answer(Trial{1, 1, 1, 0, true}), 1u) << shaded.study.cases[2].name;
    EXPECT_EQ(shaded.correct_answer(Trial{1, 1, 0, 0, true}), std::nullopt) << "names neither";
    for (const char* more : {"", "interval = \"2 s\"\n", "track = \"facets\"\ntrack_ratio = 1.5\n"}) {
        const std::string text = resolved_toml(comparison(more));
        EXPECT_EQ(resolved_toml(parse_experiment(text, "again.toml")), text);
    }
}

TEST(Comparisons, HaveATrackForEachCombinationOfTheOtherSettings) {
    const Experiment one = comparison("track = \"facets\"\n", "\"600 mil\", \"1000 mil\"");
    ASSERT_EQ(one.tracks.size(), 4u);
    EXPECT_EQ(one.tracks[1].name, "shading reference, radius 600 mil");
    EXPECT_EQ(one.tracks[1].levels, (std::vector<double>{2, 3, 5}));
    EXPECT_FALSE(one.tracks[1].rises) << "the cylinder is above all: many facets are hard to tell from it";
    EXPECT_EQ(one.size(), 16u);
    const Experiment radius = parse_experiment(
        "[experiment]\ntask = \"compare\"\nstandard = \"*600mil\"\ncorrect = \"*600mil\"\nquestion = \"Which is more "
        "curved?\"\ntrack = \"surface.radius\"\n[surface]\nkind = \"cylinder_bump\"\nradius = [\"600 mil\", \"640 "
        "mil\", \"1000 mil\", \"700 mil\"]\n",
        "r.toml");
    ASSERT_EQ(radius.tracks.size(), 1u);
    EXPECT_EQ(radius.tracks[0].name, "all");
    EXPECT_TRUE(radius.tracks[0].rises);
    EXPECT_NEAR(radius.tracks[0].levels[1], 0.01778, 1e-9);
    EXPECT_EQ(radius.track_unit, "m");
}

TEST(Comparisons, ComplainWithPlaceAndRemedy) {
    const std::string compare = "[experiment]\ntask = \"compare\"\n";
    for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
             {"[experiment]\nstandard = \"a*\"\n", "e.toml:2:1: \"standard\" is of the task"},
             {compare, "e.toml:1:1: task = \"compare\" needs a standard"},
             {compare + "standard = \"a*\"\n", "e.toml:3:12: standard = \"a*\" names no case"},
             {compare + "standard = \"*\"\n", "nothing to compare"},
             {compare + "standard = \"*facets-4\"\ntrack = \"facets\"\n[surface]\nfacets = [2, 3, 4, 5]\n",
              "on both sides"}})
        EXPECT_TRUE(says(complaint_of(text), words));
    for (const auto& [more, words] : std::vector<std::pair<std::string, std::string>>{
             {"correct = \"*\"\n", "compare.toml:5:1: say what is asked"},
             {"track = \"facetts\"\n", "did you mean \"facets\"?"},
             {"track = \"shading\"\n", "compare.toml:5:9: track = \"shading\": its values are no single numbers"},
             {"track = \"radius\"\n", "do not differ in it"},
             {"track_ratio = 0.5\n", "1 or more"},
             {"track_ratio = 2\n", "there is no track"},
             {"track = \"facets\"\ntrack_ratio = 2.5\n", "would end at once"},
             {"interval = \"60 s\"\n", "not shorter than longest_trial"},
             {"[[experiment.answer]]\nname = \"a\"\n[[experiment.answer]]\nname = \"b\"\nfacets = 2\n",
              "is of an interval"}})
        EXPECT_TRUE(says(complaint([&, &more = more] { comparison(more); }), words)) << more;
}

// A PNG of 1 x 1 pixels.
constexpr unsigned char kPixel[] = {137, 80, 78,  71, 13, 10, 26, 10,  0,   0,  0,   13, 73,  72,  68,  82, 0,
                                    0,   0,  1,   0,  0,  0,  1,  8,   0,   0,  0,   0,  58,  126, 155, 85, 0,
                                    0,   0,  10,  73, 68, 65, 84, 120, 156, 99, 248, 15, 0,   1,   1,   1,  0,
                                    177, 56, 246, 20, 0,  0,  0,  0,   73,  69, 78,  68, 174, 66,  96,  130};

class Pictures : public ::testing::Test {
protected:
    Experiment with(const std::string& picture) const {
        return parse_experiment("[[experiment.answer]]\nname = \"edge\"\npicture = \"" + picture +
                                    "\"\n[[experiment.answer]]\nname = \"round\"\nfacets = 0\n",
                                "e.toml", folder.path());
    }
    const std::string png{reinterpret_cast<const char*>(kPixel), sizeof kPixel};
    const std::string svg = "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>\n";
    const Folder folder;
};

TEST_F(Pictures, AreCheckedWhenTheExperimentIsRead) {
    folder.write("a.png", png);
    folder.write("a.svg", svg);
    folder.write("half.png", png.substr(0, 50));
    folder.write("letter.png", "Dear all");
    folder.write("page.svg", "<html><svg></svg></html>");
    folder.write("large.png", png + std::string(1 << 20, '.'));
    EXPECT_EQ(with("a.png").spec.answers[0].picture_file(), "edge.png");
    EXPECT_EQ(with("a.svg").spec.answers[0].picture_file(), "edge.svg");
    const auto of = [&](const std::string& name) { return complaint([&] { with(name); }); };
    EXPECT_EQ(of("none.png").find("e.toml:3:11: cannot read "), 0u) << of("none.png");
    EXPECT_TRUE(says(of("half.png"), "half.png cannot be shown: it is damaged"));
    EXPECT_TRUE(says(of("letter.png"), "is no picture"));
    EXPECT_TRUE(says(of("page.svg"), "is no picture"));
    EXPECT_TRUE(says(of("large.png"), "are the most"));
    EXPECT_TRUE(says(of("."), "e.toml:3:11: \".\" is a folder"));
}

TEST_F(Pictures, AreKeptWithTheData) {
    folder.write("a.png", png);
    const Folder data;
    const Experiment one = with("a.png");
    SessionRecord(data.path(), one, kSession);
    EXPECT_EQ(read_file(data / "materials" / "edge.png"), png);
    const fs::path kept = data / "materials" / "experiment.toml";
    EXPECT_EQ(resolved_toml(read_experiment(kept)), read_file(kept));
    SessionRecord(data.path(), one, kSession);
    folder.write("a.png", svg);
    const Experiment changed = with("a.png");
    EXPECT_TRUE(says(refusal(data.path(), changed), "another experiment"));
}

TEST(Orders, HaveTheStandardFirstInHalfOfTheTrialsOfEachCondition) {
    const Experiment one = comparison("practice = 3\n");
    std::map<std::size_t, std::string> places; // F: the standard is first
    const std::vector<Trial> trials = trials_of(one, "01", 1);
    for (const Trial& trial : trials)
        places[trial.condition] += trial.is_practice() ? "" : trial.standard_first ? "F" : "S";
    std::set<std::string> different;
    for (const auto& [condition, word] : places)
        different.insert(word);
    EXPECT_EQ(places.size(), 6u);
    EXPECT_GT(different.size(), 2u) << "by chance, not by turns";
    std::ptrdiff_t first = 0;
    for (const auto& [condition, word] : places) {
        first += std::ranges::count(word, 'F');
        EXPECT_NEAR(double(std::ranges::count(word, 'F')), 2, 1) << word;
    }
    EXPECT_NEAR(double(first), 12, 3);
    const std::vector<Trial> again = trials_of(one, "01", 1), other = trials_of(one, "02", 1);
    EXPECT_TRUE(std::ranges::equal(trials, again, {}, &Trial::standard_first, &Trial::standard_first));
    EXPECT_FALSE(std::ranges::equal(trials, other, {}, &Trial::standard_first, &Trial::standard_first));
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
    const Folder folder;
    const Experiment one = small();
    std::uint64_t second = 0;
    {
        SessionRecord record(folder.path(), one, kSession);
        record.add(*record.next(), answered(0));
        second = record.next()->number;
        TrialOutcome failed;
        failed.status = "device lost";
        record.add(*record.next(), failed);
    }
    { // the line that a power loss cut off
        std::ofstream(data_files(folder.path())[0], std::ios::app) << "03-1-3,03,1,3,";
    }
    std::vector<std::uint64_t> numbers;
    {
        SessionRecord record(folder.path(), one, kSession);
        EXPECT_TRUE(says(record.repaired(), "cut off"));
        EXPECT_EQ(record.left(), 5u);
        while (const auto trial = record.next()) {
            numbers.push_back(trial->number);
            record.add(*trial, answered(1));
        }
    }
    EXPECT_EQ(numbers, (std::vector<std::uint64_t>{3, 4, 5, 6, second})) << "what failed comes at the end";
    const auto rows = read_rows(data_files(folder.path())[0]);
    ASSERT_EQ(rows.size(), 7u);
    EXPECT_EQ(std::ranges::count_if(rows, &TrialRow::counts), 6);
    EXPECT_EQ(rows[0].outcome.reaction, 1.5);
    EXPECT_TRUE(says(refusal(folder.path(), one), "is complete"));
    SessionRecord(folder.path(), one, {"03", 2, "person", "test"});
}

// The first of two kinds of answers that somebody gives who is right at few facets, and else by chance.
TrialOutcome answer_to(const Experiment& experiment, const Trial& trial) {
    const std::uint32_t facets = experiment.stimulus(experiment.conditions[trial.condition]).scene.surface.facets;
    const bool right = facets < 3 || Random(trial.seed, "").below(2) == 0;
    const std::size_t correct = *experiment.correct_answer(trial);
    return answered(right ? correct : 1 - correct);
}

// Every time from the rows alone: reopened after each trial, the conditions are those of one run.
TEST(SessionRecords, ResumeTracksFromTheRows) {
    const Experiment one = comparison("track = \"facets\"\npractice = 2\n");
    const auto run = [&](const fs::path& folder, bool reopen) {
        std::vector<std::string> conditions;
        auto record = std::make_unique<SessionRecord>(folder, one, kSession);
        while (const auto trial = record->next()) {
            conditions.push_back(one.stimulus(one.conditions[trial->condition]).name);
            record->add(*trial, answer_to(one, *trial));
            const bool withdrawn = conditions.size() == 5 && record->withdraw_last();
            EXPECT_EQ(withdrawn, conditions.size() == 5);
            if (reopen && record->next()) {
                record.reset();
                record = std::make_unique<SessionRecord>(folder, one, kSession);
            }
        }
        return conditions;
    };
    const Folder whole, parts;
    const auto conditions = run(whole.path(), false);
    EXPECT_EQ(conditions.size(), 2u + 8 + 1);
    EXPECT_EQ(conditions, run(parts.path(), true));
    const auto rows = read_rows(data_files(whole.path())[0]);
    EXPECT_EQ(rows[0].track, "") << "practice";
    EXPECT_EQ(std::ranges::count(rows, "shading none", &TrialRow::track) +
                  std::ranges::count(rows, "shading reference", &TrialRow::track),
              10);
    for (const TrialRow& row : rows) {
        EXPECT_EQ(row.standard, "cylinder_bump");
        EXPECT_TRUE(row.standard_interval == 1 || row.standard_interval == 2);
    }
}

TEST(SessionRecords, EndTracksWhoseThresholdIsKnown) {
    const Folder folder;
    const Experiment one = comparison("track = \"facets\"\ntrack_ratio = 2\n");
    Experiment longer = one;
    longer.spec.trials = 200;
    SessionRecord record(folder.path(), longer, kSession);
    std::size_t trials = 0;
    while (const auto trial = record.next()) {
        record.add(*trial, answer_to(longer, *trial));
        ++trials;
    }
    EXPECT_LT(trials, 200u) << "of 400";
    EXPECT_GT(trials, 10u);
    EXPECT_EQ(record.left(), 0u);
}

// Rows of before answers had a way and devices a check.
TEST(SessionRecords, OlderRowsAreRead) {
    const Folder folder;
    const Experiment one = small();
    {
        SessionRecord record(folder.path(), one, kSession);
        record.add(*record.next(), answered(0));
        record.keep_device("{}");
        record.keep_device("{}");
    }
    EXPECT_EQ(folder.read("documentation/subject-03_session-1_device.jsonl"), "{}\n{}\n");
    const fs::path file = data_files(folder.path())[0];
    std::string older;
    for (const std::string& line : lines_of(read_file(file)))
        older += line.substr(0, line.rfind(',', line.rfind(',') - 1)) + "\n";
    write_text(file, older);
    const auto rows = read_rows(file);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_TRUE(rows[0].counts());
    EXPECT_EQ(rows[0].outcome.answered_by, "");
    EXPECT_TRUE(says(refusal(folder.path(), one), "an older one began it")) << "rows of two widths are not mixed";
}

TEST(SessionRecords, RefuseWhatDoesNotBelong) {
    const Folder folder;
    const Experiment one = small();
    EXPECT_TRUE(says(refusal(folder.path(), one, {"a/b", 1, "", ""}), "letters and digits"));
    SessionRecord first(folder.path(), one, kSession);
    EXPECT_TRUE(says(refusal(folder.path(), one), "under way"));
    EXPECT_TRUE(says(refusal(folder.path(), small("seed = 7\n"), {"04", 1, "person", "test"}), "another experiment"));
    const fs::path data = data_files(folder.path())[0];
    std::ofstream(data, std::ios::app) << "damaged\n";
    EXPECT_TRUE(says(complaint([&] { read_rows(data); }), "data.csv:2:1: is damaged"));
    const Folder other;
    other.write("letter.txt", "dear");
    EXPECT_TRUE(says(refusal(other.path(), one), "is not empty"));
}

// What a process that was killed left behind: everything but the experiment, which comes last.
TEST(SessionRecords, AreSetUpAnewWhereThatWasCutOff) {
    const Folder folder;
    const Experiment one = small();
    SessionRecord(folder.path(), one, kSession);
    EXPECT_FALSE(fs::exists(folder / ".unfinished"));
    folder.write(".unfinished", "");
    fs::remove(folder / "materials" / "experiment.toml");
    fs::remove(folder / "README.md");
    SessionRecord(folder.path(), one, kSession);
    EXPECT_FALSE(fs::exists(folder / ".unfinished"));
    EXPECT_TRUE(fs::exists(folder / "materials" / "experiment.toml") && fs::exists(folder / "README.md"));
}

TEST(SessionRecords, TwoRigsMayStartTogether) {
    const Experiment one = small();
    for (int times = 0; times < 10; ++times) {
        const Folder folder;
        std::string complaints;
        {
            const std::jthread other([&] { SessionRecord(folder / "data", one, {"04", 1, "person", "test"}); });
            complaints = refusal(folder / "data", one);
        }
        EXPECT_EQ(complaints, "");
        EXPECT_EQ(data_files(folder / "data").size(), 2u);
    }
}

TEST(SessionRecords, CompareExperimentsByWhatTheyMean) {
    const Folder folder;
    const Experiment one = small();
    SessionRecord(folder.path(), one, kSession);
    const fs::path kept = folder / "materials" / "experiment.toml";
    std::string older;
    for (const std::string& line : lines_of(read_file(kept)))
        if (!line.starts_with("max_repeats"))
            older += line + "\n";
    write_text(kept, "# a comment\n" + older);
    SessionRecord(folder.path(), one, {"04", 1, "person", "test"});
}

TEST(SessionRecords, ReadWhatASpreadsheetSavedAndRefuseDamagedCells) {
    const Folder folder;
    const Experiment one = small();
    {
        SessionRecord record(folder.path(), one, kSession);
        record.add(*record.next(), answered(0));
    }
    const fs::path file = data_files(folder.path())[0];
    const std::string text = read_file(file);
    std::string saved = "\xEF\xBB\xBF";
    for (const char c : text)
        saved += c == '\n' ? std::string("\r\n") : std::string(1, c);
    write_text(file, saved);
    {
        SessionRecord record(folder.path(), one, kSession);
        ASSERT_EQ(record.rows().size(), 1u);
        record.add(*record.next(), answered(1));
    }
    EXPECT_EQ(read_rows(file).size(), 2u);
    const auto damaged = [&](const std::string& from, const std::string& to) {
        std::string bad = text;
        bad.replace(bad.find(from, bad.find('\n')), from.size(), to);
        write_text(file, bad);
        return refusal(folder.path(), one);
    };
    const std::string answer = "," + one.spec.answers[0].name + ",";
    EXPECT_TRUE(says(damaged(answer, ",banana,"), "_data.csv:2:", "\"banana\" is no answer of this experiment"));
    EXPECT_TRUE(says(damaged(",1.5,", ",nan,"), "\"nan\" is no reaction_time"));
}

// The published rules: dataset_description.json, names of files, rows as wide as the header, columns described, ids
// that differ.
void expect_psych_ds(const Experiment& one, std::size_t trials, const std::string& path) {
    const Folder folder;
    const auto observer = make_observer(one);
    EXPECT_EQ(run_session(one, *observer, {folder.path(), {"03", 1, "observer", "simulated"}, true}), trials);
    const auto description = nlohmann::json::parse(read_file(folder / "dataset_description.json"));
    EXPECT_EQ(description.at("@context"), "https://schema.org");
    EXPECT_EQ(description.at("@type"), "Dataset");
    EXPECT_FALSE(description.at("name").get<std::string>().empty());
    EXPECT_FALSE(description.at("description").get<std::string>().empty());
    std::vector<std::string> variables;
    for (const auto& variable : description.at("variableMeasured"))
        variables.push_back(variable.at("name"));
    const auto files = data_files(folder.path());
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(files[0].filename(), "subject-03_session-1_data.csv");
    const std::vector<std::string> lines = lines_of(read_file(files[0]));
    EXPECT_EQ(cells_of(lines.at(0)), variables);
    EXPECT_EQ(bool(says(lines[0], "standard")), one.spec.task == Task::compare);
    EXPECT_EQ(read_rows(files[0]).size(), trials);
    const std::string samples = read_file(folder / "paths" / path);
    const std::size_t last = samples.rfind(',') + 1;
    EXPECT_TRUE(std::ranges::any_of(one.study.cases,
                                    [&](const Case& stimulus) {
                                        return samples.substr(last) ==
                                               sha256_of(resolved_toml(stimulus)).substr(0, 16) + "\n";
                                    }))
        << "of which scene a sample is: " << samples.substr(last);
    EXPECT_EQ(description.at("schemaVersion"), "Psych-DS 1.5.1");
    // Rules of files: in the root these alone, in data/ names of keys and values; some folders are never looked at, and
    // those that .psychds-ignore names.
    const std::set<std::string> root{"dataset_description.json", "README.md", ".psychds-ignore"},
        free{"materials", "documentation", "analysis", "results"};
    const std::regex name("([a-z]+-[a-zA-Z0-9]+)(_[a-z]+-[a-zA-Z0-9]+)*_data\\.(csv|tsv)");
    const std::string ignored = read_file(folder / ".psychds-ignore");
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
        const fs::path inside = entry.path().lexically_relative(folder.path());
        const std::string top = inside.begin()->string();
        if (entry.is_directory() || free.contains(top) || says("\n" + ignored, "\n" + top + "/\n"))
            continue;
        EXPECT_TRUE(top == "data" ? std::regex_match(inside.filename().string(), name) : root.contains(top)) << inside;
    }
    std::set<std::string> ids;
    for (const std::string& line : lines)
        EXPECT_TRUE(ids.insert(cells_of(line)[0]).second) << "row_id " << line;
}

TEST(SessionRecords, KeepToPsychDs) {
    expect_psych_ds(small(), 6, "subject-03_session-1_trial-6.csv");
    expect_psych_ds(comparison(), 24, "subject-03_session-1_trial-24_interval-2.csv");
    expect_psych_ds(comparison("track = \"facets\"\n"), 8, "subject-03_session-1_trial-8_interval-1.csv");
}

// Answers of many trials against the shares that they were drawn from.
TEST(SimulatedSessions, AnswerByTheObserversShares) {
    const Folder folder;
    const Experiment one = parse_experiment("[experiment]\ntrials = 400\n[surface]\nradius = \"1000 mil\"\nfacets = "
                                            "[2, 3]\n[force]\nshading = [\"none\", \"reference\"]\n",
                                            "e.toml");
    const auto observer = make_observer(one);
    run_session(one, *observer, {folder.path(), {"01", 1, "observer", "simulated"}, false});
    const auto rows = read_rows(data_files(folder.path())[0]);
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
