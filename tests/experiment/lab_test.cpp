// What a lab says of its experiment: orders, a list of conditions, its own words and texts, catch trials, participants.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/experiment/page_text.h"
#include "host/experiment/record.h"
#include "tests/io/folder.h"

namespace forceshade::experiment {
namespace {

using forceshade::testing::Folder;
using forceshade::testing::message_of;
using forceshade::testing::says;

class Lab : public ::testing::Test {
protected:
    // Of bumps of these facets, with and without shading.
    Experiment experiment(const std::string& keys, const std::string& facets = "2, 3") const {
        return parse_experiment("[experiment]\n" + keys + "\n[surface]\nradius = \"600 mil\"\nfacets = [" + facets +
                                    "]\n[force]\nshading = [\"none\", \"reference\"]\n",
                                "e.toml", folder.path());
    }
    std::string refusal(const std::string& keys) const {
        return message_of<UsageError>([&] { experiment(keys); });
    }

    static std::vector<std::size_t> order_of(const Experiment& one, const std::string& subject) {
        std::vector<std::size_t> order;
        for (const Trial& trial : trials_of(one, subject, 1))
            order.push_back(trial.condition);
        return order;
    }

    const Folder folder;
};

// Williams 1949: over the rows every condition stands at every place, and follows every other, equally often.
TEST_F(Lab, LatinSquaresAreBalanced) {
    for (const std::size_t n : {1u, 2u, 4u, 5u, 6u, 7u, 14u}) {
        const std::size_t rows = n % 2 == 0 ? n : 2 * n;
        std::map<std::pair<std::size_t, std::size_t>, int> places, follows;
        for (std::size_t row = 0; row < rows; ++row) {
            const std::vector<std::size_t> places_of = latin_row(n, row);
            EXPECT_EQ(std::set<std::size_t>(places_of.begin(), places_of.end()).size(), n);
            for (std::size_t i = 0; i < n; ++i) {
                ++places[{i, places_of[i]}];
                if (i > 0)
                    ++follows[{places_of[i - 1], places_of[i]}];
            }
        }
        EXPECT_EQ(places.size(), n * n);
        EXPECT_EQ(follows.size(), n * (n - 1)) << n;
        for (const auto& [what, times] : places)
            EXPECT_EQ(times, int(rows / n)) << n;
        for (const auto& [what, times] : follows)
            EXPECT_EQ(times, int(rows / n)) << n << ": " << what.second << " after " << what.first;
    }
}

TEST_F(Lab, SubjectsTakeTheRowsOfASquareInTurn) {
    const Experiment latin = experiment("trials = 2\norder = \"latin\"");
    std::set<std::vector<std::size_t>> orders;
    for (const char* subject : {"01", "s02", "3", "04"})
        orders.insert(order_of(latin, subject));
    EXPECT_EQ(orders.size(), 4u) << "a row of four each";
    const std::vector<std::size_t> first = order_of(latin, "01"), second = order_of(latin, "02");
    EXPECT_TRUE(std::equal(first.begin() + 4, first.end(), second.begin())) << "its repetition is the next row";
    EXPECT_EQ(first, order_of(latin, "05"));
    EXPECT_EQ(order_of(latin, "anna"), order_of(latin, "anna"));
}

TEST_F(Lab, BlocksAreOfAFactorsValues) {
    for (const char* order : {"random", "latin", "sequential"}) {
        const Experiment one = experiment("trials = 3\nblock_by = \"shading\"\norder = \"" + std::string(order) + "\"");
        std::map<std::uint64_t, std::set<bool>> shaded;
        std::map<std::size_t, int> times;
        for (const Trial& trial : trials_of(one, "01", 1)) {
            shaded[trial.block].insert(one.stimulus(one.conditions[trial.condition]).scene.force.shading !=
                                       Shading::none);
            ++times[trial.condition];
        }
        EXPECT_EQ(shaded.size(), 2u) << order;
        for (const auto& [block, values] : shaded)
            EXPECT_EQ(values.size(), 1u) << order;
        EXPECT_EQ(times, (std::map<std::size_t, int>{{0, 3}, {1, 3}, {2, 3}, {3, 3}})) << order;
    }
    const auto first_block = [&](const std::string& subject) {
        const Experiment one = experiment("trials = 1\nblock_by = \"force.shading\"\norder = \"latin\"");
        return one.stimulus(one.conditions[order_of(one, subject).front()]).scene.force.shading;
    };
    EXPECT_NE(first_block("1"), first_block("2")) << "the order of blocks is balanced, too";
    std::map<std::size_t, int> first; // of four subjects
    for (const char* subject : {"1", "2", "3", "4"})
        ++first[order_of(experiment("trials = 1\nblock_by = \"shading\"\norder = \"latin\""), subject).front()];
    EXPECT_EQ(first.size(), 4u) << "every condition begins a session";
    EXPECT_TRUE(says(refusal("block_by = \"radius\""), "e.toml:2:", "radius", "do not differ"));
    EXPECT_TRUE(says(refusal("block_by = \"shading\"\nblocks = 2\ntrials = 2"), "e.toml:2:", "makes the blocks"));
}

TEST_F(Lab, ConditionsAreThoseOfTheFile) {
    folder.write("c.csv", "shading,facets\r\nreference,3\r\nnone,2\r\nreference,3\r\n");
    const Experiment listed = experiment("trials = 2\norder = \"sequential\"\nconditions = \"c.csv\"");
    EXPECT_EQ(listed.size(), 6u);
    EXPECT_EQ(listed.asked().size(), 2u);
    for (const Trial& trial : trials_of(experiment("practice = 9\nconditions = \"c.csv\""), "01", 1))
        EXPECT_EQ(std::ranges::count(listed.asked(), trial.condition), 1) << "nor practice has others";
    std::vector<std::string> names;
    for (const Trial& trial : trials_of(listed, "01", 1))
        names.push_back(listed.stimulus(listed.conditions[trial.condition]).name);
    ASSERT_EQ(names.size(), 6u);
    EXPECT_TRUE(says(names[0], "facets-3", "reference"));
    EXPECT_TRUE(says(names[1], "facets-2"));
    EXPECT_EQ(names[2], names[0]);
    EXPECT_EQ(names[3], names[0]);
    folder.write("c.csv", "case\n" + names[1] + "\n");
    EXPECT_EQ(experiment("conditions = \"c.csv\"").listed.size(), 1u);
    const auto refused = [&](const std::string& csv, const std::vector<std::string>& words) {
        folder.write("c.csv", csv);
        EXPECT_TRUE(says(refusal("conditions = \"c.csv\""), words));
    };
    refused("facet\n2\n", {"c.csv:1:1", "\"facet\"", "surface.facets"});
    refused("facets\n2\n", {"c.csv:2:1", "2 of the 4"});
    refused("facets,shading\n9,none\n", {"c.csv:2:1", "none of the 4"});
    refused("facets,shading\n2\n", {"1 cells", "2 columns"});
    refused("facets\n", {"no row"});
}

TEST_F(Lab, WordsAreAnyLanguagesAndStayWithTheData) {
    folder.write("ja.md", "# 同意書\n\n実験に**参加**します。\n");
    const std::string keys = "consent = \"ja.md\"\n[experiment.text]\nlanguage = \"ja\"\nspace = \"スペース\"\n"
                             "welcome_hint = \"{space}キーを押してください。\"\nlift = \"Levez la sonde, s’il vous "
                             "plaît.\"\n";
    const Experiment given = experiment(keys);
    const auto texts = texts_with(given.spec.text);
    EXPECT_EQ(texts.at("welcome_hint"), "{space}キーを押してください。");
    EXPECT_EQ(texts.at("done"), "That was all. Thank you!") << "what is not given is English";
    const SessionRecord record(folder / "data", given, {.subject = "01", .participant = "person", .device = "sim"});
    record.keep_participant({31, "left"});
    record.keep_participant({31, "left"});
    EXPECT_EQ(folder.read("data/documentation/participants.csv"), "subject,session,age_years,hand\n01,1,31,left\n");
    const Experiment kept = read_experiment(folder / "data/materials/experiment.toml");
    EXPECT_EQ(kept.spec.text, given.spec.text);
    EXPECT_EQ(kept.spec.consent.bytes, given.spec.consent.bytes);
    EXPECT_EQ(resolved_toml(kept), resolved_toml(given));
    folder.write("ja.md", "another");
    EXPECT_THROW(
        SessionRecord(folder / "data", experiment(keys), {.subject = "02", .participant = "person", .device = "sim"}),
        UsageError);

    EXPECT_TRUE(says(refusal("[experiment.text]\nwelcom = \"x\""), "e.toml:3:1", "welcome"));
    EXPECT_TRUE(says(refusal("[experiment.text]\nwelcome_hint = \"{button}\""), "e.toml:3:", "{button}", "{space}"));
    EXPECT_TRUE(says(refusal("[experiment.text]\ndone = \"\""), "e.toml:3:", "done is a text"));
    EXPECT_TRUE(says(refusal("consent = \"gone.md\""), "e.toml:2:", "gone.md"));
    EXPECT_TRUE(says(refusal("break_least = \"60 s\""), "e.toml:2:", "no break"));
}

TEST_F(Lab, WhoMissesCatchTrialsIsLeftOut) {
    const Experiment caught = experiment("trials = 4\ncatch = \"*facets-2*none*\"\ncatch_least = 0.75");
    const auto answer_all = [&](const std::string& subject, std::size_t wrong) {
        SessionRecord record(folder / "data", caught, {.subject = subject, .participant = "person", .device = "sim"});
        while (const std::optional<Trial> trial = record.next()) {
            TrialOutcome outcome;
            const bool is_catch = caught.is_catch(caught.stimulus(caught.conditions[trial->condition]).name);
            const std::size_t right = *caught.correct_answer(*trial);
            outcome.answer = is_catch && wrong > 0 ? (wrong--, (right + 1) % 4) : right;
            record.add(*trial, outcome);
        }
    };
    answer_all("01", 1);
    EXPECT_EQ(read_answers({folder / "data"}).excluded.size(), 0u) << "three of four are enough";
    answer_all("02", 2);
    const Answers answers = read_answers({folder / "data"});
    EXPECT_EQ(answers.excluded, std::vector<std::string>{"02 (2 of 4 catch trials right)"});
    EXPECT_EQ(answers.subjects(), std::vector<std::string>{"01"});
    EXPECT_EQ(answers.rows.size(), 16u);
    EXPECT_TRUE(says(refusal("catch = \"*facets-9*\""), "e.toml:2:", "names no stimulus"));
    EXPECT_TRUE(says(refusal("catch = \"*\"\ncatch_least = 1.5"), "at most 1"));
}

} // namespace
} // namespace forceshade::experiment
