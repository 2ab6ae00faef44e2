// A scene is felt alike wherever it lies: forces, proxies and what is written of places, far from the world's origin
// and in single precision; and where that is too coarse, a warning says so.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/cases/case_pipeline.h"
#include "host/field/engine.h"
#include "host/output/exr_volume.h"
#include "host/output/rows.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/paths/explored.h"
#include "tests/paths/path_workplace.h"

namespace forceshade::testing {
namespace {

constexpr double kStiffness = 2; /* N/m */

// To 2^-16 m, so that a shift by whole metres changes nothing of it in double.
glm::dvec3 rounded(const glm::dvec3& place) {
    return {std::round(place.x * 0x1p16) * 0x1p-16, std::round(place.y * 0x1p16) * 0x1p-16,
            std::round(place.z * 0x1p16) * 0x1p-16};
}

class FarScene : public PathWorkplace {
protected:
    FarScene() {
        PolygonSoup ball = shapes::icosphere(2);
        for (glm::dvec3& vertex : ball.vertices)
            vertex = rounded(vertex);
        write("ball.obj", as_obj(ball));
    }

    // A ball of 1 m about `shift`, m.
    static std::string ball(const glm::dvec3& shift, const std::string& more) {
        return fmt::format(
            "[surface]\nkind = \"mesh\"\nfile = \"ball.obj\"\n"
            "transform = {{ translate = [\"{} m\", \"{} m\", \"{} m\"] }}\n[force]\nstiffness = \"{} N/m\"\n{}",
            shift.x, shift.y, shift.z, kStiffness, more);
    }

    // Spirals over the ball, in and out of it.
    static std::vector<glm::dvec3> way() {
        std::vector<glm::dvec3> places;
        for (int i = 0; i <= 400; ++i) {
            const double share = i / 400.0, along = std::numbers::pi * (0.1 + 0.8 * share), round = 25 * share;
            const double r = 0.9 + 0.2 * std::cos(40 * share);
            places.push_back(rounded(
                {r * std::sin(along) * std::cos(round), r * std::sin(along) * std::sin(round), r * std::cos(along)}));
        }
        return places;
    }

    static std::string rows(const std::vector<glm::dvec3>& places, const glm::dvec3& shift) {
        std::string text = "path,t,x,y,z\n";
        for (std::size_t i = 0; i < places.size(); ++i) {
            const glm::dvec3 at = places[i] + shift;
            text += fmt::format("0,{},{},{},{}\n", i, at.x, at.y, at.z);
        }
        return text;
    }

    // The proxy from where the scene was shifted to.
    std::vector<Felt> along_paths(const glm::dvec3& shift, const std::string& more = "") const {
        std::vector<Felt> all = felt_rows(felt(prepare(ball(shift, more), Precision::f32), rows(way(), shift)));
        for (Felt& one : all)
            one.proxy -= shift;
        return all;
    }

    // Over a grid about the ball: force, proxy and facet alone.
    std::vector<Felt> over_grid(const glm::dvec3& shift) const {
        constexpr double kBegin = -1.109375, kSpacing = 0.140625; /* m */
        const PreparedCase prepared =
            prepare(ball(shift, fmt::format("[grid]\nsize = [16, 16, 16]\norigin = [\"{} m\", \"{} m\", \"{} m\"]\n"
                                            "spacing = \"{} m\"\n"
                                            "[output]\nchannels = [\"force\", \"proxy\", \"facet\"]\n",
                                            shift.x + kBegin, shift.y + kBegin, shift.z + kBegin, kSpacing)),
                    Precision::f32);
        const FieldTables<float> tables = make_tables<float>(prepared.one.scene, prepared.images, Extent::everything);
        EngineOptions options;
        options.cpu = true;
        std::vector<float> force, proxy;
        std::vector<layout::uint> facet;
        make_engine(options)->evaluate<float>(tables.input(), [&](const layout::FieldChunk<float>& chunk) {
            append_rows(chunk, chunk.force, 3, 1, force);
            append_rows(chunk, chunk.proxy, 3, 1, proxy);
            append_rows(chunk, chunk.facet, 1, 1, facet);
        });
        std::vector<Felt> all;
        const glm::dvec3 origin = scene_origin(prepared);
        for (std::size_t i = 0; i < facet.size(); ++i)
            all.push_back({{},
                           origin + glm::dvec3(reference::vector_at<float>(proxy, i)) - shift,
                           glm::dvec3(reference::vector_at<float>(force, i)),
                           0,
                           int(facet[i])});
        return all;
    }

    // `tolerance`: of the largest force, and of the ball's size.
    static void expect_alike(const std::vector<Felt>& here, const std::vector<Felt>& there, double tolerance) {
        ASSERT_EQ(here.size(), there.size());
        double largest = 0, force = 0, proxy = 0;
        std::size_t touching = 0;
        for (std::size_t i = 0; i < here.size(); ++i) {
            touching += here[i].facet >= 0;
            largest = std::max(largest, glm::length(here[i].force));
            force = std::max(force, glm::length(there[i].force - here[i].force));
            proxy = std::max(proxy, glm::length(there[i].proxy - here[i].proxy));
        }
        EXPECT_GT(touching, here.size() / 10);
        EXPECT_LE(force, tolerance * largest);
        EXPECT_LE(proxy, 2 * tolerance);
    }
};

// Of a tenth of a metre to 10^7 sizes.
std::vector<glm::dvec3> shifts() {
    std::vector<glm::dvec3> all;
    for (double sizes = 10; sizes <= 1e7; sizes *= 10)
        all.insert(all.end(), {{2 * sizes, -2 * sizes, 2 * sizes},
                               {0, 2 * sizes, 0},
                               {2 * sizes + 0.3125, -2 * sizes - 0.4375, 0.1875 - 2 * sizes}});
    return all;
}

TEST_F(FarScene, IsFeltAlikeAlongPaths) {
    for (const char* const more : {"", "shading = \"mean_value\"\n"}) {
        const std::vector<Felt> here = along_paths(glm::dvec3(0), more);
        for (const glm::dvec3& shift : shifts()) {
            SCOPED_TRACE(fmt::format("{} m, {} m, {} m", shift.x, shift.y, shift.z));
            expect_alike(here, along_paths(shift, more), 1e-6);
        }
    }
}

TEST_F(FarScene, HasTheSameField) {
    const std::vector<Felt> here = over_grid(glm::dvec3(0));
    for (const glm::dvec3& shift : shifts()) {
        SCOPED_TRACE(fmt::format("{} m, {} m, {} m", shift.x, shift.y, shift.z));
        expect_alike(here, over_grid(shift), 1e-6);
    }
}

TEST_F(FarScene, GivesTheSameForcesBitForBitWhereTheShiftIsOfWholeScales) {
    const std::vector<Felt> here = along_paths(glm::dvec3(0)), there = along_paths({1 << 24, -4096, 64});
    ASSERT_EQ(here.size(), there.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
        EXPECT_EQ(here[i].force, there[i].force);
        EXPECT_LT(glm::length(here[i].proxy - there[i].proxy), 1e-7) << "here they are written as floats";
        EXPECT_EQ(here[i].facet, there[i].facet);
    }
}

// A sine's phase is that of the world, wherever the mesh lies.
TEST_F(FarScene, HasItsTextureWhereTheWorldHasIt) {
    const std::string texture =
        "[texture]\nstiffness = \"2 N/m\"\nfunction = \"sine\"\nwidth = \"125 mm\"\nheight = \"10 mm\"\n";
    const std::vector<Felt> here = along_paths(glm::dvec3(0), texture);
    expect_alike(here, along_paths({1 << 20, 0, 0}, texture), 1e-5);
    const std::vector<Felt> other = along_paths({(1 << 20) + 0.0625, 0, 0}, texture);
    double most = 0;
    for (std::size_t i = 0; i < here.size(); ++i)
        most = std::max(most, glm::length(here[i].force - other[i].force));
    EXPECT_GT(most, 0.1);
}

// Generated paths, in closed loop too, and those that follow the surface.
TEST_F(FarScene, IsExploredAlike) {
    for (const char* const paths :
         {"depth = \"100 mm\"\n", "press = \"0.5 N\"\n", "depth = \"20 mm\"\nfollow = \"surface\"\n",
          "kind = \"random_walk\"\ndepth = \"200 mm\"\n"}) {
        const auto forces = [&](const glm::dvec3& shift) {
            const PreparedCase prepared =
                prepare(ball(shift, std::string("[paths]\ncount = 3\nsteps = 400\nrate = \"200 Hz\"\n"
                                                "speed = \"0.5 m/s\"\n") +
                                        paths),
                        Precision::f32);
            ScenePaths<float> source(prepared);
            return explored(source).force;
        };
        const auto here = forces(glm::dvec3(0));
        EXPECT_TRUE(std::ranges::any_of(here, [](const auto& force) { return force.z > 0.01f; })) << paths;
        EXPECT_EQ(here, forces({1 << 24, -(1 << 24), 64})) << paths;
    }
}

// Files hold places of the world in double, or say what they are measured from.
TEST_F(FarScene, IsWrittenInWorldCoordinates) {
    const glm::dvec3 shift(1 << 22, 0, -(1 << 20));
    write("way.csv", rows(way(), shift));
    const PreparedCase prepared =
        prepare(ball(shift, "[output]\nchannels = [\"force\", \"depth\", \"facet\", \"proxy\"]\n"), Precision::f32);
    EngineOptions engine;
    engine.cpu = true;
    PathRunOptions options;
    options.recorded = path("way.csv");
    options.samples = path("a.exr");
    options.stem = path("a");
    options.also.npy = options.also.vtp = true;
    const PathRecord record = run_paths(*make_engine(engine), prepared, options);
    EXPECT_TRUE(record.error.passed());

    const std::vector<glm::dvec3> places = way();
    const PathSamples samples = read_paths(path("a.exr"), 10, 10000);
    EXPECT_EQ(samples.origin, shift);
    const std::string npy = read("a.position.npy");
    EXPECT_TRUE(says(npy, "'<f8'"));
    EXPECT_TRUE(says(read("a.proxy.npy"), "'<f8'"));
    EXPECT_TRUE(says(read("a.force.npy"), "'<f4'"));
    EXPECT_TRUE(says(read("a.vtp"), "type=\"Float64\" Name=\"proxy\""));
    ASSERT_EQ(samples.position.size(), 3 * places.size());
    std::vector<double> written(3 * places.size());
    ASSERT_GT(npy.size(), written.size() * sizeof(double));
    std::memcpy(written.data(), npy.data() + npy.size() - written.size() * sizeof(double),
                written.size() * sizeof(double));
    for (std::size_t i = 0; i < written.size(); ++i) {
        const int axis = int(i % 3);
        EXPECT_NEAR(double(samples.position[i]), places[i / 3][axis], 1e-7);
        EXPECT_EQ(written[i], shift[axis] + double(samples.position[i]));
    }
}

// How many warnings name double precision.
std::ptrdiff_t coarse(const std::vector<std::string>& warnings) {
    return std::ranges::count_if(warnings, [](const std::string& one) { return bool(says(one, "--precision f64")); });
}

TEST_F(FarScene, WarnsOfCoarseSteps) {
    const auto warnings = [&](const std::string& scene, Precision precision = Precision::f32) {
        const PreparedCase prepared = prepare(scene, precision);
        return precision == Precision::f32 ? ScenePaths<float>(prepared).warnings()
                                           : ScenePaths<double>(prepared).warnings();
    };
    const std::string bump =
        "[surface]\nkind = \"bump\"\n[paths]\nsteps = 5000\nspeed = \"20 mm/s\"\ndepth = \"1 mm\"\n";
    EXPECT_EQ(coarse(warnings(bump)), 0);
    EXPECT_EQ(coarse(warnings(bump + "centre = [\"0 m\", \"1 km\"]\n")), 1);
    EXPECT_EQ(coarse(warnings(bump + "centre = [\"0 m\", \"1 km\"]\n", Precision::f64)), 0);
    EXPECT_EQ(coarse(warnings(ball({1e7, 0, 0}, "[paths]\nsteps = 5000\nspeed = \"1 m/s\"\ndepth = \"100 mm\"\n"))), 0);

    const auto told = [&](const std::string& scene, const std::vector<glm::dvec3>& places, const glm::dvec3& shift) {
        write("in.csv", rows(places, shift));
        return explore(prepare(scene, Precision::f32), "in.csv").warnings;
    };
    const std::string plain = "[surface]\nkind = \"bump\"\n";
    EXPECT_EQ(coarse(told(plain, way(), glm::dvec3(0))), 0);
    EXPECT_EQ(coarse(told(plain, way(), {0, 1e5, 0})), 1);
    EXPECT_EQ(coarse(told(ball({0, 1e5, 0}, ""), way(), {0, 1e5, 0})), 0);
}

TEST_F(FarScene, WarnsOfACoarseGrid) {
    const auto warnings = [&](const std::string& scene, Precision precision) {
        return prepare(scene, precision).warnings;
    };
    const std::string sine = "[surface]\nkind = \"height_map\"\nfunction = \"sine\"\nwidth = \"2 mm\"\n"
                             "[force]\nshading = \"height_map\"\n[grid]\nsize = [64, 1, 16]\n"
                             "spacing = \"0.1 mm\"\n";
    EXPECT_EQ(coarse(warnings(sine + "origin = [\"0 m\", \"0 m\", \"-1 mm\"]\n", Precision::f32)), 0);
    const std::string far = sine + "origin = [\"100 m\", \"0 m\", \"-1 mm\"]\n";
    EXPECT_EQ(coarse(warnings(far, Precision::f32)), 1);
    EXPECT_EQ(coarse(warnings(far, Precision::f64)), 0);
}

} // namespace
} // namespace forceshade::testing
