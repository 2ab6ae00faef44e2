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
    /// The device agrees with oracle and closed form on all `voxels`, in single and double precision.
    void expect_right(const std::string& scene, std::size_t voxels) const {
        SCOPED_TRACE(scene);
        write("scene.toml", scene);
        const Outcome outcome = expect_success({"validate", "scene.toml", "--quiet"});
        EXPECT_EQ(last_line(outcome.out), fmt::format("{} voxels, 0 differ", 2 * voxels)) << outcome.out;
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

// Symmetric about x = 0 and through z = 0, so that samples lie on both, and beyond the bump.
const std::string kAround = grid("[65, 1, 33]", "[\"-16 mm\", \"0 mm\", \"-8 mm\"]", "\"0.5 mm\"");
constexpr std::size_t kAroundVoxels = 65 * 33;

TEST_F(Extreme, radius_equal_to_half_of_the_width) {
    for (const char* kind : {"bump", "cylinder_bump"})
        expect_right(fmt::format("[surface]\nkind = \"{}\"\nradius = \"500 mil\"\n", kind) + kAround, kAroundVoxels);
    for (const char* depth : {"vertical", "normal"})
        for (const char* reference : {"normal", "radial"})
            expect_right(bump("500 mil", 3,
                              fmt::format("[force]\nshading = \"reference\"\ndepth = \"{}\"\nreference = \"{}\"\n",
                                          depth, reference)) +
                             kAround,
                         kAroundVoxels);
    // In other units too it is exactly the half.
    expect_right("[surface]\nwidth = \"1 in\"\nradius = \"12.7 mm\"\n" + kAround, kAroundVoxels);
}

TEST_F(Extreme, a_cylinders_axis_has_a_force_upwards) {
    // With R = a the axis is at z = 0, and its samples are exactly on it.
    const std::string surface = "[surface]\nkind = \"cylinder_bump\"\nradius = \"500 mil\"\n";
    const auto force = force_at(surface + grid("[1, 1, 1]", "[\"0 m\", \"0 m\", \"0 m\"]", "\"1 mm\""));
    EXPECT_EQ(force, (std::array<float, 3>{0, 0, 12.7f}));
    expect_right(surface + grid("[3, 1, 3]", "[\"-1 nm\", \"0 m\", \"-1 nm\"]", "\"1 nm\""), 9);
    // Radial shading has no direction there.
    expect_right(bump("500 mil", 2, "[force]\nshading = \"reference\"\nreference = \"radial\"\n") +
                     grid("[3, 1, 3]", "[\"-1 nm\", \"0 m\", \"-1 nm\"]", "\"1 nm\""),
                 9);
}

TEST_F(Extreme, radius_a_billion_times_half_of_the_width) {
    for (const int facets : {1, 2, 3, 1000})
        for (const char* shading : {"none", "reference"})
            expect_right(bump("12700 km", facets, fmt::format("[force]\nshading = \"{}\"\n", shading)) + kAround,
                         kAroundVoxels);
    expect_right("[surface]\nkind = \"cylinder_bump\"\nradius = \"12700 km\"\n" + kAround, kAroundVoxels);
    // U(0) = a^2 / 2R = 6.35 pm: an unshaded voxel at z = 0 feels it.
    const auto force = force_at(bump("12700 km", 2) + grid("[1, 1, 1]", "[\"0 m\", \"0 m\", \"0 m\"]", "\"1 mm\""));
    EXPECT_NEAR(force[2], 6.35e-9, 1e-13);
}

TEST_F(Extreme, facets_from_one_to_a_million) {
    for (const int facets : {1, 2, 3, 1000})
        for (const char* spacing : {"equal_arc", "equal_x"})
            expect_right(bump("600 mil", facets, fmt::format("facet_spacing = \"{}\"\n", spacing)) + kReference +
                             kAround,
                         kAroundVoxels);
    // The closed form looks at every facet for every column: few columns, at the edge, the middle and beside the bump.
    const std::string few =
        grid("[5, 2, 33]", "[\"-500 mil\", \"0 mm\", \"-8 mm\"]", "[\"251 mil\", \"1 mm\", \"0.5 mm\"]");
    expect_right(bump("600 mil", 1000000) + few, 330);
    expect_right(bump("600 mil", 1000000, "facet_spacing = \"equal_x\"\n") + kReference + few, 330);
}

TEST_F(Extreme, stiffness_from_a_billionth_to_a_trillion) {
    for (const char* stiffness : {"1e-9 N/m", "1e12 N/m", "1 MN/um"})
        for (const char* kind : {"bump", "cylinder_bump"})
            expect_right(fmt::format("[surface]\nkind = \"{}\"\n[force]\nstiffness = \"{}\"\n", kind, stiffness) +
                             kAround,
                         kAroundVoxels);
    const std::string grid_below = grid("[1, 1, 1]", "[\"20 mm\", \"0 m\", \"-1 m\"]", "\"1 mm\"");
    EXPECT_EQ(force_at("[force]\nstiffness = \"1e-9 N/m\"\n" + grid_below)[2], 1e-9f);
    EXPECT_EQ(force_at("[force]\nstiffness = \"1e12 N/m\"\n" + grid_below)[2], 1e12f);
}

TEST_F(Extreme, grid_a_kilometre_away) {
    for (const char* origin :
         {"[\"1 km\", \"1 km\", \"-4 mm\"]", "[\"-1 km\", \"0 m\", \"-4 mm\"]", "[\"-4 mm\", \"1 km\", \"-4 mm\"]",
          "[\"-4 mm\", \"0 m\", \"-1 km\"]", "[\"-4 mm\", \"0 m\", \"1 km\"]"})
        for (const char* kind : {"bump", "cylinder_bump"})
            expect_right(fmt::format("[surface]\nkind = \"{}\"\n", kind) + grid("[16, 2, 16]", origin, "\"0.5 mm\""),
                         512);
    // One precision only, so that single precision is not judged where its samples coincide: 1 km down, K = 1 N/mm.
    const std::string far_below = grid("[1, 1, 1]", "[\"1 km\", \"1 km\", \"-1 km\"]", "\"1 mm\"");
    EXPECT_EQ(force_at(far_below)[2], 1e6f);
    expect_right("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n"
                 "[force]\nshading = \"height_map\"\n" +
                     grid("[8, 8, 8]", "[\"1 km\", \"1 km\", \"-4 mm\"]", "\"0.5 mm\""),
                 512);
    expect_right("[surface]\nkind = \"height_map\"\nfunction = \"sine\"\nwidth = \"2 mm\"\n"
                 "[force]\nshading = \"height_map\"\n" +
                     grid("[8, 8, 8]", "[\"1 km\", \"1 km\", \"-4 mm\"]", "\"0.5 mm\""),
                 512);
}

TEST_F(Extreme, spacing_of_a_nanometre) {
    for (const char* origin :
         {"[\"0 m\", \"0 m\", \"-8 nm\"]", "[\"-12.7 mm\", \"0 m\", \"-8 nm\"]", "[\"5 mm\", \"0 m\", \"4 mm\"]"})
        for (const int facets : {2, 3})
            expect_right(bump("600 mil", facets) + kReference + grid("[16, 2, 16]", origin, "\"1 nm\""), 512);
}

TEST_F(Extreme, grids_of_one_voxel_and_one_plane) {
    for (const char* size :
         {"[1, 1, 1]", "[1, 8, 8]", "[8, 1, 8]", "[8, 8, 1]", "[1, 1, 8]", "[1, 8, 1]", "[8, 1, 1]"}) {
        const std::size_t ones = 3 - static_cast<std::size_t>(std::count(size, size + std::strlen(size), '8'));
        const std::size_t voxels = ones == 3 ? 1 : ones == 2 ? 8 : 64;
        const std::string where = grid(size, "[\"-3 mm\", \"-3 mm\", \"-3 mm\"]", "\"0.8 mm\"");
        expect_right(bump("600 mil", 3) + kReference + where, voxels);
        expect_right("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nradius = \"3 mm\"\n"
                     "[force]\nshading = \"height_map\"\n" +
                         where,
                     voxels);
        expect_success(
            {"field", "scene.toml", "--out", "field.exr", "--also", "npy,vti,vtp,png", "--quiet", "--engine", "gpu"});
        EXPECT_EQ(read_exr(path("field.exr")).parts.at("force").channels.at("B").size(), voxels);
    }
}

TEST_F(Extreme, depths_that_are_denormal) {
    // 1e-40 m is denormal in single precision, 1e-310 m in double.
    for (const char* step : {"1e-40 m", "1e-44 m", "1e-310 m"})
        expect_right(bump("600 mil", 1) + kReference +
                         grid("[4, 1, 4]", fmt::format("[\"0 m\", \"0 m\", \"-{}\"]", step),
                              fmt::format("[\"5 mm\", \"1 mm\", \"{}\"]", step)),
                     16);
    EXPECT_EQ(force_at("[force]\nstiffness = \"1 N/m\"\n" +
                       grid("[1, 1, 1]", "[\"0 m\", \"0 m\", \"-1e-40 m\"]", "\"1 mm\""))[2],
              1e-40f);
}

TEST_F(Extreme, voxels_exactly_on_the_plane_and_on_facet_boundaries) {
    // z = 0 is at k = 16, x = 0 (the middle boundary of two facets) at i = 32.
    for (const int facets : {1, 2, 4})
        for (const char* depth : {"vertical", "normal"})
            expect_right(
                bump("600 mil", facets,
                     fmt::format("[force]\ndepth = \"{}\"\n[output]\nchannels = [\"force\", \"facet\"]\n", depth)) +
                    kAround,
                kAroundVoxels);
    // Steps of W/4 from -W/2, exact in binary: every sample is on a boundary, which belongs to the facet on its right.
    const std::string boundaries =
        "[surface]\nwidth = \"4 m\"\nradius = \"3 m\"\nfacets = 4\nfacet_spacing = \"equal_x\"\n"
        "[output]\nchannels = [\"facet\"]\n" +
        grid("[5, 1, 1]", "[\"-2 m\", \"0 m\", \"-1 mm\"]", "\"1 m\"");
    expect_right(boundaries, 5);
    expect_success({"field", "scene.toml", "--out", "field.exr", "--precision", "f64", "--quiet", "--engine", "gpu"});
    const auto facets = read_exr(path("field.exr")).parts.at("facet").channels.at("id");
    EXPECT_EQ(std::vector<float>(facets.begin(), facets.begin() + 4), (std::vector<float>{0, 1, 2, 3}));
    // Out of contact by no more than nothing: z = 0 beside the bump, F = 0.
    EXPECT_EQ(force_at(grid("[1, 1, 1]", "[\"20 mm\", \"0 m\", \"0 m\"]", "\"1 mm\"")), (std::array<float, 3>{}));
}

TEST_F(Extreme, forces_too_small_for_a_volume_are_told) {
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

TEST_F(Extreme, meshes_of_wildly_mixed_magnitudes_are_taken_or_refused) {
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

TEST_F(Extreme, all_channels_and_kinds_of_pixels) {
    for (const char* pixel : {"float", "half"})
        for (const char* compression : {"none", "zip1", "zip", "pxr24"}) {
            write("scene.toml", bump("600 mil", 3) + kReference + kAround +
                                    fmt::format("[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\", "
                                                "\"unshaded\"]\npixel = \"{}\"\ncompression = \"{}\"\n",
                                                pixel, compression));
            expect_success({"field", "scene.toml", "--out", "field.exr", "--quiet", "--engine", "gpu"});
            EXPECT_EQ(read_exr(path("field.exr")).parts.size(), 5u);
        }
    expect_success({"validate", "scene.toml", "--quiet"});
}

TEST_F(Extreme, texture_on_everything) {
    for (const char* kind : {"kind = \"bump\"\nfacets = 3\n", "kind = \"cylinder_bump\"\n"})
        for (const char* texture :
             {"function = \"sine\"\nwidth = \"2 mm\"\n", "function = \"gaussian\"\nradius = \"3 mm\"\n",
              "function = \"dip\"\nwidth = \"2 mm\"\nradius = \"1 mm\"\n"})
            expect_right(fmt::format("[surface]\n{}[texture]\nstiffness = \"1e12 N/m\"\n{}", kind, texture) +
                             grid("[17, 3, 9]", "[\"-4 mm\", \"-0.5 mm\", \"-4 mm\"]", "\"0.5 mm\""),
                         17 * 3 * 9);
}

} // namespace
} // namespace forceshade::testing
