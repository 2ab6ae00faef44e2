#include <algorithm>

#include <fmt/format.h>

#include "compute/vulkan.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {
namespace {

constexpr std::uint32_t kApiVersion = VK_API_VERSION_1_1;

std::string version_text(std::uint32_t version) {
    return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                       VK_API_VERSION_PATCH(version));
}

std::string type_text(vk::PhysicalDeviceType type) {
    switch (type) {
    case vk::PhysicalDeviceType::eCpu:
        return "software";
    case vk::PhysicalDeviceType::eIntegratedGpu:
        return "integrated";
    case vk::PhysicalDeviceType::eDiscreteGpu:
        return "discrete";
    case vk::PhysicalDeviceType::eVirtualGpu:
        return "virtual";
    default:
        return "other";
    }
}

std::optional<std::uint32_t> compute_family(const vk::raii::PhysicalDevice& physical) {
    const auto families = physical.getQueueFamilyProperties();
    for (std::uint32_t family = 0; family < families.size(); ++family)
        if (families[family].queueFlags & vk::QueueFlagBits::eCompute)
            return family;
    return std::nullopt;
}

std::vector<std::string> find_refusals(const vk::raii::PhysicalDevice& physical, const vk::PhysicalDeviceLimits& limits,
                                       std::uint32_t api) {
    std::vector<std::string> reasons;
    if (api < kApiVersion)
        reasons.push_back(
            fmt::format("its driver speaks Vulkan {}, needed is {}", version_text(api), version_text(kApiVersion)));
    if (!compute_family(physical))
        reasons.push_back("it has no compute queue");
    if (limits.maxPerStageDescriptorStorageBuffers < layout::kBindCount)
        reasons.push_back(fmt::format("a kernel may bind {} storage buffers, needed are {}",
                                      limits.maxPerStageDescriptorStorageBuffers, layout::kBindCount));
    return reasons;
}

DeviceReport describe(const vk::raii::PhysicalDevice& physical, std::uint32_t index) {
    const vk::PhysicalDeviceProperties properties = physical.getProperties();
    DeviceReport report;
    report.index = index;
    report.name = properties.deviceName.data();
    report.type = type_text(properties.deviceType);
    report.software = properties.deviceType == vk::PhysicalDeviceType::eCpu;
    report.api = version_text(properties.apiVersion);
    report.driver = version_text(properties.driverVersion);
    report.buffer_range = properties.limits.maxStorageBufferRange;
    report.refusals = find_refusals(physical, properties.limits, properties.apiVersion);
    const vk::PhysicalDeviceFeatures features = physical.getFeatures();
    report.f64 = features.shaderFloat64;
    report.int64 = features.shaderInt64;
    const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
    for (std::uint32_t heap = 0; heap < memory.memoryHeapCount; ++heap)
        if (memory.memoryHeaps[heap].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
            report.memory = std::max<std::uint64_t>(report.memory, memory.memoryHeaps[heap].size);
    if (properties.apiVersion < kApiVersion)
        return report;
    const auto chain = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceIDProperties,
                                               vk::PhysicalDeviceSubgroupProperties>();
    for (const std::uint8_t byte : chain.get<vk::PhysicalDeviceIDProperties>().deviceUUID)
        report.uuid += fmt::format("{:02x}", byte);
    report.subgroup = chain.get<vk::PhysicalDeviceSubgroupProperties>().subgroupSize;
    if (properties.apiVersion >= VK_API_VERSION_1_2) {
        const auto driver = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>()
                                .get<vk::PhysicalDeviceDriverProperties>();
        report.driver = fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
    }
    return report;
}

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& implementation = *static_cast<Device::Implementation*>(user);
    const std::lock_guard lock(implementation.messages_mutex);
    implementation.messages.emplace_back(data->pMessage);
    return VK_FALSE;
}

void make_instance(Device::Implementation& self, bool validation) {
    const vk::ApplicationInfo application("forceshade", 1, "forceshade", 1, kApiVersion);
    std::vector<const char*> layers, extensions;
    if (validation) {
        layers.push_back("VK_LAYER_KHRONOS_validation");
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
        extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    }
    const std::vector<vk::ValidationFeatureEnableEXT> enabled{
        vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
    const vk::ValidationFeaturesEXT features(enabled);
    vk::InstanceCreateInfo info({}, &application, layers, extensions);
    if (validation)
        info.pNext = &features;
    self.instance = vk::raii::Instance(self.context, info);
    if (!validation)
        return;
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    self.messenger = self.instance.createDebugUtilsMessengerEXT(
        {{}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, keep_message, &self});
}

void make_device(Device::Implementation& self, std::span<const std::byte> cache) {
    self.queue_family = compute_family(self.physical).value();
    self.timestamp_bits = self.physical.getQueueFamilyProperties()[self.queue_family].timestampValidBits;
    self.limits = self.physical.getProperties().limits;
    self.memory = self.physical.getMemoryProperties();
    const float priority = 1.0f;
    const vk::DeviceQueueCreateInfo queue({}, self.queue_family, 1, &priority);
    vk::PhysicalDeviceFeatures features;
    features.shaderFloat64 = self.report.f64;
    features.shaderInt64 = self.report.int64;
    self.device = self.physical.createDevice({{}, queue, {}, {}, &features});
    self.queue = self.device.getQueue(self.queue_family, 0);
    self.command_pool =
        self.device.createCommandPool({vk::CommandPoolCreateFlagBits::eResetCommandBuffer, self.queue_family});
    try {
        self.pipeline_cache = self.device.createPipelineCache({{}, cache.size(), cache.data()});
    } catch (const vk::SystemError&) {
        self.pipeline_cache = self.device.createPipelineCache({});
    }
}

vk::raii::Context load() {
    try {
        return vk::raii::Context();
    } catch (const std::exception& error) {
        throw DeviceError(DeviceError::Kind::no_such_device,
                          fmt::format("no Vulkan loader ({}): install the package libvulkan1", error.what()));
    }
}

} // namespace

std::vector<DeviceReport> list_devices() {
    const vk::raii::Context context = load();
    return checked("listing the Vulkan devices", [&] {
        const vk::ApplicationInfo application("forceshade", 1, "forceshade", 1, kApiVersion);
        std::vector<DeviceReport> devices;
        try {
            const vk::raii::Instance instance(context, vk::InstanceCreateInfo({}, &application));
            for (const vk::raii::PhysicalDevice& physical : instance.enumeratePhysicalDevices())
                devices.push_back(describe(physical, static_cast<std::uint32_t>(devices.size())));
        } catch (const vk::IncompatibleDriverError&) {
            devices.clear(); // the loader found no driver
        }
        return devices;
    });
}

Device::Device(const DeviceOptions& options) {
    const DeviceReport chosen = choose_device(list_devices(), options.wanted, options.needs_f64);
    checked("opening " + chosen.name, [&] {
        implementation_ = std::make_unique<Implementation>();
        implementation_->report = chosen;
        make_instance(*implementation_, options.validation);
        implementation_->physical = std::move(implementation_->instance.enumeratePhysicalDevices().at(chosen.index));
        make_device(*implementation_, options.pipeline_cache);
    });
}

Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const DeviceReport& Device::report() const {
    return implementation_->report;
}

std::vector<std::string> Device::validation_messages() const {
    const std::lock_guard lock(implementation_->messages_mutex);
    return implementation_->messages;
}

std::vector<std::byte> Device::pipeline_cache() const {
    return checked("reading the pipeline cache", [&] {
        std::vector<std::byte> bytes;
        for (const std::uint8_t byte : implementation_->pipeline_cache.getData())
            bytes.push_back(static_cast<std::byte>(byte));
        return bytes;
    });
}

} // namespace forceshade::compute
