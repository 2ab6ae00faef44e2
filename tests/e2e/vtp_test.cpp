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

class Vtp : public Paths {
protected:
    void expect_good(const std::string& script, const std::string& argument = "") const {
        write("read.py", kReader + script);
        const Outcome outcome =
            run({.arguments = {"read.py", argument}, .folder = folder_.path(), .program = "/usr/bin/python3"});
        EXPECT_EQ(outcome.out, "good\n") << outcome.error << "package python3-numpy";
    }
};

TEST_F(Vtp, OfAMeshHoldsWhatAProbeFeelsOnEachFacet) {
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

// What may be held of the rows of paths is bounded already; lines add their buffers.
TEST_F(Vtp, OfLongPathsTakesNoMemoryForSamples) {
    write("long.toml", scene("count = 5\nsteps = 200000\n")); // a million samples of 64 bytes
    const std::uint64_t plain = expect_success(explore("long.toml", "a.csv")).peak_memory,
                        lines = expect_success(explore("long.toml", "a.csv", {"--also", "vtp"})).peak_memory;
    EXPECT_LT(lines, plain + 32 * kMebibyte) << plain / kMebibyte << " MiB, then " << lines / kMebibyte;
    EXPECT_GT(std::filesystem::file_size(path("a.vtp")), 4 * kMebibyte);
}

} // namespace
} // namespace forceshade::testing
