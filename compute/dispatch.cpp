#include "compute/dispatch.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "compute/vulkan.h"

namespace forceshade::compute {
namespace {

using layout::uint;
using Stage = vk::PipelineStageFlagBits;
using Access = vk::AccessFlagBits;
using Usage = vk::BufferUsageFlagBits;

// Timestamps of a dispatch: before its runs, after them, after the copy.
constexpr std::uint32_t kTimestamps = 3;

// Drivers of hardware end dispatches after some seconds, 2 on some.
constexpr double kAim = 0.1;       // s: that a dispatch is to take
constexpr double kMostGrowth = 4;  // from dispatch to dispatch
constexpr double kFirstShare = 64; // of the most: what the first one is not larger than

void drop(Buffer& buffer) {
    buffer.buffer = vk::raii::Buffer{nullptr}; // before its memory
    buffer = Buffer{};
}

// Makes `buffer` hold at least `bytes`; what it held is lost if it grows.
void grow(Device::Implementation& device, Buffer& buffer, std::size_t bytes, vk::BufferUsageFlags usage,
          Placement placement) {
    if (buffer.size >= bytes)
        return;
    drop(buffer); // before the new one, so that both need not fit
    buffer = make_buffer(device, bytes, usage, placement);
}

void barrier(const vk::raii::CommandBuffer& commands, vk::PipelineStageFlags before, vk::AccessFlags written,
             vk::PipelineStageFlags after, vk::AccessFlags read) {
    commands.pipelineBarrier(before, after, {}, vk::MemoryBarrier(written, read), {}, {});
}

// What a dispatch binds of its own: a table (copied from `host`) or results (copied to it); without staging the host
// sees `device` itself.
struct OwnBuffer {
    Buffer device, host;
    std::size_t bytes = 0;  // used
    std::size_t behind = 0; // bytes that stay poisoned
    bool is_table = false;
    std::optional<uint> filled;
};

struct InFlight {
    Commands commands;
    vk::raii::DescriptorSet set;
    vk::raii::QueryPool timestamps{nullptr};
    Buffer status{};
    std::vector<OwnBuffer> buffers{}; // by binding
    Clock::time_point submitted{};
    std::uint64_t work = 0;   // units
    std::uint64_t kernel = 0; // hash of the last run's, and its work group
    std::uint32_t group = 0;
    std::function<void()> consume{};
    bool pending = false;
};

struct SharedBuffer {
    Buffer device, host; // `host` only where the host does not see `device`
};

// A kernel as it is specialised, in the sizes of work groups that were asked for so far.
struct Pipeline {
    Code code;
    std::vector<std::uint32_t> constants;
    std::uint64_t hash; // of both
    std::map<std::uint32_t, vk::raii::Pipeline> by_group{};
};

// FNV-1a, by words.
std::uint64_t hash_of(Code words, std::uint64_t hash = 0xCBF29CE484222325u) {
    for (const std::uint32_t word : words)
        hash = (hash ^ word) * 0x100000001B3u;
    return hash;
}

} // namespace

struct Dispatcher::Implementation {
    Device::Implementation& device;
    DispatchShape shape;
    bool staged; // results are copied to memory of the host's, else the kernel writes there itself
    vk::raii::DescriptorSetLayout set_layout{nullptr};
    vk::raii::PipelineLayout layout{nullptr};
    std::vector<Pipeline> pipelines;
    Commands transfers;
    Buffer unused; // bound where a kernel uses no buffer
    std::vector<SharedBuffer> shared;
    vk::raii::DescriptorPool sets{nullptr};
    std::vector<InFlight> slots;
    std::size_t turn = 0; // the slot at hand is turn % slots
    double compiled = 0;  // s, not yet in anybody's times
    bool poisoned = false;
    double pace = 0; // units of work that a dispatch may take; 0: not known

    Implementation(Device::Implementation& on, const DispatchShape& wanted, bool force_staging)
        : device(on), shape(wanted),
          staged(force_staging || on.taken.memory != 0 || !(on.report.software || on.report.type == "integrated")),
          transfers(on), unused(make_buffer(on, 16, Usage::eStorageBuffer, Placement::device)),
          shared(wanted.bindings) {
        std::vector<vk::DescriptorSetLayoutBinding> bindings;
        for (uint binding = 0; binding < shape.bindings; ++binding)
            bindings.emplace_back(binding, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
        set_layout = on.device.createDescriptorSetLayout({{}, bindings});
        const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0, shape.push_bytes);
        layout = on.device.createPipelineLayout({{}, *set_layout, push});
        // One is computed, one copied, and one consumed.
        if (staged && shape.in_flight > 1)
            ++shape.in_flight;
        const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, shape.bindings * shape.in_flight);
        sets = on.device.createDescriptorPool(
            {vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, shape.in_flight, size});
        for (std::uint32_t i = 0; i < shape.in_flight; ++i) {
            slots.push_back({Commands(on), std::move(on.device.allocateDescriptorSets({*sets, *set_layout}).front())});
            slots.back().buffers.resize(shape.bindings);
            slots.back().status = make_buffer(on, sizeof(uint), Usage::eStorageBuffer, Placement::host_read);
            if (on.timestamp_bits)
                slots.back().timestamps = on.device.createQueryPool({{}, vk::QueryType::eTimestamp, kTimestamps});
        }
    }

    // Compiles it, if it was not yet.
    vk::Pipeline compile(Pipeline& kernel, std::uint32_t group);

    // Those of dispatches that are not in flight.
    void drop_buffers() {
        for (InFlight& slot : slots)
            if (!slot.pending)
                for (OwnBuffer& own : slot.buffers) {
                    drop(own.device);
                    drop(own.host);
                    own = OwnBuffer{};
                }
    }

    InFlight& slot() { return slots[turn % slots.size()]; }

    void reserve(OwnBuffer& own, std::size_t bytes) {
        grow(device, own.device, bytes, Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst,
             staged ? Placement::device : Placement::host_read);
        if (staged)
            grow(device, own.host, bytes, Usage::eTransferDst, Placement::host_read);
    }

    vk::Buffer buffer_of(const InFlight& slot, uint binding) const {
        if (binding == shape.status)
            return *slot.status.buffer;
        if (slot.buffers[binding].bytes != 0)
            return *slot.buffers[binding].device.buffer;
        return shared[binding].device.size != 0 ? *shared[binding].device.buffer : *unused.buffer;
    }

    void bind(const InFlight& slot) {
        std::vector<vk::DescriptorBufferInfo> infos;
        for (uint binding = 0; binding < shape.bindings; ++binding)
            infos.emplace_back(buffer_of(slot, binding), 0, VK_WHOLE_SIZE);
        device.device.updateDescriptorSets(
            vk::WriteDescriptorSet(*slot.set, 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos), {});
    }

    void upload(uint binding, Bytes table);
    void record(const InFlight& slot, std::span<const Run> runs, const vk::raii::CommandBuffer& commands);
    double add_times(const InFlight& slot, FieldTimes& times);
    void finish(InFlight& slot, FieldTimes& times);
};

void Dispatcher::Implementation::upload(uint binding, Bytes table) {
    if (table.empty())
        return;
    if (table.size() > device.report.buffer_range)
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("a table of the scene takes {} bytes and a buffer of this device spans {}: fewer "
                                      "facets, a smaller height map or a smaller grid would fit",
                                      table.size(), device.report.buffer_range));
    const Buffer staging = make_buffer(device, table.size(), Usage::eTransferSrc, Placement::host_upload);
    std::memcpy(staging.mapped, table.data(), table.size());
    flush_to_device(device, staging);
    Buffer& buffer = shared[binding].device;
    grow(device, buffer, table.size(), Usage::eStorageBuffer | Usage::eTransferDst, Placement::device);
    transfers.record([&](const vk::raii::CommandBuffer& commands) {
        commands.copyBuffer(*staging.buffer, *buffer.buffer, vk::BufferCopy(0, 0, table.size()));
        barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eComputeShader, Access::eShaderRead);
    });
    transfers.submit();
    transfers.wait();
}

vk::Pipeline Dispatcher::Implementation::compile(Pipeline& kernel, std::uint32_t group) {
    if (const auto found = kernel.by_group.find(group); found != kernel.by_group.end())
        return *found->second;
    const Clock::time_point start = Clock::now();
    kernel.constants[layout::kSpecLocalX] = group;
    return checked("compiling a kernel", [&] {
        const std::vector<std::uint32_t> code =
            with_float_controls(kernel.code, device.report.single, device.report.twice);
        const vk::raii::ShaderModule module(device.device, {{}, code.size() * sizeof(std::uint32_t), code.data()});
        std::vector<vk::SpecializationMapEntry> entries;
        for (std::uint32_t id = 0; id < kernel.constants.size(); ++id)
            entries.emplace_back(id, id * std::uint32_t(sizeof(std::uint32_t)), sizeof(std::uint32_t));
        const vk::SpecializationInfo info(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                          kernel.constants.size() * sizeof(std::uint32_t), kernel.constants.data());
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main", &info);
        const auto [compiled_one, made] = kernel.by_group.emplace(
            group, device.device.createComputePipeline(device.pipeline_cache, {{}, stage, *layout}));
        compiled += seconds_since(start);
        return *compiled_one->second;
    });
}

void Dispatcher::Implementation::record(const InFlight& slot, std::span<const Run> runs,
                                        const vk::raii::CommandBuffer& commands) {
    const auto stamp = [&](std::uint32_t query) {
        if (device.timestamp_bits)
            commands.writeTimestamp(Stage::eBottomOfPipe, *slot.timestamps, query);
    };
    const auto copy = [&](const Buffer& from, const Buffer& to, std::size_t bytes) {
        commands.copyBuffer(*from.buffer, *to.buffer, vk::BufferCopy(0, 0, bytes));
    };
    if (device.timestamp_bits)
        commands.resetQueryPool(*slot.timestamps, 0, kTimestamps);
    stamp(0);
    for (const OwnBuffer& own : slot.buffers) {
        if (own.is_table && staged && own.bytes != 0)
            copy(own.host, own.device, own.bytes);
        if (own.filled)
            commands.fillBuffer(*own.device.buffer, 0, own.bytes, *own.filled);
        if (own.behind != 0)
            commands.fillBuffer(*own.device.buffer, own.bytes, own.behind, kPoison);
    }
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout, 0, *slot.set, {});
    for (const Run& run : runs) {
        vk::PipelineStageFlags before;
        vk::AccessFlags written;
        if (run.after_copies || poisoned) {
            before |= Stage::eTransfer;
            written |= Access::eTransferWrite;
        }
        if (run.after_runs) {
            before |= Stage::eComputeShader;
            written |= Access::eShaderWrite;
        }
        if (before)
            barrier(commands, before, written, Stage::eComputeShader, Access::eShaderRead | Access::eShaderWrite);
        const bool is_last = &run == &runs.back();
        Pipeline& kernel = pipelines[run.pipeline];
        const std::uint32_t group = is_last ? slot.group : device.groups.usual(kernel.hash, shape.group);
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, compile(kernel, group));
        commands.pushConstants<std::byte>(*layout, vk::ShaderStageFlagBits::eCompute, 0,
                                          vk::ArrayProxy(static_cast<std::uint32_t>(run.push.size()), run.push.data()));
        commands.dispatch(static_cast<std::uint32_t>(divide_up(run.invocations, group)), 1, 1);
    }
    stamp(1);
    const vk::PipelineStageFlags worked = Stage::eComputeShader | Stage::eTransfer;
    const vk::AccessFlags written = Access::eShaderWrite | Access::eTransferWrite;
    if (staged) {
        barrier(commands, worked, written, Stage::eTransfer, Access::eTransferRead);
        for (const OwnBuffer& own : slot.buffers)
            if (!own.is_table && own.bytes != 0)
                copy(own.device, own.host, own.bytes + own.behind);
    }
    barrier(commands, worked, written, Stage::eHost, Access::eHostRead);
    stamp(2);
}

// Returns those of the runs alone, s.
double Dispatcher::Implementation::add_times(const InFlight& slot, FieldTimes& times) {
    ++times.dispatches;
    if (!device.timestamp_bits) {
        const double since = seconds_since(slot.submitted);
        times.kernel += since;
        return since;
    }
    const auto [result, stamps] = slot.timestamps.getResults<std::uint64_t>(
        0, kTimestamps, kTimestamps * sizeof(std::uint64_t), sizeof(std::uint64_t),
        vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess)
        return 0;
    const std::uint64_t mask = device.timestamp_bits >= 64 ? ~0ull : (1ull << device.timestamp_bits) - 1;
    const double tick = 1e-9 * static_cast<double>(device.limits.timestampPeriod);
    const double seconds = tick * static_cast<double>((stamps[1] - stamps[0]) & mask);
    times.kernel += seconds;
    if (staged)
        times.read_back += tick * static_cast<double>((stamps[2] - stamps[1]) & mask);
    return seconds;
}

void Dispatcher::Implementation::finish(InFlight& slot, FieldTimes& times) {
    if (!std::exchange(slot.pending, false))
        return;
    slot.commands.wait();
    const double seconds = add_times(slot, times);
    if (device.taken.longest > 0 && seconds > device.taken.longest)
        throw vk::DeviceLostError(kLimitsVariable);
    device.groups.add(slot.kernel, slot.group, slot.work, seconds);
    times.group = slot.group;
    times.compile += std::exchange(compiled, 0);
    const double next = static_cast<double>(slot.work) * std::min(kMostGrowth, kAim / std::max(seconds, 1e-9));
    if (slot.work != 0) // and a small one says nothing against larger ones
        pace = seconds < kAim ? std::max(pace, next) : next;
    uint status = 0;
    std::memcpy(&status, visible_to_host(device, slot.status), sizeof(status));
    if (status & layout::kStatusUnfinished)
        throw DeviceError(DeviceError::Kind::unfinished,
                          "the device's driver ended a loop of the kernel before its work was done; do not trust "
                          "what it computed");
    for (const OwnBuffer& own : slot.buffers)
        if (own.behind != 0)
            require_poison({visible_to_host(device, staged ? own.host : own.device) + own.bytes, own.behind});
}

void require_poison(Bytes behind) {
    for (std::size_t at = 0; at < behind.size(); at += sizeof(uint)) {
        uint word = 0;
        std::memcpy(&word, behind.data() + at, sizeof(word));
        if (word != Dispatcher::kPoison)
            throw DeviceError(DeviceError::Kind::differs_in_parts,
                              fmt::format("a kernel writes {} bytes behind the end of its results; do not trust what "
                                          "this device computes",
                                          at));
    }
}

Dispatcher::Dispatcher(Device& device, const DispatchShape& shape, bool force_staging)
    : implementation_(checked("preparing a kernel", [&] {
          return std::make_unique<Implementation>(device.implementation(), shape, force_staging);
      })) {}

Dispatcher::~Dispatcher() = default;

const DeviceReport& Dispatcher::report() const {
    return implementation_->device.report;
}

std::size_t Dispatcher::pipeline(Code code, std::span<const std::uint32_t> constants, FieldTimes& times) {
    Implementation& self = *implementation_;
    std::vector<std::uint32_t> wanted(constants.begin(), constants.end());
    wanted[layout::kSpecLocalX] = 0;
    const std::uint64_t hash = hash_of(wanted, hash_of(code));
    auto found = std::ranges::find(self.pipelines, hash, &Pipeline::hash);
    if (found == self.pipelines.end())
        found = self.pipelines.insert(found, {code, std::move(wanted), hash});
    self.compile(*found, self.device.groups.usual(hash, self.shape.group));
    times.compile += std::exchange(self.compiled, 0);
    return static_cast<std::size_t>(found - self.pipelines.begin());
}

void Dispatcher::upload(FieldTimes& times, const std::function<void(const PutTable&)>& tables) {
    const Clock::time_point start = Clock::now();
    tables([&](uint binding, Bytes table) {
        implementation_->upload(binding, table);
        times.uploaded += table.size();
    });
    times.upload += seconds_since(start);
}

std::byte* Dispatcher::keep(uint binding, std::size_t bytes, bool shared) {
    Implementation& self = *implementation_;
    SharedBuffer& kept = self.shared[binding];
    const bool copied = self.staged && !shared;
    grow(self.device, kept.device, bytes, Usage::eStorageBuffer | Usage::eTransferSrc,
         copied ? Placement::device : Placement::host_read);
    if (copied)
        grow(self.device, kept.host, bytes, Usage::eTransferDst, Placement::host_read);
    return kept.device.mapped;
}

const std::byte* Dispatcher::kept(uint binding) {
    Implementation& self = *implementation_;
    const SharedBuffer& kept = self.shared[binding];
    if (kept.host.size == 0)
        return visible_to_host(self.device, kept.device);
    self.transfers.record([&](const vk::raii::CommandBuffer& commands) {
        barrier(commands, Stage::eComputeShader, Access::eShaderWrite, Stage::eTransfer, Access::eTransferRead);
        commands.copyBuffer(*kept.device.buffer, *kept.host.buffer,
                            vk::BufferCopy(0, 0, std::min(kept.device.size, kept.host.size)));
        barrier(commands, Stage::eTransfer, Access::eTransferWrite, Stage::eHost, Access::eHostRead);
    });
    self.transfers.submit();
    self.transfers.wait();
    return visible_to_host(self.device, kept.host);
}

void Dispatcher::flush(uint binding) {
    flush_to_device(implementation_->device, implementation_->shared[binding].device);
}

void Dispatcher::begin(FieldTimes& times) {
    Implementation& self = *implementation_;
    ++self.turn;
    InFlight& slot = self.slot();
    const bool done = slot.pending;
    self.finish(slot, times);
    if (done)
        slot.consume();
    for (OwnBuffer& own : slot.buffers) {
        own.bytes = own.behind = 0;
        own.filled.reset();
    }
}

void Dispatcher::finish(FieldTimes& times) {
    for (std::size_t i = 0; i < implementation_->slots.size(); ++i)
        begin(times);
}

void Dispatcher::complete(FieldTimes& times, const std::function<void()>& work) {
    implementation_->turn = 0; // the same buffers serve the same dispatches of the next run
    try {
        work();
        finish(times);
    } catch (...) {
        // The device must be done with the buffers before anybody uses them again.
        FieldTimes ignored;
        for (InFlight& slot : implementation_->slots)
            try {
                implementation_->finish(slot, ignored);
            } catch (const std::exception&) {
                // The exception in flight says more.
            }
        throw;
    }
}

void Dispatcher::put(uint binding, Bytes table) {
    Implementation& self = *implementation_;
    OwnBuffer& own = self.slot().buffers[binding];
    own.is_table = true;
    own.bytes = table.size();
    if (table.empty())
        return;
    // Room to spare, since the next table may need somewhat more.
    const std::size_t room =
        table.size() <= own.device.size
            ? own.device.size
            : std::max<std::size_t>(table.size(), std::min<std::uint64_t>(16 + table.size() + table.size() / 4,
                                                                          self.device.report.buffer_range));
    grow(self.device, own.device, room, Usage::eStorageBuffer | Usage::eTransferDst,
         self.staged ? Placement::device : Placement::host_upload);
    if (self.staged)
        grow(self.device, own.host, room, Usage::eTransferSrc, Placement::host_upload);
    const Buffer& host = self.staged ? own.host : own.device;
    std::memcpy(host.mapped, table.data(), table.size());
    flush_to_device(self.device, host);
}

void Dispatcher::expect(uint binding, std::size_t bytes) {
    OwnBuffer& own = implementation_->slot().buffers[binding];
    implementation_->reserve(own, bytes);
    own.bytes = bytes;
    if (!implementation_->poisoned || bytes == 0)
        return;
    own.filled = kPoison;
    own.behind = kPoisonBehind;
    implementation_->reserve(own, bytes + own.behind);
}

void Dispatcher::expect_channels(uint force_binding, uint channels, std::size_t samples, std::size_t real_size) {
    for (uint i = 0; i < kChannels.size(); ++i)
        if (channels & kChannels[i].bit)
            expect(force_binding - 1 + i, samples * kChannels[i].bytes(real_size));
}

void Dispatcher::reserve_channels(uint force_binding, uint channels, std::size_t samples, std::size_t real_size) {
    for (InFlight& slot : implementation_->slots)
        for (uint i = 0; i < kChannels.size(); ++i)
            if (channels & kChannels[i].bit)
                implementation_->reserve(slot.buffers[force_binding - 1 + i], samples * kChannels[i].bytes(real_size));
}

void Dispatcher::fill(uint binding, uint word) {
    if (OwnBuffer& own = implementation_->slot().buffers[binding]; own.bytes != 0)
        own.filled = word;
}

void Dispatcher::begin_run(bool poison) {
    implementation_->poisoned = poison;
    implementation_->pace = 0;
}

std::uint64_t Dispatcher::paced(std::uint64_t most) const {
    const Implementation& self = *implementation_;
    if (self.device.report.software && self.device.taken.longest == 0)
        return most;
    const double all = static_cast<double>(most), share = all / kFirstShare;
    return static_cast<std::uint64_t>(std::clamp(self.pace > 0 ? self.pace : share, 1.0, std::max(1.0, all)));
}

std::uint32_t Dispatcher::least_group() const {
    return std::min({kGroups.front(), implementation_->shape.group, report().group_invocations});
}

std::size_t Dispatcher::fitting(std::size_t wanted) const {
    const Implementation& self = *implementation_;
    const std::optional<std::uint64_t> free = self.device.free_memory();
    if (!free || !self.staged) // elsewhere it is the host's
        return wanted;
    std::uint64_t room = *free; // and what earlier runs had
    for (const InFlight& slot : self.slots)
        for (const OwnBuffer& own : slot.buffers)
            room += own.device.size;
    constexpr std::uint64_t kShare = 2; // half is for tables, and others
    return static_cast<std::size_t>(std::min<std::uint64_t>(wanted, room / kShare / self.slots.size()));
}

void Dispatcher::fit(const std::function<void()>& reserve, const std::function<bool()>& lessen) {
    for (;;)
        try {
            return reserve();
        } catch (const DeviceError& error) {
            if (error.kind() != DeviceError::Kind::out_of_memory || !lessen())
                throw;
            implementation_->drop_buffers();
        }
}

void Dispatcher::submit(std::span<const Run> runs, std::uint64_t work, const std::function<void()>& consume) {
    Implementation& self = *implementation_;
    InFlight& slot = self.slot();
    self.bind(slot);
    if (!runs.empty()) {
        slot.kernel = self.pipelines[runs.back().pipeline].hash;
        slot.group = self.device.groups.next(slot.kernel, self.shape.group);
    }
    slot.commands.record([&](const vk::raii::CommandBuffer& commands) { self.record(slot, runs, commands); });
    std::memset(slot.status.mapped, 0, sizeof(uint));
    flush_to_device(self.device, slot.status);
    slot.consume = consume;
    slot.work = work;
    slot.submitted = Clock::now();
    slot.commands.submit();
    slot.pending = true;
}

Bytes Dispatcher::result_bytes(uint binding) const {
    Implementation& self = *implementation_;
    const OwnBuffer& own = self.slot().buffers[binding];
    if (own.bytes == 0)
        return {};
    return {visible_to_host(self.device, self.staged ? own.host : own.device), own.bytes};
}

Kernel::Kernel(Device& device, const KernelOptions& options, const DispatchShape& shape)
    : dispatcher_(new Dispatcher(device, shape, options.force_staging)), options_(options) {}

Kernel::~Kernel() = default;

void run_checked(const std::string& doing, const std::function<void()>& call) {
    checked(doing, call);
}

} // namespace forceshade::compute
