// What evaluates fields and paths: a Vulkan device or the CPU oracle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "host/long_run.h"
#include "host/output/record.h"
#include "host/reference/field.h"
#include "shaders/shared/law.h"

namespace forceshade {

struct PreparedCase;
class Engine;

// A whole field at once.

/// Every sample of a grid: x fastest, then y, then z. Channels that the case does not ask for are empty.
template <typename T> struct Field {
    std::vector<T> force;    /* N, 3 a sample */
    std::vector<T> depth;    /* m */
    std::vector<T> proxy;    /* m, 3 a sample, from scene_origin() */
    std::vector<T> unshaded; /* N, 3 a sample */
    std::vector<layout::uint> facet;
    EngineTimes times;

    /// The next chunk; where one y stands for all, it stands `repeats` times.
    void append(const layout::FieldChunk<T>& chunk, std::size_t repeats);
};

/// The field of a case's grid, in T whatever the case's own precision. \throws UsageError if a value leaves the range
/// of T, and what Engine::run throws.
template <typename T> Field<T> evaluate(const PreparedCase& prepared, Engine& engine);

/// Of tables that are there already; `repeats` as for append().
template <typename T> Field<T> evaluate(const layout::FieldInput<T>& input, std::size_t repeats, Engine& engine);

// Chunk by chunk.

/// A law to evaluate at every sample of a grid, and what takes consecutive chunks of rows in order (z, then y). A
/// mesh's blocks are planned slab by slab, unless the input has a plan (of the whole grid): that one is followed then.
template <typename T> struct FieldWork {
    using Real = T;
    const layout::FieldInput<T>& input;
    const std::function<void(const layout::FieldChunk<T>&)>& take;
};

/// Paths to take through their law, and what takes chunks batch of paths by batch of paths, within one in the order of
/// steps; then the batch's metrics.
template <typename T> struct PathWork {
    using Real = T;
    const layout::PathInput<T>& input;
    const reference::TakePaths<T>& take;
    const reference::TakeMetrics<T>& take_metrics;
};

using EngineWork = std::variant<FieldWork<float>, FieldWork<double>, PathWork<float>, PathWork<double>>;

/// What evaluates fields and paths: a Vulkan device or the CPU oracle, behind one face.
class Engine {
public:
    virtual ~Engine() = default;
    virtual EngineReport report() const = 0;
    /// \throws compute::DeviceError, and whatever the callbacks throw.
    virtual EngineTimes run(const EngineWork& work) = 0;

    template <typename T>
    EngineTimes evaluate(const layout::FieldInput<T>& input,
                         const std::type_identity_t<std::function<void(const layout::FieldChunk<T>&)>>& take) {
        Stage stage("computing the field", input.z.size(), "layers");
        const std::function<void(const layout::FieldChunk<T>&)> count = [&](const layout::FieldChunk<T>& chunk) {
            take(chunk);
            stage.update(chunk.z_first + chunk.z_count);
        };
        return run(FieldWork<T>{input, count});
    }
    template <typename T>
    EngineTimes explore(const layout::PathInput<T>& input, const std::type_identity_t<reference::TakePaths<T>>& take,
                        const std::type_identity_t<reference::TakeMetrics<T>>& take_metrics) {
        return run(PathWork<T>{input, take, take_metrics});
    }
};

/// Why a Vulkan device is refused for paths with friction or vibration.
inline constexpr const char* kRubsOnCpu = "friction and vibration run on the CPU; leave --engine gpu out";

struct EngineOptions {
    bool cpu = false;     /* the oracle instead of a Vulkan device */
    unsigned threads = 0; /* of the oracle; 0: most_threads() */
    std::string gpu;      /* as in compute::choose_device */
    bool needs_f64 = false;
    bool validation = false;                         /* Vulkan validation layers; complaints end the run */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* results held at once */
    std::filesystem::path cache;                     /* folder of compiled kernels; empty: none is kept */
    bool try_groups = false; /* hardware tries sizes of work groups at once, not only when a run is long */
    /// Computes all a second time on a Vulkan device, in parts (compute/kernels.h). \throws compute::DeviceError
    /// (differs_in_parts) where a bit differs.
    bool twice = false;
};

/// \throws compute::DeviceError if the device is not there or refused. There is no silent fallback from one engine to
/// the other.
std::unique_ptr<Engine> make_engine(const EngineOptions& options);

} // namespace forceshade
