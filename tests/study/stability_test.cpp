// Loops of the study of stability: closed forms, limits found by paths, and maps.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/scene/study.h"
#include "host/study/stability/loop_curves.h"
#include "host/study/stability/loop_laws.h"
#include "host/study/stability/loop_limits.h"
#include "host/study/stability/loop_tables.h"
#include "tests/paths/sampled_plants.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;
using testing::kPlants;
using testing::Plant;

TEST(LoopLaws, TableOfSampledStability) {
    for (const Plant& plant : kPlants) {
        EXPECT_NEAR(critical_stiffness(plant.mass, plant.damping, plant.period), plant.limit, 0.006);
        EXPECT_NEAR(critical_stiffness_late(plant.mass, plant.damping, plant.period), plant.limit_late, 0.006);
    }
}

TEST(LoopLaws, SmallDampingNeedsNoDifference) {
    const double tiny = 1e-9; // N s/m
    EXPECT_NEAR(critical_stiffness(0.1, tiny, 1e-3) / (2 * tiny / 1e-3), 1, 1e-9);
    EXPECT_NEAR(critical_stiffness_late(0.1, tiny, 1e-3) / (2 * tiny / 3e-3), 1, 1e-9);
    EXPECT_DOUBLE_EQ(passive_stiffness(1, 1e-3, 0), 2000);
    EXPECT_DOUBLE_EQ(passive_stiffness(1, 1e-3, 1), 2000.0 / 3);
    EXPECT_DOUBLE_EQ(friction_stiffness(0.1, 1e-4), 2000);
}

const LoopPlace& own(const std::string& name) {
    static const std::vector<LoopPlace> places = own_places();
    return *std::ranges::find(places, name, &LoopPlace::name);
}

TEST(LoopLaws, FlutterOfTheDip) {
    const double slope = 50 * std::numbers::pi / 180, s = std::sin(slope), c = std::cos(slope), deep = 0.131;
    const glm::dmat3& felt = own("dip-shaded").slope; // columns first
    EXPECT_NEAR(felt[0][0], deep, 1e-6);
    EXPECT_NEAR(std::abs(felt[2][0]), s, 1e-6);
    EXPECT_NEAR(std::abs(felt[0][2]), s * deep / c, 1e-6);
    EXPECT_NEAR(felt[2][2], c, 1e-6);
    EXPECT_NEAR(flutter_stiffness(felt, 0.1, 1).value(), 71, 0.01 * 71);
    EXPECT_FALSE(flutter_stiffness(own("plane").slope, 0.1, 1));
}

TEST(LinearLoop, IsTheClosedFormOnThePlane) {
    for (const Plant& plant : kPlants)
        for (const std::uint64_t delay : {0U, 1U}) {
            HandSpec hand = own("plane").hand;
            hand.mass = plant.mass;
            hand.damping = plant.damping;
            hand.delay_samples = delay;
            const LoopCell cell{hand, 1 / plant.period, 1};
            const auto limit = linear_limit(linear_loop(own("plane"), hand, 1 / plant.period), 1, 1e6);
            EXPECT_NEAR(limit.value() / wall_limit(cell), 1, 1e-6);
        }
}

TEST(LinearLoop, HeldDipFluttersSooner) {
    const LoopPlace& dip = own("dip-shaded");
    EXPECT_NEAR(linear_limit(linear_loop(dip, dip.hand, 1000), 1, 1e4).value(), 69, 0.01 * 69);
    EXPECT_NEAR(linear_limit(linear_loop(dip, dip.hand, 1e5), 1, 1e4).value(),
                flutter_stiffness(dip.slope, dip.hand.mass, dip.hand.damping).value(), 0.05);
    EXPECT_EQ(linear_limit(linear_loop(dip, dip.hand, 1000), 100, 1e4), 0.0) << "it flutters there already";
}

Engine& engine() {
    static const std::unique_ptr<Engine> one = make_engine(EngineOptions{});
    return *one;
}

LoopCell damped(const LoopPlace& place, double damping, double stiffness = 1) {
    LoopCell cell{place.hand, place.rate, stiffness};
    cell.hand.damping = damping;
    cell.hand.grip_damping = 0;
    return cell;
}

TEST(MeasuredLimit, OfThePlaneAndTheDip) {
    const LoopCell cell = damped(own("plane"), 5);
    EXPECT_NEAR(measured_limit(engine(), own("plane"), cell).value() / wall_limit(cell), 1, 1e-4);
    const LoopCell slow = damped(own("dip-shaded"), 5);
    EXPECT_NEAR(measured_limit(engine(), own("dip-shaded"), slow).value() /
                    linear_limit(linear_loop(own("dip-shaded"), slow.hand, 1000), 1, 1e5).value(),
                1, 1e-3);
}

// A device that computes in single precision only.
class SingleEngine final : public Engine {
public:
    EngineReport report() const override {
        EngineReport report = engine().report();
        report.f64 = false;
        return report;
    }
    EngineTimes run(const EngineWork& work) override {
        EXPECT_TRUE(std::holds_alternative<forceshade::PathWork<float>>(work));
        return engine().run(work);
    }
};

TEST(MeasuredLimit, InSinglePrecision) {
    SingleEngine single;
    const LoopCell cell = damped(own("plane"), 5);
    EXPECT_NEAR(measured_limit(single, own("plane"), cell).value() / wall_limit(cell), 1, 1e-4);
}

// A probe slides off a shaded bump whatever the damping: its grip against K d / R.
TEST(MeasuredLimit, OfTheShadedBumpIsStatic) {
    const LoopPlace& bump = own("bump-shaded");
    const auto expected = linear_limit(linear_loop(bump, damped(bump, 10).hand, 1000), 1, 1e5);
    EXPECT_NEAR(measured_limit(engine(), bump, damped(bump, 10)).value() / expected.value(), 1, 1e-3);
    const auto softer = linear_limit(linear_loop(bump, damped(bump, 2).hand, 1000), 1, 1e5);
    EXPECT_NEAR(softer.value() / expected.value(), 1, 1e-6);
}

TEST(LoopCells, MeshIsTheWallOfItsFacet) {
    const LoopPlace& mesh = own("mesh");
    const double limit = linear_limit(linear_loop(mesh, damped(mesh, 10).hand, 1000), 1, 1e6).value();
    EXPECT_NEAR(limit / wall_limit(damped(mesh, 10)), 1, 0.01);
    LoopRun run;
    run.patience = 120;
    const auto outcomes =
        run_cells(engine(), mesh, {damped(mesh, 10, 0.95 * limit), damped(mesh, 10, 1.05 * limit)}, run);
    EXPECT_EQ(outcomes[0].state, LoopState::stable);
    EXPECT_NE(outcomes[1].state, LoopState::stable);
}

TEST(LoopCells, StatesOfThePlane) {
    const LoopPlace& plane = own("plane");
    const double limit = wall_limit(damped(plane, 5));
    LoopRun run;
    std::vector<LoopCell> cells{damped(plane, 5, 0.98 * limit), damped(plane, 5, 1.1 * limit),
                                damped(plane, 5, 3 * limit)};
    const auto bare = run_cells(engine(), plane, cells, run);
    EXPECT_EQ(bare[0].state, LoopState::stable);
    EXPECT_EQ(bare[1].state, LoopState::limit_cycle);
    EXPECT_EQ(bare[2].state, LoopState::unstable);
    run.disturbance = 0.5;
    for (LoopCell& cell : cells) {
        cell.stiffness = 2000; // 2 f_c / quantum of the first
        cell.hand.quantisation = 5e-5;
    }
    cells[0].hand.coulomb = 1.02 * 0.05;
    cells[1].hand.coulomb = 0.98 * 0.05;
    const auto rounded = run_cells(engine(), plane, cells, run);
    EXPECT_EQ(rounded[0].state, LoopState::stable);
    EXPECT_EQ(rounded[1].state, LoopState::chatter);
    EXPECT_EQ(rounded[2].state, LoopState::chatter);
}

// Two rows of three, and limits of two surfaces.
Json sample_map() {
    const LoopPlace& plane = own("plane");
    const LoopMap map{
        "plane-damping", {LoopAxis::stiffness, 1000, 4000, 3}, {LoopAxis::damping, 5, 10, 2}, damped(plane, 1), {}};
    return map_result(engine(), plane, map);
}

TEST(LoopMaps, SameEachTime) {
    EXPECT_EQ(sample_map().dump(), sample_map().dump());
}

TEST(LoopMaps, CellsCurvesAndWhatIsForeseen) {
    const Json map = sample_map();
    EXPECT_EQ(map.at("states"), Json({"sss", "sss"}));
    EXPECT_EQ(map.at("expected"), map.at("states"));
    const Table table = map_table({map});
    ASSERT_EQ(table.rows.size(), 6U);
    EXPECT_EQ(table.number(5, "stiffness_N_per_m"), 4000);
    EXPECT_EQ(table.number(5, "damping_N_s_per_m"), 10);
    EXPECT_EQ(table.word(5, "state"), "stable");
    EXPECT_EQ(table.word(5, "closed_form"), "rests");
}

bool mentions(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

PreparedCase prepared(const std::string& text) {
    return CasePreparation().prepare(parse_scene(text, "scene.toml"));
}

TEST(ScenePlace, IsTheScenesOwn) {
    const LoopPlace place = scene_place(prepared("[surface]\nkind = \"bump\"\n[force]\nstiffness = \"500 N/m\"\n"
                                                 "[hand]\ngrip_stiffness = \"0 N/m\"\nmass = \"0.2 kg\"\n"
                                                 "[paths]\npress = \"0.25 N\"\nrate = \"2000 Hz\"\n"));
    EXPECT_EQ(place.stiffness, 500);
    EXPECT_EQ(place.rate, 2000);
    EXPECT_EQ(place.hand.mass, 0.2);
    EXPECT_NEAR(place.rest.z, -0.0005, 1e-12);
    EXPECT_NEAR(place.slope[2][2], 1, 1e-9);
    EXPECT_NEAR(place.force.z, 0.0005, 1e-12);
}

TEST(ScenePlace, LimitsAreAboutTheScenesOwn) {
    const LoopPlace place = scene_place(prepared("[surface]\nkind = \"bump\"\n[force]\nstiffness = \"500 N/m\"\n"
                                                 "[hand]\ngrip_stiffness = \"0 N/m\"\ndamping = \"9 N s/m\"\n"
                                                 "grip_damping = \"1 N s/m\"\n[paths]\npress = \"0.25 N\"\n"));
    const Json result = limits_result(engine(), place, {damped(place, 10), damped(place, 20)});
    EXPECT_NEAR(result.at("points").at(0).at("measured").get<double>() / critical_stiffness(0.1, 10, 1e-3), 1, 1e-4);
    EXPECT_EQ(result.at("points").at(0).at("own"), 500);
    EXPECT_TRUE(result.at("points").at(1).at("own").is_null());
    EXPECT_TRUE(mentions(result.at("hand"), "500 N/m, 0.1 kg, 10 N s/m, 1000 Hz"));
    EXPECT_DOUBLE_EQ(result.at("pressed").at("depth").get<double>(), 5e-4);
}

TEST(ScenePlace, RefusesWhatIsNoLoop) {
    const std::string paths = "[paths]\npress = \"1 N\"\n";
    EXPECT_THROW(scene_place(prepared("[surface]\nkind = \"bump\"\n[hand]\ndamping = \"0 N s/m\"\ngrip_damping = "
                                      "\"0 N s/m\"\n" +
                                      paths)),
                 UsageError);
    EXPECT_THROW(scene_place(prepared("[surface]\nkind = \"bump\"\n[force]\nstiffness = \"0 N/m\"\n" + paths)),
                 UsageError);
}

TEST(ScenePlace, IsOnAMeshOrRefused) {
    const std::string mesh =
        "[surface]\nkind = \"mesh\"\nfile = \"" FORCESHADE_TEST_DATA "/spot.obj\"\n[paths]\npress = \"1 N\"\n";
    const LoopPlace place = scene_place(prepared(mesh));
    EXPECT_GT(place.rest.z, 0);
    EXPECT_NEAR(place.slope[0][0] + place.slope[1][1] + place.slope[2][2], 1, 0.05); // one direction pushes back
    try {
        scene_place(prepared(mesh + "centre = [\"5 m\", \"0 m\"]\n"));
        FAIL() << "a place beside the mesh was taken";
    } catch (const UsageError& error) {
        EXPECT_TRUE(mentions(error.what(), "x = 5 m, y = 0 m")) << error.what();
        EXPECT_TRUE(mentions(error.what(), "paths.centre"));
    }
}

} // namespace
} // namespace forceshade::study
