// Vulkan types of the open device, its memory and its commands, for sources of this folder only: including this takes
// seconds.
#pragma once

#include <map>
#include <mutex>
#include <optional>

#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#include <vulkan/vulkan_raii.hpp>

#include "compute/device.h"
#include "compute/device_limits.h"
#include "compute/groups.h"

namespace forceshade::compute {

/// Runs a call and turns Vulkan's exceptions into DeviceError with `doing` as context.
template <typename Call> decltype(auto) checked(const std::string& doing, Call&& call) {
    try {
        return call();
    } catch (const vk::OutOfDeviceMemoryError&) {
        throw DeviceError(DeviceError::Kind::out_of_memory, "out of device memory while " + doing);
    } catch (const vk::OutOfHostMemoryError&) {
        throw DeviceError(DeviceError::Kind::out_of_memory, "out of host memory while " + doing);
    } catch (const vk::DeviceLostError&) {
        throw DeviceError(DeviceError::Kind::device_lost,
                          "the device was lost while " + doing +
                              ": its driver was reset or the device removed; run again, or choose another with --gpu");
    } catch (const vk::LayerNotPresentError&) {
        throw DeviceError(DeviceError::Kind::unsupported,
                          "Vulkan's validation layers are not installed: install the package vulkan-validationlayers");
    } catch (const vk::SystemError& error) {
        throw DeviceError(DeviceError::Kind::unsupported, std::string(error.what()) + " while " + doing);
    }
}

/// The Vulkan loader and an instance of it. \throws DeviceError (no_such_device) without a loader.
struct Loaded {
    Loaded();
    vk::raii::Context context;
    vk::raii::Instance instance{nullptr};
};

/// Memory of one type. Small buffers take parts of one piece; a large one has a piece of its own.
struct MemoryPiece {
    vk::raii::DeviceMemory memory{nullptr};
    std::byte* mapped = nullptr;
    std::map<std::size_t, std::size_t> free{}; // bytes by offset
    std::shared_ptr<void> counted{};           // in `allocated`
};

struct Device::Implementation {
    DeviceReport report;
    DeviceLimits taken;            // to be the device's, below its own
    std::uint64_t allocated = 0;   // bytes of the device's own memory
    std::uint64_t submissions = 0; // so far
    std::uint64_t buffers = 0;     // that were asked for
    std::shared_ptr<Loaded> loaded;
    std::mutex messages_mutex;
    std::vector<std::string> messages; // of the validation layers; filled by the messenger below
    vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
    vk::raii::PhysicalDevice physical{nullptr};
    vk::PhysicalDeviceLimits limits;
    vk::PhysicalDeviceMemoryProperties memory;
    bool tells_budget = false; // of its memory
    GroupSizes groups;
    std::uint32_t queue_family = 0;
    std::uint32_t timestamp_bits = 0; // 0: the queue keeps no time
    vk::raii::Device device{nullptr};
    vk::raii::Queue queue{nullptr};
    vk::raii::PipelineCache pipeline_cache{nullptr};
    // Of small buffers: by type, and whether mapped.
    std::map<std::pair<std::uint32_t, bool>, std::vector<std::shared_ptr<MemoryPiece>>> pieces;

    /// Bytes of the device's own memory that are free, where its driver says.
    std::optional<std::uint64_t> free_memory() const;
};

/// Of a piece of memory, given back to it at the end.
struct Part {
    std::shared_ptr<MemoryPiece> piece;
    std::size_t offset = 0, bytes = 0;
};

/// A buffer with its part of memory, mapped if that is visible to the host.
struct Buffer {
    std::shared_ptr<const Part> memory{};
    vk::raii::Buffer buffer{nullptr}; // gone before its memory
    std::size_t size = 0;             // bytes
    std::byte* mapped = nullptr;
    bool coherent = false;
    std::vector<std::byte> apart{}; // what `mapped` is where memory is taken for incoherent
    std::byte* behind = nullptr;    // and what it stands for
};

enum class Placement {
    device,      // fastest for kernels; may not be visible to the host
    host_upload, // the host writes, the device copies from it
    host_read,   // the device writes or copies to it, the host reads: cached where there is such memory
};

/// \throws DeviceError (out_of_memory).
Buffer make_buffer(Device::Implementation& device, std::size_t bytes, vk::BufferUsageFlags usage, Placement placement);

/// Shows the device what the host wrote.
void flush_to_device(Device::Implementation& device, const Buffer& buffer);
/// Shows the host what the device wrote.
const std::byte* visible_to_host(Device::Implementation& device, const Buffer& buffer);

/// Commands, recorded anew each time, and the fence that signals when the device is done with them.
class Commands {
public:
    explicit Commands(Device::Implementation& device);

    template <typename Record> void record(const Record& what) {
        pool_.reset();
        buffer_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        what(buffer_);
        buffer_.end();
    }
    void submit();
    /// \throws DeviceError (device_lost).
    void wait();

private:
    Device::Implementation* device_;
    vk::raii::CommandPool pool_;
    vk::raii::CommandBuffer buffer_;
    vk::raii::Fence fence_;
};

} // namespace forceshade::compute
