#include "compute/bandwidth.h"

#include <algorithm>
#include <cstring>

#include "compute/vulkan.h"
#include "host/clock.h"

namespace forceshade::compute {
namespace {

using Usage = vk::BufferUsageFlagBits;
using Stage = vk::PipelineStageFlagBits;
using Access = vk::AccessFlagBits;

constexpr int kTries = 3, kRepeats = 4; // in a submission

template <typename Work> double best_rate(std::size_t bytes, const Work& work) {
    double best = 0;
    work(); // memory is there for the first time
    for (int i = 0; i < kTries; ++i) {
        const Clock::time_point start = Clock::now();
        work();
        best = std::max(best, kRepeats * static_cast<double>(bytes) / seconds_since(start));
    }
    return best;
}

} // namespace

Bandwidth measure_bandwidth(Device& opened) {
    return checked("measuring bandwidth", [&] {
        Device::Implementation& device = opened.implementation();
        // Larger than caches, a small part of the memory.
        const std::size_t bytes = std::min<std::uint64_t>(std::size_t(device.report.software ? 64 : 256) << 20,
                                                          device.report.memory / 16 / 4 * 4);
        const Buffer first = make_buffer(device, bytes, Usage::eTransferSrc | Usage::eTransferDst, Placement::device);
        const Buffer second = make_buffer(device, bytes, Usage::eTransferDst, Placement::device);
        const Buffer host = make_buffer(device, bytes, Usage::eTransferDst, Placement::host_read);
        std::vector<std::byte> read(bytes);
        Commands commands(device);
        const auto run = [&](const auto& record) {
            commands.record([&](const vk::raii::CommandBuffer& buffer) {
                for (int i = 0; i < kRepeats; ++i) {
                    record(buffer);
                    buffer.pipelineBarrier(Stage::eTransfer, Stage::eTransfer | Stage::eHost, {},
                                           vk::MemoryBarrier(Access::eTransferWrite, Access::eTransferRead |
                                                                                         Access::eTransferWrite |
                                                                                         Access::eHostRead),
                                           {}, {});
                }
            });
            commands.submit();
            commands.wait();
        };
        const auto copy_to = [&](const Buffer& to) {
            run([&](const vk::raii::CommandBuffer& buffer) {
                buffer.copyBuffer(*first.buffer, *to.buffer, vk::BufferCopy(0, 0, bytes));
            });
        };
        Bandwidth found;
        found.store = best_rate(bytes, [&] {
            run([&](const vk::raii::CommandBuffer& buffer) {
                buffer.fillBuffer(*first.buffer, 0, bytes, 0x3F800000u);
            });
        });
        found.copy = best_rate(bytes, [&] { copy_to(second); });
        found.read_back = best_rate(bytes, [&] {
            copy_to(host);
            for (int i = 0; i < kRepeats; ++i) // as each copy would be
                std::memcpy(read.data(), visible_to_host(device, host), bytes);
        });
        return found;
    });
}

} // namespace forceshade::compute
