#include "host/field/engine.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "compute/kernels.h"
#include "host/clock.h"
#include "host/field/digests.h"
#include "host/field/pipeline_cache.h"
#include "host/mesh/block_plan.h"
#include "host/reference/field.h"
#include "host/reference/god_object.h"
#include "host/reference/mesh_field.h"
#include "host/threads.h"

namespace forceshade {
namespace {

// Plans a mesh's field slab by slab, so that plans take little memory however large the grid is; or hands out the plan
// that comes with it.
template <typename T> class SlabPlanner {
public:
    SlabPlanner(const layout::FieldInput<T>& input, unsigned threads, EngineTimes& spent)
        : input_(input), spent_(spent) {
        const Clock::time_point start = Clock::now();
        if (input.plan.blocks.empty())
            planner_ = std::make_unique<BlockPlanner<T>>(input.law.mesh, input.x, input.y, input.z,
                                                         input.law.features.inside, threads);
        spent_.plan = seconds_since(start);
    }

    layout::MeshPlan plan(std::size_t z_first, std::size_t z_count) {
        if (!planner_)
            return input_.plan;
        const Clock::time_point start = Clock::now();
        plan_ = planner_->plan(z_first, z_count);
        spent_.plan += seconds_since(start);
        spent_.voxels_evaluated += plan_.voxels_evaluated;
        return plan_.view();
    }

private:
    const layout::FieldInput<T>& input_;
    EngineTimes& spent_;
    std::unique_ptr<const BlockPlanner<T>> planner_;
    BlockPlan plan_;
};

// For --verbose.
void print_times(const EngineReport& engine, const EngineTimes& times) {
    spdlog::debug("{}: plan {:.3f} s, compile {:.3f} s, upload {:.3f} s, kernel {:.3f} s, read back {:.3f} s",
                  engine.device, times.plan, times.compile, times.upload, times.kernel, times.read_back);
}

// The CPU oracle. Measures the time between the callbacks.
class CpuEngine final : public Engine {
public:
    explicit CpuEngine(const EngineOptions& options) {
        options_.threads = path_options_.threads = options.threads;
        options_.chunk_bytes = path_options_.chunk_bytes = options.chunk_bytes;
    }

    EngineReport report() const override { return {"cpu", "CPU reference", "", "", true, true}; }

    EngineTimes run(const EngineWork& work) override {
        EngineTimes times;
        Clock::time_point start = Clock::now();
        const auto timed = [&](const auto& callback) {
            return [&](const auto&... values) {
                times.kernel += seconds_since(start);
                callback(values...);
                start = Clock::now();
            };
        };
        std::visit(
            [&]<typename Work>(const Work& one) {
                using T = typename Work::Real;
                if constexpr (requires { one.take_metrics; })
                    reference::evaluate_paths<T>(one.input, path_options_, timed(one.take), timed(one.take_metrics));
                else if (one.input.law.features.surface != layout::kSurfaceMesh)
                    reference::evaluate_field<T>(one.input, options_, timed(one.take));
                else
                    evaluate_mesh<T>(one, timed(one.take), start, times);
            },
            work);
        print_times(report(), times);
        return times;
    }

private:
    template <typename T>
    void evaluate_mesh(const FieldWork<T>& work, const std::function<void(const layout::FieldChunk<T>&)>& take,
                       Clock::time_point& start, EngineTimes& times) {
        const layout::FieldInput<T>& input = work.input;
        SlabPlanner<T> planner(input, options_.threads, times);
        start = Clock::now();
        reference::evaluate_mesh_field<T>(
            input, options_,
            [&](std::size_t z_first, std::size_t z_count) {
                times.kernel += seconds_since(start);
                const layout::MeshPlan plan = planner.plan(z_first, z_count);
                start = Clock::now();
                return plan;
            },
            take);
    }

    reference::FieldOptions options_;
    reference::PathOptions path_options_;
};

// Hands batches on, and keeps the paths' lengths.
template <typename T> class Lengths final : public layout::PathSource<T> {
public:
    explicit Lengths(const layout::PathInput<T>& input)
        : source_(*input.source), lengths_(input.paths, static_cast<layout::uint>(input.steps)) {}

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        const layout::PathBatch<T> batch = source_.batch(first, count);
        std::ranges::copy(batch.steps, lengths_.begin() + std::ptrdiff_t(first));
        return batch;
    }
    std::span<const T> positions(std::size_t step, std::size_t steps) override {
        return source_.positions(step, steps);
    }

    std::span<const layout::uint> lengths() const { return lengths_; }

private:
    layout::PathSource<T>& source_;
    std::vector<layout::uint> lengths_;
};

// A kernel, made when it is first asked for.
template <typename Kernel, typename Options> class OnDemand {
public:
    Options options;
    Kernel& on(compute::Device& device) {
        if (!kernel_)
            kernel_ = std::make_unique<Kernel>(device, options);
        return *kernel_;
    }
    void set_in_parts(bool on) {
        if (kernel_)
            kernel_->set_in_parts(on);
    }

private:
    std::unique_ptr<Kernel> kernel_;
};

class GpuEngine final : public Engine {
public:
    explicit GpuEngine(const EngineOptions& options)
        : cache_(options.cache), twice_(options.twice),
          chosen_(compute::choose_device(compute::list_devices(), options.gpu, options.needs_f64)),
          device_(open(options)) {
        fields_.options.chunk_bytes = options.chunk_bytes;
        mesh_fields_.options.chunk_bytes = options.chunk_bytes;
        paths_.options.chunk_bytes = options.chunk_bytes;
        mesh_paths_.options.chunk_bytes = options.chunk_bytes;
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

    EngineTimes run(const EngineWork& work) override {
        return std::visit([&](const auto& one) { return twice_ ? run_twice(one) : run_once(one); }, work);
    }

private:
    template <typename Work> EngineTimes run_once(const Work& work) {
        EngineTimes spent;
        const compute::FieldTimes times = run_kernel(work, spent);
        if (const auto complaints = device_.validation_messages(); !complaints.empty())
            throw compute::DeviceError(compute::DeviceError::Kind::unsupported,
                                       "the validation layers complain: " + complaints.front());
        spent.compile = times.compile;
        spent.upload = times.upload;
        spent.kernel = times.kernel;
        spent.read_back = times.read_back;
        spent.uploaded = times.uploaded;
        print_times(report(), spent);
        return spent;
    }

    template <typename T> EngineTimes run_twice(const FieldWork<T>& work) {
        const std::size_t ny = work.input.y.size(), rows = ny * work.input.z.size();
        Digests whole(rows), parts(rows);
        const std::function<void(const layout::FieldChunk<T>&)> take = [&](const layout::FieldChunk<T>& chunk) {
            add(whole, chunk, ny);
            work.take(chunk);
        };
        const std::function<void(const layout::FieldChunk<T>&)> again = [&](const layout::FieldChunk<T>& chunk) {
            add(parts, chunk, ny);
        };
        const EngineTimes times = run_once(FieldWork<T>{work.input, take});
        in_parts([&] { run_once(FieldWork<T>{work.input, again}); });
        if (const std::size_t row = parts.first_difference(whole); row != rows)
            throw differs(fmt::format("the field at y {}, z {}", row % ny, row / ny));
        return times;
    }

    template <typename T> EngineTimes run_twice(const PathWork<T>& work) {
        layout::PathInput<T> input = work.input;
        Lengths<T> source(input);
        input.source = &source;
        Digests whole(input.paths), parts(input.paths);
        Digests* digests = &whole;
        const reference::TakePaths<T> take = [&](const layout::PathChunk<T>& chunk) {
            add(*digests, chunk, source.lengths());
            if (digests == &whole)
                work.take(chunk);
        };
        const reference::TakeMetrics<T> take_metrics = [&](std::size_t first,
                                                           std::span<const layout::PathMetrics<T>> metrics) {
            add(*digests, first, metrics);
            if (digests == &whole)
                work.take_metrics(first, metrics);
        };
        const EngineTimes times = run_once(PathWork<T>{input, take, take_metrics});
        digests = &parts;
        in_parts([&] { run_once(PathWork<T>{input, take, take_metrics}); });
        if (const std::size_t path = parts.first_difference(whole); path != input.paths)
            throw differs(fmt::format("path {}", path));
        return times;
    }

    void in_parts(const std::function<void()>& work) {
        set_in_parts(true);
        try {
            work();
        } catch (...) {
            set_in_parts(false);
            throw;
        }
        set_in_parts(false);
    }
    void set_in_parts(bool on) {
        fields_.set_in_parts(on);
        mesh_fields_.set_in_parts(on);
        paths_.set_in_parts(on);
        mesh_paths_.set_in_parts(on);
    }
    compute::DeviceError differs(const std::string& what) const {
        return {compute::DeviceError::Kind::differs_in_parts,
                fmt::format("{} of {} comes out otherwise when it is computed in other parts; do not trust what this "
                            "device computes, and report it with its driver: {}",
                            what, chosen_.name, chosen_.driver)};
    }

    std::string identity() const { return chosen_.name + chosen_.uuid + chosen_.driver; }
    compute::Device open(const EngineOptions& options) {
        const Stage stage("opening " + chosen_.name);
        const std::vector<std::byte> kept = read_pipeline_cache(cache_, identity());
        compute::DeviceOptions wanted;
        wanted.wanted = options.gpu;
        wanted.needs_f64 = options.needs_f64;
        wanted.validation = options.validation;
        wanted.pipeline_cache = kept;
        return compute::Device(wanted);
    }

    template <typename T> compute::FieldTimes run_kernel(const FieldWork<T>& work, EngineTimes& spent) {
        const layout::FieldInput<T>& input = work.input;
        if (input.law.features.surface != layout::kSurfaceMesh)
            return fields_.on(device_).evaluate(input, work.take);
        compute::MeshKernel& kernel = mesh_fields_.on(device_);
        if (!input.plan.blocks.empty())
            return kernel.evaluate<T>(input, work.take);
        SlabPlanner<T> planner(input, 0, spent);
        return kernel.evaluate<T>(
            input, work.take, [&](std::size_t z_first, std::size_t z_count) { return planner.plan(z_first, z_count); });
    }

    template <typename T> compute::FieldTimes run_kernel(const PathWork<T>& work, EngineTimes& spent) {
        if (work.input.law.features.surface != layout::kSurfaceMesh)
            return paths_.on(device_).explore(work.input, work.take, work.take_metrics);
        // The oracle does the updates that the kernel leaves: few steps need its many cases.
        const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> updates) {
            reference::finish_updates(work.input.law.mesh, updates, most_threads());
        };
        const compute::MeshPathTimes times =
            mesh_paths_.on(device_).explore(work.input, finish, work.take, work.take_metrics);
        spent.host_updates = times.host_updates;
        return times;
    }

    std::filesystem::path cache_;
    bool twice_;
    compute::DeviceReport chosen_;
    compute::Device device_;
    OnDemand<compute::FieldKernel, compute::FieldKernelOptions> fields_;
    OnDemand<compute::MeshKernel, compute::MeshKernelOptions> mesh_fields_;
    OnDemand<compute::PathKernel, compute::PathKernelOptions> paths_;
    OnDemand<compute::MeshPathKernel, compute::MeshPathOptions> mesh_paths_;
};

} // namespace

std::unique_ptr<Engine> make_engine(const EngineOptions& options) {
    std::unique_ptr<Engine> engine;
    if (options.cpu)
        engine = std::make_unique<CpuEngine>(options);
    else
        engine = std::make_unique<GpuEngine>(options);
    const EngineReport report = engine->report();
    spdlog::debug("device: {}{}{}", report.device, report.driver.empty() ? "" : ", " + report.driver,
                  options.cpu || options.cache.empty() ? "" : ", compiled kernels in " + options.cache.string());
    return engine;
}

} // namespace forceshade
