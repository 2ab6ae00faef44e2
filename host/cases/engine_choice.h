// Which engine `--engine auto` takes: the CPU, or a hardware GPU or else the software device if it is done sooner by
// what was measured of them. It depends on the machine and the scene alone, never on how fast it is just
// now, and both compute the same bits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compute/device.h"
#include "host/scene/study.h"

namespace forceshade {

/// The work, as far as it decides which engine is faster.
struct Workload {
    double voxels = 0;      /* evaluated, of analytic surfaces */
    double mesh_voxels = 0; /* of meshes' grids */
    double steps = 0;       /* of paths over analytic surfaces */
    double harmonics = 0;   /* of their motions, summed over the steps */
    double mesh_steps = 0;  /* of paths over meshes */
    bool rubs = false;      /* paths with friction or vibration, which the CPU alone computes */

    Workload& operator+=(const Workload& other);
    Workload operator*(double times) const;
};

/// A scene's field; nothing where it has none.
Workload field_workload(const Scene& scene);
/// A scene's paths; nothing where it has none. Of recorded ones, those in the file `recorded` or, where that is empty,
/// in the scene's: as many as its size lets one expect.
Workload path_workload(const Scene& scene, const std::string& recorded = "");

/// All fields and paths of a study, so that shards and parts of it take the same engine.
Workload study_workload(const Study& study);

/// s: by how much a software device is done sooner than the CPU engine, both on that many threads; below 0: later.
double saved_by_software_device(const Workload& work, unsigned threads);

/// s: the same of a hardware GPU, which needs none of the threads.
double saved_by_hardware(const Workload& work, unsigned threads);

struct EngineChoice {
    bool cpu = true;
    std::string gpu; /* index of the device, as for compute::choose_device */
    std::string why; /* in words, with the engine's name */
};

/// `devices`: all that there are.
EngineChoice choose_engine(const Workload& work, const std::vector<compute::DeviceReport>& devices, bool needs_f64,
                           unsigned threads);
/// Of this machine, whose devices are listed only where that can matter: loading the drivers takes longer than many a
/// field.
EngineChoice choose_engine(const Workload& work, bool needs_f64);

} // namespace forceshade
