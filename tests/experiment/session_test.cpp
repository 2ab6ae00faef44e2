// A person's session at a simulated device, by keys in headless Chromium: killed in the middle, resumed, finished.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/experiment/analysis.h"
#include "host/experiment/record.h"
#include "host/output/files.h"
#include "tests/e2e/process.h"
#include "tests/io/folder.h"
#include "tests/report/browser.h"

namespace forceshade::experiment {
namespace {

using forceshade::testing::Browser;
using forceshade::testing::cells_of;
using forceshade::testing::Folder;
using forceshade::testing::Launch;
using forceshade::testing::lines_of;
using forceshade::testing::Outcome;
using forceshade::testing::Process;
using forceshade::testing::says;
using forceshade::testing::with;

constexpr const char* kPhase = "document.body.dataset.phase";

class Session : public ::testing::Test {
protected:
    Session() {
        folder.write("e.toml", "[experiment]\nleast_contact = \"0 s\"\ntrials = 1\nblocks = 2\n[surface]\n"
                               "radius = \"600 mil\"\nfacets = [2, 3]\n[force]\nshading = [\"none\", \"reference\"]\n");
    }

    void start(const std::string& session = "1", const std::vector<std::string>& further = {}) {
        Launch launch;
        launch.arguments =
            with({"experiment", "run", folder / "e.toml", "--subject", "03", "--session", session, "--out", data()},
                 further);
        launch.error = folder / "stderr.txt";
        for (int i = 0; i < 3; ++i) { // a check in real time can fail where the machine is busy
            std::filesystem::remove(launch.error);
            process = std::make_unique<Process>(launch);
            while (process->running() && address("operator").empty())
                std::this_thread::sleep_for(std::chrono::milliseconds(25));
            if (!says(said(), "did not pass its check"))
                break;
        }
        ASSERT_FALSE(address("operator").empty()) << said();
    }
    std::string address(const std::string& page) const {
        const std::string text = said();
        const std::size_t end = text.find("/" + page + "\n");
        const std::size_t begin = end == std::string::npos ? end : text.rfind("http://", end);
        return begin == std::string::npos ? "" : text.substr(begin, end - begin) + "/" + page;
    }
    std::string said() const { return folder.read("stderr.txt"); }
    bool reaches(const std::string& phase) { return browser.wait_for(std::string(kPhase) + " === '" + phase + "'"); }
    void begin() {
        browser.open_address(address("participant"));
        ASSERT_TRUE(reaches("welcome") || reaches("pause"));
        browser.press(" ");
    }
    // What a command that is refused says.
    std::string refusal(const std::vector<std::string>& further, int code = 2) const {
        Launch launch;
        launch.arguments = with({"experiment", "run", folder / "e.toml", "--subject", "04", "--out", data()}, further);
        const Outcome outcome = Process(launch).wait();
        EXPECT_EQ(outcome.code, code) << outcome.error;
        return outcome.error;
    }
    std::vector<TrialRow> rows() const { return read_rows(data_files(data())[0]); }
    std::filesystem::path data() const { return folder / "data"; }

    const Folder folder;
    Browser browser;
    std::unique_ptr<Process> process;
};

TEST_F(Session, IsKilledResumedAndFinishedWithEveryTrialOnce) {
    start();
    begin();
    ASSERT_TRUE(reaches("feel")) << browser.text("document.body.textContent");
    EXPECT_EQ(browser.text("document.querySelectorAll('.answer svg path').length"), "4") << "four pictures";
    EXPECT_EQ(browser.evaluate("document.documentElement.scrollHeight <= innerHeight"), true) << "nothing to scroll";
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    browser.press("2");
    browser.press("3"); // a second key does not count
    ASSERT_TRUE(browser.wait_for("document.body.dataset.trial === '2'"));
    ASSERT_TRUE(reaches("feel"));
    EXPECT_EQ(browser.text("document.querySelectorAll('.answer.chosen').length"), "0") << "that of the trial before";
    process->send(SIGKILL);
    process->wait();
    ASSERT_EQ(rows().size(), 1u) << "the running trial alone is lost";
    EXPECT_EQ(rows()[0].answer, "two_poly");

    start();
    begin();
    for (int i = 0; i < 20 && browser.text(kPhase) != "done"; ++i) {
        ASSERT_TRUE(browser.wait_for(std::string("['feel', 'rest', 'done'].includes(") + kPhase + ")"));
        const std::string phase = browser.text(kPhase);
        if (phase == "rest")
            browser.press(" ");
        else if (phase == "feel") {
            std::this_thread::sleep_for(std::chrono::milliseconds(900));
            browser.press("4");
            ASSERT_TRUE(browser.wait_for(std::string(kPhase) + " !== 'feel'"));
        }
    }
    EXPECT_TRUE(reaches("done"));
    const Outcome outcome = process->wait();
    EXPECT_EQ(outcome.code, 0) << said();
    std::map<std::uint64_t, int> answered;
    for (const TrialRow& row : rows())
        answered[row.number] += row.counts();
    EXPECT_EQ(answered, (std::map<std::uint64_t, int>{{1, 1}, {2, 1}, {3, 1}, {4, 1}}));
    const TrialRow last = rows().back();
    EXPECT_EQ(last.participant, "person");
    EXPECT_GT(last.outcome.reaction, 0.5);
    EXPECT_GT(last.outcome.contact, 0.3);
    EXPECT_GT(last.outcome.largest_force, 0.5);
    EXPECT_EQ(read_answers({data()}).rows.size(), 4u);

    // The path that was recorded gives the same forces, digit for digit.
    const std::string name = "subject-03_session-1_trial-" + std::to_string(last.number) + ".csv";
    Launch explore;
    explore.arguments = {"explore",     data() / "materials" / "stimuli" / (last.condition + ".toml"),
                         "--paths",     data() / "paths" / name,
                         "--out",       folder / "again.csv",
                         "--engine",    "cpu",
                         "--precision", "f64"};
    const Outcome explored = Process(explore).wait();
    ASSERT_EQ(explored.code, 0) << explored.error;
    const auto lines = [](const std::filesystem::path& file) {
        std::vector<std::vector<std::string>> cut;
        for (const std::string& line : lines_of(read_file(file))) {
            std::vector<std::string>& cells = cut.emplace_back(cells_of(line));
            cells.resize(13); // to the facet
            cells.erase(cells.begin());
        }
        return cut;
    };
    const auto recorded = lines(data() / "paths" / name), again = lines(folder / "again.csv");
    EXPECT_GT(recorded.size(), 500u);
    EXPECT_EQ(recorded, again);
}

// A lab's own words, consent, instructions, known answers, breaks: a session by keys in which no English is left.
TEST_F(Session, IsHeldInAnotherLanguage) {
    const std::map<std::string, std::string> german{{"language", "de"},
                                                    {"space", "Leertaste"},
                                                    {"progress", "erledigte Durchgänge"},
                                                    {"connecting", "Verbindung …"},
                                                    {"consent_hint", "Drücken Sie {space}, wenn Sie zustimmen."},
                                                    {"instructions_hint", "Weiter mit {space}."},
                                                    {"welcome", "Bereit?"},
                                                    {"welcome_hint", "Beginnen Sie mit {space}."},
                                                    {"familiar", "Das ist „{answer}“."},
                                                    {"familiar_hint", "Fühlen Sie in Ruhe, dann weiter mit {space}."},
                                                    {"lift", "Heben Sie die Sonde ab."},
                                                    {"next_hint", "Die nächste Form kommt."},
                                                    {"answer_hint", "Antworten Sie mit {first} bis {last}."},
                                                    {"answered", "Danke."},
                                                    {"right", "Richtig."},
                                                    {"wrong", "Leider nicht."},
                                                    {"rest", "Zeit für eine Pause."},
                                                    {"rest_wait", "Weiter in {seconds} Sekunden."},
                                                    {"rest_hint", "Weiter mit {space}, wann Sie möchten."},
                                                    {"pause", "Pause."},
                                                    {"pause_hint", "Weiter mit {space}, sobald Sie so weit sind."},
                                                    {"page_closed", "Die Seite wurde geschlossen."},
                                                    {"done", "Das war alles."},
                                                    {"done_hint", "Sie können die Seite schließen."}};
    std::string text;
    std::vector<std::string> known{
        "Welche Form war es?", "eine Kante",    "eine Fläche", "Einverständnis", "Ich nehme freiwillig teil.",
        "Anleitung",           "Streichen Sie", "langsam",     "über die Form."};
    for (const auto& [key, sentence] : german) {
        text += key + " = \"" + sentence + "\"\n";
        for (std::size_t from = 0; from < sentence.size();) {
            const std::size_t open = std::min(sentence.find('{', from), sentence.size());
            known.push_back(sentence.substr(from, open - from));
            from = open < sentence.size() ? sentence.find('}', open) + 1 : open;
        }
    }
    std::ranges::sort(known, std::ranges::greater(), &std::string::size);
    folder.write("zu.md", "# Einverständnis\n\nIch nehme freiwillig teil.\n");
    folder.write("an.md", "# Anleitung\n\n- Streichen Sie **langsam**\n- über die Form.\n");
    folder.write(
        "e.toml",
        "[experiment]\nleast_contact = \"0 s\"\ntrials = 1\nquestion = \"Welche Form war es?\"\nfeedback = true\n"
        "consent = \"zu.md\"\ninstructions = \"an.md\"\nfamiliarise = true\nbreak_every = 1\nbreak_least = \"5 s\"\n"
        "[experiment.text]\n" +
            text +
            "[[experiment.answer]]\nname = \"edge\"\nlabel = \"eine Kante\"\nfacets = 2\n[[experiment.answer]]\n"
            "name = \"level\"\nlabel = \"eine Fläche\"\nfacets = 3\n[surface]\nradius = \"600 mil\"\nfacets = [2, "
            "3]\n");
    const auto expect_german = [&](const std::string& phase) {
        ASSERT_TRUE(reaches(phase)) << browser.text("document.body.innerText");
        std::string seen = browser.text("document.querySelector('main').innerText");
        EXPECT_NE(seen.find_first_not_of(" \n"), std::string::npos) << phase;
        for (const std::string& words : known)
            for (std::size_t at = words.empty() ? seen.npos : seen.find(words); at != seen.npos; at = seen.find(words))
                seen.erase(at, words.size());
        EXPECT_TRUE(std::ranges::none_of(seen, [](unsigned char c) { return std::isalpha(c); }))
            << phase << ": " << seen;
    };
    start("1", {"--age", "31", "--hand", "left"});
    browser.open_address(address("participant"));
    expect_german("consent");
    EXPECT_EQ(browser.text("document.documentElement.lang"), "de");
    Browser desk;
    desk.open_address(address("operator"));
    for (const char* after : {"Go on", "Pause"}) {
        desk.press("p");
        ASSERT_TRUE(
            desk.wait_for("document.getElementById('pause').textContent.startsWith('" + std::string(after) + "')"));
    }
    EXPECT_EQ(browser.text(kPhase), "consent") << "the operator agrees for nobody";
    EXPECT_EQ(browser.text("document.querySelector('#page h2').textContent"), "Einverständnis");
    browser.press(" ");
    expect_german("instructions");
    EXPECT_EQ(browser.text("document.querySelector('#page li strong').textContent"), "langsam");
    browser.press(" ");
    for (const char* label : {"eine Kante", "eine Fläche"}) {
        ASSERT_TRUE(browser.wait_for("document.getElementById('head').textContent === 'Das ist „" + std::string(label) +
                                     "“.'"));
        expect_german("familiar");
        EXPECT_EQ(browser.text("[...document.querySelectorAll('.answer')].filter((one) => !one.hidden).length"), "1");
        browser.press(" ");
    }
    expect_german("welcome");
    browser.press(" ");
    expect_german("feel");
    browser.open_address("data:text/html,gone");
    browser.open_address(address("participant"));
    expect_german("pause");
    EXPECT_TRUE(browser.wait_for("document.getElementById('hints').innerText.includes('sobald')"))
        << "its reason, and how to go on once the break was long enough";
    browser.press(" ");
    expect_german("feel");
    browser.press("1");
    expect_german("rest");
    EXPECT_TRUE(says(browser.text("document.getElementById('hints').innerText"), "Sekunden"));
    browser.press(" ");
    EXPECT_EQ(browser.text(kPhase), "rest") << "the break has a least length";
    ASSERT_TRUE(browser.wait_for("document.getElementById('hints').textContent.includes('möchten')"));
    browser.press(" ");
    for (int i = 0; i < 4 && !rows().empty() && browser.text(kPhase) != "done"; ++i) {
        ASSERT_TRUE(browser.wait_for(std::string("['feel', 'rest', 'done'].includes(") + kPhase + ")"));
        if (browser.text(kPhase) == "rest") {
            ASSERT_TRUE(browser.wait_for("document.getElementById('hints').textContent.includes('möchten')"));
            browser.press(" ");
        } else if (browser.text(kPhase) == "feel") {
            browser.press("2");
            ASSERT_TRUE(browser.wait_for(std::string(kPhase) + " !== 'feel'"));
        }
    }
    expect_german("done");
    EXPECT_EQ(process->wait().code, 0) << said();
    EXPECT_TRUE(says(read_file(data() / "documentation" / "subject-03_session-1_notes.csv"), "agreed"));
    EXPECT_TRUE(says(read_file(data() / "documentation" / "participants.csv"), "03,1,31,left"));
}

// Two stimuli a trial, by keys, with a picture from a file; killed in the second trial's first interval.
TEST_F(Session, ComparesTwoStimuliAndResumesWithTheSameOrder) {
    folder.write("one.svg", "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\"/>");
    folder.write(
        "e.toml",
        "[experiment]\nleast_contact = \"0 s\"\ntask = \"compare\"\nstandard = \"cylinder_bump*\"\ntrials = 1\n"
        "[[experiment.answer]]\nname = \"one\"\npicture = \"one.svg\"\n[[experiment.answer]]\nname = \"two\"\n"
        "[surface]\nradius = \"600 mil\"\n[[variant]]\nsurface.kind = \"cylinder_bump\"\n[[variant]]\n"
        "surface.kind = \"bump\"\nsurface.facets = [2, 3]\n");
    start();
    begin();
    ASSERT_TRUE(reaches("first")) << browser.text("document.body.textContent");
    browser.press("1"); // no answer yet
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    browser.press(" ");
    ASSERT_TRUE(reaches("feel"));
    EXPECT_EQ(browser.evaluate("document.querySelector('.answer img').naturalWidth"), 20) << "the picture is there";
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    browser.press("2");
    ASSERT_TRUE(browser.wait_for("document.body.dataset.trial === '2'"));
    ASSERT_TRUE(reaches("first"));
    process->send(SIGKILL);
    process->wait();
    ASSERT_EQ(rows().size(), 1u);

    start();
    begin();
    ASSERT_TRUE(reaches("first"));
    browser.press(" ");
    ASSERT_TRUE(reaches("feel"));
    std::this_thread::sleep_for(std::chrono::milliseconds(900));
    browser.press("1");
    EXPECT_TRUE(reaches("done"));
    EXPECT_EQ(process->wait().code, 0) << said();
    const std::vector<TrialRow> all = rows();
    ASSERT_EQ(all.size(), 2u);
    const std::string order = read_file(data() / "materials" / "order" / "subject-03_session-1.csv");
    for (const TrialRow& row : all) {
        const bool chose_standard = (row.answer == "one") == (row.standard_interval == 1);
        EXPECT_EQ(row.correct, chose_standard) << "the cylinder is the smoother one";
        EXPECT_TRUE(says(order, "\n" + std::to_string(row.number) + ",1," + row.condition + "," +
                                    std::to_string(row.standard_interval) + ","));
    }
    EXPECT_NE(all[0].condition, all[1].condition);
    EXPECT_EQ(all[0].answer, "two");
    EXPECT_GT(all[0].outcome.contact, 0.8) << "of both intervals";
    for (const char* interval : {"1", "2"}) {
        const std::string log =
            read_file(data() / "paths" / ("subject-03_session-1_trial-1_interval-" + std::string(interval) + ".csv"));
        EXPECT_GT(std::ranges::count(log, '\n'), 500);
    }
    EXPECT_EQ(read_answers({data()}).rows.size(), 2u);
}

TEST_F(Session, ShowsEachStimulusForItsInterval) {
    folder.write("e.toml", "[experiment]\nleast_contact = \"0 s\"\ntask = \"compare\"\nstandard = \"*facets-3\"\n"
                           "trials = 1\ninterval = \"500 ms\"\n[surface]\nradius = \"600 mil\"\nfacets = [2, 3]\n");
    start("1", {"--check", "now"});
    begin();
    ASSERT_TRUE(reaches("feel")) << "without a key";
    Browser desk;
    desk.open_address(address("operator"));
    EXPECT_TRUE(desk.wait_for("document.getElementById('safety').textContent === 'no force'"));
    EXPECT_EQ(browser.text(kPhase), "feel") << "still to be answered";
    browser.press("2");
    EXPECT_TRUE(reaches("done"));
    EXPECT_EQ(process->wait().code, 0) << said();
    ASSERT_EQ(rows().size(), 1u);
    EXPECT_EQ(rows()[0].device_check, "passed");
    EXPECT_EQ(rows()[0].outcome.answered_by, "key");
    EXPECT_LT(rows()[0].outcome.contact, 1.2) << "s: of two intervals";
    EXPECT_GT(rows()[0].outcome.contact, 0.3);
}

TEST_F(Session, PausesWhenThePageIsClosedAndRefusesASecondPage) {
    start();
    begin();
    ASSERT_TRUE(reaches("feel"));
    Browser other;
    other.open_address(address("participant"));
    EXPECT_TRUE(other.wait_for("document.body.dataset.phase === 'taken'"));
    browser.open_address("data:text/html,gone"); // closes the page
    Browser desk;
    desk.open_address(address("operator"));
    EXPECT_TRUE(desk.wait_for("document.getElementById('page').textContent === 'closed'"));
    EXPECT_TRUE(desk.wait_for("document.getElementById('safety').textContent === 'no force'"));
    browser.open_address(address("participant"));
    ASSERT_TRUE(reaches("pause"));
    browser.press(" ");
    ASSERT_TRUE(reaches("feel"));
    desk.press("p");
    EXPECT_TRUE(reaches("pause"));
    EXPECT_TRUE(desk.wait_for("document.getElementById('pause').textContent.startsWith('Go on')"));
    desk.press("p");
    ASSERT_TRUE(reaches("feel"));
    browser.press("1");
    ASSERT_TRUE(browser.wait_for(std::string(kPhase) + " !== 'feel'"));
    ASSERT_TRUE(reaches("feel"));
    desk.press("r"); // a stray key does nothing
    EXPECT_TRUE(desk.wait_for("document.getElementById('said').textContent.includes('again.')"));
    desk.press("r");
    EXPECT_TRUE(desk.wait_for("document.getElementById('said').textContent.includes('comes again')"));
    process->send(SIGINT);
    EXPECT_EQ(process->wait().code, 130);
    std::map<std::string, int> statuses;
    for (const TrialRow& row : rows())
        ++statuses[row.outcome.status];
    EXPECT_EQ(statuses, (std::map<std::string, int>{{"answered", 1}, {"interrupted", 2}, {"withdrawn", 1}}));
}

// Button 3 of a simulated hand goes down once a second, whatever the page shows: it answers one trial after the other,
// and nothing in between. The dead-man's is held.
TEST_F(Session, IsAnsweredByTheDevicesButtonsAtACheckedDevice) {
    std::string device = "sim:1@0 s..900 s,5@899 s..900 s";
    for (int second = 1; second < 90; ++second)
        device += fmt::format(",3@{0} s..{0}.6 s", second);
    const std::vector<std::string> manner{"--device", device, "--dead-man", "1", "--rotate", "z 180 deg"};
    Launch check;
    check.arguments = with({"device", "check", folder.write("scene.toml", "[surface]\nradius = \"600 mil\"\n"), "--out",
                            folder / "check.json"},
                           manner);
    Process(check).wait();
    nlohmann::json outcome = nlohmann::json::parse(folder.read("check.json"));
    const auto with_outcome = [&](const nlohmann::json& json) {
        return with({"--answer-buttons", "2,3,4,5", "--check", folder.write("check.json", json.dump())}, manner);
    };
    outcome["passed"] = false;
    EXPECT_TRUE(says(refusal(with_outcome(outcome), 1), "did not pass its check"));
    outcome["passed"] = true; // the dead-man's button was never let go of
    outcome["device"]["name"] = "omega.3";
    EXPECT_TRUE(says(refusal(with_outcome(outcome)), "it is of omega.3"));
    outcome["device"]["name"] = "simulated hand and device";
    const auto right = with_outcome(outcome);
    EXPECT_TRUE(says(refusal({"--check", folder / "check.json"}), "another mapping"));
    EXPECT_TRUE(says(refusal({"--answer-buttons", "1,2"}), "4 answers want as many"));
    EXPECT_TRUE(says(refusal({"--device", device, "--answer-buttons", "2,3,4,6"}), "no button 6"));
    EXPECT_TRUE(says(refusal({"--device", device, "--answer-buttons", "1,2,3,4", "--dead-man", "1"}), "two things"));

    start("1", right);
    begin();
    ASSERT_TRUE(reaches("feel")) << browser.text("document.body.textContent");
    EXPECT_EQ(browser.text("document.querySelector('.answer').innerText.split('\\n').at(-1)"), "button 2");
    Browser desk;
    desk.open_address(address("operator"));
    EXPECT_TRUE(desk.wait_for("document.getElementById('manner').textContent.includes('along the device')"));
    for (int i = 0; i < 20 && browser.text(kPhase) != "done"; ++i)
        if (browser.wait_for(std::string("['rest', 'done'].includes(") + kPhase + ")"))
            browser.press(" ");
    EXPECT_TRUE(reaches("done"));
    EXPECT_EQ(process->wait().code, 0) << said();
    std::size_t answered = 0;
    for (const TrialRow& row : rows()) {
        if (std::set<std::string>{"too early", "no contact", "force clamped", "force off"}.contains(row.outcome.status))
            continue; // a press in the first 0.2 s of a trial, or a loop late on a busy machine: the trial comes again
        ++answered;
        EXPECT_EQ(row.answer, "two_poly");
        EXPECT_EQ(row.outcome.answered_by, "button");
        EXPECT_EQ(row.outcome.status, kAnswered);
        EXPECT_EQ(row.device_check, "passed");
    }
    EXPECT_EQ(answered, 4u) << "nothing between the trials counts";
    const std::string line = read_file(data() / "documentation" / "subject-03_session-1_device.jsonl");
    const nlohmann::json kept = nlohmann::json::parse(line);
    EXPECT_EQ(kept["check"]["steps"].size(), 7u);
    EXPECT_EQ(kept["dead_man"], 1);
    EXPECT_TRUE(says(kept["manner"].get<std::string>(), "scene's x, y, z along the device's -x, -y, z"));
    for (int trial = 1; trial <= 4; ++trial) { // answered when it goes down, not because it is
        std::vector<std::string> held;
        for (const std::string& row :
             lines_of(read_file(data() / "paths" / fmt::format("subject-03_session-1_trial-{}.csv", trial))))
            held.push_back(cells_of(row).back());
        ASSERT_GT(held.size(), 200u);
        EXPECT_EQ(held[0], "buttons");
        EXPECT_EQ(held.back(), "5") << trial;
        EXPECT_EQ(held[held.size() - 100], "1") << trial;
    }
}

// Without the dead-man's button no stimulus begins; one during which it is let go of does not count.
TEST_F(Session, WaitsForTheDeadMansButton) {
    start("1", {"--device", "sim:1@4 s..6 s,1@6.6 s..900 s", "--dead-man", "1"});
    begin();
    ASSERT_TRUE(reaches("loading"));
    EXPECT_TRUE(
        browser.wait_for("document.getElementById('hints').textContent.startsWith('Hold button 1 of the device.')"));
    ASSERT_TRUE(reaches("feel"));
    std::this_thread::sleep_for(std::chrono::milliseconds(3000));
    browser.press("1");
    ASSERT_TRUE(browser.wait_for("document.body.dataset.trial === '2'"));
    ASSERT_EQ(rows().size(), 1u);
    EXPECT_EQ(rows()[0].outcome.status, "force off");
    EXPECT_EQ(rows()[0].outcome.answered_by, "key");
    EXPECT_EQ(rows()[0].device_check, "none");
}

} // namespace
} // namespace forceshade::experiment
