#include "host/engine/engine.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include <spdlog/spdlog.h>

#include "compute/field_kernel.h"
#include "compute/mesh_kernel.h"
#include "compute/mesh_path_kernel.h"
#include "compute/path_kernel.h"
#include "host/error.h"
#include "host/mesh/block_plan.h"
#include "host/output/files.h"
#include "host/reference/field.h"
#include "host/reference/god_object.h"

namespace forceshade {

namespace {

constexpr std::size_t kDigest = 64;             // hex digits of the SHA-256 that the file begins with
constexpr std::uintmax_t kLargest = 256u << 20; // bytes; a larger file is not ours

} // namespace

std::filesystem::path pipeline_cache_path(const std::filesystem::path& folder, const std::string& device) {
    return folder / ("pipelines-" + sha256_of(device).substr(0, 16) + ".bin");
}

std::vector<std::byte> read_pipeline_cache(const std::filesystem::path& folder, const std::string& device) {
    if (folder.empty())
        return {};
    const std::filesystem::path path = pipeline_cache_path(folder, device);
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || size < kDigest || size > kLargest)
        return {};
    std::string content(size, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(content.data(), static_cast<std::streamsize>(size));
    const std::span<const std::byte> bytes = std::as_bytes(std::span(content)).subspan(kDigest);
    if (!file || content.substr(0, kDigest) != sha256_of(bytes)) {
        spdlog::info("{} is damaged: kernels are compiled anew", path.string());
        return {};
    }
    return {bytes.begin(), bytes.end()};
}

void write_pipeline_cache(const std::filesystem::path& folder, const std::string& device,
                          std::span<const std::byte> bytes) {
    if (folder.empty() || bytes.empty())
        return;
    try {
        std::filesystem::create_directories(folder);
        std::string content = sha256_of(bytes);
        content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        write_file_atomically(pipeline_cache_path(folder, device), content);
    } catch (const std::exception& error) {
        spdlog::debug("compiled kernels are not kept: {}", error.what());
    }
}

namespace {

template <typename T> using Consume = std::function<void(const layout::FieldChunk<T>&)>;

class CpuEngine final : public Engine {
public:
    explicit CpuEngine(const EngineOptions& options) {
        options_.chunk_bytes = options.chunk_bytes;
        path_options_.chunk_bytes = options.chunk_bytes;
    }

    EngineReport report() const override { return {"cpu", "CPU reference", "", "", true, true}; }

    EngineTimes evaluate(const layout::FieldInput<float>& input, const Consume<float>& consume) override {
        return run(input, consume);
    }
    EngineTimes evaluate(const layout::FieldInput<double>& input, const Consume<double>& consume) override {
        return run(input, consume);
    }

    EngineTimes explore(const layout::PathInput<float>& input, const reference::TakePaths<float>& take,
                        const reference::TakeMetrics<float>& take_metrics) override {
        return run_paths(input, take, take_metrics);
    }
    EngineTimes explore(const layout::PathInput<double>& input, const reference::TakePaths<double>& take,
                        const reference::TakeMetrics<double>& take_metrics) override {
        return run_paths(input, take, take_metrics);
    }

private:
    using Clock = std::chrono::steady_clock;

    // Times what lies between the callbacks.
    template <typename T>
    EngineTimes run_paths(const layout::PathInput<T>& input, const reference::TakePaths<T>& take,
                          const reference::TakeMetrics<T>& take_metrics) {
        EngineTimes times;
        Clock::time_point start = Clock::now();
        const auto timed = [&](const auto& callback, const auto&... values) {
            times.kernel += std::chrono::duration<double>(Clock::now() - start).count();
            callback(values...);
            start = Clock::now();
        };
        reference::evaluate_paths<T>(
            input, path_options_, [&](const layout::PathChunk<T>& chunk) { timed(take, chunk); },
            [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
                timed(take_metrics, first, metrics);
            });
        return times;
    }

    template <typename T> EngineTimes run(const layout::FieldInput<T>& input, const Consume<T>& consume) {
        EngineTimes times;
        Clock::time_point start = Clock::now();
        const Consume<T> timed = [&](const layout::FieldChunk<T>& chunk) {
            times.kernel += std::chrono::duration<double>(Clock::now() - start).count();
            consume(chunk);
            start = Clock::now();
        };
        reference::evaluate_field(input, options_, timed);
        return times;
    }

    reference::FieldOptions options_;
    reference::PathOptions path_options_;
};

class GpuEngine final : public Engine {
public:
    explicit GpuEngine(const EngineOptions& options)
        : cache_(options.cache), chosen_(choose(options)), device_(open(options)),
          kernel_(device_, kernel_options(options)) {
        mesh_options_.chunk_bytes = options.chunk_bytes;
        path_options_.chunk_bytes = options.chunk_bytes;
        mesh_path_options_.chunk_bytes = options.chunk_bytes;
    }

    ~GpuEngine() override {
        try {
            write_pipeline_cache(cache_, identity(), device_.pipeline_cache());
        } catch (const std::exception& error) {
            spdlog::debug("compiled kernels are not kept: {}", error.what());
        }
    }

    EngineReport report() const override {
        return {"gpu", chosen_.name, chosen_.uuid, chosen_.driver, chosen_.software, chosen_.f64};
    }

    EngineTimes evaluate(const layout::FieldInput<float>& input, const Consume<float>& consume) override {
        return run(input, consume);
    }
    EngineTimes evaluate(const layout::FieldInput<double>& input, const Consume<double>& consume) override {
        return run(input, consume);
    }

    EngineTimes explore(const layout::PathInput<float>& input, const reference::TakePaths<float>& take,
                        const reference::TakeMetrics<float>& take_metrics) override {
        return run_paths(input, take, take_metrics);
    }
    EngineTimes explore(const layout::PathInput<double>& input, const reference::TakePaths<double>& take,
                        const reference::TakeMetrics<double>& take_metrics) override {
        return run_paths(input, take, take_metrics);
    }

private:
    static compute::DeviceReport choose(const EngineOptions& options) {
        return compute::choose_device(compute::list_devices(), options.gpu, options.needs_f64);
    }
    std::string identity() const { return chosen_.name + chosen_.uuid + chosen_.driver; }
    compute::Device open(const EngineOptions& options) {
        const std::vector<std::byte> kept = read_pipeline_cache(cache_, identity());
        compute::DeviceOptions wanted;
        wanted.wanted = options.gpu;
        wanted.needs_f64 = options.needs_f64;
        wanted.validation = options.validation;
        wanted.pipeline_cache = kept;
        return compute::Device(wanted);
    }
    static compute::FieldKernelOptions kernel_options(const EngineOptions& options) {
        compute::FieldKernelOptions kernel;
        kernel.chunk_bytes = options.chunk_bytes;
        return kernel;
    }

    template <typename T> EngineTimes run(const layout::FieldInput<T>& input, const Consume<T>& consume) {
        EngineTimes spent;
        const bool mesh = input.law.features.surface == layout::kSurfaceMesh;
        add(mesh ? run_mesh(input, consume, spent) : kernel_.evaluate(input, consume), spent);
        return spent;
    }

    template <typename T>
    EngineTimes run_paths(const layout::PathInput<T>& input, const reference::TakePaths<T>& take,
                          const reference::TakeMetrics<T>& take_metrics) {
        EngineTimes spent;
        if (input.law.features.surface == layout::kSurfaceMesh) {
            add(run_mesh_paths(input, take, take_metrics), spent);
            return spent;
        }
        if (!path_kernel_)
            path_kernel_ = std::make_unique<compute::PathKernel>(device_, path_options_);
        add(path_kernel_->explore(input, take, take_metrics), spent);
        return spent;
    }

    // What kernels leave is the oracle's: its updates go many ways there, few steps need them.
    template <typename T>
    compute::FieldTimes run_mesh_paths(const layout::PathInput<T>& input, const reference::TakePaths<T>& take,
                                       const reference::TakeMetrics<T>& take_metrics) {
        if (!mesh_path_kernel_)
            mesh_path_kernel_ = std::make_unique<compute::MeshPathKernel>(device_, mesh_path_options_);
        const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> updates) {
            reference::finish_updates(input.law.mesh, updates, std::thread::hardware_concurrency());
        };
        return mesh_path_kernel_->explore(input, finish, take, take_metrics);
    }

    void add(const compute::FieldTimes& times, EngineTimes& spent) {
        if (const auto complaints = device_.validation_messages(); !complaints.empty())
            throw compute::DeviceError(compute::DeviceError::Kind::unsupported,
                                       "the validation layers complain: " + complaints.front());
        spent.compile = times.compile;
        spent.upload = times.upload;
        spent.kernel = times.kernel;
        spent.read_back = times.read_back;
        spent.uploaded = times.uploaded;
    }

    // Slab by slab, so that plans take little memory however large the grid is.
    template <typename T>
    compute::FieldTimes run_mesh(const layout::FieldInput<T>& input, const Consume<T>& consume, EngineTimes& spent) {
        using Clock = std::chrono::steady_clock;
        const auto since = [](Clock::time_point start) {
            return std::chrono::duration<double>(Clock::now() - start).count();
        };
        if (!mesh_kernel_)
            mesh_kernel_ = std::make_unique<compute::MeshKernel>(device_, mesh_options_);
        if (!input.plan.blocks.empty())
            return mesh_kernel_->evaluate<T>(input, consume);
        Clock::time_point start = Clock::now();
        const BlockPlanner<T> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside);
        spent.plan = since(start);
        BlockPlan plan;
        return mesh_kernel_->evaluate<T>(input, consume, [&](std::size_t z_first, std::size_t z_count) {
            start = Clock::now();
            plan = planner.plan(z_first, z_count);
            spent.plan += since(start);
            spent.voxels_evaluated += plan.voxels_evaluated;
            return plan.view();
        });
    }

    std::filesystem::path cache_;
    compute::DeviceReport chosen_;
    compute::Device device_;
    compute::FieldKernel kernel_;
    compute::MeshKernelOptions mesh_options_;
    std::unique_ptr<compute::MeshKernel> mesh_kernel_; // made for the first mesh
    compute::PathKernelOptions path_options_;
    std::unique_ptr<compute::PathKernel> path_kernel_; // made for the first paths
    compute::MeshPathOptions mesh_path_options_;
    std::unique_ptr<compute::MeshPathKernel> mesh_path_kernel_; // made for the first paths on a mesh
};

[[noreturn]] void refuse_paths() {
    throw compute::DeviceError(compute::DeviceError::Kind::unsupported,
                               "this engine has no kernel for such paths: use --engine cpu");
}

} // namespace

EngineTimes Engine::explore(const layout::PathInput<float>&, const reference::TakePaths<float>&,
                            const reference::TakeMetrics<float>&) {
    refuse_paths();
}
EngineTimes Engine::explore(const layout::PathInput<double>&, const reference::TakePaths<double>&,
                            const reference::TakeMetrics<double>&) {
    refuse_paths();
}

std::unique_ptr<Engine> make_engine(const EngineOptions& options) {
    if (options.cpu)
        return std::make_unique<CpuEngine>(options);
    return std::make_unique<GpuEngine>(options);
}

std::filesystem::path default_cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return std::filesystem::path(folder) / "forceshade";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "forceshade";
    return {};
}

} // namespace forceshade
