// Fields of analytic surfaces and of meshes.
#include <algorithm>

#include <fmt/format.h>

#include "compute/dispatch.h"
#include "compute/plan.h"
#include "host/threads.h"
#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

using layout::uint;

// True if what depends on (x, y) alone differs from y to y; shaders/field.comp: ALONG_Z.
bool columns_vary_in_y(const layout::Features& features) {
    const auto varies = [](uint map) { return map == layout::kMapGaussian || map == layout::kMapSamples; };
    return varies(features.map) || varies(features.texture);
}

// Invocations that fill a device: on software some vectors for every thread, so that they finish together.
std::uint32_t filling_invocations(const DeviceReport& report) {
    return report.software ? 256 * most_threads() : 65536;
}

// Layers of the next dispatch of a field whose layers have `ny` rows, and rows of each.
uint layers_of(const Dispatcher& dispatcher, uint y_step, uint z_step, uint ny) {
    if (z_step == 1)
        return 1;
    return static_cast<uint>(std::max<std::uint64_t>(1, dispatcher.paced(std::uint64_t(y_step) * z_step) / ny));
}
uint rows_of(const Dispatcher& dispatcher, uint y_step, uint left, uint layers) {
    const uint most = std::min(y_step, left);
    return layers > 1 ? most : std::min(most, static_cast<uint>(dispatcher.paced(most)));
}

// A field on its way through the device.
template <typename T> struct FieldRun {
    Dispatcher& dispatcher;
    const KernelOptions& options;
    const layout::FieldInput<T>& input;
    const bool packed = sizeof(T) == sizeof(float) && !takes_exact<T>(dispatcher.report()) && options.packed_stores &&
                        dispatcher.report().int64;

    std::uint32_t lanes() const { return packed ? layout::kLanesPacked : layout::kLanes; }
    Code code() const {
        return packed ? kernels::field_f32_packed()
                      : code_for<T>(dispatcher.report(), kernels::field_f32(), kernels::field_f32_exact(),
                                    kernels::field_f64());
    }
    FieldPlan reserve() const;
    void run(const FieldPlan& plan, std::size_t pipeline, FieldTimes& times, const TakeField<T>& take) const;
};

// Buffers for the results, smaller ones while the device is short of memory.
template <typename T> FieldPlan FieldRun<T>::reserve() const {
    const layout::Features& features = input.law.features;
    const DeviceReport& report = dispatcher.report();
    const SampleBytes sample = bytes_per_sample(features.channels, sizeof(T));
    PlanLimits limits;
    limits.buffer_range = report.buffer_range;
    limits.group_invocations = dispatcher.least_group();
    limits.group_count = report.group_count;
    limits.lanes = lanes();
    limits.rows = options.rows;
    limits.invocations = filling_invocations(report);
    limits.along_z = columns_vary_in_y(features);
    // Rows of one y lie far apart: there a chunk gains more from columns that serve for many of them.
    const bool cached = report.software && !limits.along_z;
    const std::size_t wanted =
        dispatcher.fitting(cached ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes);
    const std::size_t row = (input.x.size() + limits.lanes) * sample.all;
    // 1 GiB keeps every index of the kernel within 32 bits.
    limits.chunk_bytes = std::max(std::min<std::size_t>(wanted, std::size_t(1) << 30), row);
    if (options.in_parts) {
        limits.chunk_bytes = std::clamp(row * part_of(input.y.size()), row, limits.chunk_bytes);
        limits.rows = 3;
    }
    FieldPlan plan;
    const auto reserve = [&] {
        plan = plan_field(input.x.size(), input.y.size(), input.z.size(), sample, limits);
        dispatcher.reserve_channels(layout::kBindForce, features.channels,
                                    std::size_t(plan.x_pitch) * plan.y_step * plan.z_step, sizeof(T));
    };
    dispatcher.fit(reserve, [&] { return (limits.chunk_bytes /= 2) >= row; });
    return plan;
}

template <typename T>
void FieldRun<T>::run(const FieldPlan& plan, std::size_t pipeline, FieldTimes& times, const TakeField<T>& take) const {
    const auto ny = static_cast<uint>(input.y.size()), nz = static_cast<uint>(input.z.size());
    layout::ChunkParams chunk{};
    for (uint z = 0; z < nz; z += chunk.z_count) {
        chunk.z_count = layers_of(dispatcher, plan.y_step, plan.z_step, ny);
        chunk.z_count = std::min(chunk.z_count, nz - z);
        for (uint y = 0; y < ny; y += chunk.y_count) {
            dispatcher.begin(times);
            chunk.x_pitch = plan.x_pitch;
            chunk.y_first = y;
            chunk.y_count = rows_of(dispatcher, plan.y_step, ny - y, chunk.z_count);
            chunk.y_axis = plan.x_pitch;
            chunk.z_first = z;
            chunk.z_axis = plan.x_pitch + ny;
            chunk.rows = plan.rows;
            dispatcher.expect_channels(layout::kBindForce, input.law.features.channels,
                                       std::size_t(plan.x_pitch) * chunk.y_count * chunk.z_count, sizeof(T));
            const Dispatcher::Run run{pipeline, plan.invocations(chunk.y_count, chunk.z_count), bytes_of(chunk)};
            dispatcher.submit({&run, 1}, std::uint64_t(chunk.y_count) * chunk.z_count, [this, chunk, &take] {
                take(dispatcher.field_chunk<T>(layout::kBindForce, input.x.size(), chunk));
            });
        }
    }
}

// The plan of this many samples fits into any buffer, however long the planner makes its lists.
constexpr std::uint64_t kMostBlockSamples = std::uint64_t(1)
                                            << 18; // 32 768 blocks, each with up to 512 candidates: 65 MiB

Constants free_constants() {
    layout::Features features;
    features.channels = layout::kChannelProxy;
    Constants constants = constants_of(features);
    constants[layout::kSpecFree] = 1;
    return constants;
}

template <typename T>
MeshChunkSteps steps_of(const Dispatcher& dispatcher, const KernelOptions& options, const layout::FieldInput<T>& input,
                        std::uint64_t x_pitch) {
    const SampleBytes sample = bytes_per_sample(input.law.features.channels, sizeof(T));
    const DeviceReport& report = dispatcher.report();
    const std::size_t wanted = dispatcher.fitting(
        report.software ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes);
    const std::uint64_t least = layout::kMeshBlock * x_pitch * sample.all; // a row of blocks always fits
    std::uint64_t bytes = std::max(least, std::min<std::uint64_t>(wanted, kMostBlockSamples * sample.all));
    if (options.in_parts)
        bytes = std::clamp(x_pitch * sample.all * part_of(input.y.size()), least, bytes);
    return plan_mesh_chunks(x_pitch, input.y.size(), input.z.size(), sample, report.buffer_range, bytes);
}

// A mesh's field on its way through the device.
template <typename T> struct MeshFieldRun {
    Dispatcher& dispatcher;
    const layout::FieldInput<T>& input;
    const TakeField<T>& take;
    FieldTimes& times;
    std::size_t pipeline, free_pipeline;
    std::vector<uint> candidates;
    std::uint32_t x_pitch;
    MeshChunkSteps steps;
    bool voxel_by_voxel;
    layout::MeshChunkParams chunk{}; // at hand
    MeshChunkPlan part{};            // its

    bool halve();
    void submit(const layout::MeshPlan& plan);
    void slab(const layout::MeshPlan& plan, std::size_t z_first, std::size_t z_count) {
        const auto ny = static_cast<uint>(input.y.size()), z_end = static_cast<uint>(z_first + z_count);
        for (chunk.z_first = static_cast<uint>(z_first); chunk.z_first < z_end; chunk.z_first += chunk.z_count) {
            chunk.z_count = chunk.z_first % layout::kMeshBlock == 0 ? std::min(steps.z_step, z_end - chunk.z_first) : 1;
            for (chunk.y_first = 0; chunk.y_first < ny; chunk.y_first += chunk.y_count) {
                chunk.y_count = std::min(steps.y_step, ny - chunk.y_first);
                submit(plan);
            }
        }
    }
};

// False where the chunk is of one row of blocks.
template <typename T> bool MeshFieldRun<T>::halve() {
    const auto half = [](uint count) { return count / 2 / layout::kMeshBlock * layout::kMeshBlock; };
    if (chunk.z_count > 1)
        chunk.z_count = std::max(1u, half(chunk.z_count));
    else if (chunk.y_count > layout::kMeshBlock)
        chunk.y_count = std::max(layout::kMeshBlock, half(chunk.y_count));
    else
        return false;
    return true;
}

template <typename T> void MeshFieldRun<T>::submit(const layout::MeshPlan& plan) {
    dispatcher.begin(times);
    chunk.x_pitch = chunk.y_axis = x_pitch;
    chunk.z_axis = chunk.x_pitch + static_cast<uint>(input.y.size());
    const Clock::time_point start = Clock::now();
    cut_plan(plan, chunk, candidates, voxel_by_voxel, part);
    const std::uint64_t most =
        std::min<std::uint64_t>(dispatcher.paced(part.words.size()), dispatcher.report().buffer_range / sizeof(uint));
    while (part.words.size() > most && halve())
        cut_plan(plan, chunk, candidates, voxel_by_voxel, part);
    std::uint64_t samples = 0;
    const uint channels = input.law.features.channels;
    const auto reserve = [&] {
        const Bytes words = std::as_bytes(std::span<const uint>(part.words));
        if (words.size() > dispatcher.report().buffer_range)
            throw DeviceError(DeviceError::Kind::out_of_memory,
                              fmt::format("the candidates of a part of the grid take {} bytes and a buffer of this "
                                          "device spans {}: a smaller grid would fit",
                                          words.size(), dispatcher.report().buffer_range));
        dispatcher.put(layout::kMeshBindPlan, words);
        samples = std::uint64_t(chunk.x_pitch) * chunk.y_count * chunk.z_count;
        dispatcher.expect_channels(layout::kMeshBindForce, channels, samples, sizeof(T));
    };
    dispatcher.fit(reserve, [&] {
        const bool halved = halve();
        if (halved)
            cut_plan(plan, chunk, candidates, voxel_by_voxel, part);
        return halved;
    });
    chunk.blocks = part.blocks;
    chunk.candidates = layout::kMeshBlockWords * chunk.blocks;
    times.uploaded += part.words.size() * sizeof(uint);
    times.upload += seconds_since(start);
    // Everything free of contact first; then the blocks that are listed.
    for (const uint binding : {layout::kMeshBindForce, layout::kMeshBindDepth, layout::kMeshBindUnshaded})
        dispatcher.fill(binding, 0);
    dispatcher.fill(layout::kMeshBindFacet, layout::kNoFacet);
    std::vector<Dispatcher::Run> runs;
    if (channels & layout::kChannelProxy)
        runs.push_back({free_pipeline, samples, bytes_of(chunk), true});
    if (chunk.blocks != 0)
        runs.push_back({pipeline, chunk.blocks, bytes_of(chunk), true, !runs.empty()});
    dispatcher.submit(runs, part.words.size(), [this, one = chunk] {
        take(dispatcher.field_chunk<T>(layout::kMeshBindForce, input.x.size(), one));
    });
}

} // namespace

FieldKernel::FieldKernel(Device& device, const KernelOptions& options)
    : Kernel(device, options, {layout::kBindCount, layout::kBindStatus, sizeof(layout::ChunkParams)}) {}

template <typename T> FieldTimes FieldKernel::evaluate(const layout::FieldInput<T>& input, const TakeField<T>& take) {
    Dispatcher& dispatcher = *dispatcher_;
    return run_kernel<T>(dispatcher, options_.in_parts, "evaluating a field", [&](FieldTimes& times) {
        const FieldRun<T> field{dispatcher, options_, input};
        FieldPlan plan;
        dispatcher.upload(times, [&](const PutTable& put) {
            put_field_tables(input, field.lanes(), put);
            plan = field.reserve();
        });
        const std::size_t pipeline = dispatcher.pipeline(field.code(), constants_of(input.law.features), times);
        dispatcher.complete(times, [&] { field.run(plan, pipeline, times, take); });
    });
}

template FieldTimes FieldKernel::evaluate<float>(const layout::FieldInput<float>&, const TakeField<float>&);
template FieldTimes FieldKernel::evaluate<double>(const layout::FieldInput<double>&, const TakeField<double>&);

MeshKernel::MeshKernel(Device& device, const KernelOptions& options)
    : Kernel(device, options, {layout::kMeshBindCount, layout::kMeshBindStatus, sizeof(layout::MeshChunkParams)}) {}

template <typename T>
FieldTimes MeshKernel::evaluate(const layout::FieldInput<T>& input, const TakeField<T>& take, const PlanSlab& plan) {
    Dispatcher& dispatcher = *dispatcher_;
    return run_kernel<T>(dispatcher, options_.in_parts, "evaluating a field", [&](FieldTimes& times) {
        const FacetLoops loops = facet_loops(input.law.features, input.law.mesh.facet_begins);
        std::vector<uint> candidates;
        dispatcher.upload(times, [&](const PutTable& put) { candidates = put_mesh_tables(input, put); });
        const Code code = code_for<T>(dispatcher.report(), kernels::mesh_field_f32(), kernels::mesh_field_f32_exact(),
                                      kernels::mesh_field_f64());
        const auto x_pitch =
            static_cast<std::uint32_t>(divide_up(input.x.size(), layout::kMeshBlock) * layout::kMeshBlock);
        MeshFieldRun<T> field{dispatcher,
                              input,
                              take,
                              times,
                              dispatcher.pipeline(code, constants_of(input.law.features, loops), times),
                              dispatcher.pipeline(code, free_constants(), times),
                              std::move(candidates),
                              x_pitch,
                              steps_of(dispatcher, options_, input, x_pitch),
                              loops.voxel_by_voxel};
        const std::size_t nz = input.z.size();
        const std::size_t layers = std::max<std::size_t>(1, options_.slab_voxels / (input.x.size() * input.y.size()));
        const std::size_t step = std::max<std::size_t>(layout::kMeshBlock, field.steps.z_step);
        const std::size_t slab = plan ? std::max<std::size_t>(1, layers / step) * step : nz;
        dispatcher.complete(times, [&] {
            for (std::size_t z = 0; z < nz; z += slab) {
                const std::size_t count = std::min(slab, nz - z);
                field.slab(plan ? plan(z, count) : input.plan, z, count);
            }
        });
    });
}

template FieldTimes MeshKernel::evaluate<float>(const layout::FieldInput<float>&, const TakeField<float>&,
                                                const PlanSlab&);
template FieldTimes MeshKernel::evaluate<double>(const layout::FieldInput<double>&, const TakeField<double>&,
                                                 const PlanSlab&);

} // namespace forceshade::compute
