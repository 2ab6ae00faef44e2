// Several processes write one folder: as shards of a study, as tasks of a batch system, and by mistake.
#include <memory>

#include <fmt/format.h>

#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Shards : public Workplace {
protected:
    Shards() { write("paper.toml", small_study()); }

    /// What one undisturbed process makes of the study.
    Tree whole() const {
        expect_success({"sweep", "paper.toml", "--out", "whole", "--also", "npy", "--quiet"});
        return results_in(path("whole"));
    }

    Launch part(const std::string& out, std::vector<std::string> further = {}) const {
        Launch launch = Workplace::launch({"sweep", "paper.toml", "--out", out, "--also", "npy", "--json", "--quiet"});
        launch.arguments.insert(launch.arguments.end(), further.begin(), further.end());
        return launch;
    }

    // Runs all at once; returns how many cases each computed.
    static std::vector<int> run_together(const std::vector<Launch>& launches) {
        std::vector<std::unique_ptr<Process>> processes;
        for (const Launch& launch : launches)
            processes.push_back(std::make_unique<Process>(launch));
        std::vector<int> computed;
        for (const auto& process : processes) {
            const Outcome outcome = process->wait();
            EXPECT_EQ(outcome.code, 0) << outcome.error;
            computed.push_back(outcome.code == 0 ? json::parse(outcome.out)["computed"].get<int>() : -1);
        }
        return computed;
    }

    void expect_whole(const std::string& out, const Tree& expected) const {
        EXPECT_EQ(differences(results_in(path(out)), expected), std::set<std::string>{});
        EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
        const json manifest = read_json(out + "/manifest.json");
        EXPECT_EQ(manifest["complete"], true);
        EXPECT_EQ(manifest["cases"].size(), 51u);
    }
};

TEST_F(Shards, at_once_in_one_folder_merge_into_what_one_process_makes) {
    const Tree expected = whole();
    const std::vector<int> computed = run_together(
        {part("out", {"--shard", "1/3"}), part("out", {"--shard", "2/3"}), part("out", {"--shard", "3/3"})});
    EXPECT_EQ(computed, (std::vector<int>{17, 17, 17}));
    expect_whole("out", expected);
}

TEST_F(Shards, one_after_another_merge_too) {
    const Tree expected = whole();
    for (int i = 4; i >= 1; --i) {
        EXPECT_EQ(run_together({part("out", {"--shard", fmt::format("{}/4", i)})}).front(), i == 4 ? 12 : 13);
        const json manifest = read_json("out/manifest.json");
        EXPECT_EQ(manifest["complete"], i == 1);
        EXPECT_EQ(manifest["cases_of_study"], 51);
        EXPECT_EQ(manifest["cases_recorded"], manifest["cases"].size());
    }
    expect_whole("out", expected);
}

TEST_F(Shards, are_merged_by_the_next_command_that_reads_the_folder) {
    const Tree expected = whole();
    run_together({part("out", {"--shard", "1/2"}), part("out", {"--shard", "2/2"})});
    std::filesystem::remove(path("out/manifest.json"));
    std::filesystem::remove(path("out/summary.csv"));
    EXPECT_EQ(run_together({part("out")}).front(), 0);
    expect_whole("out", expected);
}

TEST_F(Shards, come_from_slurms_array_variables) {
    const Tree expected = whole();
    std::vector<Launch> tasks;
    for (int task = 10; task <= 14; task += 2) { // --array=10-14:2
        Launch& launch = tasks.emplace_back(part("out"));
        launch.environment.insert({{"SLURM_ARRAY_TASK_ID", std::to_string(task)},
                                   {"SLURM_ARRAY_TASK_COUNT", "3"},
                                   {"SLURM_ARRAY_TASK_MIN", "10"},
                                   {"SLURM_ARRAY_TASK_MAX", "14"},
                                   {"SLURM_ARRAY_TASK_STEP", "2"}});
    }
    EXPECT_EQ(run_together(tasks), (std::vector<int>{17, 17, 17}));
    expect_whole("out", expected);
    Launch overridden = part("other", {"--shard", "1/51"});
    overridden.environment.insert({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_COUNT", "3"}});
    EXPECT_EQ(run_together({overridden}).front(), 1) << "what the user says counts more than the surroundings";
}

// A task that cannot tell its part must not take all of them: n tasks would do the work n times.
TEST_F(Shards, from_slurms_variables_that_make_no_sense_are_refused) {
    using Pair = std::pair<std::string, std::string>;
    for (const auto& [id, count] :
         {Pair("x", "3"), Pair("1", "none"), Pair("7", "3"), Pair("-1", "3"), Pair("1", "")}) {
        Launch launch = part("out");
        launch.environment.insert(
            {{"SLURM_ARRAY_TASK_ID", id}, {"SLURM_ARRAY_TASK_COUNT", count}, {"SLURM_ARRAY_TASK_MIN", "1"}});
        expect_failure(2, launch, {"Slurm array", "--shard"});
    }
}

TEST_F(Shards, beyond_the_number_of_cases_have_nothing_to_do) {
    EXPECT_EQ(run_together({part("out", {"--shard", "51/60"})}).front(), 1);
    EXPECT_EQ(run_together({part("out", {"--shard", "60/60"})}).front(), 0);
}

TEST_F(Shards, that_are_none_are_refused) {
    for (const char* text :
         {"0/3", "4/3", "1/0", "3", "1/3/5", "a/b", "-1/3", "1/3 ", "1.0/3", "/", "", "1/99999999999999999999"})
        expect_failure(2, {"sweep", "paper.toml", "--out", "out", "--shard", text}, {"shard"});
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Shards, are_not_needed_for_two_runs_in_one_folder_to_end_well) {
    const Tree expected = whole();
    for (int repeat = 0; repeat < 3; ++repeat) {
        const std::string out = fmt::format("out{}", repeat);
        run_together({part(out), part(out), part(out, {"--fresh"})});
        EXPECT_EQ(run_together({part(out)}).front(), 0) << "all was recorded";
        expect_whole(out, expected);
    }
}

// The folder then belongs to whoever came last, but no volume may be a mixture, and each study finishes on its own.
TEST_F(Shards, of_different_studies_in_one_folder_end_with_the_last_one) {
    const Tree expected = whole();
    std::string stiffer = small_study();
    stiffer.replace(stiffer.find("\"1 N/mm\""), 8, "\"2 N/mm\"");
    write("stiffer.toml", stiffer);
    Launch other = part("out");
    other.arguments[1] = "stiffer.toml";
    for (int repeat = 0; repeat < 3; ++repeat)
        run_together({part("out"), other});
    run_together({part("out")});
    expect_whole("out", expected);
}

} // namespace
} // namespace forceshade::testing
