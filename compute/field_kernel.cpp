#include "compute/field_kernel.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>
#include <type_traits>

#include <fmt/format.h>

#include "compute/field_pipeline.h"
#include "compute/field_plan.h"

namespace forceshade::compute {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The output channels in the order of their bindings.
struct Channel {
    layout::uint bit, binding;
    std::uint32_t reals, uints; // a sample
};
constexpr std::array<Channel, 5> kChannels{{{layout::kChannelForce, layout::kBindForce, 3, 0},
                                            {layout::kChannelDepth, layout::kBindDepth, 1, 0},
                                            {layout::kChannelFacet, layout::kBindFacet, 0, 1},
                                            {layout::kChannelProxy, layout::kBindProxy, 3, 0},
                                            {layout::kChannelUnshaded, layout::kBindUnshaded, 3, 0}}};

// Neighbouring x samples an invocation evaluates; shaders/stores.glsl: ABREAST.
std::uint32_t abreast(FieldVariant variant) {
    return variant == FieldVariant::f32_packed ? 8 : 4;
}

// True if what depends on (x, y) alone differs from y to y; shaders/field.comp: ALONG_Z.
bool columns_vary_in_y(const layout::Features& features) {
    const auto varies = [](layout::uint map) { return map == layout::kMapGaussian || map == layout::kMapSamples; };
    return varies(features.map) || varies(features.texture);
}

// Invocations that fill a device: on software some vectors for every thread, so that they finish together.
std::uint32_t filling_invocations(const DeviceReport& report) {
    return report.software ? 256 * std::max(1u, std::thread::hardware_concurrency()) : 65536;
}

// Timestamps of one chunk: before the kernel, after it, after the copy.
constexpr std::uint32_t kTimestamps = 3;

// One dispatch in flight: results, their way to the host, and the words the kernel raises.
struct Slot {
    std::array<Buffer, kChannels.size()> results;
    std::array<Buffer, kChannels.size()> staging; // unused where the host shares the results' memory
    Buffer status;
    vk::raii::DescriptorSet set{nullptr};
    vk::raii::CommandBuffer commands{nullptr};
    vk::raii::Fence fence{nullptr};
    vk::raii::QueryPool timestamps{nullptr};
    Clock::time_point submitted;
    layout::ChunkParams chunk{};
    bool in_flight = false;
};

} // namespace

struct FieldKernel::Implementation {
    Device::Implementation& device;
    FieldKernelOptions options;
    FieldPipelines pipelines;
    bool staged;
    Buffer nothing; // bound where a kernel uses no buffer
    std::array<Buffer, layout::kBindStatus> inputs;
    vk::raii::DescriptorPool sets{nullptr};
    std::array<Slot, 2> slots; // one is computed while the other is consumed

    Implementation(Device& from, const FieldKernelOptions& wanted)
        : device(from.implementation()), options(wanted), pipelines(device),
          staged(wanted.force_staging || !shares_memory_with_host(device)) {
        checked("preparing the field kernel", [&] { prepare(); });
    }

    void prepare() {
        const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer,
                                          layout::kBindCount * static_cast<std::uint32_t>(slots.size()));
        sets = device.device.createDescriptorPool(
            {vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, static_cast<std::uint32_t>(slots.size()), size});
        nothing = make_buffer(device, 16, vk::BufferUsageFlagBits::eStorageBuffer, Placement::device);
        for (Slot& slot : slots) {
            slot.status = make_buffer(device, sizeof(std::uint32_t), vk::BufferUsageFlagBits::eStorageBuffer,
                                      Placement::host_read);
            slot.set = std::move(device.device.allocateDescriptorSets({*sets, *pipelines.set_layout()}).front());
            slot.commands = std::move(
                device.device.allocateCommandBuffers({*device.command_pool, vk::CommandBufferLevel::ePrimary, 1})
                    .front());
            slot.fence = device.device.createFence({});
            if (device.timestamp_bits)
                slot.timestamps = device.device.createQueryPool({{}, vk::QueryType::eTimestamp, kTimestamps});
        }
    }

    // A buffer that holds at least `bytes`, kept from field to field. True if it is a new one.
    bool grow(Buffer& buffer, std::size_t bytes, vk::BufferUsageFlags usage, Placement placement) {
        if (buffer.size >= bytes)
            return false;
        buffer = Buffer{};
        buffer = make_buffer(device, bytes, usage, placement);
        return true;
    }

    void run_once(const std::function<void(const vk::raii::CommandBuffer&)>& record) {
        Slot& slot = slots[0];
        slot.commands.reset();
        slot.commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        record(slot.commands);
        slot.commands.end();
        device.device.resetFences(*slot.fence);
        device.queue.submit(vk::SubmitInfo({}, {}, *slot.commands), *slot.fence);
        wait(slot);
    }

    void wait(Slot& slot) {
        if (device.device.waitForFences(*slot.fence, true, UINT64_MAX) != vk::Result::eSuccess)
            throw DeviceError(DeviceError::Kind::device_lost, "the device did not finish a dispatch");
    }

    void upload(layout::uint binding, std::span<const std::byte> bytes) {
        using Usage = vk::BufferUsageFlagBits;
        if (bytes.empty())
            return;
        if (bytes.size() > device.limits.maxStorageBufferRange)
            throw DeviceError(DeviceError::Kind::out_of_memory,
                              fmt::format("a table of the scene takes {} bytes and a buffer of this device spans {}: "
                                          "fewer facets, a smaller height map or a smaller grid would fit",
                                          bytes.size(), device.limits.maxStorageBufferRange));
        Buffer staging = make_buffer(device, bytes.size(), Usage::eTransferSrc, Placement::host_upload);
        std::memcpy(staging.mapped, bytes.data(), bytes.size());
        if (!staging.coherent)
            device.device.flushMappedMemoryRanges(vk::MappedMemoryRange(*staging.memory, 0, VK_WHOLE_SIZE));
        grow(inputs[binding], bytes.size(), Usage::eStorageBuffer | Usage::eTransferDst, Placement::device);
        run_once([&](const vk::raii::CommandBuffer& commands) {
            commands.copyBuffer(*staging.buffer, *inputs[binding].buffer, vk::BufferCopy(0, 0, bytes.size()));
            const vk::MemoryBarrier written(vk::AccessFlagBits::eTransferWrite, vk::AccessFlagBits::eShaderRead);
            commands.pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eComputeShader,
                                     {}, written, {}, {});
        });
    }

    template <typename T> void upload_tables(const layout::FieldInput<T>& input) {
        // Rows are padded to whole invocations; the padding repeats the last sample.
        std::vector<T> axes(input.x.begin(), input.x.end());
        const std::size_t block = abreast(variant_of(sizeof(T)));
        axes.resize((axes.size() + block - 1) / block * block, input.x.back());
        axes.insert(axes.end(), input.y.begin(), input.y.end());
        axes.insert(axes.end(), input.z.begin(), input.z.end());
        upload(layout::kBindLaw, std::as_bytes(std::span(&input.law.params, 1)));
        upload(layout::kBindAxes, std::as_bytes(std::span<const T>(axes)));
        upload(layout::kBindFacetVertices, std::as_bytes(input.law.facet_vertices));
        upload(layout::kBindMapGradients, std::as_bytes(input.law.map_gradients));
        upload(layout::kBindTextureGradients, std::as_bytes(input.law.texture_gradients));
    }

    void prepare_results(layout::uint channels, std::size_t samples, std::size_t real_size) {
        using Usage = vk::BufferUsageFlagBits;
        for (Slot& slot : slots) {
            for (std::size_t c = 0; c < kChannels.size(); ++c) {
                if (!(channels & kChannels[c].bit))
                    continue;
                const std::size_t bytes =
                    samples * (kChannels[c].reals * real_size + kChannels[c].uints * sizeof(layout::uint));
                const Placement placement = staged ? Placement::device : Placement::host_read;
                grow(slot.results[c], bytes, Usage::eStorageBuffer | Usage::eTransferSrc, placement);
                if (staged)
                    grow(slot.staging[c], bytes, Usage::eTransferDst, Placement::host_read);
            }
            write_set(slot, channels);
        }
    }

    void write_set(Slot& slot, layout::uint channels) {
        std::array<vk::DescriptorBufferInfo, layout::kBindCount> infos;
        infos.fill({*nothing.buffer, 0, VK_WHOLE_SIZE});
        for (std::size_t binding = 0; binding < inputs.size(); ++binding)
            if (inputs[binding].size)
                infos[binding].buffer = *inputs[binding].buffer;
        infos[layout::kBindStatus].buffer = *slot.status.buffer;
        for (std::size_t c = 0; c < kChannels.size(); ++c)
            if (channels & kChannels[c].bit)
                infos[kChannels[c].binding].buffer = *slot.results[c].buffer;
        // A buffer kept from a larger field may exceed what one binding may span.
        for (vk::DescriptorBufferInfo& info : infos)
            info.range = VK_WHOLE_SIZE;
        const vk::WriteDescriptorSet write(*slot.set, 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos);
        device.device.updateDescriptorSets(write, {});
    }

    FieldVariant variant_of(std::size_t real_size) const {
        if (real_size == sizeof(double))
            return FieldVariant::f64;
        return options.packed_stores && device.report.int64 ? FieldVariant::f32_packed : FieldVariant::f32;
    }

    PlanLimits limits(std::size_t chunk_bytes, const layout::Features& features, FieldVariant variant) const {
        PlanLimits plan;
        plan.buffer_range = device.limits.maxStorageBufferRange;
        plan.chunk_bytes = chunk_bytes;
        plan.group_invocations =
            std::min(device.limits.maxComputeWorkGroupInvocations, device.limits.maxComputeWorkGroupSize[0]);
        plan.group_count = device.limits.maxComputeWorkGroupCount[0];
        plan.abreast = abreast(variant);
        plan.rows = options.rows;
        plan.invocations = filling_invocations(device.report);
        plan.along_z = columns_vary_in_y(features);
        return plan;
    }

    void record(Slot& slot, vk::Pipeline pipeline, const FieldPlan& plan, layout::uint channels, std::size_t real_size);
    void submit(Slot& slot);
    template <typename T>
    void drain(Slot& slot, std::size_t x_count, layout::uint channels, FieldTimes& times,
               const std::function<void(const layout::FieldChunk<T>&)>& consume);
    void add_times(Slot& slot, FieldTimes& times);
    template <typename T> FieldPlan reserve(const layout::FieldInput<T>& input);
};

void FieldKernel::Implementation::record(Slot& slot, vk::Pipeline pipeline, const FieldPlan& plan,
                                         layout::uint channels, std::size_t real_size) {
    using Stage = vk::PipelineStageFlagBits;
    const vk::raii::CommandBuffer& commands = slot.commands;
    const auto stamp = [&](std::uint32_t query) {
        if (device.timestamp_bits)
            commands.writeTimestamp(Stage::eBottomOfPipe, *slot.timestamps, query);
    };
    commands.reset();
    commands.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    if (device.timestamp_bits)
        commands.resetQueryPool(*slot.timestamps, 0, kTimestamps);
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, pipeline);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipelines.layout(), 0, *slot.set, {});
    commands.pushConstants<layout::ChunkParams>(*pipelines.layout(), vk::ShaderStageFlagBits::eCompute, 0, slot.chunk);
    stamp(0);
    commands.dispatch(plan.groups(slot.chunk.y_count, slot.chunk.z_count), 1, 1);
    stamp(1);
    if (staged) {
        const vk::MemoryBarrier computed(vk::AccessFlagBits::eShaderWrite, vk::AccessFlagBits::eTransferRead);
        commands.pipelineBarrier(Stage::eComputeShader, Stage::eTransfer, {}, computed, {}, {});
        const std::size_t samples = std::size_t(slot.chunk.y_count) * slot.chunk.z_count * slot.chunk.x_pitch;
        for (std::size_t c = 0; c < kChannels.size(); ++c)
            if (channels & kChannels[c].bit)
                commands.copyBuffer(
                    *slot.results[c].buffer, *slot.staging[c].buffer,
                    vk::BufferCopy(
                        0, 0, samples * (kChannels[c].reals * real_size + kChannels[c].uints * sizeof(layout::uint))));
    }
    const vk::MemoryBarrier to_host(vk::AccessFlagBits::eShaderWrite | vk::AccessFlagBits::eTransferWrite,
                                    vk::AccessFlagBits::eHostRead);
    commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eHost, {}, to_host, {}, {});
    stamp(2);
    commands.end();
}

void FieldKernel::Implementation::submit(Slot& slot) {
    std::memset(slot.status.mapped, 0, sizeof(std::uint32_t));
    if (!slot.status.coherent)
        device.device.flushMappedMemoryRanges(vk::MappedMemoryRange(*slot.status.memory, 0, VK_WHOLE_SIZE));
    device.device.resetFences(*slot.fence);
    slot.submitted = Clock::now();
    device.queue.submit(vk::SubmitInfo({}, {}, *slot.commands), *slot.fence);
    slot.in_flight = true;
}

void FieldKernel::Implementation::add_times(Slot& slot, FieldTimes& times) {
    ++times.dispatches;
    if (!device.timestamp_bits) {
        times.kernel += seconds_since(slot.submitted);
        return;
    }
    const auto [result, stamps] = slot.timestamps.getResults<std::uint64_t>(
        0, kTimestamps, kTimestamps * sizeof(std::uint64_t), sizeof(std::uint64_t),
        vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess)
        return;
    const std::uint64_t mask = device.timestamp_bits >= 64 ? ~0ull : (1ull << device.timestamp_bits) - 1;
    const double tick = 1e-9 * static_cast<double>(device.limits.timestampPeriod);
    times.kernel += tick * static_cast<double>((stamps[1] - stamps[0]) & mask);
    if (staged)
        times.read_back += tick * static_cast<double>((stamps[2] - stamps[1]) & mask);
}

template <typename T>
void FieldKernel::Implementation::drain(Slot& slot, std::size_t x_count, layout::uint channels, FieldTimes& times,
                                        const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    if (!slot.in_flight)
        return;
    wait(slot);
    slot.in_flight = false;
    add_times(slot, times);
    const auto visible = [&](const Buffer& buffer) {
        if (!buffer.coherent)
            device.device.invalidateMappedMemoryRanges(vk::MappedMemoryRange(*buffer.memory, 0, VK_WHOLE_SIZE));
        return buffer.mapped;
    };
    std::uint32_t status = 0;
    std::memcpy(&status, visible(slot.status), sizeof(status));
    if (status & layout::kStatusUnfinished)
        throw DeviceError(DeviceError::Kind::unfinished,
                          "the device's driver ended a loop of the kernel before its work was done; nothing of this "
                          "field can be trusted");
    const layout::ChunkParams& part = slot.chunk;
    const std::size_t samples = std::size_t(part.y_count) * part.z_count * part.x_pitch;
    const auto reals = [&](std::size_t c) {
        if (!(channels & kChannels[c].bit))
            return std::span<const T>();
        return std::span(reinterpret_cast<const T*>(visible((staged ? slot.staging : slot.results)[c])),
                         samples * kChannels[c].reals);
    };
    layout::FieldChunk<T> chunk{x_count,  part.x_pitch, part.y_first, part.y_count, part.z_first, part.z_count,
                                reals(0), reals(1),     {},           reals(3),     reals(4)};
    if (channels & layout::kChannelFacet)
        chunk.facet = std::span(
            reinterpret_cast<const layout::uint*>(visible((staged ? slot.staging : slot.results)[2])), samples);
    consume(chunk);
}

// Buffers for the results, smaller ones while the device is short of memory.
template <typename T> FieldPlan FieldKernel::Implementation::reserve(const layout::FieldInput<T>& input) {
    const layout::uint channels = input.law.features.channels;
    const SampleBytes sample = bytes_per_sample(channels, sizeof(T));
    const FieldVariant variant = variant_of(sizeof(T));
    // Rows of one y lie far apart: there a chunk gains more from columns that serve for many of them.
    const bool cached = device.report.software && !columns_vary_in_y(input.law.features);
    const std::size_t wanted =
        cached ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes;
    // 1 GiB keeps every index of the kernel within 32 bits.
    std::size_t chunk_bytes = std::min<std::size_t>(wanted, std::size_t(1) << 30);
    const std::size_t row = (input.x.size() + abreast(variant)) * sample.all;
    for (chunk_bytes = std::max(chunk_bytes, row);; chunk_bytes /= 2) {
        const FieldPlan plan = plan_field(input.x.size(), input.y.size(), input.z.size(), sample,
                                          limits(chunk_bytes, input.law.features, variant));
        try {
            prepare_results(channels, std::size_t(plan.x_pitch) * plan.y_step * plan.z_step, sizeof(T));
            return plan;
        } catch (const DeviceError& error) {
            if (error.kind() != DeviceError::Kind::out_of_memory || chunk_bytes / 2 < row)
                throw;
        }
    }
}

FieldKernel::FieldKernel(Device& device, const FieldKernelOptions& options)
    : implementation_(std::make_unique<Implementation>(device, options)) {}

FieldKernel::~FieldKernel() = default;

template <typename T>
FieldTimes FieldKernel::evaluate(const layout::FieldInput<T>& input,
                                 const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    Implementation& self = *implementation_;
    constexpr bool kDouble = std::is_same_v<T, double>;
    if (kDouble && !self.device.report.f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          self.device.report.name + " has no double precision in kernels: use --precision f32");
    FieldTimes times;
    return checked("evaluating a field", [&] {
        auto start = Clock::now();
        self.upload_tables(input);
        const FieldPlan plan = self.reserve(input);
        times.upload = seconds_since(start);
        start = Clock::now();
        const vk::Pipeline pipeline = self.pipelines.get({self.variant_of(sizeof(T)), plan.group, input.law.features});
        times.compile = seconds_since(start);
        const std::size_t ny = input.y.size(), nz = input.z.size();
        const layout::uint channels = input.law.features.channels;
        std::size_t turn = 0;
        try {
            for (std::size_t z = 0; z < nz; z += plan.z_step)
                for (std::size_t y = 0; y < ny; y += plan.y_step, ++turn) {
                    Slot& slot = self.slots[turn % self.slots.size()];
                    self.drain(slot, input.x.size(), channels, times, consume);
                    slot.chunk = {plan.x_pitch,
                                  static_cast<layout::uint>(y),
                                  static_cast<layout::uint>(std::min<std::size_t>(plan.y_step, ny - y)),
                                  plan.x_pitch,
                                  static_cast<layout::uint>(z),
                                  static_cast<layout::uint>(std::min<std::size_t>(plan.z_step, nz - z)),
                                  static_cast<layout::uint>(plan.x_pitch + ny),
                                  plan.rows};
                    self.record(slot, pipeline, plan, channels, sizeof(T));
                    self.submit(slot);
                }
            for (std::size_t i = 0; i < self.slots.size(); ++i)
                self.drain(self.slots[(turn + i) % self.slots.size()], input.x.size(), channels, times, consume);
        } catch (...) {
            for (Slot& slot : self.slots)
                if (std::exchange(slot.in_flight, false))
                    self.wait(slot);
            throw;
        }
        return times;
    });
}

template FieldTimes FieldKernel::evaluate<float>(const layout::FieldInput<float>&,
                                                 const std::function<void(const layout::FieldChunk<float>&)>&);
template FieldTimes FieldKernel::evaluate<double>(const layout::FieldInput<double>&,
                                                  const std::function<void(const layout::FieldChunk<double>&)>&);

} // namespace forceshade::compute
