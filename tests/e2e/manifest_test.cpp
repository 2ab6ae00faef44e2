// The account that a sweep leaves: what stands in it, and that figures agree with the files.
#include <algorithm>
#include <cmath>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

// The digest by the system's own tool.
std::string sha256_by_tool(const std::filesystem::path& path) {
    return run({.arguments = {path.string()}, .program = "/usr/bin/sha256sum"}).out.substr(0, 64);
}

class Account : public Workplace {
protected:
    Account() {
        write("paper.toml", small_study());
        static const Folder made;
        static const Outcome once =
            expect_success({"sweep", "paper.toml", "--out", made / "out", "--quiet", "--engine", "gpu"});
        std::filesystem::copy(made / "out", path("out"), std::filesystem::copy_options::recursive);
        manifest_ = read_json("out/manifest.json");
    }
    json manifest_;
};

TEST_F(Account, NamesProgramDeviceDriverAndProcessor) {
    const std::string version = expect_success({"--version"}).out;
    EXPECT_EQ("forceshade " + manifest_["program"].get<std::string>() + "\n", version);
    const json run = manifest_["last_run"];
    const json gpu = json_of({"gpus", "--json", "--quiet"})[0];
    EXPECT_EQ(run["device"], gpu["name"]);
    EXPECT_EQ(run["driver"], gpu["driver"]);
    EXPECT_GT(run["cpu"].get<std::string>().size(), 2u);
    EXPECT_GE(run["cores"], 1);
    EXPECT_EQ(run["cases_computed"], 51);
    for (const char* key : {"wall_s", "cpu_s", "engine_s", "output_s", "peak_memory_bytes"})
        EXPECT_GT(run[key], 0) << key;
}

TEST_F(Account, TellsOfEachCaseWhatMadeItAndWhatItCost) {
    ASSERT_EQ(manifest_["cases"].size(), 51u);
    std::set<std::string> names, fingerprints;
    for (const json& one : manifest_["cases"]) {
        names.insert(one["case"]);
        fingerprints.insert(one["fingerprint"]);
        EXPECT_EQ(one["precision"], "f32");
        EXPECT_TRUE(one["parameters"].contains("radius")) << one["parameters"];
        EXPECT_EQ(one["engine"]["kind"], "gpu");
        EXPECT_EQ(one["voxels"], 16 * 4 * 8);
        EXPECT_EQ(one["voxels_evaluated"], 16 * 8);
        EXPECT_EQ(one["oracle"]["voxels_differing"], 0);
        EXPECT_EQ(one["oracle"]["voxels_compared"], 16 * 8);
        EXPECT_LT(one["oracle"]["relative_error"], 1e-5);
        EXPECT_NE(std::find(one["omitted"].begin(), one["omitted"].end(), "texture"), one["omitted"].end());
        for (const char* stage : {"compile", "upload", "kernel", "read_back", "encode", "flush", "verify", "hash"})
            EXPECT_GE(one["seconds"][stage], 0) << stage;
    }
    EXPECT_EQ(names.size(), 51u);
    EXPECT_EQ(fingerprints.size(), 51u);
}

TEST_F(Account, GivesTheHashAndSizeOfEveryFile) {
    expect_success({"sweep", "paper.toml", "--out", "out", "--only", "*facets-2*", "--also", "npy,png,vti", "--quiet",
                    "--engine", "gpu"});
    const json manifest = read_json("out/manifest.json");
    std::set<std::string> listed;
    for (const json& one : manifest["cases"])
        for (const json& file : one["files"]) {
            const std::filesystem::path path = this->path("out") / file["name"].get<std::string>();
            listed.insert(file["name"]);
            EXPECT_EQ(file["bytes"], std::filesystem::file_size(path));
            EXPECT_EQ(file["sha256"], sha256_by_tool(path)) << path;
        }
    for (const auto& [name, content] : results_in(path("out"))) {
        if (name != "study.toml" && name != "summary.csv") {
            EXPECT_EQ(listed.count(name), 1u) << name;
        }
    }
    EXPECT_EQ(listed.size(), 51u + 6 * 4);
}

TEST_F(Account, GivesTheLargestForceAndWhereItIs) {
    for (const json& one : manifest_["cases"]) {
        const ReadVolume volume = read_exr(path("out") / one["files"][0]["name"].get<std::string>());
        const auto& channels = volume.parts.at("force").channels;
        const auto magnitude = [&](std::size_t i) {
            return std::hypot(channels.at("R")[i], channels.at("G")[i], channels.at("B")[i]);
        };
        double largest = 0;
        for (std::size_t i = 0; i < 16 * 4 * 8; ++i)
            largest = std::max(largest, double(magnitude(i)));
        EXPECT_NEAR(one["largest_force_N"], largest, 1e-5);
        const std::array<std::size_t, 3> at = one["largest_force_voxel"];
        EXPECT_NEAR(magnitude((at[2] * 4 + at[1]) * 16 + at[0]), largest, 1e-5);
    }
}

TEST_F(Account, HasASummaryWithARowACase) {
    std::vector<std::vector<std::string>> rows;
    for (const std::string& line : lines_of(read_text(path("out/summary.csv"))))
        rows.push_back(cells_of(line));
    ASSERT_EQ(rows.size(), 52u);
    const auto column = [&](const std::string& name) {
        return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
    };
    for (const char* name : {"case", "kind", "radius", "facets", "shading", "precision", "voxels", "largest_force_N",
                             "oracle_relative_error", "exr_bytes", "exr_sha256"})
        ASSERT_LT(column(name), rows[0].size()) << name;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        ASSERT_EQ(rows[i].size(), rows[0].size()) << i;
        const json& one = manifest_["cases"][i - 1];
        EXPECT_EQ(rows[i][column("case")], one["case"]);
        EXPECT_EQ(rows[i][column("exr_sha256")], one["files"][0]["sha256"]);
        EXPECT_EQ(rows[i][column("radius")], one["parameters"]["radius"]);
        EXPECT_EQ(std::strtod(rows[i][column("largest_force_N")].c_str(), nullptr), one["largest_force_N"]);
    }
    for (const std::string& cell : rows[0])
        EXPECT_FALSE(says(cell, "seconds")) << "timings would differ from run to run";
}

TEST_F(Account, SaysThatTheCpuComputed) {
    expect_success({"sweep", "paper.toml", "--out", "cpu", "--only", "*facets-2*", "--engine", "cpu", "--precision",
                    "f64", "--quiet"});
    const json manifest = read_json("cpu/manifest.json");
    ASSERT_EQ(manifest["cases"].size(), 6u);
    EXPECT_EQ(manifest["cases"][0]["engine"]["kind"], "cpu");
    EXPECT_EQ(manifest["cases"][0]["precision"], "f64");
    EXPECT_EQ(manifest["cases"][0]["oracle"]["largest_error_N"], 0);
}

} // namespace
} // namespace forceshade::testing
