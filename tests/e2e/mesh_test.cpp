// Meshes as a user meets them: fields, sweeps and validation of polygon files, and what is said of bad ones.
#include <cmath>

#include <fmt/format.h>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

constexpr const char* kCube = R"(OFF
8 6 0
-1 -1 -1
1 -1 -1
1 1 -1
-1 1 -1
-1 -1 1
1 -1 1
1 1 1
-1 1 1
4 3 2 1 0
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
)";

std::string scene(const std::string& file, const std::string& more = "") {
    return fmt::format("[surface]\nkind = \"mesh\"\nfile = \"{}\"\nunit = \"cm\"\n{}", file, more);
}

class MeshField : public Workplace {
protected:
    MeshField() {
        write("cube.off", kCube);
        write("cube.toml", scene("cube.off", "[force]\nstiffness = \"1 N/mm\"\n[grid]\nsamples = 22\n"
                                             "[output]\nchannels = [\"depth\", \"facet\", \"proxy\", \"unshaded\"]\n"));
    }
};

// A cube of 2 cm, K = 1000 N/m: the force is K times the way out through the nearest face.
TEST_F(MeshField, of_a_cube_is_the_closed_form) {
    expect_success({"field", "cube.toml", "--out", "cube.exr"});
    const ReadVolume volume = read_exr(path("cube.exr"));
    EXPECT_EQ(volume.grid, (std::array<int, 3>{22, 22, 22}));
    EXPECT_NEAR(volume.spacing[0], 0.001, 1e-12); // 1.05 times 2 cm in 21 steps
    const auto& force = volume.parts.at("force").channels;
    const auto& facet = volume.parts.at("facet").channels.begin()->second;
    std::size_t inside = 0;
    for (int k = 0; k < 22; ++k)
        for (int j = 0; j < 22; ++j)
            for (int i = 0; i < 22; ++i) {
                const auto voxel = static_cast<std::size_t>((k * 22 + j) * 22 + i);
                const double half = 0.01;
                double way = 1;
                for (const auto& [axis, index] : {std::pair(0u, i), {1u, j}, {2u, k}})
                    way = std::min(way, half - std::abs(volume.origin[axis] + volume.spacing[axis] * index));
                const double size =
                    std::hypot(force.at("R")[voxel], std::hypot(force.at("G")[voxel], force.at("B")[voxel]));
                EXPECT_NEAR(size, 1000 * std::max(0.0, way), 2e-5) << i << " " << j << " " << k;
                EXPECT_EQ(facet[voxel]<6, way> 0);
                inside += way > 0;
            }
    EXPECT_EQ(inside, 20u * 20 * 20);
}

TEST_F(MeshField, is_the_same_on_both_engines_and_from_run_to_run) {
    expect_success({"field", "cube.toml", "--out", "gpu.exr", "--also", "npy"});
    expect_success({"field", "cube.toml", "--out", "cpu.exr", "--also", "npy", "--engine", "cpu"});
    expect_success({"field", "cube.toml", "--out", "again.exr"});
    EXPECT_EQ(read_text(path("gpu.exr")), read_text(path("again.exr")));
    for (const char* channel : {"force", "depth", "facet", "proxy", "unshaded"})
        EXPECT_EQ(read_text(path(fmt::format("gpu.{}.npy", channel))),
                  read_text(path(fmt::format("cpu.{}.npy", channel))))
            << channel;
}

TEST_F(MeshField, is_validated) {
    for (const char* extra : {"", "inside = \"winding\"\n", "normals = \"angle\"\n[force]\nshading = \"mean_value\"\n",
                              "[texture]\neffect = \"normal\"\n[force]\nshading = \"two_pass\"\n",
                              "[texture]\nfunction = \"gaussian\"\n[force]\nshading = \"morgenbesser\"\n"}) {
        write("scene.toml", scene("cube.off", extra) + "[grid]\nsamples = 17\n");
        const Outcome outcome = expect_success({"validate", "scene.toml"});
        EXPECT_EQ(last_line(outcome.out), "9826 voxels, 0 differ") << extra;
    }
}

TEST_F(MeshField, sweeps_and_tells_what_was_evaluated) {
    write("study.toml",
          scene("cube.off", "[force]\nshading = [\"none\", \"morgenbesser\"]\n[grid]\nsize = [64, 64, 64]\n"
                            "origin = [\"-4 cm\", \"-4 cm\", \"-4 cm\"]\nspacing = \"1.3 mm\"\n"));
    expect_success({"sweep", "study.toml", "--out", "out", "--also", "png"});
    const nlohmann::json manifest = read_json("out/manifest.json");
    ASSERT_EQ(manifest["cases"].size(), 2u);
    for (const auto& one : manifest["cases"]) {
        EXPECT_EQ(one["voxels"], 64 * 64 * 64);
        EXPECT_EQ(one["inputs"].at(0)["name"], "cube.off");
        // Blocks of four that meet the cube: 15 or 16 samples of 64 a side.
        EXPECT_GE(one["voxels_evaluated"], 15 * 15 * 15);
        EXPECT_LE(one["voxels_evaluated"], 24 * 24 * 24);
    }
    EXPECT_TRUE(std::filesystem::exists(path("out/mesh_shading-none.exr")));
    EXPECT_TRUE(std::filesystem::exists(path("out/mesh_shading-none.arrows.png")));
    const Tree before = results_in(path("out"));
    const Outcome again = expect_success({"sweep", "study.toml", "--out", "out", "--also", "png"});
    EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
    EXPECT_NE(again.error.find("0 computed, 2 kept"), std::string::npos) << again.error;
    // Another mesh under the same name is another study.
    std::string larger = kCube;
    larger.replace(larger.find("-1 -1 -1"), 8, "-2 -2 -2");
    write("cube.off", larger);
    const Outcome other = expect_success({"sweep", "study.toml", "--out", "out"});
    EXPECT_NE(other.error.find("2 computed"), std::string::npos) << other.error;
}

TEST_F(MeshField, warns_of_findings_and_refuses_what_has_no_meaning) {
    std::string open = kCube;
    open.replace(open.find("8 6 0"), 5, "8 5 0");
    open.resize(open.find("4 3 0 4 7"));
    write("open.off", open);
    write("open.toml", scene("open.off", "[grid]\nsamples = 9\n"));
    const Outcome outcome = expect_success({"field", "open.toml", "--out", "open.exr"});
    EXPECT_NE(outcome.error.find("warning: open.off: "), std::string::npos) << outcome.error;
    EXPECT_NE(outcome.error.find("4 boundary edges"), std::string::npos) << outcome.error;

    write("line.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
    write("line.toml", scene("line.off"));
    expect_failure(2, {"field", "line.toml", "--out", "line.exr"}, {"line.off", "area"});
    write("empty.off", "");
    write("empty.toml", scene("empty.off"));
    expect_failure(4, {"field", "empty.toml", "--out", "x.exr"}, {"empty.off"});
    write("missing.toml", scene("nowhere.obj"));
    expect_failure(4, {"field", "missing.toml", "--out", "x.exr"}, {"nowhere.obj"});
    write("quads.toml", scene("cube.off", "[force]\nshading = \"barycentric\"\n"));
    expect_failure(2, {"field", "quads.toml", "--out", "x.exr"}, {"triangles", "facet 0", "4 corners", "mean_value"});
    write("digest.toml", scene("cube.off", "sha256 = \"" + std::string(64, '0') + "\"\n"));
    expect_failure(2, {"field", "digest.toml", "--out", "x.exr"}, {"cube.off", "SHA-256"});
    write("far.toml", scene("cube.off", "[grid]\nsize = [4, 4, 4]\norigin = [\"1e8 m\", \"0 m\", \"0 m\"]\n"
                                        "spacing = \"1 mm\"\n"));
    expect_failure(2, {"field", "far.toml", "--out", "x.exr"}, {"1e+08 m", "along x", "f32", "unit"});
    EXPECT_FALSE(std::filesystem::exists(path("x.exr")));
    write("missed.toml", scene("cube.off", "[grid]\nsize = [4, 4, 4]\norigin = [\"1 m\", \"0 m\", \"0 m\"]\n"
                                           "spacing = \"1 mm\"\n"));
    const Outcome missed = expect_success({"field", "missed.toml", "--out", "missed.exr"});
    EXPECT_NE(missed.error.find("the force is 0 everywhere"), std::string::npos) << missed.error;
}

// The same mesh in other units, and far from the origin: the same forces in single precision.
TEST_F(MeshField, does_not_depend_on_unit_or_place) {
    const auto forces = [&](const std::string& name, const std::string& keys) {
        write(name + ".toml", scene("cube.off", keys + "[grid]\nsamples = 15\n"));
        expect_success({"field", name + ".toml", "--out", name + ".exr"});
        return read_exr(path(name + ".exr")).parts.at("force").channels;
    };
    const auto here = forces("here", "");
    const auto there = forces("there", "transform.translate = [\"20 km\", \"-20 km\", \"20 km\"]\n");
    // The size alone: on a plane of symmetry rounding chooses the side.
    const auto size = [](const auto& force, std::size_t i) {
        return std::hypot(force.at("R")[i], std::hypot(force.at("G")[i], force.at("B")[i]));
    };
    for (std::size_t i = 0; i < here.at("R").size(); ++i)
        ASSERT_NEAR(size(here, i), size(there, i), 1e-5) << i;
}

} // namespace
} // namespace forceshade::testing
