// Compiled kernels kept on disk between runs, one file a device. A damaged or foreign file is ignored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/reference/paths.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// The bytes kept for a device, or none if there is no intact file. `device` tells devices and drivers apart. Never
/// throws for the file's sake.
std::vector<std::byte> read_pipeline_cache(const std::filesystem::path& folder, const std::string& device);

/// Keeps the bytes; a folder that cannot be written is no error.
void write_pipeline_cache(const std::filesystem::path& folder, const std::string& device,
                          std::span<const std::byte> bytes);

/// Where they are kept.
std::filesystem::path pipeline_cache_path(const std::filesystem::path& folder, const std::string& device);

// What evaluates fields: a Vulkan device or the CPU oracle, behind one face.

class Engine {
public:
    virtual ~Engine() = default;
    virtual EngineReport report() const = 0;
    /// Evaluates the law at every sample, in float or double, and hands over consecutive chunks of rows in order (z,
    /// then y). A mesh's blocks are planned slab by slab, unless the input has a plan (of the whole grid): that one is
    /// followed then. \throws compute::DeviceError, and whatever `consume` throws.
    virtual EngineTimes evaluate(const layout::FieldInput<float>& input,
                                 const std::function<void(const layout::FieldChunk<float>&)>& consume) = 0;
    virtual EngineTimes evaluate(const layout::FieldInput<double>& input,
                                 const std::function<void(const layout::FieldChunk<double>&)>& consume) = 0;
    /// Takes every path through its law: chunks batch of paths by batch of paths, within one in the order of steps;
    /// then the batch's metrics. \throws compute::DeviceError (unsupported, unless an engine says otherwise).
    virtual EngineTimes explore(const layout::PathInput<float>& input, const reference::TakePaths<float>& take,
                                const reference::TakeMetrics<float>& take_metrics);
    virtual EngineTimes explore(const layout::PathInput<double>& input, const reference::TakePaths<double>& take,
                                const reference::TakeMetrics<double>& take_metrics);
};

struct EngineOptions {
    bool cpu = false; /* the oracle on all cores instead of a Vulkan device */
    std::string gpu;  /* as in compute::choose_device; empty: the software device */
    bool needs_f64 = false;
    bool validation = false;                         /* Vulkan validation layers; complaints end the run */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* results held at once */
    std::filesystem::path cache;                     /* folder of compiled kernels; empty: none is kept */
};

/// \throws compute::DeviceError if the device is not there or refused. There is no silent fallback from one engine to
/// the other.
std::unique_ptr<Engine> make_engine(const EngineOptions& options);

/// $XDG_CACHE_HOME/forceshade or ~/.cache/forceshade; empty if neither is known.
std::filesystem::path default_cache_folder();

} // namespace forceshade
