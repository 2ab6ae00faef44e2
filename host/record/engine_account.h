// What an engine tells of itself and of its work.
#pragma once

#include <cstdint>
#include <string>

namespace forceshade {

/// Where the time of a field went, s.
struct EngineTimes {
    double compile = 0, upload = 0, kernel = 0, read_back = 0;
    double plan = 0;                    /* of a mesh: where there is force, and what is near */
    std::uint64_t voxels_evaluated = 0; /* of a mesh; the others were found free as whole blocks */
    std::uint64_t uploaded = 0;         /* bytes copied to a device: tables, plans, recorded positions */
};

struct EngineReport {
    std::string engine; /* "gpu" or "cpu" */
    std::string device; /* name */
    std::string uuid;   /* of a Vulkan device */
    std::string driver;
    bool software = true; /* results must equal the oracle's bit for bit */
    bool f64 = true;      /* evaluates in double precision */
};

} // namespace forceshade
