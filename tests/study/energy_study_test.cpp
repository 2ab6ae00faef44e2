// Work round loops: quadrature, closed forms, the engine's samples, curl.
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/program.h"
#include "host/study/energy/closed_forms.h"
#include "host/study/energy/curl_maps.h"
#include "host/study/energy/energy.h"
#include "host/study/energy/energy_findings.h"
#include "host/study/energy/loop_cases.h"
#include "host/study/energy/loop_paths.h"
#include "host/study/energy/notes.h"
#include "host/study/energy/scene_loops.h"
#include "host/study/energy/scenes.h"
#include "host/study/energy/tables.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

std::unique_ptr<Engine> oracle() {
    EngineOptions options;
    options.cpu = true;
    return make_engine(options);
}

TEST(LoopWork, OfALinearFieldIsItsCurlTimesTheArea) {
    const ForceAt force = [](const Vector& at) { return Vector(3 * at.z, 0, -at.x); };
    const Section section{{0, 0.5, 2}, [](double) { return 1.0; }, [](double) { return 0.0; }};
    // Out at z = 0.5, back at z = 0.75: against the sense in which curl_y = 4 counts.
    EXPECT_NEAR(work_round(force, section, 0.5, 0.25).work, -4 * 2 * 0.25, 1e-14);
    EXPECT_NEAR(work_round(force, section, 0.25, 0.5).work, 4 * 2 * 0.25, 1e-14);
}

TEST(LoopWork, FollowsASlopingSection) {
    const ForceAt potential = [](const Vector& at) { return Vector(at.z, 0, at.x); };
    const Section section{{0, 1}, [](double x) { return x * x; }, [](double x) { return 2 * x; }};
    EXPECT_NEAR(work_round(potential, section, 0.3, 0.1).work, 0, 1e-14);
}

TEST(ClosedForms, OfOneFacetAreThePlanes) {
    const double vertices[] = {-kHalfWidth, kHalfWidth};
    const BumpLoop loop{500, 0.01524, 0.999 * kHalfWidth, 0.002, 0.001};
    EXPECT_NEAR(shaded_facets_work(loop, vertices, false), shaded_plane_work(loop), 1e-16);
    EXPECT_NEAR(shaded_plane_work(loop), 2.3061e-3, 5e-8);
    EXPECT_NEAR(two_pass_plane_work(loop), 3.398e-3, 5e-7);
    EXPECT_EQ(faceted_work(loop, vertices, false), 0);
}

TEST(LoopRows, HoldTheClosedFormsAndTheSamplesAgree) {
    const auto engine = oracle();
    for (const LoopCase& one : bump_loops(600, {1, 2, 3, 5})) {
        const Json row = loop_row(one, *engine);
        if (row.contains("closed_form_difference")) {
            EXPECT_LT(row["closed_form_difference"].get<double>(), 1e-12) << row;
        }
        EXPECT_LT(row["engine_difference"].get<double>(), 1e-6) << row;
    }
}

TEST(LoopRows, OfMeshesTellAConservativeFieldFromOneThatIsNot) {
    const auto engine = oracle();
    for (const LoopCase& one : mesh_loops(MeshCells::triangles, 4)) {
        const Json row = loop_row(one, *engine);
        const double eta = row["eta"];
        if (one.scheme == "triangles none") {
            EXPECT_LT(std::abs(eta), 1e-12) << row;
        }
        if (one.scheme == "triangles none, god-object") {
            EXPECT_LT(eta, -0.01) << "the proxy lags behind whichever way it goes: " << row;
        }
        if (one.scheme == "triangles morgenbesser") {
            EXPECT_GT(eta, 0.01) << row;
        }
    }
}

TEST(LoopRows, OfTheShadedPlaneAsMeshComeToTheLawsFigures) {
    const auto engine = oracle();
    for (const LoopCase& one : plane_mesh_loops(1400, 128))
        EXPECT_LT(loop_row(one, *engine)["closed_form_difference"].get<double>(), 1e-5) << one.scheme;
}

PreparedCase scene(const std::string& text) {
    return CasePreparation().prepare(parse_scene(text, "scene.toml"));
}

TEST(SceneLoops, TakeEachSchemeOfASurface) {
    const auto engine = oracle();
    const PreparedCase bump = scene("[surface]\nkind = \"bump\"\nfacets = 1\nradius = \"1000 mil\"\n[force]\n"
                                    "stiffness = \"500 N/m\"\n[paths]\ndepth = \"2 mm\"\ndepth_back = \"1 mm\"\n");
    const std::vector<LoopCase> loops = scene_loops(bump);
    EXPECT_EQ(loops.size(), 12u);
    for (const LoopCase& one : loops) {
        const Json row = loop_row(one, *engine);
        if (one.loop == "half" && one.scheme == "shaded") {
            const BumpLoop inside{500, 0.0254, 0.999 * kHalfWidth, 0.002, 0.001};
            EXPECT_NEAR(row["work_mJ"].get<double>(), 1e3 * shaded_plane_work(inside), 1e-9);
        }
        if (one.scheme == "facets") {
            EXPECT_LT(std::abs(row["eta"].get<double>()), 1e-12) << "a plane";
        }
        EXPECT_EQ(row["radius_mil"], 1000);
    }
    EXPECT_EQ(scene_curl_maps(bump, 21).size(), 6u);
}

TEST(SceneLoops, HaveTheRadiusThatTheirSurfaceHas) {
    const auto radius = [](const std::string& surface) { return scene_loops(scene(surface)).front().radius_mil; };
    EXPECT_EQ(radius("[surface]\nkind = \"cylinder_bump\"\nradius = \"600 mil\"\n"), 600);
    EXPECT_EQ(radius("[surface]\nkind = \"height_map\"\nfunction = \"cylinder\"\nradius = \"20 mm\"\n"), 787.401575);
    EXPECT_EQ(radius("[surface]\nkind = \"height_map\"\nfunction = \"sine\"\n"), 0);
}

TEST(SceneLoops, EndInsideTheBumpWhereUnequalSlopesShow) {
    const auto engine = oracle();
    for (const LoopCase& one : scene_loops(scene("[surface]\nkind = \"bump\"\nfacets = 5\nradius = \"800 mil\"\n")))
        if (one.loop == "half" && one.scheme == "facets") {
            EXPECT_GT(std::abs(loop_row(one, *engine)["eta"].get<double>()), 0.01);
        }
}

TEST(SceneLoops, OverPlaneAndCylinderAreConservativeWhereverTheyComeThroughThePlane) {
    const auto engine = oracle();
    for (const char* radius : {"501 mil", "600 mil", "800 mil", "1400 mil"})
        for (const char* paths :
             {"", "depth = \"2 mm\"\ndepth_back = \"1 mm\"\n", "depth = \"6 mm\"\ndepth_back = \"0.1 mm\"\n",
              "centre = [\"-9 mm\", \"0 mm\"]\ndepth = \"1 mm\"\n", "length = \"50 mm\"\ndepth = \"3 mm\"\n"}) {
            const std::vector<LoopCase> loops =
                scene_loops(scene(fmt::format("[surface]\nkind = \"cylinder_bump\"\nradius = \"{}\"\n[force]\n"
                                              "stiffness = \"500 N/m\"\n[paths]\n{}",
                                              radius, paths)));
            EXPECT_EQ(loops.size(), 2u);
            for (const LoopCase& one : loops) {
                const Json row = loop_row(one, *engine);
                EXPECT_LT(std::abs(row["eta"].get<double>()), 1e-11) << radius << " " << paths << row;
            }
        }
}

bool says(const std::vector<std::string>& notes, const char* part) {
    return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(Notes, TellStiffnessDepthsAndWaysOfTheLoops) {
    for (const char* part :
         {"K = 500 N/m", "out 2 mm deep, up, back 1 mm deep", "\"superposed\" is", "\"plane mesh\" is",
          "\"height map on the plane\" is", "0.999 of half the width of 25.4 mm"})
        EXPECT_TRUE(says(loop_notes(), part)) << part;
    const PreparedCase bump = scene("[surface]\nkind = \"bump\"\nfacets = 3\nradius = \"800 mil\"\n[force]\n"
                                    "stiffness = \"300 N/m\"\n[paths]\ndepth = \"3 mm\"\n");
    const std::vector<std::string> notes = scene_notes(bump, scene_loops(bump));
    for (const char* part :
         {"K is 300 N/m", "below the scene's own facets, at y = 0 mm: \"half\" from x = 0 mm to 12.69 mm",
          "\"whole\" from x = -15.21 mm", "out 3 mm deep, up, back 1.5 mm deep"})
        EXPECT_TRUE(says(notes, part)) << part << notes.front();
    EXPECT_FALSE(says(notes, "god-object"));
}

TEST(SceneLoops, WithoutRoomAreRefused) {
    EXPECT_THROW(scene_loops(scene("[surface]\nkind = \"bump\"\n[paths]\nlength = \"0 mm\"\n")), UsageError);
}

TEST(LoopPaths, CloseAndMeetBothSidesOfABreak) {
    const Section section{{0, 0.3, 1}, [](double x) { return x; }, [](double) { return 1.0; }};
    const LoopPlaces places = loop_places(section, 0.2, 0.1, 32);
    EXPECT_EQ(places.front(), places.back());
    EXPECT_EQ(std::ranges::count_if(places, [](const Vector& at) { return at.x == 0.3; }), 2);
}

TEST(Curl, OfALinearFieldIsExactAndUnknownWhereACornerIsFree) {
    SectionField field;
    for (int i = 0; i < 4; ++i) {
        field.x.push_back(i);
        field.z.push_back(2 * i);
    }
    for (const double z : field.z)
        for (const double x : field.x) {
            field.force.insert(field.force.end(), {3 * z, 0, -x});
            field.depth.push_back(x == 3 ? 0 : 1);
        }
    const std::vector<double> curl = cell_curls(field);
    ASSERT_EQ(curl.size(), 9u);
    EXPECT_EQ(curl[0], 4);
    EXPECT_EQ(curl[7], 4);
    EXPECT_TRUE(std::isnan(curl[2])) << "a corner is free";
}

TEST(Curl, InARectangleIsTheWorkRoundIt) {
    const auto engine = oracle();
    CurlMap map = curl_maps(41).front(); // the flat plane, shaded
    SectionGrid grid{{0, -0.002}, {0.999 * kHalfWidth, -0.001}, 0, 65, 33};
    set_section(map.prepared, grid);
    const SectionField field = evaluated_section(*engine, map.prepared);
    double sum = 0;
    for (const double curl : cell_curls(field))
        sum += curl * (field.x[1] - field.x[0]) * (field.z[1] - field.z[0]);
    EXPECT_NEAR(-sum, shaded_plane_work({kStiffness, 0.0254, 0.999 * kHalfWidth, 0.002, 0.001}), 1e-6);
}

TEST(Curl, IsToldFromWhatSamplingLeavesAtJumps) {
    const auto folder = std::filesystem::temp_directory_path() / "forceshade_energy_curl_test";
    std::filesystem::create_directories(folder);
    const auto engine = oracle();
    for (const CurlMap& map : curl_maps(325)) {
        const Json result = curl_result(map, *engine, folder);
        const double mean = result["mean_per_K"], sampling = result["sampling_per_K"];
        const bool conservative = map.scheme == "superposed" || map.scheme == "triangles none";
        EXPECT_EQ(mean <= sampling, conservative) << map.title << " " << mean << " " << sampling;
    }
    std::filesystem::remove_all(folder);
}

TEST(Curl, VolumesAreWrittenAndTheirLossIsSeen) {
    const auto folder = std::filesystem::temp_directory_path() / "forceshade_energy_study_test";
    std::filesystem::create_directories(folder);
    const auto engine = oracle();
    const CurlMap map = curl_maps(41).front();
    const Json result = curl_result(map, *engine, folder);
    EXPECT_LT(result["closed_form_difference_per_K"].get<double>(), 1e-3);
    EXPECT_NEAR(result["largest_per_K"].get<double>(), 0.5, 0.7);
    for (const Json& volume : result["volumes"])
        EXPECT_TRUE(file_is_intact(folder / volume["name"].get<std::string>(), volume["sha256"]));
    std::filesystem::remove_all(folder);
}

} // namespace
} // namespace forceshade::study
