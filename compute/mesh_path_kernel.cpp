#include "compute/mesh_path_kernel.h"

#include <algorithm>
#include <chrono>
#include <type_traits>

#include "compute/mesh_path_batch.h"
#include "compute/mesh_path_inputs.h"
#include "compute/mesh_pipeline.h"
#include "compute/path_inputs.h"
#include "compute/pipelines.h"
#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

constexpr std::size_t kMostSamples = std::size_t(1) << 24; // from one callback to the next

using layout::uint;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kGroup = 64; // invocations of a work group

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

template <typename T>
std::array<std::uint32_t, layout::kMeshPathSpecCount> constants_of(const layout::PathInput<T>& input,
                                                                   std::uint32_t unroll) {
    const HandFeatures hands = features_of(input.hands);
    std::array<std::uint32_t, layout::kMeshPathSpecCount> values{};
    values[layout::kMeshPathSpecLocalX] = kGroup;
    values[layout::kMeshPathSpecShading] = input.law.features.shading;
    values[layout::kMeshPathSpecMap] = input.law.features.map;
    values[layout::kMeshPathSpecTexture] = input.law.features.texture;
    values[layout::kMeshPathSpecChannels] = input.features.channels;
    values[layout::kMeshPathSpecMotion] = input.features.motion;
    values[layout::kMeshPathSpecLoop] = input.features.loop;
    values[layout::kMeshPathSpecHarmonics] = input.features.harmonics;
    values[layout::kMeshPathSpecFriction] = hands.friction;
    values[layout::kMeshPathSpecQuantised] = hands.quantised;
    values[layout::kMeshPathSpecUnroll] = unroll;
    return values;
}

} // namespace

struct MeshPathKernel::Implementation {
    Device::Implementation& device;
    MeshPathOptions options;
    Pipelines pipelines;
    MeshPathInputs inputs;
    MeshPathBatch batch;
    vk::raii::DescriptorPool sets{nullptr};
    vk::raii::DescriptorSet set{nullptr};
    vk::raii::CommandBuffer commands;
    vk::raii::Fence fence;

    Implementation(Device::Implementation& on, const MeshPathOptions& wanted)
        : device(on), options(wanted), pipelines(on, layout::kMeshPathBindCount, sizeof(layout::MeshPathChunkParams)),
          inputs(on), batch(on), commands(make_commands(on)), fence(on.device.createFence({})) {
        const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, layout::kMeshPathBindCount);
        sets = device.device.createDescriptorPool({vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size});
        set = std::move(device.device.allocateDescriptorSets({*sets, *pipelines.set_layout()}).front());
    }

    template <typename T> struct Run;
    void bind();
};

void MeshPathKernel::Implementation::bind() {
    std::array<vk::DescriptorBufferInfo, layout::kMeshPathBindCount> infos;
    std::vector<vk::WriteDescriptorSet> writes;
    for (uint binding = 0; binding < layout::kMeshPathBindCount; ++binding) {
        const bool input = binding < layout::kMeshPathBindRecorded;
        infos[binding] =
            vk::DescriptorBufferInfo(input ? inputs.buffer(binding) : batch.buffer(binding), 0, VK_WHOLE_SIZE);
        writes.emplace_back(*set, binding, 0, 1, vk::DescriptorType::eStorageBuffer, nullptr, &infos[binding]);
    }
    device.device.updateDescriptorSets(writes, {});
}

template <typename T> struct MeshPathKernel::Implementation::Run {
    Implementation& self;
    const layout::PathInput<T>& input;
    const FinishUpdates<T>& finish;
    MeshPathTimes& times;
    vk::Pipeline hot, rare;

    void dispatch(const WaitingPaths& waiting, layout::MeshPathChunkParams chunk);
    bool round(layout::MeshPathChunkParams chunk);
    void finish_waiting();
    void chunk(std::size_t step_first, std::size_t step_count);
};

// Lists are of different paths, so the dispatches need not wait for each other.
template <typename T>
void MeshPathKernel::Implementation::Run<T>::dispatch(const WaitingPaths& waiting, layout::MeshPathChunkParams chunk) {
    const std::array<vk::Pipeline, kMeshPathLists> kernels{hot, rare, rare};
    const auto begins = self.batch.put_lists(waiting);
    const vk::raii::CommandBuffer& commands = self.commands;
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *self.pipelines.layout(), 0, *self.set, {});
    for (std::size_t i = 0; i < kMeshPathLists; ++i) {
        if (waiting[i].empty())
            continue;
        chunk.first = begins[i];
        chunk.listed = static_cast<std::uint32_t>(waiting[i].size());
        chunk.pause = i == 0 ? self.options.pause : self.options.rare_pause;
        chunk.limit = i == 2 ? self.options.limit_alone : self.options.limit;
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, kernels[i]);
        commands.pushConstants<layout::MeshPathChunkParams>(*self.pipelines.layout(), vk::ShaderStageFlagBits::eCompute,
                                                            0, chunk);
        commands.dispatch((chunk.listed + kGroup - 1) / kGroup, 1, 1);
    }
}

// Takes every path as far as one dispatch goes. False if all have come to the end.
template <typename T> bool MeshPathKernel::Implementation::Run<T>::round(layout::MeshPathChunkParams chunk) {
    using Stage = vk::PipelineStageFlagBits;
    const WaitingPaths waiting = self.batch.waiting(chunk.step_end);
    if (std::ranges::all_of(waiting, [](const auto& list) { return list.empty(); }))
        return false;
    ++times.dispatches;
    times.rare_updates += waiting[1].size();
    self.commands.reset();
    self.commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    dispatch(waiting, chunk);
    const vk::MemoryBarrier to_host(vk::AccessFlagBits::eShaderWrite, vk::AccessFlagBits::eHostRead);
    self.commands.pipelineBarrier(Stage::eComputeShader, Stage::eHost, {}, to_host, {}, {});
    self.commands.end();
    self.device.device.resetFences(*self.fence);
    const Clock::time_point start = Clock::now();
    self.device.queue.submit(vk::SubmitInfo({}, {}, *self.commands), *self.fence);
    wait_for(self.device, self.fence);
    times.kernel += seconds_since(start);
    self.batch.check_status();
    finish_waiting();
    return true;
}

template <typename T> void MeshPathKernel::Implementation::Run<T>::finish_waiting() {
    HostUpdates<T> waiting = self.batch.host_updates<T>();
    if (waiting.paths.empty())
        return;
    const Clock::time_point start = Clock::now();
    finish(waiting.updates);
    self.batch.put(waiting);
    times.host_updates += waiting.paths.size();
    times.host += seconds_since(start);
}

template <typename T>
void MeshPathKernel::Implementation::Run<T>::chunk(std::size_t step_first, std::size_t step_count) {
    layout::MeshPathChunkParams chunk{};
    chunk.paths = static_cast<std::uint32_t>(self.batch.paths());
    chunk.row_first = static_cast<std::uint32_t>(step_first);
    chunk.rows = static_cast<std::uint32_t>(self.batch.rows());
    chunk.step_end = static_cast<std::uint32_t>(step_first + step_count);
    chunk.own_hands = input.hands.size() > 1;
    chunk.stretch = input.stretch;
    chunk.vertices = self.inputs.vertices();
    while (round(chunk)) {
    }
}

MeshPathKernel::MeshPathKernel(Device& device, const MeshPathOptions& options)
    : implementation_(checked("preparing the kernels of paths",
                              [&] { return std::make_unique<Implementation>(device.implementation(), options); })) {}

MeshPathKernel::~MeshPathKernel() = default;

template <typename T>
MeshPathTimes MeshPathKernel::explore(const layout::PathInput<T>& input, const FinishUpdates<T>& finish,
                                      const TakePaths<T>& take, const TakeMetrics<T>& take_metrics) {
    Implementation& self = *implementation_;
    constexpr bool kDouble = std::is_same_v<T, double>;
    if (!self.device.report.f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          self.device.report.name +
                              " has no double precision in kernels, which paths on meshes need: use --engine cpu");
    MeshPathTimes times;
    return checked("evaluating paths", [&] {
        const FacetLoops loops = facet_loops(input.law.features, input.law.mesh.facet_begins);
        Clock::time_point start = Clock::now();
        const std::uint64_t before = self.inputs.uploaded();
        self.inputs.upload(input.law);
        times.upload = seconds_since(start);
        start = Clock::now();
        const auto constants = constants_of(input, loops.unroll);
        Implementation::Run<T> run{
            self,
            input,
            finish,
            times,
            self.pipelines.get(kDouble ? kernels::mesh_path_f64() : kernels::mesh_path_f32(), constants),
            self.pipelines.get(kDouble ? kernels::mesh_rest_f64() : kernels::mesh_rest_f32(),
                               std::span(constants).first(1))};
        times.compile = seconds_since(start);
        const uint channels = input.features.channels;
        const bool recorded = input.features.motion == layout::kMotionRecorded;
        for (std::size_t first = 0; first < input.paths; first += self.batch.paths()) {
            start = Clock::now();
            const layout::PathBatch<T> batch =
                input.source->batch(first, std::min(self.options.batch_paths, input.paths - first));
            const std::size_t row = MeshPathBatch::row_bytes(channels, batch.count, sizeof(T), recorded);
            const std::size_t steps = batch.longest ? batch.longest : input.steps;
            const std::size_t most = std::clamp<std::size_t>(kMostSamples / batch.count, 1, steps);
            const std::size_t rows =
                std::clamp<std::size_t>(self.options.chunk_bytes / std::max<std::size_t>(row, 1), 1, most);
            self.inputs.upload(input, batch);
            self.batch.begin(batch, steps, channels, rows, recorded);
            self.bind();
            times.upload += seconds_since(start);
            for (std::size_t step = 0; step < steps; step += rows) {
                const std::size_t count = std::min(rows, steps - step);
                if (recorded) {
                    const auto positions = input.source->positions(step, std::min(count + 1, steps - step));
                    self.batch.put_positions(positions);
                    times.uploaded += positions.size_bytes();
                }
                run.chunk(step, count);
                take(self.batch.chunk<T>(step, count));
            }
            take_metrics(batch.first, self.batch.metrics<T>());
        }
        times.uploaded += self.inputs.uploaded() - before;
        return times;
    });
}

template MeshPathTimes MeshPathKernel::explore<float>(const layout::PathInput<float>&, const FinishUpdates<float>&,
                                                      const TakePaths<float>&, const TakeMetrics<float>&);
template MeshPathTimes MeshPathKernel::explore<double>(const layout::PathInput<double>&, const FinishUpdates<double>&,
                                                       const TakePaths<double>&, const TakeMetrics<double>&);

} // namespace forceshade::compute
