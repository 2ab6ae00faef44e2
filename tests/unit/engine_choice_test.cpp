// Which engine --engine auto takes.
#include "host/cases/engine_choice.h"

#include <gtest/gtest.h>

#include "host/scene/study.h"

namespace forceshade {
namespace {

compute::DeviceReport report_of(std::uint32_t index, const char* name, const char* type) {
    compute::DeviceReport report;
    report.index = index;
    report.name = name;
    report.type = type;
    report.software = report.type == "software";
    report.f64 = true;
    return report;
}

Scene scene_of(const char* text) {
    return parse_scene(text, "test").scene;
}

constexpr const char* kPaths = "[paths]\ncount = 1000\nsteps = 500\n";
constexpr const char* kPlane = "[surface]\nkind = \"bump\"\n[grid]\nsize = [10, 20, 30]\n";
constexpr const char* kMesh = "[surface]\nkind = \"mesh\"\nfile = \"a.obj\"\n[grid]\nsamples = 10\n";

TEST(EngineChoice, CountsWhatAnEngineComputes) {
    const Scene plane = scene_of(kPlane);
    EXPECT_EQ(field_workload(plane).voxels, 300) << "once in y";
    EXPECT_EQ(path_workload(plane).steps, 0);
    const Scene dimpled =
        scene_of("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\n[force]\nshading = \"height_map\"\n"
                 "[grid]\nsize = [10, 20, 30]\n");
    EXPECT_EQ(field_workload(dimpled).voxels, 6000);
    const Scene mesh = scene_of((std::string(kMesh) + kPaths).c_str());
    EXPECT_EQ(field_workload(mesh).voxels, 0);
    EXPECT_EQ(path_workload(mesh).steps, 0);
    EXPECT_EQ(path_workload(mesh).mesh_steps, 500000);
    const Scene strokes = scene_of((std::string("[surface]\nkind = \"bump\"\n") + kPaths).c_str());
    EXPECT_EQ(field_workload(strokes).voxels, 0) << "it has no grid";
    EXPECT_EQ(path_workload(strokes).steps, 500000);
    EXPECT_EQ(path_workload(strokes).harmonics, 0);
    const Scene walks = scene_of((std::string(kPaths) + "kind = \"random_walk\"\n").c_str());
    EXPECT_EQ(path_workload(walks).harmonics, 16 * 500000);
    EXPECT_EQ(path_workload(strokes, "/no/such/file").steps, 0);
}

TEST(EngineChoice, IsTheCpuUntilADeviceIsWorthStarting) {
    EXPECT_LT(saved_by_software_device({}, 2), 0);
    EXPECT_LT(saved_by_software_device({.steps = 1e6}, 2), 0);
    EXPECT_GT(saved_by_software_device({.steps = 1e7}, 2), 0);
    EXPECT_LT(saved_by_software_device({.steps = 1e7}, 64), 0);
    EXPECT_GT(saved_by_software_device({.steps = 1e6, .harmonics = 16e6}, 2), 0);
    EXPECT_LT(saved_by_software_device({.mesh_steps = 1e9}, 2), 0);
    EXPECT_LT(saved_by_software_device({.voxels = 1e9}, 2), 0);
}

TEST(EngineChoice, IsTheCpuForFrictionAndVibration) {
    const Scene rubs = scene_of((std::string(kPlane) + "[friction]\n" + kPaths).c_str());
    EXPECT_FALSE(field_workload(rubs).rubs) << "a static field has none";
    EXPECT_FALSE(path_workload(scene_of((std::string(kPlane) + kPaths).c_str())).rubs);
    EXPECT_FALSE(path_workload(scene_of((std::string(kPlane) + "[friction]\n").c_str())).rubs) << "no paths";
    Workload work = path_workload(rubs);
    EXPECT_TRUE(work.rubs);
    work += Workload{.steps = 1e12};
    const EngineChoice choice = choose_engine(work * 2, {report_of(0, "Card", "discrete")}, false, 2);
    EXPECT_TRUE(choice.cpu);
    EXPECT_EQ(choice.why, "cpu (2 threads): friction and vibration run on the CPU");
}

TEST(EngineChoice, TakesHardwareThenWhatIsFaster) {
    const Workload little{}, some{.steps = 1e7}, much{.steps = 1e9};
    const compute::DeviceReport software = report_of(0, "llvmpipe", "software");
    compute::DeviceReport card = report_of(1, "Card", "discrete");
    const EngineChoice without = choose_engine(little, {software, card}, false, 2);
    EXPECT_TRUE(without.cpu);
    EXPECT_NE(without.why.find("--engine gpu"), std::string::npos) << without.why;
    EXPECT_GT(saved_by_hardware({.mesh_voxels = 1e8}, 16), 0);
    EXPECT_LT(saved_by_hardware({.mesh_steps = 1e9}, 16), 0) << "paths that wait for each other";
    EXPECT_GT(saved_by_hardware({.mesh_steps = 1e9}, 2), 0);
    const EngineChoice on_card = choose_engine(some, {software, card}, false, 2);
    EXPECT_FALSE(on_card.cpu);
    EXPECT_EQ(on_card.gpu, "1");
    EXPECT_EQ(on_card.why, "gpu (Card)");
    const EngineChoice on_one = choose_engine(some, {software, card, report_of(2, "Card", "discrete")}, false, 2);
    EXPECT_EQ(on_one.gpu, "1");
    EXPECT_NE(on_one.why.find("one of 2: --gpu"), std::string::npos) << on_one.why;
    card.f64 = false;
    EXPECT_FALSE(choose_engine(some, {software, card}, false, 2).cpu);
    EXPECT_TRUE(choose_engine(little, {software, card}, true, 2).cpu) << "it has no double precision";
    card.refusals = {"broken"};
    EXPECT_TRUE(choose_engine(little, {software, card}, false, 2).cpu);
    const EngineChoice on_software = choose_engine(much, {software, card}, false, 2);
    EXPECT_FALSE(on_software.cpu);
    EXPECT_EQ(on_software.gpu, "0");
    EXPECT_TRUE(choose_engine(much, {card}, false, 2).cpu);
    EXPECT_TRUE(choose_engine(much, {}, false, 2).cpu);
}

} // namespace
} // namespace forceshade
