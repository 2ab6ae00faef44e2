// A sweep run again: nothing is done twice, what is damaged, missing or changed is done anew, and all bytes are the
// same.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

class Sweep : public Workplace {
protected:
    Sweep() { write("three.toml", kThreeCases); }

    /// Runs a sweep into `out` and returns what it says of itself.
    json sweep(const std::vector<std::string>& further = {}, const std::string& study = "three.toml",
               const std::string& out = "out") const {
        const Outcome outcome = expect_success(with({"sweep", study, "--out", out, "--json", "--quiet"}, further));
        return outcome.code == 0 ? json::parse(outcome.out) : json::object();
    }

    void expect_counts(const json& said, int computed, int kept) const {
        EXPECT_EQ(said.value("computed", -1), computed);
        EXPECT_EQ(said.value("kept", -1), kept);
    }

    // Damages a file by `damage` and expects that the next run computes one case, and that all is as it was.
    void expect_repaired(const std::string& name, const std::function<void(std::filesystem::path)>& damage) const {
        SCOPED_TRACE(name);
        const Tree before = results_in(path("out"));
        damage(path("out") / name);
        expect_counts(sweep({"--also", "npy,vti,vtp,png"}), 1, 2);
        EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
        EXPECT_EQ(temporaries_in(path("out")), std::vector<std::string>{});
    }
};

const std::string kCase = "bump_radius-1000mil";

void flip_a_bit(const std::filesystem::path& path, std::size_t at) {
    std::string content = read_text(path);
    content.at(at) = static_cast<char>(content.at(at) ^ 4);
    write_text(path, content);
}

TEST_F(Sweep, OfThePapersStudyHas51CasesAndTheSecondRunChangesNoByte) {
    write("paper.toml", small_study());
    const json first = sweep({"--also", "npy,vti,vtp,png"}, "paper.toml");
    expect_counts(first, 51, 0);
    EXPECT_EQ(first["voxels_differing_from_oracle"], 0);
    const Tree before = tree_of(path("out"));
    const json manifest = json::parse(before.at("manifest.json"));
    EXPECT_EQ(manifest["cases"].size(), 51u);
    // A volume, an array, two ParaView files, two pictures and a record each; study, summary, manifest, report.
    EXPECT_EQ(before.size(), 51u * 7 + 4);
    expect_counts(sweep({"--also", "npy,vti,vtp,png"}, "paper.toml"), 0, 51);
    EXPECT_EQ(differences(before, tree_of(path("out"))), std::set<std::string>{}) << "the manifest included";
}

TEST_F(Sweep, IntoAnotherFolderAndFromItsOwnStudyGivesTheSameBytes) {
    write("paper.toml", small_study());
    const std::string only = "*1400mil*";
    sweep({"--only", only, "--also", "npy,vti,vtp,png"}, "paper.toml");
    sweep({"--only", only, "--also", "png,vtp,vti", "--also", "npy"}, "paper.toml", "elsewhere/deep");
    sweep({"--only", only, "--also", "npy,vti,vtp,png"}, "out/study.toml", "again");
    EXPECT_EQ(results_in(path("out")).size(), 17u * 6 + 2);
    EXPECT_EQ(differences(results_in(path("out")), results_in(path("elsewhere/deep"))), std::set<std::string>{});
    EXPECT_EQ(differences(results_in(path("out")), results_in(path("again"))), std::set<std::string>{});
}

TEST_F(Sweep, DoesADamagedOrMissingFileAgainAndNoOther) {
    sweep({"--also", "npy,vti,vtp,png"});
    using Damage = std::function<void(const std::filesystem::path&)>;
    const Damage damages[] = {[](const auto& file) { std::filesystem::remove(file); },
                              [](const auto& file) { std::filesystem::resize_file(file, 0); },
                              [](const auto& file) { std::filesystem::resize_file(file, 300); },
                              [](const auto& file) { flip_a_bit(file, std::filesystem::file_size(file) / 2); },
                              [](const auto& file) { flip_a_bit(file, std::filesystem::file_size(file) - 1); },
                              [](const auto& file) { write_text(file, read_text(file) + "x"); }};
    std::size_t number = 0; // of the kind of file: the first meets all damages, each other one two of them
    for (const char* name : {".exr", ".force.npy", ".vti", ".vtp", ".stroke.png", ".arrows.png"}) {
        for (std::size_t i = 0; i < std::size(damages); ++i)
            if (number == 0 || i % 3 == number % 3)
                expect_repaired(kCase + name, damages[i]);
        ++number;
    }
}

TEST_F(Sweep, SurvivesDamagedRecords) {
    sweep({"--also", "npy,vti,vtp,png"});
    const std::string record = "manifest.d/" + kCase + ".json";
    for (const char* text : {"", "{", "null", "[]", "{\"case\": 3}", "\xff\xfe\x00garbage"})
        expect_repaired(record, [&](const auto& file) { write_text(file, text); });
    expect_repaired(record, [](const auto& file) { std::filesystem::resize_file(file, 200); });
    expect_repaired(record, [](const auto& file) { std::filesystem::remove(file); });
    // A record that tells of another case, and one whose types are wrong.
    expect_repaired(
        record, [&](const auto& file) { write_text(file, read_text(path("out/manifest.d/bump_radius-600mil.json"))); });
    expect_repaired(record, [&](const auto& file) {
        json changed = json::parse(read_text(file));
        changed["parameters"] = {{"surface.radius", 7}};
        changed["oracle"]["largest_error_N"] = nullptr;
        write_text(file, changed.dump());
    });
}

TEST_F(Sweep, SurvivesADamagedManifest) {
    sweep();
    const Tree before = results_in(path("out"));
    const json manifest = read_json("out/manifest.json");
    for (const char* text : {"", "{\"cases\": [", "3", "{\"last_run\": 7}"}) {
        write("out/manifest.json", text);
        write("out/summary.csv", text);
        expect_counts(sweep(), 0, 3);
        EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
        EXPECT_EQ(read_json("out/manifest.json")["cases"], manifest["cases"]);
    }
    std::filesystem::remove_all(path("out/manifest.d"));
    std::filesystem::remove(path("out/manifest.json"));
    expect_counts(sweep(), 3, 0);
    EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
}

TEST_F(Sweep, DoesOnlyWhatIsAskedFor) {
    expect_counts(sweep({"--only", "*1?00mil"}), 2, 0);
    EXPECT_FALSE(std::filesystem::exists(path("out/bump_radius-600mil.exr")));
    EXPECT_EQ(read_json("out/manifest.json")["complete"], false);
    expect_counts(sweep(), 1, 2);
    EXPECT_EQ(read_json("out/manifest.json")["complete"], true);
    expect_failure(2, {"sweep", "three.toml", "--out", "out", "--only", "plane*"}, {"plane*", "bump_radius-600mil"});
}

TEST_F(Sweep, AfreshComputesAllAndChangesNoByte) {
    sweep();
    const Tree before = results_in(path("out"));
    expect_counts(sweep({"--fresh"}), 3, 0);
    EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
    expect_counts(sweep({"--fresh", "--only", "*600*"}), 1, 0);
}

TEST_F(Sweep, AddsFormatsThatAreAskedForLater) {
    sweep();
    const Tree before = results_in(path("out"));
    expect_counts(sweep({"--also", "npy"}), 3, 0);
    const Tree after = results_in(path("out"));
    EXPECT_EQ(after.size(), before.size() + 3);
    // Asking for less is no reason to compute.
    expect_counts(sweep(), 0, 3);
    EXPECT_EQ(differences(after, results_in(path("out"))), std::set<std::string>{});
}

TEST_F(Sweep, RedoesTheCasesWhoseParametersChanged) {
    sweep();
    const Tree before = results_in(path("out"));
    std::string changed = kThreeCases;
    changed.replace(changed.find("1400 mil"), 8, "1500 mil");
    write("changed.toml", changed);
    expect_counts(sweep({"--replace"}, "changed.toml"), 1, 2);
    std::string stiffer = kThreeCases;
    stiffer.replace(stiffer.find("[force]"), 7, "[force]\nstiffness = \"2 N/mm\"");
    write("stiffer.toml", stiffer);
    expect_counts(sweep({"--replace"}, "stiffer.toml"), 3, 0);
    expect_counts(sweep(), 3, 0);
    const Tree after = results_in(path("out"));
    for (const auto& [name, content] : before)
        EXPECT_TRUE(after.at(name) == content) << name;
    expect_counts(sweep({"--engine", "cpu"}), 0, 3); // which small work is computed on unasked
    expect_counts(sweep({"--engine", "gpu"}), 3, 0);
    expect_counts(sweep({"--precision", "f64"}), 3, 0);
}

TEST_F(Sweep, DoesNotTakeThePlaceOfAnotherStudyUnasked) {
    sweep();
    write("other.toml", "[surface]\nkind = \"cylinder_bump\"\n[grid]\nsize = [8, 2, 4]\n");
    expect_refused({"sweep", "other.toml", "--out", "out"},
                   {"another study", "3 of its 3 finished cases", "bump_radius-1000mil", "--out", "--replace"});

    // More cases lose nothing; fewer again do, but a part of the larger study does not.
    std::string larger = kThreeCases;
    larger.replace(larger.find("\"1400 mil\""), 10, "\"1400 mil\", \"1800 mil\"");
    write("larger.toml", larger);
    expect_counts(sweep({}, "larger.toml"), 1, 3);
    expect_failure(2, {"sweep", "three.toml", "--out", "out"}, {"1 of its 4 finished cases", "bump_radius-1800mil"});
    expect_counts(sweep({"--only", "*600mil"}, "larger.toml"), 0, 1);
    expect_counts(sweep({"--shard", "1/2"}, "larger.toml"), 0, 2);
    expect_counts(sweep({}, "out/study.toml"), 0, 4);

    expect_counts(sweep({"--replace"}, "other.toml"), 1, 0);
    EXPECT_EQ(read_json("out/manifest.json")["cases"].size(), 1u);
    expect_counts(sweep({"--replace"}), 0, 3); // records and volumes stayed
    EXPECT_EQ(read_json("out/manifest.json")["cases"].size(), 3u);
}

TEST_F(Sweep, RedoesWhatAnotherDeviceComputedIfADeviceIsAskedFor) {
    sweep({"--engine", "gpu"});
    const std::string record = "out/manifest.d/" + kCase + ".json";
    json changed = read_json(record);
    changed["engine"]["device"] = "another";
    write(record, changed.dump());
    expect_counts(sweep({"--engine", "gpu"}), 0, 3);
    expect_counts(sweep({"--gpu", "llvmpipe"}), 1, 2);
    expect_counts(sweep({"--gpu", "llvmpipe"}), 0, 3);
}

TEST_F(Sweep, TellsItsCasesAndWhatTheyTakeBeforeItBegins) {
    EXPECT_EQ(lines_of(expect_success({"sweep", "three.toml", "--list"}).out).size(), 3u);
    EXPECT_EQ(json_of({"sweep", "three.toml", "--list", "--json"})[1]["parameters"]["radius"], "1000 mil");
    const std::vector<std::string> dry{"sweep", "three.toml", "--out", "told", "--also", "npy", "--dry-run", "--json"};
    const json told = json_of(dry);
    EXPECT_EQ(told["to_compute"], 3);
    EXPECT_EQ(told["voxels"], 3 * 16 * 4 * 8);
    EXPECT_FALSE(std::filesystem::exists(path("told")));
    expect_success({"sweep", "three.toml", "--out", "told", "--also", "npy"});
    double bytes = 0;
    for (const auto& [name, content] : tree_of(path("told")))
        if (name.ends_with(".exr") || name.ends_with(".npy"))
            bytes += static_cast<double>(content.size());
    EXPECT_NEAR(told["expected_bytes"].get<double>(), bytes, 0.02 * bytes) << "so small that the copies are whole";
    EXPECT_EQ(json_of(dry)["to_compute"], 0);
}

std::string study(const std::string& stiffness, const std::string& channels = "[\"force\"]") {
    return "[surface]\nfacets = [2, 3]\n[force]\nstiffness = \"" + stiffness +
           "\"\n[grid]\nsize = [16, 2, 8]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\nspacing = \"1.8 "
           "mm\"\n[output]\n"
           "channels = " +
           channels + "\n";
}

using Stale = Workplace;

TEST_F(Stale, RecordsOfOtherParametersDoNotCount) {
    write("study.toml", study("1 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    write("study.toml", study("5 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out", "--only", "*facets-2"});
    const json manifest = read_json("out/manifest.json");
    EXPECT_EQ(manifest["complete"], false);
    EXPECT_EQ(manifest["cases_recorded"], 1);
    EXPECT_FALSE(says(read_text(path("out/summary.csv")), "facets-3"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    EXPECT_EQ(read_json("out/manifest.json")["complete"], true);
    expect_success({"sweep", "study.toml", "--out", "undisturbed"});
    EXPECT_EQ(differences(results_in(path("out")), results_in(path("undisturbed"))), std::set<std::string>{});
}

TEST_F(Stale, FilesBesideAVolumeFollowIt) {
    write("study.toml", study("1 N/mm", "[\"force\", \"depth\"]"));
    expect_success({"sweep", "study.toml", "--out", "out", "--also", "npy"});
    EXPECT_TRUE(exists(path("out/bump_facets-2.depth.npy")));
    const std::string before = read_text(path("out/bump_facets-2.force.npy"));
    write("study.toml", study("5 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    EXPECT_NE(read_text(path("out/bump_facets-2.force.npy")), before) << "made again, though nobody asked for it";
    EXPECT_FALSE(exists(path("out/bump_facets-2.depth.npy"))) << "the channel is gone";
    EXPECT_EQ(read_json("out/manifest.json")["cases"][0]["files"].size(), 2u);
}

TEST_F(Stale, ADeviceThatIsNotThereForgetsNothing) {
    write("study.toml", study("1 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    expect_refused(without_device({"sweep", "study.toml", "--out", "out", "--fresh", "--engine", "gpu"}),
                   {"no usable Vulkan device", "mesa-vulkan-drivers"}, 3);
}

} // namespace
} // namespace forceshade::testing
