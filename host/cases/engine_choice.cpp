#include "host/cases/engine_choice.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "host/field/prepared_case.h"
#include "host/numbers.h"
#include "host/paths/motions.h"
#include "host/threads.h"

namespace forceshade {
namespace {

// What a device saves, measured once. What both engines do alike, such as writing, is not in it.
struct Savings {
    double start;                                        /* s that opening it and reading its kernels takes */
    double voxel, mesh_voxel, step, harmonic, mesh_step; /* s of a thread; below 0 where the device is slower */
    double own_mesh_step;                                /* s that the device takes, however many threads there are */
};

// Whole commands with both engines on two threads of a Xeon with AVX-512 and of Mesa 22.3, kernels on disk. Opening
// takes 0.07 s for a field, 0.13 for paths.
constexpr Savings kSoftware{0.12, -10e-9, 0, 0.1e-6, 15e-9, -0.3e-6, 0};
// An NVIDIA H200 (driver 580) against 16 threads of a Xeon at 2.1 GHz: whole commands for the start, the kernels'
// benches and the engines' times for the rest (host/referee/README.md).
constexpr Savings kHardware{0.25, 0.9e-9, 0.23e-6, 0.15e-6, 50e-9, 0.37e-6, 0.06e-6};

constexpr double kBytesASample = 40; // of a recorded file: five numbers

double grid_voxels(const GridSpec& grid) {
    return static_cast<double>(grid.size[0]) * static_cast<double>(grid.size[1]) * static_cast<double>(grid.size[2]);
}

double recorded_samples(const std::string& file) {
    std::error_code none;
    const std::uintmax_t bytes = std::filesystem::file_size(file, none);
    return none ? 0 : static_cast<double>(bytes) / kBytesASample;
}

double saved(const Savings& by, const Workload& work, unsigned threads) {
    return (by.voxel * work.voxels + by.mesh_voxel * work.mesh_voxels + by.step * work.steps +
            by.harmonic * work.harmonics + by.mesh_step * work.mesh_steps) /
               threads -
           by.own_mesh_step * work.mesh_steps - by.start;
}

std::string cpu_text(unsigned threads) {
    return fmt::format("cpu ({})", numbers::counted(threads, "thread"));
}

EngineChoice left_to_cpu(unsigned threads, const std::string& gpu) {
    return {true, "", fmt::format("{}: it is done before {} would be; --engine gpu takes one", cpu_text(threads), gpu)};
}

bool is_hardware(const compute::DeviceReport& device, bool needs_f64) {
    return !device.software && device.refusals.empty() && (device.f64 || !needs_f64);
}

} // namespace

Workload& Workload::operator+=(const Workload& other) {
    voxels += other.voxels;
    mesh_voxels += other.mesh_voxels;
    steps += other.steps;
    harmonics += other.harmonics;
    mesh_steps += other.mesh_steps;
    rubs = rubs || other.rubs;
    return *this;
}

Workload Workload::operator*(double times) const {
    return {voxels * times, mesh_voxels * times, steps * times, harmonics * times, mesh_steps * times, rubs};
}

Workload field_workload(const Scene& scene) {
    Workload work;
    if (!scene.field)
        return work;
    const double voxels = grid_voxels(scene.grid);
    if (scene.surface.kind == SurfaceKind::mesh)
        work.mesh_voxels = voxels;
    else
        work.voxels = depends_on_y(scene) ? voxels : voxels / static_cast<double>(scene.grid.size[1]);
    return work;
}

Workload path_workload(const Scene& scene, const std::string& recorded) {
    Workload work;
    double steps = 0, harmonics = 0;
    if (!recorded.empty())
        steps = recorded_samples(recorded);
    else if (scene.paths && scene.paths->kind == PathKind::recorded)
        steps = recorded_samples(scene.paths->path);
    else if (scene.paths) {
        steps = static_cast<double>(scene.paths->count) * static_cast<double>(scene.paths->steps);
        harmonics = harmonic_count(*scene.paths);
    }
    const bool rubs = scene.rubs() && (scene.paths || !recorded.empty());
    if (scene.surface.kind == SurfaceKind::mesh)
        return {.mesh_steps = steps, .rubs = rubs};
    return {.steps = steps, .harmonics = steps * harmonics, .rubs = rubs};
}

Workload study_workload(const Study& study) {
    const std::vector<Case>& cases = study.sample.empty() ? study.cases : study.sample;
    Workload work;
    for (const Case& one : cases) {
        work += field_workload(one.scene);
        work += path_workload(one.scene);
    }
    return work * (static_cast<double>(study.all) / static_cast<double>(cases.size()));
}

double saved_by_software_device(const Workload& work, unsigned threads) {
    return saved(kSoftware, work, threads);
}

double saved_by_hardware(const Workload& work, unsigned threads) {
    return saved(kHardware, work, threads);
}

EngineChoice choose_engine(const Workload& work, const std::vector<compute::DeviceReport>& devices, bool needs_f64,
                           unsigned threads) {
    if (work.rubs)
        return {true, "", cpu_text(threads) + ": friction and vibration run on the CPU"};
    const auto hardware = std::ranges::count_if(devices, [&](const auto& one) { return is_hardware(one, needs_f64); });
    if (hardware > 0) {
        const compute::DeviceReport& chosen = compute::choose_device(devices, "", needs_f64);
        if (saved_by_hardware(work, threads) <= 0)
            return left_to_cpu(threads, chosen.name);
        return {
            false, std::to_string(chosen.index),
            fmt::format("gpu ({}){}", chosen.name,
                        hardware > 1 ? fmt::format(", one of {}: --gpu UUID or INDEX takes another", hardware) : "")};
    }
    const std::string cpu = cpu_text(threads);
    const double saved = saved_by_software_device(work, threads);
    if (saved < -kSoftware.start)
        return {true, "",
                fmt::format("{}: a software device would be slower for {}", cpu,
                            work.mesh_steps > 0 ? "paths over meshes" : "fields of analytic surfaces")};
    if (saved <= 0)
        return {true, "", cpu + ": starting a software device would take longer than it saves"};
    for (const compute::DeviceReport& device : devices)
        if (device.refusals.empty() && (device.f64 || !needs_f64))
            return {false, std::to_string(device.index),
                    fmt::format("gpu ({}): so much work is done sooner by a software device", device.name)};
    return {true, "", cpu + ": there is no Vulkan device"};
}

EngineChoice choose_engine(const Workload& work, bool needs_f64) {
    const unsigned threads = most_threads();
    if (work.rubs)
        return choose_engine(work, {}, needs_f64, threads);
    if (compute::may_have_hardware() && saved_by_hardware(work, threads) <= 0)
        return left_to_cpu(threads, "a GPU");
    std::vector<compute::DeviceReport> devices;
    if (compute::may_have_hardware() || saved_by_software_device(work, threads) > 0)
        try {
            devices = compute::list_devices();
        } catch (const compute::DeviceError&) {
            devices.clear(); // no Vulkan here
        }
    return choose_engine(work, devices, needs_f64, threads);
}

} // namespace forceshade
