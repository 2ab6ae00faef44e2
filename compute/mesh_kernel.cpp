#include "compute/mesh_kernel.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

#include "compute/field_plan.h"
#include "compute/field_slot.h"
#include "compute/mesh_chunk.h"
#include "compute/mesh_inputs.h"
#include "compute/mesh_pipeline.h"

namespace forceshade::compute {
namespace {

using layout::uint;
using Clock = std::chrono::steady_clock;

constexpr SlotBindings kBindings{layout::kMeshBindCount,
                                 layout::kMeshBindStatus,
                                 {layout::kMeshBindForce, layout::kMeshBindDepth, layout::kMeshBindFacet,
                                  layout::kMeshBindProxy, layout::kMeshBindUnshaded}};
constexpr std::size_t kFacetChannel = 2, kProxyChannel = 3; // in the order of SlotBindings::results

// The plan of so many samples fits into any buffer, however long the planner makes its lists.
constexpr std::uint64_t kMostSamples = std::uint64_t(1) << 18; // 32 768 blocks, each with up to 512 candidates: 65 MiB

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// A dispatch and the plan that it reads.
struct MeshSlot {
    FieldSlot results;
    Buffer plan, upload; // `upload` only where the host does not share the memory
    MeshChunkPlan part;
};

} // namespace

struct MeshKernel::Implementation {
    static constexpr std::uint32_t kSlots = 2; // one is computed while the other is planned and consumed

    Device::Implementation& device;
    MeshKernelOptions options;
    Pipelines pipelines;
    MeshInputs inputs;
    vk::raii::DescriptorPool sets{nullptr};
    std::vector<MeshSlot> slots;

    Implementation(Device::Implementation& on, const MeshKernelOptions& wanted);

    template <typename T> struct Run; // of one field
    template <typename T> MeshChunkSteps steps(const layout::FieldInput<T>& input) const;
    void put_plan(MeshSlot& slot);
    void finish_all();
};

MeshKernel::Implementation::Implementation(Device::Implementation& on, const MeshKernelOptions& wanted)
    : device(on), options(wanted), pipelines(make_mesh_pipelines(on)), inputs(on) {
    const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, layout::kMeshBindCount * kSlots);
    sets = device.device.createDescriptorPool({vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSlots, size});
    const bool staged = options.force_staging || !shares_memory_with_host(device);
    for (std::uint32_t i = 0; i < kSlots; ++i)
        slots.push_back(
            {FieldSlot(device, kBindings,
                       std::move(device.device.allocateDescriptorSets({*sets, *pipelines.set_layout()}).front()),
                       staged),
             {},
             {},
             {}});
}

template <typename T> MeshChunkSteps MeshKernel::Implementation::steps(const layout::FieldInput<T>& input) const {
    const SampleBytes sample = bytes_per_sample(input.law.features.channels, sizeof(T));
    const std::size_t wanted =
        device.report.software ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes;
    const std::uint64_t pitch = inputs.x_pitch();
    const std::uint64_t least = layout::kMeshBlock * pitch * sample.all; // a row of blocks always fits
    const std::uint64_t bytes = std::max(least, std::min<std::uint64_t>(wanted, kMostSamples * sample.all));
    return plan_mesh_chunks(pitch, input.y.size(), input.z.size(), sample, device.limits.maxStorageBufferRange, bytes);
}

// The slot's part of the plan into memory that the kernel or the recorded copy reads.
void MeshKernel::Implementation::put_plan(MeshSlot& slot) {
    using Usage = vk::BufferUsageFlagBits;
    const auto bytes = std::as_bytes(std::span<const uint>(slot.part.words));
    if (bytes.size() > device.limits.maxStorageBufferRange)
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("the candidates of a part of the grid take {} bytes and a buffer of this device "
                                      "spans {}: a smaller grid would fit",
                                      bytes.size(), device.limits.maxStorageBufferRange));
    // Room to spare, since the next chunk may need somewhat more.
    const std::size_t room = bytes.size() <= slot.plan.size ? slot.plan.size : 16 + bytes.size() + bytes.size() / 4;
    const bool staged = slot.results.staged();
    grow(device, slot.plan, std::max<std::size_t>(room, 16), Usage::eStorageBuffer | Usage::eTransferDst,
         staged ? Placement::device : Placement::host_upload);
    if (staged)
        grow(device, slot.upload, room, Usage::eTransferSrc, Placement::host_upload);
    const Buffer& host = staged ? slot.upload : slot.plan;
    if (!bytes.empty())
        std::memcpy(host.mapped, bytes.data(), bytes.size());
    flush_to_device(device, host);
}

// The device must be done with the buffers before anybody uses them again.
void MeshKernel::Implementation::finish_all() {
    FieldTimes ignored;
    for (MeshSlot& slot : slots)
        try {
            slot.results.finish(ignored);
        } catch (const DeviceError&) {
            // The error under way says more.
        }
}

template <typename T> struct MeshKernel::Implementation::Run {
    Implementation& self;
    const layout::FieldInput<T>& input;
    const std::function<void(const layout::FieldChunk<T>&)>& consume;
    FieldTimes& times;
    vk::Pipeline pipeline, free_pipeline;
    MeshChunkSteps steps;
    bool voxel_by_voxel;
    std::size_t turn = 0;

    void hand_over(MeshSlot& slot) {
        if (!slot.results.in_flight())
            return;
        slot.results.finish(times);
        consume(slot.results.results<T>(input.x.size()));
    }

    void record(MeshSlot& slot, const layout::MeshChunkParams& chunk, const vk::raii::CommandBuffer& commands);
    void submit(const layout::MeshPlan& plan, uint y, uint z, uint z_end);
    void slab(const layout::MeshPlan& plan, std::size_t z_first, std::size_t z_count);
    void hand_over_rest() {
        for (std::size_t i = 0; i < kSlots; ++i)
            hand_over(self.slots[(turn + i) % kSlots]);
    }
};

// Everything free of contact first; then the blocks that are listed.
template <typename T>
void MeshKernel::Implementation::Run<T>::record(MeshSlot& slot, const layout::MeshChunkParams& chunk,
                                                const vk::raii::CommandBuffer& commands) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    for (std::size_t c = 0; c < FieldSlot::kChannelCount; ++c)
        if (const FieldSlot::Result result = slot.results.result(c); result.bytes && c != kProxyChannel)
            commands.fillBuffer(result.buffer, 0, result.bytes, c == kFacetChannel ? layout::kNoFacet : 0);
    if (slot.results.staged() && !slot.part.words.empty())
        commands.copyBuffer(*slot.upload.buffer, *slot.plan.buffer,
                            vk::BufferCopy(0, 0, slot.part.words.size() * sizeof(uint)));
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *self.pipelines.layout(), 0, slot.results.set(), {});
    commands.pushConstants<layout::MeshChunkParams>(*self.pipelines.layout(), vk::ShaderStageFlagBits::eCompute, 0,
                                                    chunk);
    const auto groups = [](std::uint64_t invocations) {
        return static_cast<std::uint32_t>((invocations + kMeshGroup - 1) / kMeshGroup);
    };
    const auto wait = [&](Stage stage, vk::AccessFlags written) {
        const vk::MemoryBarrier barrier(written, Access::eShaderRead | Access::eShaderWrite);
        commands.pipelineBarrier(stage, Stage::eComputeShader, {}, barrier, {}, {});
    };
    wait(Stage::eTransfer, Access::eTransferWrite);
    if (slot.results.result(kProxyChannel).bytes) {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, free_pipeline);
        commands.dispatch(groups(std::uint64_t(chunk.x_pitch) * chunk.y_count * chunk.z_count), 1, 1);
        wait(Stage::eComputeShader, Access::eShaderWrite);
    }
    if (chunk.blocks == 0)
        return;
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, pipeline);
    commands.dispatch(groups(chunk.blocks), 1, 1);
}

template <typename T>
void MeshKernel::Implementation::Run<T>::submit(const layout::MeshPlan& plan, uint y, uint z, uint z_end) {
    const auto ny = static_cast<uint>(input.y.size());
    MeshSlot& slot = self.slots[turn++ % kSlots];
    hand_over(slot);
    layout::MeshChunkParams chunk{};
    chunk.x_pitch = self.inputs.x_pitch();
    chunk.y_first = y;
    chunk.y_count = std::min(steps.y_step, ny - y);
    chunk.y_axis = chunk.x_pitch;
    chunk.z_first = z;
    chunk.z_count = std::min(steps.z_step, z_end - z);
    chunk.z_axis = chunk.x_pitch + ny;
    const Clock::time_point start = Clock::now();
    cut_plan(plan, chunk, self.inputs.candidates(), voxel_by_voxel, slot.part);
    chunk.blocks = slot.part.blocks;
    chunk.candidates = layout::kMeshBlockWords * chunk.blocks;
    self.put_plan(slot);
    times.uploaded += slot.part.words.size() * sizeof(uint);
    slot.results.reserve(input.law.features.channels, std::size_t(chunk.x_pitch) * steps.y_step * steps.z_step,
                         sizeof(T), [&](uint binding) {
                             return binding == layout::kMeshBindPlan ? *slot.plan.buffer : self.inputs.buffer(binding);
                         });
    times.upload += seconds_since(start);
    slot.results.submit({chunk.x_pitch, chunk.y_first, chunk.y_count, chunk.z_first, chunk.z_count},
                        [&](const vk::raii::CommandBuffer& commands) { record(slot, chunk, commands); });
}

template <typename T>
void MeshKernel::Implementation::Run<T>::slab(const layout::MeshPlan& plan, std::size_t z_first, std::size_t z_count) {
    const auto z_end = static_cast<uint>(z_first + z_count);
    for (auto z = static_cast<uint>(z_first); z < z_end; z += steps.z_step)
        for (uint y = 0; y < input.y.size(); y += steps.y_step)
            submit(plan, y, z, z_end);
}

MeshKernel::MeshKernel(Device& device, const MeshKernelOptions& options)
    : implementation_(checked("preparing the mesh kernel",
                              [&] { return std::make_unique<Implementation>(device.implementation(), options); })) {}

MeshKernel::~MeshKernel() = default;

template <typename T>
FieldTimes MeshKernel::evaluate(const layout::FieldInput<T>& input,
                                const std::function<void(const layout::FieldChunk<T>&)>& consume,
                                const PlanSlab& plan) {
    Implementation& self = *implementation_;
    constexpr bool kDouble = std::is_same_v<T, double>;
    if (kDouble && !self.device.report.f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          self.device.report.name + " has no double precision in kernels: use --precision f32");
    FieldTimes times;
    return checked("evaluating a field", [&] {
        const FacetLoops loops = facet_loops(input.law.features, input.law.mesh.facet_begins);
        Clock::time_point start = Clock::now();
        const std::uint64_t before = self.inputs.uploaded();
        self.inputs.upload(input);
        times.uploaded = self.inputs.uploaded() - before;
        times.upload = seconds_since(start);
        start = Clock::now();
        Implementation::Run<T> run{self,
                                   input,
                                   consume,
                                   times,
                                   mesh_pipeline(self.pipelines, input.law.features, loops, kDouble),
                                   free_proxy_pipeline(self.pipelines, kDouble),
                                   self.steps(input),
                                   loops.voxel_by_voxel};
        times.compile = seconds_since(start);
        const std::size_t nz = input.z.size();
        const std::size_t layers =
            std::max<std::size_t>(1, self.options.slab_voxels / (input.x.size() * input.y.size()));
        const std::size_t step = std::max<std::size_t>(layout::kMeshBlock, run.steps.z_step);
        const std::size_t slab = plan ? std::max<std::size_t>(1, layers / step) * step : nz;
        try {
            for (std::size_t z = 0; z < nz; z += slab) {
                const std::size_t count = std::min(slab, nz - z);
                run.slab(plan ? plan(z, count) : input.plan, z, count);
            }
            run.hand_over_rest();
        } catch (...) {
            self.finish_all();
            throw;
        }
        return times;
    });
}

template FieldTimes MeshKernel::evaluate<float>(const layout::FieldInput<float>&,
                                                const std::function<void(const layout::FieldChunk<float>&)>&,
                                                const PlanSlab&);
template FieldTimes MeshKernel::evaluate<double>(const layout::FieldInput<double>&,
                                                 const std::function<void(const layout::FieldChunk<double>&)>&,
                                                 const PlanSlab&);

} // namespace forceshade::compute
