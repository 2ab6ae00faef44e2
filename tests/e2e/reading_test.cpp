// Volumes read by other people's programs, and what must not stand in them.
#include <cstring>

#include <fmt/format.h>
#include <unistd.h>

#include "tests/e2e/volume.h"
#include "tests/e2e/workplace.h"
#include "tests/io/picture.h"
#include "tests/places.h"

namespace forceshade::testing {
namespace {

// Everything that NumPy can say of a volume with all channels, against the arrays beside it.
constexpr const char* kPython = R"(
import sys, numpy, OpenImageIO
image = OpenImageIO.ImageInput.open("field.exr")
nx, ny, nz = image.spec().getattribute("forceshade.grid")
assert (nx, ny, nz) == (16, 4, 8), (nx, ny, nz)
assert image.spec().getattribute("forceshade.scene").startswith("[surface]")
parts = {}
part = 0
while image.seek_subimage(part, 0):
    spec = image.spec()
    pixels = image.read_image(part, 0, 0, spec.nchannels, OpenImageIO.UNKNOWN)
    parts[spec.getattribute("oiio:subimagename") or spec.getattribute("name")] = (spec.channelnames, pixels.reshape(nz, ny, nx, -1))
    part += 1
assert sorted(parts) == ["depth", "facet", "force", "proxy", "unshaded"], sorted(parts)
assert tuple(parts["force"][0]) == ("R", "G", "B"), parts["force"][0]
for name, (channels, values) in parts.items():
    array = numpy.load(f"field.{name}.npy")
    values = values if array.ndim == 4 else values[..., 0]
    assert array.shape == values.shape and array.dtype == values.dtype, (name, array.shape, values.shape, array.dtype, values.dtype)
    assert array.tobytes() == values.tobytes(), name
force = parts["force"][1]
assert force.shape == (8, 4, 16, 3) and force.dtype == numpy.float32
assert numpy.abs(force).max() > 1
print("good")
)";

class Reading : public Workplace {
protected:
    Reading() {
        write("scene.toml", std::string(kOneCase) + "[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\", "
                                                    "\"unshaded\"]\n");
        expect_success({"field", "scene.toml", "--out", "field.exr", "--also", "npy,vti,png", "--quiet"});
    }
    Outcome tool(const std::string& program, std::vector<std::string> arguments) const {
        return run({.arguments = std::move(arguments), .folder = folder_.path(), .program = "/usr/bin/" + program});
    }
};

TEST_F(Reading, WithNumpyGivesTheArraysBesideIt) {
    write("read.py", kPython);
    const Outcome outcome = tool("python3", {"read.py"});
    EXPECT_EQ(outcome.out, "good\n") << outcome.error << "packages python3-numpy and python3-openimageio";
}

// Paths' columns as arrays, held against the CSV.
constexpr const char* kPythonPaths = R"(
import csv, numpy
rows = list(csv.DictReader(open("all.csv")))
load = lambda name: numpy.load(f"{name}.npy", mmap_mode="r")
paths, steps = load("felt.facet").shape
assert len(rows) == paths * steps
for name, columns in (("position", "xyz"), ("proxy", ("gx", "gy", "gz")), ("force", ("fx", "fy", "fz"))):
    array = load("felt." + name)
    assert array.shape == (paths, steps, 3) and array.dtype == numpy.float32, name
    for i, column in enumerate(columns):
        assert (array[..., i].ravel() == numpy.array([row[column] for row in rows], numpy.float32)).all(), column
assert (load("felt.depth").ravel() == numpy.array([row["depth"] for row in rows], numpy.float32)).all()
assert (load("felt.facet").astype(numpy.int32).ravel() == numpy.array([row["facet"] for row in rows], numpy.int32)).all()
time = load("felt.time")
assert time.shape == (steps,) and time.dtype == numpy.float64
assert (numpy.tile(time, paths) == numpy.array([row["t"] for row in rows], float)).all()
# Recorded paths have times of their own, and end where they end.
rows = list(csv.DictReader(open("in.csv")))
time = load("again.time")
assert time.shape == load("again.force").shape[:2] == (2, 3)
assert time[0].tolist() == [float(row["t"]) for row in rows[:3]]
assert time[1, 0] == 7 and numpy.isnan(time[1, 1:]).all() and numpy.isnan(load("again.force")[1, 1:]).all()
print("good")
)";

TEST_F(Reading, OfPathsWithNumpyGivesTheColumnsOfTheirCsv) {
    write("paths.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n[paths]\ncount = 12\nsteps = 150\n"
                        "press = \"1 N\"\n[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\"]\n");
    write("in.csv", "path,t,x,y,z\n4,0.25,0,0,0.003\n4,0.5,0.001,0,0.003\n4,1,0.002,0,0.003\n9,7,0,0,0.003\n");
    write("plain.toml", "[surface]\nfacets = 3\n");
    expect_success({"explore", "paths.toml", "--out", "all.csv", "--quiet"});
    const Outcome outcome = expect_success({"explore", "paths.toml", "--out", "felt.npy"});
    EXPECT_TRUE(says(outcome.error, "wrote felt.force.npy", "felt.time.npy"));
    EXPECT_FALSE(std::filesystem::exists(path("felt.npy")));
    EXPECT_EQ(read_text(path("felt.paths.csv")), read_text(path("all.paths.csv")));
    expect_success({"explore", "plain.toml", "--paths", "in.csv", "--out", "again.npy", "--quiet"});
    write("read.py", kPythonPaths);
    const Outcome read = tool("python3", {"read.py"});
    EXPECT_EQ(read.out, "good\n") << read.error;
    expect_failure(2, {"explore", "paths.toml", "--out", "felt.npy", "--also", "html"}, {"felt.exr --also npy,html"});
}

// Width and height of a PNG.
std::pair<unsigned, unsigned> size_of_png(const std::string& bytes) {
    const auto number = [&](std::size_t at) {
        unsigned value = 0;
        for (std::size_t i = at; i < at + 4; ++i)
            value = value * 256 + static_cast<unsigned char>(bytes.at(i));
        return value;
    };
    return {number(16), number(20)};
}

TEST_F(Reading, FindsPicturesAsTheyWereAskedFor) {
    expect_success({"field", "scene.toml", "--out", "a.exr", "--also", "png,svg,pdf", "--title", "A title", "--size",
                    "800x600", "--quantity", "turn", "--slice", "x", "--quiet"});
    for (const std::string kind : {"arrows", "mosaic", "shading"}) {
        const auto [width, height] = size_of_png(read_text(path("a." + kind + ".png")));
        EXPECT_EQ(width, 800u) << kind;
        EXPECT_LE(height, 600u) << kind;
        EXPECT_TRUE(says(read_text(path("a." + kind + ".svg")), "viewBox=\"0 0 800 ")) << kind;
        EXPECT_TRUE(read_text(path("a." + kind + ".pdf")).starts_with("%PDF-")) << kind;
    }
    expect_success({"field", "scene.toml", "--out", "b.exr", "--also", "png", "--quiet"});
    EXPECT_EQ(size_of_png(read_text(path("b.arrows.png"))).first, 1400u);
    EXPECT_FALSE(std::filesystem::exists(path("b.arrows.svg")));
    expect_success(
        {"field", "scene.toml", "--out", "b.exr", "--also", "png", "--quiet", "--full-scale", "50 N", "--overwrite"});
    const std::string paler = read_text(path("b.mosaic.png"));
    expect_success(
        {"field", "scene.toml", "--out", "b.exr", "--also", "png", "--quiet", "--full-scale", "1 N", "--overwrite"});
    EXPECT_NE(read_text(path("b.mosaic.png")), paler) << "colours end at that force";
}

TEST_F(Reading, WithOpenexrsToolsFindsNothingWrong) {
    EXPECT_EQ(tool("exrheader", {"field.exr"}).code, 0) << "package openexr";
    // exrinfo 3.1.5 returns a number that it never set: what it prints decides.
    const Outcome info = tool("exrinfo", {"-v", "field.exr"});
    EXPECT_EQ(info.error, "");
    EXPECT_TRUE(says(info.out, "forceshade.grid: v3i [ 16, 4, 8 ]"));
    if (std::filesystem::exists("/usr/bin/exrcheck")) {
        EXPECT_EQ(tool("exrcheck", {"field.exr"}).code, 0);
    }
}

TEST_F(Reading, FindsGridAttributesAndASceneThatGivesTheSameVolume) {
    const ReadVolume volume = read_exr(path("field.exr"));
    EXPECT_EQ(volume.grid, (std::array{16, 4, 8}));
    EXPECT_EQ(volume.origin, (std::array{-14e-3, -1e-3, -4e-3}));
    EXPECT_EQ(volume.spacing, (std::array{1.8e-3, 0.5e-3, 0.6e-3}));
    write("again.toml", volume.texts.at("forceshade.scene"));
    expect_success({"field", "again.toml", "--out", "again.exr", "--quiet"});
    EXPECT_TRUE(read_text(path("again.exr")) == read_text(path("field.exr")));
    EXPECT_EQ("forceshade " + volume.texts.at("forceshade.version") + "\n", expect_success({"--version"}).out);
    for (const auto& [part, type] : {std::pair("force", "float"), {"depth", "float"}, {"facet", "uint"}})
        EXPECT_EQ(volume.parts.at(part).types.begin()->second, type) << part;
}

TEST_F(Reading, FindsRowZTimesNyPlusY) {
    // A texture makes the field depend on y: each voxel alone must be what it is in the whole.
    const std::string law = "[texture]\nstiffness = \"0.5 N/mm\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n";
    write("whole.toml", law + "[grid]\nsize = [5, 4, 3]\norigin = [\"-3 mm\", \"-2 mm\", \"-1 mm\"]\n"
                              "spacing = [\"1 mm\", \"0.75 mm\", \"0.25 mm\"]\n");
    expect_success({"field", "whole.toml", "--out", "whole.exr", "--quiet"});
    const auto whole = read_exr(path("whole.exr")).parts.at("force");
    EXPECT_EQ(whole.width, 5);
    EXPECT_EQ(whole.height, 12);
    for (const auto& [i, j, k] : {std::array{4, 3, 1}, {2, 1, 0}, {1, 3, 2}}) {
        write("one.toml", law + fmt::format("[grid]\nsize = [1, 1, 1]\norigin = [\"{} mm\", \"{} mm\", \"{} mm\"]\n",
                                            -3 + i, -2 + 0.75 * j, -1 + 0.25 * k));
        expect_success({"field", "one.toml", "--out", "one.exr", "--quiet"});
        const auto one = read_exr(path("one.exr")).parts.at("force");
        for (const auto& [name, samples] : one.channels)
            EXPECT_NEAR(samples[0], whole.channels.at(name)[static_cast<std::size_t>((k * 4 + j) * 5 + i)], 1e-6);
    }
}

TEST_F(Reading, FindsNoPathOfTheMachine) {
    const std::string place = path("secret place").string();
    std::filesystem::create_directory(place);
    write_png(path("secret place/map.png"), 2, {{0, 255}, {255, 0}});
    for (const std::string& file : {place + "/map.png", std::string("secret place/map.png")}) {
        write("map.toml",
              fmt::format("[surface]\nkind = \"height_map\"\nfile = \"{}\"\nsize = [\"8 mm\", \"6 mm\"]\n"
                          "height = [\"1 mm\", \"2 mm\"]\n[force]\nshading = \"height_map\"\n[grid]\n"
                          "size = [8, 8, 4]\norigin = [\"-4 mm\", \"-4 mm\", \"-1 mm\"]\nspacing = \"1 mm\"\n",
                          file));
        expect_success({"sweep", path("map.toml"), "--out", path("out"), "--also", "npy,vti,vtp,png", "--fresh"});
        char host[256] = {};
        ::gethostname(host, sizeof host - 1);
        std::vector<std::string> secrets{"secret place", folder_.path().string(), in_source("")};
        if (std::strlen(host) > 5)
            secrets.emplace_back(host);
        for (const auto& [name, content] : tree_of(path("out")))
            for (const std::string& secret : secrets)
                EXPECT_EQ(content.find(secret), std::string::npos) << secret << " stands in " << name;
        EXPECT_TRUE(says(read_text(path("out/study.toml")), "sha256")) << "the map by its digest";
    }
}

} // namespace
} // namespace forceshade::testing
