// A folder that an earlier scene was swept into: nothing of it passes for a result of the present one.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

std::string study(const std::string& stiffness, const std::string& channels = "[\"force\"]") {
    return "[surface]\nfacets = [2, 3]\n[force]\nstiffness = \"" + stiffness +
           "\"\n[grid]\nsize = [16, 2, 8]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\nspacing = \"1.8 "
           "mm\"\n[output]\n"
           "channels = " +
           channels + "\n";
}

using Stale = Workplace;

TEST_F(Stale, records_of_other_parameters_do_not_count) {
    write("study.toml", study("1 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    write("study.toml", study("5 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out", "--only", "*facets-2"});
    const json manifest = read_json("out/manifest.json");
    EXPECT_EQ(manifest["complete"], false);
    EXPECT_EQ(manifest["cases_recorded"], 1);
    EXPECT_EQ(read_text(path("out/summary.csv")).find("facets-3"), std::string::npos);
    expect_success({"sweep", "study.toml", "--out", "out"});
    EXPECT_EQ(read_json("out/manifest.json")["complete"], true);
    expect_success({"sweep", "study.toml", "--out", "undisturbed"});
    EXPECT_EQ(differences(results_in(path("out")), results_in(path("undisturbed"))), std::set<std::string>{});
}

TEST_F(Stale, files_beside_a_volume_follow_it) {
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

TEST_F(Stale, a_device_that_is_not_there_forgets_nothing) {
    write("study.toml", study("1 N/mm"));
    expect_success({"sweep", "study.toml", "--out", "out"});
    const Tree before = tree_of(path("out"));
    Launch without_drivers = launch({"sweep", "study.toml", "--out", "out", "--fresh", "--engine", "gpu"});
    without_drivers.environment["VK_ICD_FILENAMES"] = path("none.json").string();
    without_drivers.environment["VK_DRIVER_FILES"] = path("none.json").string();
    expect_failure(3, without_drivers, {"no usable Vulkan device", "mesa-vulkan-drivers"});
    EXPECT_EQ(differences(before, tree_of(path("out"))), std::set<std::string>{});
}

} // namespace
} // namespace forceshade::testing
