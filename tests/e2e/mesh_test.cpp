// Meshes from the command line: the command mesh, fields over them, what is refused.
#include <cmath>
#include <filesystem>
#include <iterator>

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
TEST_F(MeshField, OfACubeIsTheClosedForm) {
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

TEST_F(MeshField, IsTheSameOnBothEnginesAndFromRunToRun) {
    expect_success({"field", "cube.toml", "--out", "gpu.exr", "--also", "npy"});
    expect_success({"field", "cube.toml", "--out", "cpu.exr", "--also", "npy", "--engine", "cpu"});
    expect_success({"field", "cube.toml", "--out", "again.exr"});
    EXPECT_EQ(read_text(path("gpu.exr")), read_text(path("again.exr")));
    for (const char* channel : {"force", "depth", "facet", "proxy", "unshaded"})
        EXPECT_EQ(read_text(path(fmt::format("gpu.{}.npy", channel))),
                  read_text(path(fmt::format("cpu.{}.npy", channel))))
            << channel;
}

TEST_F(MeshField, IsValidated) {
    for (const char* extra : {"", "inside = \"winding\"\n", "normals = \"angle\"\n[force]\nshading = \"mean_value\"\n",
                              "[texture]\neffect = \"normal\"\n[force]\nshading = \"two_pass\"\n",
                              "[texture]\nfunction = \"gaussian\"\n[force]\nshading = \"morgenbesser\"\n"}) {
        write("scene.toml", scene("cube.off", extra) + "[grid]\nsamples = 17\n");
        const Outcome outcome = expect_success({"validate", "scene.toml"});
        EXPECT_EQ(last_line(outcome.out), "9826 voxels, 0 differ") << extra;
    }
}

TEST_F(MeshField, WithoutFreeSpaceDoesNotListIt) {
    write("inside.toml", scene("cube.off", "[grid]\nsize = [8, 8, 8]\norigin = [\"-1 mm\", \"-1 mm\", \"-1 mm\"]\n"
                                           "spacing = \"0.2 mm\"\n"));
    expect_success({"sweep", "inside.toml", "--out", "out"});
    const nlohmann::json one = read_json("out/manifest.json")["cases"].at(0);
    EXPECT_EQ(one["voxels_evaluated"], one["voxels"]);
    EXPECT_FALSE(says(one["omitted"].dump(), "free space"));
    EXPECT_EQ(one["evaluations_saved"], 0);
}

TEST_F(MeshField, SweepsAndTellsWhatWasEvaluated) {
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
        EXPECT_TRUE(says(one["omitted"].dump(), "blocks of free space"));
        EXPECT_GT(one["evaluations_saved"], 0);
    }
    EXPECT_TRUE(std::filesystem::exists(path("out/mesh_shading-none.exr")));
    EXPECT_TRUE(std::filesystem::exists(path("out/mesh_shading-none.arrows.png")));
    EXPECT_TRUE(std::filesystem::exists(path("out/mesh_shading-none.turns.png")));
    for (const char* const file : {"out/mesh_shading-mean_value.turns.png", "out/mesh_shading-barycentric.turns.png"})
        EXPECT_FALSE(std::filesystem::exists(path(file))) << "the same picture again";
    const Tree before = results_in(path("out"));
    const Outcome again = expect_success({"sweep", "study.toml", "--out", "out", "--also", "png"});
    EXPECT_EQ(differences(before, results_in(path("out"))), std::set<std::string>{});
    EXPECT_TRUE(says(again.error, "0 computed, 2 kept"));
    // Another mesh under the same name is another study.
    std::string larger = kCube;
    larger.replace(larger.find("-1 -1 -1"), 8, "-2 -2 -2");
    write("cube.off", larger);
    const Outcome other = expect_success({"sweep", "study.toml", "--out", "out"});
    EXPECT_TRUE(says(other.error, "2 computed"));
}

TEST_F(MeshField, WarnsOfFindingsAndRefusesWhatHasNoMeaning) {
    std::string open = kCube;
    open.replace(open.find("8 6 0"), 5, "8 5 0");
    open.resize(open.find("4 3 0 4 7"));
    write("open.off", open);
    write("open.toml", scene("open.off", "[grid]\nsamples = 9\n"));
    const Outcome outcome = expect_success({"field", "open.toml", "--out", "open.exr"});
    EXPECT_TRUE(says(outcome.error, "warning: open.off: ", "4 boundary edges"));

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
    EXPECT_TRUE(says(missed.error, "the force is 0 everywhere"));
}

using nlohmann::json;

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

class MeshCommand : public Workplace {
protected:
    json described(const std::vector<std::string>& arguments) const {
        return json_of(with({"mesh", "--json"}, arguments));
    }
};

TEST_F(MeshCommand, TellsSizeAndKindOfAGoodMesh) {
    write("a.obj", kTetrahedron);
    const Outcome outcome = expect_success({"mesh", "a.obj"});
    EXPECT_TRUE(says(outcome.out, "4 triangles; 1 x 2 x 3 file units", "wrong    nothing"));
    EXPECT_TRUE(says(outcome.error, "--unit"));
    EXPECT_EQ(expect_success({"mesh", "a.obj", "--quiet"}).error, "");
}

TEST_F(MeshCommand, TellsSizesInMetresIfTheUnitIsGiven) {
    write("a.obj", kTetrahedron);
    EXPECT_TRUE(says(expect_success({"mesh", "a.obj", "--unit", "mm"}).out, "0.001 x 0.002 x 0.003 m"));
    const json mesh = described({"a.obj", "--unit", "in"});
    EXPECT_EQ(mesh["unit"], "m");
    EXPECT_DOUBLE_EQ(mesh["high"][2], 3 * 0.0254);
    EXPECT_DOUBLE_EQ(mesh["volume"], 0.0254 * 0.0254 * 0.0254);
    expect_failure(2, {"mesh", "a.obj", "--unit", "kg"}, {"kg", "length"});
    expect_failure(2, {"mesh", "a.obj", "--unit", "banana"}, {"banana"});
}

TEST_F(MeshCommand, WarnsOfWhatIsSkipped) {
    write("lines.obj", std::string(kTetrahedron) + "f 1 2\nl 1 2 3\nf 3 4\n");
    EXPECT_EQ(described({"lines.obj"})["warnings"], json({"2 faces of two corners: skipped (the first in line 9)",
                                                          "1 line element (l): skipped (in line 10)"}));
    EXPECT_TRUE(says(expect_success({"mesh", "lines.obj"}).out, "wrong    2 faces of two corners: skipped"));
    write("lines.toml", "[surface]\nkind = \"mesh\"\nfile = \"lines.obj\"\nunit = \"cm\"\n[grid]\nsamples = 5\n");
    EXPECT_TRUE(says(expect_success({"field", "lines.toml", "--out", "lines.exr"}).error,
                     "warning: lines.obj: 2 faces of two corners: skipped (the first in line 9)"));
}

TEST_F(MeshCommand, WritesTheKeysThatHelpAndTriesThem) {
    std::string turned = kTetrahedron;
    turned.replace(turned.find("f 1 3 2"), 7, "f 1 2 3");
    write("turned.obj", turned);
    const std::string text = expect_success({"mesh", "turned.obj", "--unit", "mm"}).out;
    EXPECT_TRUE(says(text, "unit = \"mm\"  orient = \"outward\"", "then     closed, 1 piece; nothing is wrong"));
    const json faults = described({"turned.obj"})["faults"];
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0]["key"], "orient = \"outward\"");
    // One corner of two facets a thousandth off.
    write("crack.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nv 0 0.001 3\nf 1 3 2\nf 1 2 4\nf 2 3 5\nf 3 1 4\n");
    const std::string crack = expect_success({"mesh", "crack.obj", "--unit", "mm"}).out;
    EXPECT_TRUE(says(crack, "weld = \"1e-06 m\"", "then     closed, 1 piece; nothing is wrong"));
}

TEST_F(MeshCommand, ListsPieces) {
    // A tetrahedron of volume 1, one of 1/8 that is a cavity of it, and one apart that is inside out.
    write("three.obj",
          "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nv 0.1 0.2 0.3\nv 0.6 0.2 0.3\nv 0.1 1.2 0.3\nv 0.1 0.2 1.8\n"
          "v 5 0 0\nv 6 0 0\nv 5 2 0\nv 5 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
          "f 6 7 5\nf 8 6 5\nf 8 7 6\nf 8 5 7\nf 10 11 9\nf 12 10 9\nf 12 11 10\nf 12 9 11\n");
    const json pieces = described({"three.obj"})["pieces"];
    ASSERT_EQ(pieces.size(), 3u);
    for (const auto& [piece, volume, standing] :
         {std::tuple(0, 1.0, "outward"), {1, -0.125, "cavity"}, {2, -1.0, "inside out"}}) {
        EXPECT_NEAR(pieces[std::size_t(piece)]["volume"].get<double>(), volume, 1e-12);
        EXPECT_EQ(pieces[std::size_t(piece)]["standing"], standing);
    }
    EXPECT_TRUE(says(expect_success({"mesh", "three.obj"}).out,
                     "pieces   1: 4 facets, 1 file units^3, outward; 2: 4 facets, -0.125 file units^3, cavity; 3: "));
}

TEST_F(MeshCommand, IsKeptPreparedUnlessThatIsUnwanted) {
    constexpr int kSide = 160; // squares: 51 200 triangles
    fmt::memory_buffer text;
    for (int j = 0; j <= kSide; ++j)
        for (int i = 0; i <= kSide; ++i)
            fmt::format_to(std::back_inserter(text), "v {} {} {}\n", i, j, (i * j) % 7);
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const int a = 1 + j * (kSide + 1) + i, d = a + kSide + 1;
            fmt::format_to(std::back_inserter(text), "f {0} {1} {3}\nf {0} {3} {2}\n", a, a + 1, d, d + 1);
        }
    write("large.obj", fmt::to_string(text));
    write("large.toml", scene("large.obj", "[grid]\nsamples = 8\n"));
    const auto field = [&](const std::string& out, const std::vector<std::string>& more) {
        Launch launch = this->launch(with({"field", "large.toml", "--out", out}, more));
        launch.environment["XDG_CACHE_HOME"] = path("cache").string();
        const Outcome outcome = run(launch);
        EXPECT_EQ(outcome.code, 0) << outcome.error;
        return read_text(path(out));
    };
    const auto kept = [&] {
        std::size_t files = 0;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("")))
            files += entry.path().filename().string().starts_with("mesh-");
        return files;
    };
    const std::string first = field("a.exr", {"--no-cache"});
    EXPECT_EQ(kept(), 0u);
    EXPECT_EQ(field("b.exr", {}), first);
    EXPECT_EQ(kept(), 1u);
    EXPECT_EQ(field("c.exr", {}), first);
}

TEST_F(MeshCommand, DrawsTheMesh) {
    write("a.obj", kTetrahedron);
    expect_success({"mesh", "a.obj", "--also", "png,svg", "--size", "700"});
    EXPECT_GT(std::filesystem::file_size(path("a.mesh.png")), 5000u);
    EXPECT_GT(std::filesystem::file_size(path("a.mesh.svg")), 5000u);
    expect_failure(2, {"mesh", "a.obj", "--also", "png"}, {"a.mesh.png", "--overwrite"});
    expect_success({"mesh", "a.obj", "--also", "pdf", "--out", "b"});
    EXPECT_TRUE(std::filesystem::exists(path("b.pdf")));
    expect_failure(2, {"mesh", "a.obj", "--also", "vti"}, {"vti", "png, svg, pdf"});
    expect_failure(2, {"mesh", "a.obj", "--out", "b"}, {"--also"});
}

TEST_F(MeshCommand, RefusesWhatHasNoMeaningOrCannotBeRead) {
    write("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
    expect_failure(2, {"mesh", "line.obj"}, {"line.obj", "has an area"});
    write("a.ply", kTetrahedron);
    expect_failure(2, {"mesh", "a.ply"}, {"rename it to .obj"});
    expect_failure(4, {"mesh", "missing.obj"}, {"missing.obj"});
    write("cut.obj", std::string(kTetrahedron) + "f 1 2");
    expect_failure(4, {"mesh", "cut.obj"}, {"cut.obj:9", "three corners"});
}

} // namespace
} // namespace forceshade::testing
