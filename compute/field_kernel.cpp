#include <algorithm>

#include "compute/dispatch.h"
#include "compute/inputs.h"
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

// A field on its way through the device.
template <typename T> struct FieldRun {
    Dispatcher& dispatcher;
    const FieldKernelOptions& options;
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
    limits.group_invocations = report.group_invocations;
    limits.group_count = report.group_count;
    limits.lanes = lanes();
    limits.rows = options.rows;
    limits.invocations = filling_invocations(report);
    limits.along_z = columns_vary_in_y(features);
    // Rows of one y lie far apart: there a chunk gains more from columns that serve for many of them.
    const bool cached = report.software && !limits.along_z;
    const std::size_t wanted =
        cached ? std::min(options.chunk_bytes, options.software_chunk_bytes) : options.chunk_bytes;
    const std::size_t row = (input.x.size() + limits.lanes) * sample.all;
    // 1 GiB keeps every index of the kernel within 32 bits.
    limits.chunk_bytes = std::max(std::min<std::size_t>(wanted, std::size_t(1) << 30), row);
    if (options.in_parts) {
        limits.chunk_bytes = std::clamp(row * part_of(input.y.size()), row, limits.chunk_bytes);
        limits.rows = 3;
    }
    for (;; limits.chunk_bytes /= 2) {
        const FieldPlan plan = plan_field(input.x.size(), input.y.size(), input.z.size(), sample, limits);
        try {
            dispatcher.reserve_channels(layout::kBindForce, features.channels,
                                        std::size_t(plan.x_pitch) * plan.y_step * plan.z_step, sizeof(T));
            return plan;
        } catch (const DeviceError& error) {
            if (error.kind() != DeviceError::Kind::out_of_memory || limits.chunk_bytes / 2 < row)
                throw;
        }
    }
}

template <typename T>
void FieldRun<T>::run(const FieldPlan& plan, std::size_t pipeline, FieldTimes& times, const TakeField<T>& take) const {
    const auto ny = static_cast<uint>(input.y.size()), nz = static_cast<uint>(input.z.size());
    for (uint z = 0; z < nz; z += plan.z_step)
        for (uint y = 0; y < ny; y += plan.y_step) {
            dispatcher.begin(times);
            layout::ChunkParams chunk{};
            chunk.x_pitch = plan.x_pitch;
            chunk.y_first = y;
            chunk.y_count = std::min(plan.y_step, ny - y);
            chunk.y_axis = plan.x_pitch;
            chunk.z_first = z;
            chunk.z_count = std::min(plan.z_step, nz - z);
            chunk.z_axis = plan.x_pitch + ny;
            chunk.rows = plan.rows;
            dispatcher.expect_channels(layout::kBindForce, input.law.features.channels,
                                       std::size_t(plan.x_pitch) * chunk.y_count * chunk.z_count, sizeof(T));
            const Dispatcher::Run run{pipeline, plan.groups(chunk.y_count, chunk.z_count), bytes_of(chunk)};
            dispatcher.submit({&run, 1}, [this, chunk, &take] {
                take(dispatcher.field_chunk<T>(layout::kBindForce, input.x.size(), chunk));
            });
        }
}

} // namespace

FieldKernel::FieldKernel(Device& device, const FieldKernelOptions& options)
    : dispatcher_(new Dispatcher(
          device, {layout::kBindCount, layout::kBindStatus, sizeof(layout::ChunkParams), 2, options.force_staging})),
      options_(options) {}

FieldKernel::~FieldKernel() = default;

template <typename T> FieldTimes FieldKernel::evaluate(const layout::FieldInput<T>& input, const TakeField<T>& take) {
    Dispatcher& dispatcher = *dispatcher_;
    check_precision<T>(dispatcher.report());
    dispatcher.poison(options_.in_parts);
    FieldTimes times;
    run_checked("evaluating a field", [&] {
        const FieldRun<T> field{dispatcher, options_, input};
        FieldPlan plan;
        dispatcher.upload(times, [&](const PutTable& put) {
            put_field_tables(input, field.lanes(), put);
            plan = field.reserve();
        });
        const std::size_t pipeline =
            dispatcher.pipeline(field.code(), constants_of(plan.group, input.law.features), times);
        dispatcher.complete(times, [&] { field.run(plan, pipeline, times, take); });
    });
    return times;
}

template FieldTimes FieldKernel::evaluate<float>(const layout::FieldInput<float>&, const TakeField<float>&);
template FieldTimes FieldKernel::evaluate<double>(const layout::FieldInput<double>&, const TakeField<double>&);

} // namespace forceshade::compute
