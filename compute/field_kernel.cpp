#include "compute/field_kernel.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <type_traits>

#include "compute/field_inputs.h"
#include "compute/field_pipeline.h"
#include "compute/field_plan.h"
#include "compute/field_slot.h"

namespace forceshade::compute {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::uint32_t abreast(FieldVariant variant) {
    return variant == FieldVariant::f32_packed ? layout::kAbreastPacked : layout::kAbreast;
}

constexpr SlotBindings kBindings{
    layout::kBindCount,
    layout::kBindStatus,
    {layout::kBindForce, layout::kBindDepth, layout::kBindFacet, layout::kBindProxy, layout::kBindUnshaded}};

// True if what depends on (x, y) alone differs from y to y; shaders/field.comp: ALONG_Z.
bool columns_vary_in_y(const layout::Features& features) {
    const auto varies = [](layout::uint map) { return map == layout::kMapGaussian || map == layout::kMapSamples; };
    return varies(features.map) || varies(features.texture);
}

// Invocations that fill a device: on software some vectors for every thread, so that they finish together.
std::uint32_t filling_invocations(const DeviceReport& report) {
    return report.software ? 256 * std::max(1u, std::thread::hardware_concurrency()) : 65536;
}

} // namespace

struct FieldKernel::Implementation {
    static constexpr std::uint32_t kSlots = 2; // one is computed while the other is consumed

    Device::Implementation& device;
    FieldKernelOptions options;
    Pipelines pipelines;
    FieldInputs inputs;
    vk::raii::DescriptorPool sets{nullptr};
    std::vector<FieldSlot> slots;

    Implementation(Device::Implementation& on, const FieldKernelOptions& wanted)
        : device(on), options(wanted), pipelines(make_field_pipelines(on)), inputs(on) {
        const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, layout::kBindCount * kSlots);
        sets = device.device.createDescriptorPool({vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kSlots, size});
        const bool staged = options.force_staging || !shares_memory_with_host(device);
        for (std::uint32_t i = 0; i < kSlots; ++i)
            slots.emplace_back(
                device, kBindings,
                std::move(device.device.allocateDescriptorSets({*sets, *pipelines.set_layout()}).front()), staged);
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

    template <typename T> FieldPlan reserve(const layout::FieldInput<T>& input);
    template <typename T>
    void run(const layout::FieldInput<T>& input, const FieldPlan& plan, vk::Pipeline pipeline, FieldTimes& times,
             const std::function<void(const layout::FieldChunk<T>&)>& consume);
};

// Buffers for the results, smaller ones while the device is short of memory.
template <typename T> FieldPlan FieldKernel::Implementation::reserve(const layout::FieldInput<T>& input) {
    const layout::Features& features = input.law.features;
    const SampleBytes sample = bytes_per_sample(features.channels, sizeof(T));
    const FieldVariant variant = variant_of(sizeof(T));
    // Rows of one y lie far apart: there a chunk gains more from columns that serve for many of them.
    const bool cached = device.report.software && !columns_vary_in_y(features);
    const std::size_t wanted =
        cached ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes;
    // 1 GiB keeps every index of the kernel within 32 bits.
    std::size_t chunk_bytes = std::min<std::size_t>(wanted, std::size_t(1) << 30);
    const std::size_t row = (input.x.size() + abreast(variant)) * sample.all;
    for (chunk_bytes = std::max(chunk_bytes, row);; chunk_bytes /= 2) {
        const FieldPlan plan =
            plan_field(input.x.size(), input.y.size(), input.z.size(), sample, limits(chunk_bytes, features, variant));
        try {
            for (FieldSlot& slot : slots)
                slot.reserve(features.channels, std::size_t(plan.x_pitch) * plan.y_step * plan.z_step, sizeof(T),
                             [&](layout::uint binding) { return inputs.buffer(binding); });
            return plan;
        } catch (const DeviceError& error) {
            if (error.kind() != DeviceError::Kind::out_of_memory || chunk_bytes / 2 < row)
                throw;
        }
    }
}

template <typename T>
void FieldKernel::Implementation::run(const layout::FieldInput<T>& input, const FieldPlan& plan, vk::Pipeline pipeline,
                                      FieldTimes& times,
                                      const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    const auto ny = static_cast<layout::uint>(input.y.size()), nz = static_cast<layout::uint>(input.z.size());
    const auto hand_over = [&](FieldSlot& slot) {
        if (!slot.in_flight())
            return;
        slot.finish(times);
        consume(slot.results<T>(input.x.size()));
    };
    std::size_t turn = 0;
    for (layout::uint z = 0; z < nz; z += plan.z_step)
        for (layout::uint y = 0; y < ny; y += plan.y_step, ++turn) {
            FieldSlot& slot = slots[turn % kSlots];
            hand_over(slot);
            layout::ChunkParams chunk{};
            chunk.x_pitch = plan.x_pitch;
            chunk.y_first = y;
            chunk.y_count = std::min(plan.y_step, ny - y);
            chunk.y_axis = plan.x_pitch;
            chunk.z_first = z;
            chunk.z_count = std::min(plan.z_step, nz - z);
            chunk.z_axis = plan.x_pitch + ny;
            chunk.rows = plan.rows;
            slot.submit({chunk.x_pitch, chunk.y_first, chunk.y_count, chunk.z_first, chunk.z_count},
                        [&](const vk::raii::CommandBuffer& commands) {
                            commands.bindPipeline(vk::PipelineBindPoint::eCompute, pipeline);
                            commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipelines.layout(), 0,
                                                        slot.set(), {});
                            commands.pushConstants<layout::ChunkParams>(*pipelines.layout(),
                                                                        vk::ShaderStageFlagBits::eCompute, 0, chunk);
                            commands.dispatch(plan.groups(chunk.y_count, chunk.z_count), 1, 1);
                        });
        }
    for (std::size_t i = 0; i < kSlots; ++i)
        hand_over(slots[(turn + i) % kSlots]);
}

FieldKernel::FieldKernel(Device& device, const FieldKernelOptions& options)
    : implementation_(checked("preparing the field kernel",
                              [&] { return std::make_unique<Implementation>(device.implementation(), options); })) {}

FieldKernel::~FieldKernel() = default;

template <typename T>
FieldTimes FieldKernel::evaluate(const layout::FieldInput<T>& input,
                                 const std::function<void(const layout::FieldChunk<T>&)>& consume) {
    Implementation& self = *implementation_;
    if (std::is_same_v<T, double> && !self.device.report.f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          self.device.report.name + " has no double precision in kernels: use --precision f32");
    FieldTimes times;
    return checked("evaluating a field", [&] {
        const FieldVariant variant = self.variant_of(sizeof(T));
        auto start = Clock::now();
        const std::uint64_t before = self.inputs.uploaded();
        self.inputs.upload(input, abreast(variant));
        times.uploaded = self.inputs.uploaded() - before;
        const FieldPlan plan = self.reserve(input);
        times.upload = seconds_since(start);
        start = Clock::now();
        const vk::Pipeline pipeline = field_pipeline(self.pipelines, {variant, plan.group, input.law.features});
        times.compile = seconds_since(start);
        try {
            self.run(input, plan, pipeline, times, consume);
        } catch (...) {
            // The device must be done with the buffers before anybody uses them again.
            FieldTimes ignored;
            for (FieldSlot& slot : self.slots)
                try {
                    slot.finish(ignored);
                } catch (const DeviceError&) {
                    // The error under way says more.
                }
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
