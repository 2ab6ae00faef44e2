// `forceshade mesh`: what it says of good, odd and bad files, on which stream, with which exit code.
#include "tests/e2e/workplace.h"

namespace forceshade::testing {
namespace {

using nlohmann::json;

const char* const kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

class MeshCommand : public Workplace {
protected:
    json described(const std::vector<std::string>& arguments) const {
        std::vector<std::string> all{"mesh", "--json"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        return json::parse(expect_success(all).out);
    }
};

bool has(const std::string& text, const std::string& words) {
    return text.find(words) != std::string::npos;
}

TEST_F(MeshCommand, TellsSizeAndKindOfAGoodMesh) {
    write("a.obj", kTetrahedron);
    const Outcome outcome = expect_success({"mesh", "a.obj"});
    for (const char* words :
         {"mesh     OBJ: 4 vertices, 4 triangles; 1 x 2 x 3 file units", "closed, 1 piece, faces outward, no crossings",
          "volume 1 file units^3", "wrong    nothing", "force    inside", "write    [surface] kind = \"mesh\""})
        EXPECT_TRUE(has(outcome.out, words)) << words << " in\n" << outcome.out;
    EXPECT_TRUE(has(outcome.error, "--unit")) << outcome.error;
    EXPECT_EQ(expect_success({"mesh", "a.obj", "--quiet"}).error, "");
}

TEST_F(MeshCommand, TellsSizesInMetresIfTheUnitIsGiven) {
    write("a.obj", kTetrahedron);
    EXPECT_TRUE(has(expect_success({"mesh", "a.obj", "--unit", "mm"}).out, "0.001 x 0.002 x 0.003 m"));
    const json mesh = described({"a.obj", "--unit", "in"});
    EXPECT_EQ(mesh["unit"], "m");
    EXPECT_DOUBLE_EQ(mesh["high"][2], 3 * 0.0254);
    EXPECT_DOUBLE_EQ(mesh["volume"], 0.0254 * 0.0254 * 0.0254);
    expect_failure(2, {"mesh", "a.obj", "--unit", "kg"}, {"kg", "length"});
    expect_failure(2, {"mesh", "a.obj", "--unit", "banana"}, {"banana"});
}

TEST_F(MeshCommand, DescribesSpot) {
    const json mesh = described({std::string(FORCESHADE_SOURCE) + "/tests/data/spot.obj"});
    EXPECT_EQ(mesh["vertices"], 2930);
    EXPECT_EQ(mesh["triangles"], 5856);
    EXPECT_EQ(mesh["closed"], true);
    EXPECT_EQ(mesh["self_intersections"], 0);
    EXPECT_EQ(mesh["warnings"].size(), 0u);
    EXPECT_NEAR(mesh["volume"], 0.718259, 1e-5);
    EXPECT_EQ(mesh["sha256"].get<std::string>().size(), 64u);
}

TEST_F(MeshCommand, WarnsAndSucceeds) {
    write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 9 9 9\nf 1 2 3\nf 2 3 4\nf 1 2 2\n");
    const json mesh = described({"open.obj"});
    EXPECT_EQ(mesh["closed"], false);
    EXPECT_EQ(mesh["unused_vertices"], 1);
    EXPECT_EQ(mesh["misoriented_edges"], 1);
    EXPECT_EQ(mesh["degenerate_facets"], 1);
    EXPECT_EQ(mesh["repeated_corner_facets"], 1);
    EXPECT_GE(mesh["warnings"].size(), 4u);
    EXPECT_TRUE(has(expect_success({"mesh", "open.obj"}).out, "wrong    3 boundary edges"));
}

TEST_F(MeshCommand, WarnsOfWhatIsSkipped) {
    write("lines.obj", std::string(kTetrahedron) + "f 1 2\nl 1 2 3\nf 3 4\n");
    EXPECT_EQ(described({"lines.obj"})["warnings"], json({"2 faces of two corners: skipped (the first in line 9)",
                                                          "1 line element (l): skipped (in line 10)"}));
    EXPECT_TRUE(has(expect_success({"mesh", "lines.obj"}).out, "wrong    2 faces of two corners: skipped"));
    write("lines.toml", "[surface]\nkind = \"mesh\"\nfile = \"lines.obj\"\nunit = \"cm\"\n[grid]\nsamples = 5\n");
    EXPECT_TRUE(has(expect_success({"field", "lines.toml", "--out", "lines.exr"}).error,
                    "warning: lines.obj: 2 faces of two corners: skipped (the first in line 9)"));
}

TEST_F(MeshCommand, WritesTheKeysThatHelpAndTriesThem) {
    std::string turned = kTetrahedron;
    turned.replace(turned.find("f 1 3 2"), 7, "f 1 2 3");
    write("turned.obj", turned);
    const std::string text = expect_success({"mesh", "turned.obj", "--unit", "mm"}).out;
    EXPECT_TRUE(has(text, "unit = \"mm\"  orient = \"outward\"")) << text;
    EXPECT_TRUE(has(text, "then     closed, 1 piece; nothing is wrong")) << text;
    const json faults = described({"turned.obj"})["faults"];
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0]["key"], "orient = \"outward\"");
    // One corner of two facets a thousandth off.
    write("crack.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nv 0 0.001 3\nf 1 3 2\nf 1 2 4\nf 2 3 5\nf 3 1 4\n");
    const std::string crack = expect_success({"mesh", "crack.obj", "--unit", "mm"}).out;
    EXPECT_TRUE(has(crack, "weld = \"1e-06 m\"")) << crack;
    EXPECT_TRUE(has(crack, "then     closed, 1 piece; nothing is wrong")) << crack;
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
    EXPECT_TRUE(has(expect_success({"mesh", "three.obj"}).out,
                    "pieces   1: 4 facets, 1 file units^3, outward; 2: 4 facets, -0.125 file units^3, cavity; 3: "));
}

TEST_F(MeshCommand, SaysWhatHasNoOutside) {
    // A strip of five triangles with a half twist.
    write("strip.obj", "v 1 0 0\nv 0.3 0.9 0.2\nv -0.8 0.5 0.4\nv -0.8 -0.5 0\nv 0.3 -0.9 0.3\n"
                       "f 1 2 3\nf 3 2 4\nf 3 4 5\nf 5 4 1\nf 5 1 2\n");
    const json mesh = described({"strip.obj"});
    EXPECT_TRUE(std::ranges::any_of(mesh["faults"], [](const json& fault) {
        return has(fault["what"], "has one side only");
    })) << mesh.dump(2);
    EXPECT_FALSE(has(expect_success({"mesh", "strip.obj"}).out, "orient ="));
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

TEST_F(MeshCommand, RefusesWhatHasNoMeaning) {
    write("none.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
    expect_failure(2, {"mesh", "none.off"}, {"none.off", "no facets"});
    write("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n");
    expect_failure(2, {"mesh", "line.obj"}, {"line.obj", "has an area"});
    write("nan.obj", "v 0 0 0\nv nan 1 1\nv 2 2 2\nf 1 2 3\n");
    expect_failure(2, {"mesh", "nan.obj"}, {"nan.obj", "vertex 2 of 3"});
    write("a.fbx", kTetrahedron);
    expect_failure(2, {"mesh", "a.fbx"}, {".obj, .off, .ply, .stl", "look like OBJ"});
    write("a.ply", kTetrahedron);
    expect_failure(2, {"mesh", "a.ply"}, {"rename it to .obj"});
}

TEST_F(MeshCommand, RefusesDamagedFiles) {
    expect_failure(4, {"mesh", "missing.obj"}, {"missing.obj"});
    write("empty.stl", "");
    expect_failure(4, {"mesh", "empty.stl"}, {"empty"});
    write("huge.off", "OFF\n1000000000000 1000000000000 0\n0 0 0\n");
    expect_failure(4, {"mesh", "huge.off"}, {"huge.off:2", "1000000000000"});
    write("cut.obj", std::string(kTetrahedron) + "f 1 2");
    expect_failure(4, {"mesh", "cut.obj"}, {"cut.obj:9", "three corners"});
    write("garbage.ply", std::string(1000, '\xA7'));
    expect_failure(4, {"mesh", "garbage.ply"}, {"garbage.ply"});
    std::filesystem::create_directory(path("folder.obj"));
    expect_failure(4, {"mesh", "folder.obj"}, {"folder.obj", "regular file"});
}

} // namespace
} // namespace forceshade::testing
