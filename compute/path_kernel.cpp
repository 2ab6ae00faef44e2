#include "compute/path_kernel.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <type_traits>

#include "compute/field_slot.h"
#include "compute/path_inputs.h"
#include "compute/path_pipeline.h"
#include "compute/path_plan.h"
#include "compute/path_states.h"

namespace forceshade::compute {
namespace {

using layout::uint;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Positions travel in the place of a field's unshaded forces: both are three reals a sample.
constexpr SlotBindings kBindings{layout::kPathBindCount,
                                 layout::kPathBindStatus,
                                 {layout::kPathBindForce, layout::kPathBindDepth, layout::kPathBindFacet,
                                  layout::kPathBindProxy, layout::kPathBindPosition}};

uint slot_channels(uint channels) {
    return (channels & ~layout::kChannelPosition) |
           (channels & layout::kChannelPosition ? layout::kChannelUnshaded : 0u);
}

// A dispatch in flight, and the recorded positions that it reads.
struct PathSlot {
    FieldSlot results;
    Buffer recorded, upload; // `upload` only where the host does not share the memory
    std::size_t recorded_bytes = 0;
    layout::PathChunkParams chunk;
};

} // namespace

struct PathKernel::Implementation {
    static constexpr std::uint32_t kSlots = 2; // one is computed while the other is consumed

    Device::Implementation& device;
    PathKernelOptions options;
    bool staged;
    Pipelines pipelines;
    PathInputs inputs;
    PathStates states;
    vk::raii::DescriptorPool sets{nullptr};
    std::vector<PathSlot> slots;

    template <typename T> struct Run;

    Implementation(Device::Implementation& on, const PathKernelOptions& wanted);
    void put_recorded(PathSlot& slot, std::span<const std::byte> positions);
    void finish_all();
};

PathKernel::Implementation::Implementation(Device::Implementation& on, const PathKernelOptions& wanted)
    : device(on), options(wanted), staged(wanted.force_staging || !shares_memory_with_host(on)),
      pipelines(make_path_pipelines(on)), inputs(on), states(on, staged) {
    const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, layout::kPathBindCount * kSlots);
    sets = device.device.createDescriptorPool({vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSlots, size});
    for (std::uint32_t i = 0; i < kSlots; ++i)
        slots.push_back(
            {FieldSlot(device, kBindings,
                       std::move(device.device.allocateDescriptorSets({*sets, *pipelines.set_layout()}).front()),
                       staged),
             {},
             {},
             0,
             {}});
}

// Recorded positions into memory that the kernel or the recorded copy reads.
void PathKernel::Implementation::put_recorded(PathSlot& slot, std::span<const std::byte> positions) {
    using Usage = vk::BufferUsageFlagBits;
    slot.recorded_bytes = positions.size();
    grow(device, slot.recorded, std::max<std::size_t>(positions.size(), 16),
         Usage::eStorageBuffer | Usage::eTransferDst, staged ? Placement::device : Placement::host_upload);
    if (staged)
        grow(device, slot.upload, positions.size(), Usage::eTransferSrc, Placement::host_upload);
    if (positions.empty())
        return;
    const Buffer& host = staged ? slot.upload : slot.recorded;
    std::memcpy(host.mapped, positions.data(), positions.size());
    flush_to_device(device, host);
}

// The device must be done with the buffers before anybody uses them again.
void PathKernel::Implementation::finish_all() {
    FieldTimes ignored;
    for (PathSlot& slot : slots)
        try {
            slot.results.finish(ignored);
        } catch (const DeviceError&) {
            // The error under way says more.
        }
}

template <typename T> struct PathKernel::Implementation::Run {
    Implementation& self;
    const layout::PathInput<T>& input;
    const TakePaths<T>& take;
    FieldTimes& times;
    vk::Pipeline pipeline;
    layout::PathBatch<T> batch{};
    std::size_t turn = 0;

    bool recorded() const { return input.features.motion == layout::kMotionRecorded; }
    std::size_t steps() const { return batch.longest ? batch.longest : input.steps; }
    std::size_t batch_paths() const;
    uint window() const;
    void hand_over(PathSlot& slot);
    void record(PathSlot& slot, const vk::raii::CommandBuffer& commands);
    void submit(std::size_t step, uint window);
    void run_batch(std::size_t first);
};

// As many as the options say, and as tables fit into a buffer for.
template <typename T> std::size_t PathKernel::Implementation::Run<T>::batch_paths() const {
    const std::uint64_t range = self.device.limits.maxStorageBufferRange;
    const std::uint64_t harmonics = std::uint64_t(3) * input.features.harmonics * sizeof(layout::Harmonic<T>);
    const std::uint64_t most = range / std::max<std::uint64_t>(harmonics, sizeof(layout::PathState<T>));
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(most, 1, self.options.batch_paths));
}

template <typename T> uint PathKernel::Implementation::Run<T>::window() const {
    if (self.options.steps != 0)
        return self.options.steps;
    // Each dispatch loads and stores every state: short windows would be mostly that.
    const std::uint64_t bytes =
        std::min<std::uint64_t>(self.options.chunk_bytes, self.device.limits.maxStorageBufferRange);
    return steps_of_dispatch(step_work(input.law.features, input.features, input.law.params.facets, sizeof(T)),
                             batch.count, steps(), bytes);
}

template <typename T> void PathKernel::Implementation::Run<T>::hand_over(PathSlot& slot) {
    if (!slot.results.in_flight())
        return;
    slot.results.finish(times);
    const layout::FieldChunk<T> results = slot.results.results<T>(batch.count);
    layout::PathChunk<T> chunk{};
    chunk.path_first = batch.first;
    chunk.path_count = chunk.pitch = batch.count;
    chunk.step_first = slot.chunk.step_first;
    chunk.step_count = slot.chunk.step_end - slot.chunk.step_first;
    chunk.position = results.unshaded;
    chunk.force = results.force;
    chunk.depth = results.depth;
    chunk.facet = results.facet;
    chunk.proxy = results.proxy;
    take(chunk);
}

template <typename T>
void PathKernel::Implementation::Run<T>::record(PathSlot& slot, const vk::raii::CommandBuffer& commands) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    if (self.staged && slot.recorded_bytes != 0)
        commands.copyBuffer(*slot.upload.buffer, *slot.recorded.buffer, vk::BufferCopy(0, 0, slot.recorded_bytes));
    // The dispatch before this one wrote the states.
    const vk::MemoryBarrier barrier(Access::eShaderWrite | Access::eTransferWrite,
                                    Access::eShaderRead | Access::eShaderWrite);
    commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eComputeShader, {}, barrier, {}, {});
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, pipeline);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *self.pipelines.layout(), 0, slot.results.set(), {});
    commands.pushConstants<layout::PathChunkParams>(*self.pipelines.layout(), vk::ShaderStageFlagBits::eCompute, 0,
                                                    slot.chunk);
    commands.dispatch((slot.chunk.paths + kPathGroup - 1) / kPathGroup, 1, 1);
}

template <typename T> void PathKernel::Implementation::Run<T>::submit(std::size_t step, uint window) {
    PathSlot& slot = self.slots[turn++ % kSlots];
    hand_over(slot);
    const Clock::time_point start = Clock::now();
    const std::size_t count = std::min<std::size_t>(window, steps() - step);
    slot.chunk = {};
    slot.chunk.paths = static_cast<uint>(batch.count);
    slot.chunk.step_first = slot.chunk.row_first = static_cast<uint>(step);
    slot.chunk.step_end = static_cast<uint>(step + count);
    slot.chunk.steps = static_cast<uint>(steps());
    slot.chunk.own_lengths = !batch.steps.empty();
    slot.chunk.own_hands = input.hands.size() > 1;
    slot.chunk.stretch = input.stretch;
    if (recorded())
        self.put_recorded(slot, std::as_bytes(input.source->positions(step, std::min(count + 1, steps() - step))));
    times.uploaded += slot.recorded_bytes;
    slot.results.reserve(slot_channels(input.features.channels), batch.count * window, sizeof(T), [&](uint binding) {
        if (binding == layout::kPathBindStates)
            return self.states.buffer();
        if (binding == layout::kPathBindRecorded && recorded())
            return *slot.recorded.buffer;
        return self.inputs.buffer(binding);
    });
    times.upload += seconds_since(start);
    slot.results.submit({slot.chunk.paths, 0, static_cast<uint>(count), 0, 1},
                        [&](const vk::raii::CommandBuffer& commands) { record(slot, commands); });
}

template <typename T> void PathKernel::Implementation::Run<T>::run_batch(std::size_t first) {
    const Clock::time_point start = Clock::now();
    batch = input.source->batch(first, std::min(batch_paths(), input.paths - first));
    self.inputs.upload(input, batch);
    self.states.reserve(batch.count, sizeof(layout::PathState<T>));
    times.upload += seconds_since(start);
    const uint most = window();
    for (std::size_t step = 0; step < steps(); step += most)
        submit(step, most);
    for (std::size_t i = 0; i < kSlots; ++i)
        hand_over(self.slots[(turn + i) % kSlots]);
}

PathKernel::PathKernel(Device& device, const PathKernelOptions& options)
    : implementation_(checked("preparing the kernel of paths",
                              [&] { return std::make_unique<Implementation>(device.implementation(), options); })) {}

PathKernel::~PathKernel() = default;

template <typename T>
FieldTimes PathKernel::explore(const layout::PathInput<T>& input, const TakePaths<T>& take,
                               const TakeMetrics<T>& take_metrics) {
    Implementation& self = *implementation_;
    constexpr bool kDouble = std::is_same_v<T, double>;
    if (kDouble && !self.device.report.f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          self.device.report.name + " has no double precision in kernels: use --precision f32");
    FieldTimes times;
    return checked("evaluating paths", [&] {
        Clock::time_point start = Clock::now();
        const std::uint64_t before = self.inputs.uploaded();
        self.inputs.upload(input.law);
        times.upload = seconds_since(start);
        start = Clock::now();
        const vk::Pipeline pipeline =
            path_pipeline(self.pipelines, {input.law.features, input.features, features_of(input.hands), kDouble});
        times.compile = seconds_since(start);
        Implementation::Run<T> run{self, input, take, times, pipeline};
        try {
            for (std::size_t first = 0; first < input.paths; first += run.batch.count) {
                run.run_batch(first);
                take_metrics(run.batch.first, self.states.metrics<T>(run.batch.count));
            }
            times.uploaded += self.inputs.uploaded() - before;
        } catch (...) {
            self.finish_all();
            throw;
        }
        return times;
    });
}

template FieldTimes PathKernel::explore<float>(const layout::PathInput<float>&, const TakePaths<float>&,
                                               const TakeMetrics<float>&);
template FieldTimes PathKernel::explore<double>(const layout::PathInput<double>&, const TakePaths<double>&,
                                                const TakeMetrics<double>&);

} // namespace forceshade::compute
