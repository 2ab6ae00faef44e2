// Files for ParaView, read with nothing but Python's own zlib and XML: what stands on a surface and on paths is what
// the program itself feels there.
#include <fmt/format.h>

#include "tests/e2e/path_workplace.h"

namespace forceshade::testing {
namespace {

// read(NAME): XML root, and arrays by name.
constexpr const char* kReader = R"(
import csv, numpy, struct, sys, xml.etree.ElementTree, zlib
types = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}
def read(name):
    data = open(name, "rb").read()
    cut = data.index(b"<AppendedData")
    start = data.index(b"_", cut) + 1
    root = xml.etree.ElementTree.fromstring(data[:cut] + b"</VTKFile>")
    arrays = {}
    for array in root.iter("DataArray"):
        if array.get("format") == "appended":
            at = start + int(array.get("offset"))
            blocks, _, _ = struct.unpack_from("<3Q", data, at)
            sizes = struct.unpack_from(f"<{blocks}Q", data, at + 24)
            at += 24 + 8 * blocks
            parts = []
            for size in sizes:
                parts.append(zlib.decompress(data[at:at + size]))
                at += size
            numbers = numpy.frombuffer(b"".join(parts), types[array.get("type")])
            count = int(array.get("NumberOfComponents"))
            arrays[array.get("Name")] = numbers.reshape(-1, count) if count > 1 else numbers
    return root, arrays
def columns(name):
    with open(name) as file:
        rows = list(csv.DictReader(file))
    return {key: numpy.array([float(row[key]) for row in rows]) for key in rows[0]}
)";

// Writes a path for each facet: from just above its middle to 1 mm below it, along the facet's normal.
constexpr const char* kPress = R"(
root, surface = read("spot.vtp")
triangles = surface["Points"][surface["connectivity"].reshape(-1, 3)]
middle = triangles.mean(axis=1)
normal = numpy.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
normal /= numpy.linalg.norm(normal, axis=1)[:, None]
with open("in.csv", "w") as file:
    file.write("path,t,x,y,z\n")
    for i in range(len(middle)):
        for t, height in ((0, 1e-6), (1, -1e-3)):
            file.write("%d,%d,%.17g,%.17g,%.17g\n" % (i, t, *(middle[i] + height * normal[i])))
)";

// The corners' forces, interpolated at the middle, are what was felt there.
constexpr const char* kCompare = R"(
root, surface = read("spot.vtp")
felt = columns("felt.csv")
pressed = felt["t"] == 1
facet = felt["facet"][pressed]
force = numpy.stack([felt[c][pressed] for c in ("fx", "fy", "fz")], axis=1)
count = len(facet)
assert count == 5856 and (surface["facet"] == numpy.arange(count)).all(), count
assert (surface["offsets"] == 3 * numpy.arange(1, count + 1)).all()
assert surface["force"].dtype == numpy.float64
corners = surface["force"][surface["connectivity"].reshape(-1, 3)]
size = numpy.linalg.norm(corners, axis=2)
assert abs(size - 1).max() < 1e-9, "1 N/mm times 1 mm"
expected = corners.sum(axis=1)
expected /= numpy.linalg.norm(expected, axis=1)[:, None]
own = facet == numpy.arange(count)
assert own.mean() > 0.97, own.mean()
error = numpy.linalg.norm(force - expected, axis=1)[own].max()
assert error < 1e-8, error
unshaded = surface["unshaded"][surface["connectivity"].reshape(-1, 3)]
assert numpy.linalg.norm(unshaded - unshaded[:, :1], axis=2).max() < 1e-12, "one for a facet"
angle = numpy.degrees(numpy.arccos(numpy.clip((corners * unshaded).sum(axis=2), -1, 1)))
assert abs(angle.reshape(-1) - surface["turn"][surface["connectivity"]]).max() < 1e-5
assert (surface["turn"].max() > 10) == (sys.argv[1] != "none"), surface["turn"].max()
print("good")
)";

// Points and numbers of the lines against the rows of the CSV file beside them.
constexpr const char* kLines = R"(
root, lines = read("a.vtp")
table = columns("a.csv")
real = lines["force"].dtype
assert real == (numpy.float32 if sys.argv[1] == "f32" else numpy.float64), real
for name, (x, y, z) in (("Points", "xyz"), ("force", ("fx", "fy", "fz")), ("proxy", ("gx", "gy", "gz"))):
    rows = numpy.stack([table[c] for c in (x, y, z)], axis=1).astype(real)
    assert (lines[name] == rows).all(), name
assert (lines["depth"] == table["depth"].astype(real)).all()
assert (lines["facet"] == table["facet"]).all()
assert (lines["time"] == table["t"]).all()
assert (lines["connectivity"] == numpy.arange(len(table["t"]))).all()
begins = numpy.concatenate(([0], lines["offsets"][:-1]))
assert (lines["path"] == table["path"][begins]).all()
assert lines["offsets"][-1] == len(table["t"])
assert (numpy.repeat(lines["path"], numpy.diff(lines["offsets"], prepend=0)) == table["path"]).all()
piece = root.find("PolyData/Piece")
assert int(piece.get("NumberOfLines")) == len(lines["path"]) and int(piece.get("NumberOfPoints")) == len(table["t"])
print("good")
)";

class Vtp : public Paths {
protected:
    void expect_good(const std::string& script, const std::string& argument = "") const {
        write("read.py", kReader + script);
        const Outcome outcome =
            run({.arguments = {"read.py", argument}, .folder = folder_.path(), .program = "/usr/bin/python3"});
        EXPECT_EQ(outcome.out, "good\n") << outcome.error << "package python3-numpy";
    }
};

TEST_F(Vtp, of_a_mesh_holds_what_a_probe_feels_on_each_facet) {
    for (const char* shading : {"none", "mean_value"}) {
        write("spot.toml", fmt::format("[surface]\nkind = \"mesh\"\nfile = \"{}/tests/data/spot.obj\"\n"
                                       "transform = {{ scale = 0.05, rotate = [\"90 deg\", \"0 deg\", \"0 deg\"] }}\n"
                                       "[force]\nshading = \"{}\"\n[grid]\nsamples = 8\n",
                                       FORCESHADE_SOURCE, shading));
        const Outcome outcome =
            expect_success({"field", "spot.toml", "--out", "spot.exr", "--also", "vtp", "--precision", "f64"});
        EXPECT_NE(outcome.error.find("wrote spot.exr and spot.vtp\n"), std::string::npos) << outcome.error;
        expect_good(std::string(kPress) + "print(\"good\")\n");
        expect_success({"explore", "spot.toml", "--paths", "in.csv", "--out", "felt.csv", "--precision", "f64",
                        "--engine", "cpu"});
        expect_good(kCompare, shading);
    }
}

TEST_F(Vtp, of_paths_holds_what_the_csv_file_does) {
    std::string rows = "path,t,x,y,z\n";
    for (int p = 30; p > 0; p -= 10)
        for (int i = 0; i < 3 * p; ++i)
            rows += fmt::format("{},{:.6g},{:.6g},{},{}\n", p, 100 + i * 0.002, (i - 40) * 3e-4, p * 1e-4,
                                i % 7 ? 0.003 : 0.1);
    write("in.csv", rows);
    write("plain.toml", "[surface]\nfacets = 3\n[force]\nshading = \"reference\"\n");
    for (const char* precision : {"f32", "f64"}) {
        const std::vector<std::string> also{"--also", "vtp", "--precision", precision};
        const Outcome outcome = expect_success(explore("open.toml", "a.csv", also));
        EXPECT_NE(outcome.error.find("wrote a.csv, a.paths.csv and a.vtp\n"), std::string::npos) << outcome.error;
        expect_good(kLines, precision);
        expect_success(explore("closed.toml", "a.csv", also));
        expect_good(kLines, precision);
        expect_success(
            explore("plain.toml", "a.csv", {"--also", "vtp", "--precision", precision, "--paths", "in.csv"}));
        expect_good("assert (read(\"a.vtp\")[1][\"facet\"] == -1).any()\n" + std::string(kLines), precision);
    }
    // What samples an EXR file does not hold is in the lines all the same, but for the proxies.
    expect_success(explore("open.toml", "a.exr", {"--also", "vtp"}));
    expect_good("root, lines = read(\"a.vtp\")\nassert sorted(lines) == "
                "[\"Points\", \"connectivity\", \"depth\", \"facet\", \"force\", \"offsets\", \"path\", \"time\"], "
                "sorted(lines)\nprint(\"good\")\n");
    EXPECT_EQ(temporaries_in(folder_.path()), std::vector<std::string>{});
}

TEST_F(Vtp, stands_in_sweeps_with_its_hash_and_is_made_again_byte_for_byte) {
    const std::string study = "[surface]\nfacets = [1, 3]\n[force]\nshading = \"reference\"\n"
                              "[grid]\nsize = [16, 4, 8]\norigin = [\"-14 mm\", \"-1 mm\", \"-4 mm\"]\n"
                              "spacing = \"1.8 mm\"\n";
    write("study.toml", study + "[paths]\ncount = 5\nsteps = 40\n");
    const auto sweep = [&](const char* out, std::vector<std::string> more = {"--also", "vtp"}) {
        more.insert(more.begin(), {"sweep", "study.toml", "--out", out, "--engine", "cpu"});
        return expect_success(more).error;
    };
    sweep("s");
    const Tree first = results_in(path("s"));
    const nlohmann::json manifest = read_json("s/manifest.json");
    for (const char* stem : {"bump_facets-1", "bump_facets-3"})
        for (const char* end : {".vtp", ".paths.vtp"}) {
            const std::string name = std::string(stem) + end;
            ASSERT_TRUE(first.contains(name)) << name;
            bool listed = false;
            for (const nlohmann::json& one : manifest["cases"])
                for (const nlohmann::json& file : one["files"])
                    if (file["name"] == name) {
                        listed = true;
                        EXPECT_EQ(file["bytes"], first.at(name).size());
                        EXPECT_EQ(file["sha256"].get<std::string>().size(), 64u);
                    }
            EXPECT_TRUE(listed) << name;
        }
    sweep("t");
    EXPECT_EQ(differences(first, results_in(path("t"))), std::set<std::string>{}) << "the same bytes in every run";
    EXPECT_NE(sweep("s").find("0 computed, 2 kept"), std::string::npos);
    for (const char* name : {"s/bump_facets-1.vtp", "s/bump_facets-3.paths.vtp"}) {
        write(name, "damaged");
        EXPECT_NE(sweep("s").find("1 computed"), std::string::npos) << name;
        EXPECT_EQ(differences(first, results_in(path("s"))), std::set<std::string>{});
    }
    // What nobody asks for any more follows its case all the same; what the case no longer has goes.
    write("study.toml", study);
    sweep("s", {});
    EXPECT_TRUE(std::filesystem::exists(path("s/bump_facets-1.vtp")));
    EXPECT_FALSE(std::filesystem::exists(path("s/bump_facets-1.paths.vtp")));
    const Outcome foreseen =
        expect_success({"sweep", "study.toml", "--out", "u", "--also", "vtp", "--dry-run", "--json"});
    EXPECT_GT(nlohmann::json::parse(foreseen.out)["expected_bytes"], first.at("bump_facets-1.vtp").size());
}

TEST_F(Vtp, is_replaced_only_if_that_is_asked_for) {
    const auto outcome = [&](std::vector<std::string> arguments, const char* further) {
        Launch launch = this->launch({});
        launch.arguments = std::move(arguments);
        launch.arguments.insert(launch.arguments.end(), {"--also", "vtp", "--engine", "cpu"});
        if (*further)
            launch.arguments.emplace_back(further);
        return run(launch);
    };
    write("bump.toml", kOneCase);
    const std::vector<std::vector<std::string>> commands{{"field", "bump.toml", "--out", "f.exr"},
                                                         {"explore", "open.toml", "--out", "e.exr"}};
    for (const std::vector<std::string>& command : commands) {
        const std::string name = command.back().substr(0, 1) + ".vtp";
        write(name, "mine");
        const Outcome refused = outcome(command, "");
        EXPECT_EQ(refused.code, 2);
        EXPECT_NE(refused.error.find(name + " is there already"), std::string::npos) << refused.error;
        EXPECT_EQ(outcome(command, "--no-clobber").code, 0);
        EXPECT_EQ(read_text(path(name)), "mine");
        EXPECT_EQ(outcome(command, "--overwrite").code, 0);
        EXPECT_TRUE(read_text(path(name)).starts_with("<?xml"));
    }
}

// What may be held of the rows of paths is bounded already; lines add their buffers.
TEST_F(Vtp, of_long_paths_takes_no_memory_for_samples) {
    write("long.toml", scene("count = 5\nsteps = 200000\n")); // a million samples of 64 bytes
    const std::uint64_t plain = expect_success(explore("long.toml", "a.csv")).peak_memory,
                        lines = expect_success(explore("long.toml", "a.csv", {"--also", "vtp"})).peak_memory;
    EXPECT_LT(lines, plain + 32 * kMebibyte) << plain / kMebibyte << " MiB, then " << lines / kMebibyte;
    EXPECT_GT(std::filesystem::file_size(path("a.vtp")), 4 * kMebibyte);
}

} // namespace
} // namespace forceshade::testing
