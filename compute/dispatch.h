// What all kernels share: pipelines, tables that dispatches read, and dispatches in flight, one of which is computed
// while the results of another are consumed. Independent of what is computed, and shows no Vulkan type.
#pragma once

#include <span>

#include "compute/groups.h"
#include "compute/kernels.h"
#include "compute/plan.h"
#include "host/clock.h"

namespace forceshade::compute {

using Bytes = std::span<const std::byte>;

template <typename Value> Bytes bytes_of(const Value& value) {
    return std::as_bytes(std::span(&value, 1));
}

/// Runs a call and turns Vulkan's exceptions into DeviceError with `doing` as context.
void run_checked(const std::string& doing, const std::function<void()>& call);

/// Whether kernels take quotients and roots through double precision: where the device's own of floats may be off.
template <typename T> bool takes_exact(const DeviceReport& report) {
    return sizeof(T) == sizeof(float) && !report.nearest && report.f64;
}

/// Of a kernel's three forms the one that computes in T on this device.
using Code = std::span<const std::uint32_t>;
template <typename T> Code code_for(const DeviceReport& report, Code f32, Code f32_exact, Code f64) {
    return sizeof(T) == sizeof(double) ? f64 : takes_exact<T>(report) ? f32_exact : f32;
}

/// Of poisoned memory behind results. \throws DeviceError (differs_in_parts) if something was written there.
void require_poison(Bytes behind);

struct DispatchShape {
    static constexpr layout::uint kNoStatus = 0xFFFFFFFFu;
    layout::uint bindings = 0;
    layout::uint status = kNoStatus; /* binding of the status word */
    std::uint32_t push_bytes = 0;    /* of push constants */
    std::uint32_t group = 64;        /* invocations of a work group, until others are found to be faster */
    std::uint32_t in_flight = 2;     /* most dispatches at once; one more where results are copied */
};

class Dispatcher {
public:
    static constexpr layout::uint kPoison = 0xFFFA5A5Au; /* as real, of both precisions, no number; no facet's id */
    static_assert((kPoison & 0x7FF80000u) == 0x7FF80000u && (kPoison & 0x0007FFFFu) != 0); /* NaN, quiet, of both */
    static constexpr std::size_t kPoisonBehind = 4096;                                     /* bytes behind results */

    /// `force_staging`: results are copied even where the host shares the memory.
    Dispatcher(Device& device, const DispatchShape& shape, bool force_staging);
    ~Dispatcher();

    const DeviceReport& report() const;

    /// The number of a pipeline, compiled if it was not yet. `code` is SPIR-V that outlives this; `constants` stand by
    /// their ids, from 0, but for the size of work groups; those that the code lacks are ignored.
    std::size_t pipeline(std::span<const std::uint32_t> code, std::span<const std::uint32_t> constants,
                         FieldTimes& times);

    /// Copies the tables that `tables` puts, which every dispatch reads; an empty one leaves what was there. No
    /// dispatch may be in flight. \throws DeviceError (out_of_memory) for a table beyond the device's range.
    void upload(FieldTimes& times, const std::function<void(const PutTable& put)>& tables);

    /// A buffer that every dispatch reads and writes; what it held is lost if it grows. The address of its first byte
    /// if `shared` with the host. \throws DeviceError (out_of_memory).
    std::byte* keep(layout::uint binding, std::size_t bytes, bool shared);
    /// What dispatches left in it; none may be in flight.
    const std::byte* kept(layout::uint binding);
    /// Makes what the host wrote to it visible to the device.
    void flush(layout::uint binding);

    /// Begins a dispatch: waits for the one whose buffers it takes, adds its times and hands over its results.
    /// \throws DeviceError (device_lost, unfinished).
    void begin(FieldTimes& times);
    /// Hands over the results of all dispatches, in their order.
    void finish(FieldTimes& times);
    /// Does `work` and finishes; where it throws, waits until the device is done with the buffers.
    void complete(FieldTimes& times, const std::function<void()>& work);

    /// Of the dispatch that was begun: copies a table that it alone reads.
    void put(layout::uint binding, Bytes table);
    /// Room for results. \throws DeviceError (out_of_memory).
    void expect(layout::uint binding, std::size_t bytes);
    /// The same for the results of `samples` samples; channels are bound one after the other, in the order of
    /// kChannels.
    void expect_channels(layout::uint force_binding, layout::uint channels, std::size_t samples, std::size_t real_size);
    /// Room in every dispatch, to come.
    void reserve_channels(layout::uint force_binding, layout::uint channels, std::size_t samples,
                          std::size_t real_size);
    /// Fills results with a word before anything runs.
    void fill(layout::uint binding, layout::uint word);
    /// Before the dispatches of a run. `poison`: fills all results with kPoison, but where `fill` says otherwise, and
    /// some room behind them: what a kernel writes there ends the run with DeviceError (differs_in_parts).
    void begin_run(bool poison);
    /// Of `wanted` bytes for the results of a dispatch as many as the free memory of the device has room for, where
    /// its driver says how much there is.
    std::size_t fitting(std::size_t wanted) const;
    /// Does `reserve`, and again while the device is short of memory for it and `lessen` finds less to reserve.
    /// \throws DeviceError (out_of_memory).
    void fit(const std::function<void()>& reserve, const std::function<bool()>& lessen);
    /// Invocations of the least work group that runs may have: a run is cut below report().group_count of them.
    std::uint32_t least_group() const;
    /// Of up to `most` units of work as many as the next dispatch is to take: all on software; hardware begins with
    /// few, and takes more while dispatches of this run end within a tenth of a second, since drivers end those of
    /// seconds.
    std::uint64_t paced(std::uint64_t most) const;

    struct Run {
        std::size_t pipeline;
        std::uint64_t invocations;
        Bytes push;
        bool after_copies = false; /* waits for tables that were put, and fills */
        bool after_runs = false;   /* waits for the runs before it, of any dispatch */
    };
    /// Ends it, with `work` units, most of them in the last run: `consume` is called when it is done, by `begin` or
    /// `finish`.
    void submit(std::span<const Run> runs, std::uint64_t work, const std::function<void()>& consume);

    /// The results of the dispatch that is being consumed; none where none were expected.
    template <typename Value> std::span<const Value> results(layout::uint binding) const {
        const Bytes bytes = result_bytes(binding);
        return {reinterpret_cast<const Value*>(bytes.data()), bytes.size() / sizeof(Value)};
    }
    /// The same for the channels that fields and paths have in common.
    template <typename T, typename Chunk> void put_results(layout::uint force_binding, Chunk& chunk) const {
        chunk.force = results<T>(force_binding);
        chunk.depth = results<T>(force_binding + 1);
        chunk.facet = results<layout::uint>(force_binding + 2);
        chunk.proxy = results<T>(force_binding + 3);
    }
    /// The results of a field's chunk.
    template <typename T, typename Params>
    layout::FieldChunk<T> field_chunk(layout::uint force_binding, std::size_t x_count, const Params& params) const {
        layout::FieldChunk<T> chunk{};
        chunk.x_count = x_count;
        chunk.x_pitch = params.x_pitch;
        chunk.y_first = params.y_first;
        chunk.y_count = params.y_count;
        chunk.z_first = params.z_first;
        chunk.z_count = params.z_count;
        put_results<T>(force_binding, chunk);
        chunk.unshaded = results<T>(force_binding + 4);
        return chunk;
    }

private:
    Bytes result_bytes(layout::uint binding) const;

    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Does a kernel's `work(times)`, which computes in T; `in_parts` as its options say. \throws DeviceError: also
/// unsupported if the device cannot compute in T.
template <typename T, typename Work>
FieldTimes run_kernel(Dispatcher& dispatcher, bool in_parts, const std::string& doing, const Work& work) {
    if (sizeof(T) == sizeof(double) && !dispatcher.report().f64)
        throw DeviceError(DeviceError::Kind::unsupported,
                          dispatcher.report().name + " has no double precision in kernels: use --precision f32");
    dispatcher.begin_run(in_parts);
    FieldTimes times;
    run_checked(doing, [&] { work(times); });
    return times;
}

} // namespace forceshade::compute
