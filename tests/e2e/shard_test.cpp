// Several processes write one folder: as shards of a study, as tasks of a batch system, and by mistake.
#include <array>
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
    const Tree& whole() const {
        static const Outcome once =
            expect_success({"sweep", "paper.toml", "--out", "whole", "--also", "npy", "--quiet"});
        static const Tree made = results_in(path("whole"));
        return made;
    }

    Launch part(const std::string& out, const std::vector<std::string>& further = {}) const {
        return launch(with({"sweep", "paper.toml", "--out", out, "--also", "npy", "--json", "--quiet"}, further));
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

    // What it says of itself.
    json merge(const std::string& out, int code, const std::vector<std::string>& further = {}) const {
        const Outcome outcome =
            forceshade(with({"sweep", "paper.toml", "--out", out, "--merge", "--json", "--quiet"}, further));
        EXPECT_EQ(outcome.code, code) << outcome.error;
        return json::parse(outcome.out);
    }

    void expect_whole(const std::string& out, const Tree& expected) const {
        EXPECT_EQ(differences(results_in(path(out)), expected), std::set<std::string>{});
        EXPECT_EQ(temporaries_in(path(out)), std::vector<std::string>{});
        const json manifest = read_json(out + "/manifest.json");
        EXPECT_EQ(manifest["complete"], true);
        EXPECT_EQ(manifest["cases"].size(), 51u);
    }
};

TEST_F(Shards, AtOnceInOneFolderMergeIntoWhatOneProcessMakes) {
    const Tree& expected = whole();
    const std::vector<int> computed = run_together(
        {part("out", {"--shard", "1/3"}), part("out", {"--shard", "2/3"}), part("out", {"--shard", "3/3"})});
    EXPECT_EQ(computed, (std::vector<int>{17, 17, 17}));
    for (const char* name : {"manifest.json", "summary.csv", "report.html", "study.toml"})
        EXPECT_FALSE(std::filesystem::exists(path("out") / name)) << name;
    merge("out", 0);
    expect_whole("out", expected);
}

TEST_F(Shards, ThatAreMissingAreNamedByAMerge) {
    const Tree& expected = whole();
    for (int i = 4; i >= 1; --i) {
        EXPECT_EQ(run_together({part("out", {"--shard", fmt::format("{}/4", i)})}).front(), i == 4 ? 12 : 13);
        const json merged = merge("out", i == 1 ? 0 : 1);
        std::vector<std::string> others;
        for (int other = 1; other < i; ++other)
            others.push_back(fmt::format("{}/4", other));
        EXPECT_EQ(merged["shards"], json(others));
        const json manifest = read_json("out/manifest.json");
        EXPECT_EQ(manifest["complete"], i == 1);
        EXPECT_EQ(manifest["cases_of_study"], 51);
        EXPECT_EQ(manifest["cases_recorded"], manifest["cases"].size());
    }
    expect_whole("out", expected);
}

TEST_F(Shards, AreNotMergedByTheWrongWords) {
    run_together({part("out", {"--shard", "1/51"})});
    expect_failure(2, {"sweep", "paper.toml", "--out", "out", "--merge", "--shard", "1/2"}, {"--merge", "--shard"});
    expect_failure(2, {"sweep", "paper.toml", "--out", "out", "--verify"}, {"--verify", "--merge"});
    expect_failure(4, {"sweep", "paper.toml", "--out", "none", "--merge"}, {"none", "no such folder"});
    expect_failure(2, {"sweep", "--out", "out", "--merge"}, {"no case there is of this study"});
    EXPECT_FALSE(std::filesystem::exists(path("out/study.toml")));
}

// Whatever the flags, the merge tells why the same command would not help.
TEST_F(Shards, OfOtherFlagsOrCountsAreToldApartByAMerge) {
    run_together({part("out", {"--shard", "1/2"}), part("out", {"--shard", "2/2", "--precision", "f64"})});
    const json merged = merge("out", 1);
    EXPECT_EQ(merged["of_other_scenes_or_programs"], 25);
    EXPECT_EQ(merged["shards"], json({"2/2"}));
    run_together({part("out", {"--shard", "1/4"})});
    EXPECT_EQ(merge("out", 1)["shards"], json({"2/4", "4/4"})) << "as it was shared out last";
}

// What a GPU computed on one machine is not computed anew on one without.
TEST_F(Shards, OfAnyEngineCount) {
    run_together(
        {part("out", {"--shard", "1/2", "--engine", "gpu"}), part("out", {"--shard", "2/2", "--engine", "cpu"})});
    EXPECT_EQ(run_together({part("out")}).front(), 0);
    EXPECT_EQ(run_together({part("out", {"--engine", "gpu"})}).front(), 25);
}

TEST_F(Shards, WhoseFilesAreDamagedAreFoundByAMergeThatVerifies) {
    run_together({part("out", {"--shard", "1/2"}), part("out", {"--shard", "2/2"})});
    const std::string volume = "out/cylinder_bump_radius-600mil.exr";
    std::string bytes = read_text(path(volume));
    bytes[bytes.size() / 2] ^= 1;
    write(volume, bytes);
    merge("out", 0);
    const json verified = merge("out", 1, {"--verify"});
    EXPECT_EQ(verified["missing"], json({"cylinder_bump_radius-600mil"}));
    EXPECT_EQ(verified["shards"], json({"1/2"}));
    std::filesystem::remove(path(volume));
    EXPECT_EQ(merge("out", 1)["missing"].size(), 1u);
}

TEST_F(Shards, TellHowTheyStand) {
    expect_failure(4, {"sweep", "--status", "out"}, {"no such folder"});
    std::filesystem::create_directory(path("out"));
    expect_failure(2, {"sweep", "--status", "out"}, {"no shard"});
    run_together({part("out", {"--shard", "2/3"})});
    std::filesystem::copy(path("out/manifest.d/shards/2-of-3.json"), path("out/manifest.d/shards/2-of-3 (copy).json"));
    const json shard = json_of({"sweep", "--status", "out", "--json"})["shards"][0];
    EXPECT_EQ(shard["shard"], 2);
    EXPECT_EQ(shard["of"], 3);
    EXPECT_EQ(shard["state"], "done");
    EXPECT_EQ(shard["computed"], 17);
    EXPECT_TRUE(says(expect_success({"sweep", "--status", "out"}).out,
                     "3 shards: 1 done, 0 at work, 0 failed, 0 silent, 2 not begun"));
}

// A mesh that is not there fails its cases alone, and the merge says why.
TEST_F(Shards, ThatFailLeaveTheirReason) {
    write("meshes.toml", "[surface]\nkind = \"mesh\"\nfile = [\"b.obj\", \"c.obj\", \"a.obj\"]\n[grid]\nsamples = 8\n");
    write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const auto expect_merge = [this](const std::vector<std::string>& words) {
        const Outcome merged = forceshade({"sweep", "meshes.toml", "--out", "out", "--merge"});
        EXPECT_EQ(merged.code, 1);
        EXPECT_TRUE(says(merged.error, words));
    };
    EXPECT_EQ(forceshade({"sweep", "meshes.toml", "--out", "out", "--shard", "2/2", "--quiet"}).code, 4);
    expect_merge({"0 of 3", "mesh_file-c.obj: meshes.toml:3:18: cannot read", "3 cases missing", "--shard 2/2"});
    EXPECT_FALSE(std::filesystem::exists(path("out/manifest.json")));
    EXPECT_EQ(forceshade({"sweep", "meshes.toml", "--out", "out", "--shard", "1/2", "--quiet"}).code, 4);
    expect_merge(
        {"1 of 3", "mesh_file-b.obj: meshes.toml:3:9: cannot read", "mesh_file-c.obj", "--shard 1/2, --shard 2/2"});
}

Launch in_array(Launch launch, const std::string& id, const std::string& count, const std::string& first,
                const std::string& last) {
    launch.environment.insert({{"SLURM_ARRAY_TASK_ID", id},
                               {"SLURM_ARRAY_TASK_COUNT", count},
                               {"SLURM_ARRAY_TASK_MIN", first},
                               {"SLURM_ARRAY_TASK_MAX", last}});
    return launch;
}

TEST_F(Shards, ComeFromSlurmsArrayVariables) {
    const Tree& expected = whole();
    std::vector<Launch> tasks;
    for (const char* task : {"0", "1", "2"})
        tasks.push_back(in_array(part("out", {"--shard", "slurm"}), task, "3", "0", "2"));
    EXPECT_EQ(run_together(tasks), (std::vector<int>{17, 17, 17}));
    merge("out", 0);
    expect_whole("out", expected);
    Launch overridden = part("other", {"--shard", "1/51"});
    overridden.environment.insert({{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_COUNT", "3"}});
    EXPECT_EQ(run_together({overridden}).front(), 1) << "what the user says counts more than the surroundings";
}

// srun -n4, alone and within an array of two.
TEST_F(Shards, AreTheTasksOfAnSrun) {
    const auto in_step = [](Launch launch, int rank, int count) {
        launch.environment.insert(
            {{"SLURM_PROCID", std::to_string(rank)}, {"SLURM_STEP_NUM_TASKS", std::to_string(count)}});
        return launch;
    };
    std::vector<Launch> tasks, tasks_of_array;
    for (int rank = 0; rank < 4; ++rank)
        tasks.push_back(in_step(part("out", {"--shard", "slurm"}), rank, 4));
    EXPECT_EQ(run_together(tasks), (std::vector<int>{13, 13, 13, 12}));
    for (const char* task : {"1", "2"})
        for (int rank = 0; rank < 2; ++rank)
            tasks_of_array.push_back(
                in_step(in_array(part("two", {"--shard", "slurm"}), task, "2", "1", "2"), rank, 2));
    EXPECT_EQ(run_together(tasks_of_array), (std::vector<int>{13, 13, 13, 12}));
}

// A task that cannot tell its part must not take all of them: n tasks would do the work n times; nor another's, as
// when some tasks of an array are submitted again.
TEST_F(Shards, FromSlurmsVariablesThatLeaveThePartOpenAreRefused) {
    using Array = std::array<std::string, 4>;
    for (const auto& [id, count, first, last] :
         {Array{"x", "3", "1", "3"}, Array{"1", "none", "1", "3"}, Array{"7", "3", "1", "3"},
          Array{"-1", "3", "1", "3"}, Array{"1", "", "1", "3"}, Array{"3", "2", "3", "5"}, Array{"5", "1", "5", "5"},
          Array{"1", "1", "1", "1"}, Array{"10", "3", "10", "14"}, Array{"1", "2", "1", "3"}})
        expect_failure(2, in_array(part("out", {"--shard", "slurm"}), id, count, first, last), {"--shard slurm"});
    expect_failure(2, part("out", {"--shard", "slurm"}), {"--shard slurm", "not a task"});
}

// Jobs inherit the variables of those that submit them, and each task may be meant to do a study of its own.
TEST_F(Shards, AreNotTakenUnasked) {
    expect_failure(2, in_array(part("out"), "2", "3", "1", "3"), {"array", "--shard slurm", "--shard 1/1"});
    Launch step = part("out");
    step.environment.insert({{"SLURM_PROCID", "0"}, {"SLURM_STEP_NUM_TASKS", "2"}});
    expect_failure(2, step, {"srun", "--shard slurm", "--shard 1/1"});
    EXPECT_FALSE(std::filesystem::exists(path("out")));
    step.environment["SLURM_STEP_NUM_TASKS"] = "1";
    EXPECT_EQ(run_together({step}).front(), 51);
}

TEST_F(Shards, BeyondTheNumberOfCasesHaveNothingToDo) {
    EXPECT_EQ(run_together({part("out", {"--shard", "51/60"})}).front(), 1);
    EXPECT_EQ(run_together({part("out", {"--shard", "60/60"})}).front(), 0);
}

TEST_F(Shards, ThatAreNoneAreRefused) {
    for (const char* text : {"0/3", "4/3", "1/0", "3", "1/3/5", "a/b", "-1/3", "1/3 ", "1.0/3", "/", "", "1/1000000001",
                             "1/99999999999999999999"})
        expect_failure(2, {"sweep", "paper.toml", "--out", "out", "--shard", text}, {"shard"});
    EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(Shards, AreNotNeededForTwoRunsInOneFolderToEndWell) {
    const Tree& expected = whole();
    for (int repeat = 0; repeat < 3; ++repeat) {
        const std::string out = fmt::format("out{}", repeat);
        run_together({part(out), part(out), part(out, {"--fresh"})});
        EXPECT_EQ(run_together({part(out)}).front(), 0) << "all was recorded";
        expect_whole(out, expected);
    }
}

// The folder then belongs to whoever came last, but no volume may be a mixture, and each study finishes on its own.
TEST_F(Shards, OfDifferentStudiesInOneFolderEndWithTheLastOne) {
    const Tree& expected = whole();
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
