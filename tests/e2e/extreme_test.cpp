// Scenes at the edge of what can be asked: each has a finite right answer, on every voxel and in both precisions.
#include <cmath>
#include <random>

#include <fmt/format.h>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"
#include "tests/io/picture.h"

namespace forceshade::testing {
namespace {

class Extreme : public Workplace {
protected:
    /// The device agrees with oracle and closed form on all voxels, in single and double precision.
    void expect_right(const std::string& scene) const {
        SCOPED_TRACE(scene);
        write("scene.toml", scene);
        const std::string said = last_line(expect_success({"validate", "scene.toml", "--quiet"}).out);
        EXPECT_TRUE(said.ends_with(" voxels, 0 differ") && !said.starts_with("0 ")) << said;
    }

    /// The force of one voxel in double precision, as float.
    std::array<float, 3> force_at(const std::string& scene) const {
        write("one.toml", scene + "[run]\nprecision = \"f64\"\n");
        expect_success({"field", "one.toml", "--out", "one.exr", "--quiet", "--engine", "gpu"});
        const auto channels = read_exr(path("one.exr")).parts.at("force").channels;
        return {channels.at("R").at(0), channels.at("G").at(0), channels.at("B").at(0)};
    }
};

const std::string kReference = "[force]\nshading = \"reference\"\n";

std::string bump(const std::string& radius, int facets, const std::string& further = {}) {
    return fmt::format("[surface]\nradius = \"{}\"\nfacets = {}\n{}", radius, facets, further);
}

std::string grid(const std::string& size, const std::string& origin, const std::string& spacing) {
    return fmt::format("[grid]\nsize = {}\norigin = {}\nspacing = {}\n", size, origin, spacing);
}

// Its axis is at z = 0: R = a.
const char* const kCylinder = "[surface]\nkind = \"cylinder_bump\"\nradius = \"500 mil\"\n";
const char* const kGaussian = "[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n"
                              "[force]\nshading = \"height_map\"\n";

// The closed form looks at every facet for every column, so the random scenes that it is held to have fewer facets.
// Here are few columns: at the edge, in the middle and outside of the bump.
TEST_F(Extreme, AMillionFacetsHaveARightAnswer) {
    const std::string few =
        grid("[5, 2, 33]", "[\"-500 mil\", \"0 mm\", \"-8 mm\"]", "[\"251 mil\", \"1 mm\", \"0.5 mm\"]");
    expect_right(bump("600 mil", 1000000) + few);
    expect_right(bump("600 mil", 1000000, "facet_spacing = \"equal_x\"\n") + kReference + few);
}

// Others are among the random scenes of gpu_random_test.
TEST_F(Extreme, GridsHaveARightAnswer) {
    const std::string about_axis = grid("[3, 1, 3]", "[\"-1 nm\", \"0 m\", \"-1 nm\"]", "\"1 nm\"");
    expect_right(kCylinder + about_axis);
    expect_right(bump("500 mil", 2, kReference + "reference = \"radial\"\n") + about_axis);
    // 1e-40 m is denormal in single precision, 1e-310 m in double.
    for (const char* step : {"1e-40 m", "1e-44 m", "1e-310 m"})
        expect_right(bump("600 mil", 1) + kReference +
                     grid("[4, 1, 4]", fmt::format("[\"0 m\", \"0 m\", \"-{}\"]", step),
                          fmt::format("[\"5 mm\", \"1 mm\", \"{}\"]", step)));
    for (const char* size : {"[1, 1, 1]", "[1, 8, 8]", "[8, 1, 8]", "[8, 8, 1]", "[1, 1, 8]", "[1, 8, 1]", "[8, 1, 1]"})
        for (const std::string& surface : {bump("600 mil", 3) + kReference, std::string(kGaussian)}) {
            expect_right(surface + grid(size, "[\"-3 mm\", \"-3 mm\", \"-3 mm\"]", "\"0.8 mm\""));
            expect_success({"field", "scene.toml", "--out", "field.exr", "--also", "npy,vti,vtp,png", "--quiet",
                            "--engine", "gpu"});
        }
}

TEST_F(Extreme, ForcesKeepTheirDigits) {
    const auto one = [](const std::string& at) { return grid("[1, 1, 1]", at, "\"1 mm\""); };
    const std::string below = one("[\"20 mm\", \"0 m\", \"-1 m\"]"), middle = one("[\"0 m\", \"0 m\", \"0 m\"]");
    struct Row {
        std::string scene;
        float z; /* N */
    };
    for (const auto& [scene, z] :
         {Row{"[force]\nstiffness = \"1e-9 N/m\"\n" + below, 1e-9f},
          {"[force]\nstiffness = \"1e12 N/m\"\n" + below, 1e12f},
          {one("[\"1 km\", \"1 km\", \"-1 km\"]"), 1e6f},
          {"[force]\nstiffness = \"1 N/m\"\n" + one("[\"0 m\", \"0 m\", \"-1e-40 m\"]"), 1e-40f},
          {one("[\"20 mm\", \"0 m\", \"0 m\"]"), 0}, // out of contact by no more than nothing
          {kCylinder + middle, 12.7f}})              // on its axis
        EXPECT_EQ(force_at(scene), (std::array<float, 3>{0, 0, z})) << scene;
    EXPECT_NEAR(force_at(bump("12700 km", 2) + middle)[2], 6.35e-9, 1e-13) << "U(0) = a^2 / 2R = 6.35 pm";
}

TEST_F(Extreme, ForcesTooSmallForAVolumeAreTold) {
    write("cube.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    write("tiny.toml", "[surface]\nkind = \"mesh\"\nfile = \"cube.obj\"\ntransform = { scale = 1e-150 }\n[force]\n"
                       "stiffness = \"100 N/m\"\n[grid]\nsamples = 9\n");
    const Outcome tiny =
        expect_success({"field", "tiny.toml", "--out", "tiny.exr", "--precision", "f64", "--engine", "cpu"});
    EXPECT_NE(tiny.error.find("e-149 N) underflow"), std::string::npos) << tiny.error;
    EXPECT_EQ(tiny.error.find("in contact"), std::string::npos) << tiny.error;
    write("above.toml", grid("[2, 2, 2]", "[\"0 m\", \"0 m\", \"1 m\"]", "\"1 mm\""));
    const Outcome above = expect_success({"field", "above.toml", "--out", "above.exr", "--engine", "cpu"});
    EXPECT_NE(above.error.find("no voxel of the grid is in contact"), std::string::npos) << above.error;
}

TEST_F(Extreme, MeshesOfWildlyMixedMagnitudesAreTakenOrRefused) {
    std::mt19937 random(7);
    const auto unit = [&] { return (double(random()) + 0.5) / 4294967296.0; };
    const auto coordinate = [&] {
        return random() % 3 == 0 ? 0
                                 : (unit() < 0.5 ? -1 : 1) * std::pow(10, unit() * (random() % 8 ? 420 : 620) - 320);
    };
    write("scene.toml", "[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n[force]\nstiffness = \"1 N/m\"\n"
                        "[grid]\nsamples = 4\n[paths]\ncount = 2\nsteps = 10\n");
    write("path.csv", "path,t,x,y,z\n0,0,0,0,1e3\n0,1,0,0,-1e-9\n0,2,1e-200,1e80,-1e90\n");
    for (int i = 0; i < 6; ++i) {
        std::string mesh;
        const auto vertices = 3 + random() % 6;
        for (std::uint32_t k = 0; k < vertices; ++k)
            mesh += fmt::format("v {} {} {}\n", coordinate(), coordinate(), coordinate());
        for (auto facets = 1 + random() % 16; facets > 0; --facets) {
            mesh += "f";
            for (auto corners = 3 + random() % 4; corners > 0; --corners)
                mesh += fmt::format(" {}", 1 + random() % vertices);
            mesh += "\n";
        }
        SCOPED_TRACE(mesh);
        write("mesh.obj", mesh);
        const std::vector<std::vector<std::string>> commands{
            {"mesh", "mesh.obj"},
            {"field", "scene.toml", "--out", "field.exr", "--engine", "cpu"},
            {"explore", "scene.toml", "--paths", "path.csv", "--out", "felt.csv", "--engine", "cpu"},
            {"explore", "scene.toml", "--out", "paths.exr", "--engine", "cpu", "--precision", "f64"},
            {"validate", "scene.toml", "--engine", "cpu"}};
        for (const auto& command : commands) {
            Launch start = launch(command);
            start.timeout = 20;
            const Outcome outcome = run(start);
            // 1: what comes out is no number that a volume can hold, or referees differ on so odd a mesh.
            EXPECT_LE(outcome.code, 2) << command[0] << ": " << outcome.error;
            EXPECT_EQ(outcome.code != 0 && outcome.error.empty(), false) << command[0];
        }
    }
}

TEST_F(Extreme, AllChannelsAndKindsOfPixels) {
    for (const char* pixel : {"float", "half"})
        for (const char* compression : {"none", "zip1", "zip", "pxr24"}) {
            write("scene.toml", bump("600 mil", 3) + kReference +
                                    grid("[65, 1, 33]", "[\"-16 mm\", \"0 mm\", \"-8 mm\"]", "\"0.5 mm\"") +
                                    fmt::format("[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\", "
                                                "\"unshaded\"]\npixel = \"{}\"\ncompression = \"{}\"\n",
                                                pixel, compression));
            expect_success({"field", "scene.toml", "--out", "field.exr", "--quiet", "--engine", "gpu"});
            EXPECT_EQ(read_exr(path("field.exr")).parts.size(), 5u);
        }
    expect_success({"validate", "scene.toml", "--quiet"});
}

double bowl(int x, int y) {
    return 0.1 * x * x + 0.05 * y;
}

class ExtremeMap : public Workplace {
protected:
    std::string scene(const std::string& file) const {
        return fmt::format("[surface]\nkind = \"height_map\"\nfile = \"{}\"\nsize = [\"8 mm\", \"6 mm\"]\nheight = \"1 "
                           "mm\"\n[force]\nshading = \"height_map\"\n[grid]\nsize = [21, 17, 5]\n"
                           "origin = [\"-5 mm\", \"-4 mm\", \"-1 mm\"]\nspacing = \"0.5 mm\"\n",
                           file);
    }

    // As surface and as texture.
    void expect_right(const std::string& file) const {
        SCOPED_TRACE(file);
        write("map.toml", scene(file));
        write("texture.toml",
              fmt::format("[texture]\nfile = \"{}\"\nsize = [\"8 mm\", \"6 mm\"]\nheight = \"1 mm\"\n[grid]\n"
                          "size = [21, 17, 5]\norigin = [\"-5 mm\", \"-4 mm\", \"-1 mm\"]\nspacing = \"0.5 mm\"\n",
                          file));
        for (const char* name : {"map.toml", "texture.toml"}) {
            const Outcome outcome = expect_success({"validate", name, "--quiet"});
            EXPECT_EQ(last_line(outcome.out), fmt::format("{} voxels, 0 differ", 2 * 21 * 17 * 5)) << outcome.out;
        }
    }

    void write_bowl(const std::string& name, const std::string& channel, Imf::PixelType type,
                    const ExrKind& kind = {}) const {
        write_exr(path(name), {{channel, {type, bowl}}}, kind);
    }
};

TEST_F(ExtremeMap, PicturesOfEveryKindAndOfOnePixelRowOrColumn) {
    const auto box = [](int width, int height) { return Imath::Box2i({0, 0}, {width - 1, height - 1}); };
    write_bowl("float.exr", "Y", Imf::FLOAT);
    write_bowl("half.exr", "Y", Imf::HALF);
    write_bowl("tiled.exr", "Y", Imf::FLOAT, {.tiled = true});
    write_bowl("pixel.exr", "Y", Imf::FLOAT, {box(1, 1), box(1, 1)});
    write_bowl("row.exr", "Y", Imf::FLOAT, {box(5, 1), box(5, 1)});
    write_bowl("column.exr", "Y", Imf::FLOAT, {box(1, 5), box(1, 5)});
    write_png(path("eight.png"), 3, {{0, 128, 255}, {3, 2, 1}});
    write_png(path("sixteen.png"), 2, {{0, 1, 255, 255}, {128, 0, 0, 0}}, {.depth = 16});
    write_png(path("pixel.png"), 1, {{255}});
    for (const char* name : {"float.exr", "half.exr", "tiled.exr", "pixel.exr", "row.exr", "column.exr", "eight.png",
                             "sixteen.png", "pixel.png"})
        expect_right(name);
}

TEST_F(ExtremeMap, SamplesThatRoundingTakesAcrossTheRimAreCounted) {
    write_bowl("bowl.exr", "Y", Imf::FLOAT);
    // The outermost samples lie 1e-10 mm beyond the rim, which single precision does not tell from the rim itself.
    const std::string beyond = "[surface]\nkind = \"height_map\"\nfile = \"bowl.exr\"\nsize = [\"8 mm\", \"6 mm\"]\n"
                               "height = \"1 mm\"\n[force]\nshading = \"height_map\"\n[grid]\nsize = [9, 7, 3]\n"
                               "origin = [\"-4.0000000001 mm\", \"-3 mm\", \"-1 mm\"]\nspacing = \"1 mm\"\n";
    write("rim.toml", beyond);
    for (const std::vector<std::string>& engine : {std::vector<std::string>{}, {"--engine", "cpu"}}) {
        std::vector<std::string> arguments{"validate", "rim.toml", "--json", "--quiet"};
        arguments.insert(arguments.end(), engine.begin(), engine.end());
        const nlohmann::json report = nlohmann::json::parse(expect_success(arguments).out);
        const nlohmann::json& single = report.at("cases").at(0);
        EXPECT_EQ(single.at("precision"), "f32");
        for (const char* referee : {"oracle_f64", "closed_form"}) {
            EXPECT_EQ(single.at(referee).at("boundary_voxels"), 7);
            EXPECT_LT(single.at(referee).at("relative_error"), 1e-6);
            EXPECT_EQ(report.at("cases").at(1).at(referee).at("boundary_voxels"), 0);
        }
    }
    const auto record = nlohmann::json::parse(
        expect_success({"field", "rim.toml", "--out", "rim.exr", "--json", "--quiet", "--engine", "gpu"}).out);
    EXPECT_EQ(record.at("oracle").at("voxels_on_edge"), 7);
    EXPECT_LT(record.at("oracle").at("largest_error_N"), 1e-6);
}

TEST_F(ExtremeMap, LargestAndSmallestValues) {
    for (const auto& [name, value] : {std::pair<std::string, double>("large.exr", 3e38),
                                      {"small.exr", 1e-38},
                                      {"denormal.exr", 1e-42},
                                      {"negative.exr", -0.5}}) {
        write_exr(path(name), {{"Y", {Imf::FLOAT, [value = value](int x, int y) { return (x + y) % 2 ? value : 0; }}}});
        if (name == "large.exr") {
            write("map.toml", scene(name));
            const Outcome outcome = forceshade({"validate", "map.toml", "--quiet"});
            EXPECT_TRUE(outcome.code == 0 || (outcome.code == 2 && outcome.error.find(name) != std::string::npos))
                << outcome.out << outcome.error;
        } else {
            expect_right(name);
        }
    }
}

TEST_F(ExtremeMap, AnAxisOfPicturesIsSwept) {
    write_bowl("a.exr", "Y", Imf::FLOAT);
    write_png(path("b.png"), 1, {{255}});
    std::string study = scene("a.exr");
    study.replace(study.find("\"a.exr\""), 7, "[\"a.exr\", \"b.png\"]");
    write("study.toml", study);
    expect_success({"sweep", "study.toml", "--out", "out", "--quiet"});
    EXPECT_EQ(read_json("out/manifest.json")["cases"].size(), 2u);
    // Another picture under the same name is another case.
    write_png(path("b.png"), 1, {{254}});
    const nlohmann::json said =
        nlohmann::json::parse(expect_success({"sweep", "study.toml", "--out", "out", "--quiet", "--json"}).out);
    EXPECT_EQ(said["computed"], 1);
    EXPECT_EQ(said["kept"], 1);
}

} // namespace
} // namespace forceshade::testing
