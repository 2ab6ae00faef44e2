#include "host/field/engine.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "compute/kernels.h"
#include "host/clock.h"
#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/mesh/block_plan.h"
#include "host/output/files.h"
#include "host/output/kept.h"
#include "host/output/rows.h"
#include "host/reference/field.h"
#include "host/reference/god_object.h"
#include "host/threads.h"

namespace forceshade {
namespace {

// Plans a mesh's field slab by slab, so that plans take little memory however large the grid is; or hands out the plan
// that comes with it.
template <typename T> class SlabPlanner {
public:
    SlabPlanner(const layout::FieldInput<T>& input, unsigned threads, Evaluator evaluator, EngineTimes& spent)
        : input_(input), spent_(spent) {
        const Clock::time_point start = Clock::now();
        if (input.plan.blocks.empty())
            planner_ =
                std::make_unique<BlockPlanner<T>>(input.law.mesh, input.x, input.y, input.z, input.law.features.inside,
                                                  threads, FreeSpace::skipped, evaluator);
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
        SlabPlanner<T> planner(input, options_.threads, Evaluator::processor, times);
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

// Whether work that was computed twice came out the same: a number of 64 bits for each row of a field, or each path.
class Digests {
public:
    explicit Digests(std::size_t rows) : rows_(rows, 0) {}

    // Further values of a row, in their order.
    template <typename Value> void add(std::size_t row, std::span<const Value> values) {
        std::uint64_t digest = rows_[row];
        for (const Value& value : values) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof(Value));
            digest = (std::rotl(digest, 29) ^ bits) * 0x9E3779B97F4A7C15u;
        }
        rows_[row] = digest;
    }

    // The rows' number if there is none.
    std::size_t first_difference(const Digests& other) const {
        return static_cast<std::size_t>(std::ranges::mismatch(rows_, other.rows_).in1 - rows_.begin());
    }

private:
    std::vector<std::uint64_t> rows_;
};

// Of a field or of paths: `count` samples from `at` on.
template <typename Chunk>
void add_samples(Digests& digests, std::size_t row, const Chunk& chunk, std::size_t at, std::size_t count) {
    const auto add_channel = [&]<typename Value>(std::span<const Value> values, std::size_t width) {
        if (!values.empty())
            digests.add(row, values.subspan(width * at, width * count));
    };
    add_channel(chunk.force, 3);
    add_channel(chunk.depth, 1);
    add_channel(chunk.facet, 1);
    add_channel(chunk.proxy, 3);
    if constexpr (requires { chunk.unshaded; })
        add_channel(chunk.unshaded, 3);
    else
        add_channel(chunk.position, 3);
}

// A field's row is z * ny + y.
template <typename T> void add(Digests& digests, const layout::FieldChunk<T>& chunk, std::size_t ny) {
    for (std::size_t z = 0; z < chunk.z_count; ++z)
        for (std::size_t y = 0; y < chunk.y_count; ++y)
            add_samples(digests, (chunk.z_first + z) * ny + chunk.y_first + y, chunk,
                        (z * chunk.y_count + y) * chunk.x_pitch, chunk.x_count);
}

// Some steps of some paths; `lengths` of all paths, behind whose ends may stand anything.
template <typename T>
void add(Digests& digests, const layout::PathChunk<T>& chunk, std::span<const layout::uint> lengths) {
    for (std::size_t i = 0; i < chunk.path_count; ++i) {
        const std::size_t path = chunk.path_first + i;
        const std::size_t end = std::min<std::size_t>(chunk.step_first + chunk.step_count, lengths[path]);
        for (std::size_t step = chunk.step_first; step < end; ++step)
            add_samples(digests, path, chunk, (step - chunk.step_first) * chunk.pitch + i, 1);
    }
}

// Metrics have no padding, so that their bytes are theirs alone.
template <typename T> void add(Digests& digests, std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
    for (std::size_t i = 0; i < metrics.size(); ++i)
        digests.add(first + i, std::span(reinterpret_cast<const layout::uint*>(&metrics[i]),
                                         sizeof(metrics[i]) / sizeof(layout::uint)));
}

class GpuEngine final : public Engine {
public:
    explicit GpuEngine(const EngineOptions& options)
        : cache_(options.cache), twice_(options.twice),
          chosen_(compute::choose_device(compute::list_devices(), options.gpu, options.needs_f64)),
          device_(open(options)), options_{.chunk_bytes = options.chunk_bytes} {}

    ~GpuEngine() override {
        try {
            write_kept(kernels_path(), device_.cache());
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
    template <typename Work> EngineTimes run_once(const Work& work, bool in_parts = false) {
        EngineTimes spent;
        options_.in_parts = in_parts;
        const compute::FieldTimes times = run_kernel(work, spent);
        if (const auto complaints = device_.validation_messages(); !complaints.empty())
            throw compute::DeviceError(compute::DeviceError::Kind::unsupported,
                                       "the validation layers complain: " + complaints.front());
        spent.compile = times.compile;
        spent.upload = times.upload;
        spent.kernel = times.kernel;
        spent.read_back = times.read_back;
        spent.uploaded = times.uploaded;
        spent.host_updates = times.host_updates;
        spent.group = times.group;
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
        run_once(FieldWork<T>{work.input, again}, true);
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
        run_once(PathWork<T>{input, take, take_metrics}, true);
        if (const std::size_t path = parts.first_difference(whole); path != input.paths)
            throw differs(fmt::format("path {}", path));
        return times;
    }

    // Made when it is first asked for.
    template <typename Kernel> Kernel& made(std::unique_ptr<Kernel>& kernel) {
        if (!kernel)
            kernel = std::make_unique<Kernel>(device_, options_);
        kernel->set_in_parts(options_.in_parts);
        return *kernel;
    }
    compute::DeviceError differs(const std::string& what) const {
        return {compute::DeviceError::Kind::differs_in_parts,
                fmt::format("{} of {} comes out otherwise when it is computed in other parts; do not trust what this "
                            "device computes, and report it with its driver: {}",
                            what, chosen_.name, chosen_.driver)};
    }

    std::filesystem::path kernels_path() const {
        return kept_path(cache_, "pipelines", chosen_.name + chosen_.uuid + chosen_.driver);
    }
    compute::Device open(const EngineOptions& options) {
        const Stage stage("opening " + chosen_.name);
        const std::vector<std::byte> kept = read_kept(kernels_path());
        compute::DeviceOptions wanted;
        wanted.wanted = options.gpu;
        wanted.needs_f64 = options.needs_f64;
        wanted.validation = options.validation;
        wanted.cache = kept;
        if (options.try_groups)
            wanted.try_groups_after = 0;
        return compute::Device(wanted);
    }

    template <typename T> compute::FieldTimes run_kernel(const FieldWork<T>& work, EngineTimes& spent) {
        const layout::FieldInput<T>& input = work.input;
        if (input.law.features.surface != layout::kSurfaceMesh)
            return made(fields_).evaluate(input, work.take);
        compute::MeshKernel& kernel = made(mesh_fields_);
        if (!input.plan.blocks.empty())
            return kernel.evaluate<T>(input, work.take);
        SlabPlanner<T> planner(input, 0, chosen_.software ? Evaluator::processor : Evaluator::hardware, spent);
        return kernel.evaluate<T>(
            input, work.take, [&](std::size_t z_first, std::size_t z_count) { return planner.plan(z_first, z_count); });
    }

    template <typename T> compute::FieldTimes run_kernel(const PathWork<T>& work, EngineTimes&) {
        if (work.input.surface)
            throw UsageError(kRubsOnCpu);
        if (work.input.law.features.surface != layout::kSurfaceMesh)
            return made(paths_).explore(work.input, work.take, work.take_metrics);
        // The oracle does the updates that the kernel leaves: few steps need its many cases.
        const compute::FinishUpdates<T> finish = [&](std::span<layout::MeshUpdate<T>> updates) {
            reference::finish_updates(work.input.law.mesh, updates, most_threads());
        };
        return made(mesh_paths_).explore(work.input, finish, work.take, work.take_metrics);
    }

    std::filesystem::path cache_;
    bool twice_;
    compute::DeviceReport chosen_;
    compute::Device device_;
    compute::KernelOptions options_;
    std::unique_ptr<compute::FieldKernel> fields_;
    std::unique_ptr<compute::MeshKernel> mesh_fields_;
    std::unique_ptr<compute::PathKernel> paths_;
    std::unique_ptr<compute::MeshPathKernel> mesh_paths_;
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

template <typename T> void Field<T>::append(const layout::FieldChunk<T>& chunk, std::size_t repeats) {
    append_rows(chunk, chunk.force, 3, repeats, force);
    append_rows(chunk, chunk.depth, 1, repeats, depth);
    append_rows(chunk, chunk.proxy, 3, repeats, proxy);
    append_rows(chunk, chunk.unshaded, 3, repeats, unshaded);
    append_rows(chunk, chunk.facet, 1, repeats, facet);
}

template <typename T> Field<T> evaluate(const layout::FieldInput<T>& input, std::size_t repeats, Engine& engine) {
    Field<T> field;
    field.times = engine.evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) { field.append(chunk, repeats); });
    return field;
}

template <typename T> Field<T> evaluate(const PreparedCase& prepared, Engine& engine) {
    const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::what_varies);
    const layout::FieldInput<T> input = tables.input();
    return evaluate<T>(input, prepared.one.scene.grid.size[1] / input.y.size(), engine);
}

template struct Field<float>;
template struct Field<double>;
template Field<float> evaluate(const layout::FieldInput<float>&, std::size_t, Engine&);
template Field<double> evaluate(const layout::FieldInput<double>&, std::size_t, Engine&);
template Field<float> evaluate<float>(const PreparedCase&, Engine&);
template Field<double> evaluate<double>(const PreparedCase&, Engine&);

} // namespace forceshade
