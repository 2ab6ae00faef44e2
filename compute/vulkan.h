// Vulkan types of the open device, for device.cpp and dispatch.cpp only: including this takes seconds.
#pragma once

#include <mutex>
#include <optional>

#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#include <vulkan/vulkan_raii.hpp>

#include "compute/device.h"
#include "compute/device_limits.h"

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

struct Device::Implementation {
    DeviceReport report;
    DeviceLimits taken;            // to be the device's, below its own
    std::uint64_t allocated = 0;   // bytes of the device's own memory
    std::uint64_t submissions = 0; // so far
    std::shared_ptr<Loaded> loaded;
    std::mutex messages_mutex;
    std::vector<std::string> messages; // of the validation layers; filled by the messenger below
    vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
    vk::raii::PhysicalDevice physical{nullptr};
    vk::PhysicalDeviceLimits limits;
    vk::PhysicalDeviceMemoryProperties memory;
    std::uint32_t queue_family = 0;
    std::uint32_t timestamp_bits = 0; // 0: the queue keeps no time
    vk::raii::Device device{nullptr};
    vk::raii::Queue queue{nullptr};
    vk::raii::CommandPool command_pool{nullptr};
    vk::raii::PipelineCache pipeline_cache{nullptr};
};

/// A buffer with memory of its own, mapped if the memory is visible to the host.
struct Buffer {
    vk::raii::Buffer buffer{nullptr};
    vk::raii::DeviceMemory memory{nullptr};
    std::size_t size = 0; // bytes
    std::byte* mapped = nullptr;
    bool coherent = false;
    std::vector<std::byte> apart{};  // what `mapped` is where memory is taken for incoherent
    std::byte* behind = nullptr;     // and what it stands for
    std::shared_ptr<void> counted{}; // in `allocated`
};

enum class Placement {
    device,      // fastest for kernels; may not be visible to the host
    host_upload, // the host writes, the device copies from it
    host_read,   // the device writes or copies to it, the host reads: cached where there is such memory
};

/// \throws DeviceError (out_of_memory).
Buffer make_buffer(Device::Implementation& device, std::size_t bytes, vk::BufferUsageFlags usage, Placement placement);

} // namespace forceshade::compute
