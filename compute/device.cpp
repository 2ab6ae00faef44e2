#include "compute/device.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "compute/vulkan.h"
#include "shaders/shared/layout.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace forceshade::compute {
namespace {

constexpr std::uint32_t kApiVersion = VK_API_VERSION_1_1;
// What every device has of push constants, bytes.
static_assert(std::max({sizeof(layout::ChunkParams), sizeof(layout::MeshChunkParams), sizeof(layout::PathChunkParams),
                        sizeof(layout::MeshPathChunkParams)}) <= 128);
constexpr std::uint32_t kMostBindings =
    std::max({layout::kBindCount, layout::kMeshBindCount, layout::kPathBindCount, layout::kMeshPathBindCount});

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
    if (limits.maxPerStageDescriptorStorageBuffers < kMostBindings)
        reasons.push_back(fmt::format("a kernel may bind {} storage buffers, needed are {}",
                                      limits.maxPerStageDescriptorStorageBuffers, kMostBindings));
    return reasons;
}

bool has_extension(const vk::raii::PhysicalDevice& physical, std::string_view name) {
    const auto all = physical.enumerateDeviceExtensionProperties();
    return std::ranges::any_of(all, [&](const auto& one) { return name == one.extensionName.data(); });
}

// What may be asked of each width alone: where a device has one behaviour for some widths together, these are left out.
void describe_floats(const vk::raii::PhysicalDevice& physical, DeviceReport& report) {
    if (!has_extension(physical, VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME))
        return;
    using Properties = vk::PhysicalDeviceFloatControlsProperties;
    using Independence = vk::ShaderFloatControlsIndependence;
    const auto of = physical.getProperties2<vk::PhysicalDeviceProperties2, Properties>().get<Properties>();
    const bool one = of.denormBehaviorIndependence != Independence::eNone,
               each = of.denormBehaviorIndependence == Independence::eAll,
               one_rounds = of.roundingModeIndependence != Independence::eNone,
               each_rounds = of.roundingModeIndependence == Independence::eAll;
    report.single = {one && of.shaderDenormPreserveFloat32, bool(of.shaderSignedZeroInfNanPreserveFloat32),
                     one_rounds && of.shaderRoundingModeRTEFloat32};
    report.twice = {each && of.shaderDenormPreserveFloat64, bool(of.shaderSignedZeroInfNanPreserveFloat64),
                    each_rounds && of.shaderRoundingModeRTEFloat64};
}

DeviceReport describe(const vk::raii::PhysicalDevice& physical, std::uint32_t index, const DeviceLimits& taken) {
    const vk::PhysicalDeviceProperties properties = physical.getProperties();
    DeviceReport report;
    report.index = index;
    report.name = properties.deviceName.data();
    report.type = type_text(properties.deviceType);
    report.software = properties.deviceType == vk::PhysicalDeviceType::eCpu;
    report.api = version_text(properties.apiVersion);
    report.driver = version_text(properties.driverVersion);
    report.nearest = report.software;
    report.buffer_range = properties.limits.maxStorageBufferRange;
    report.group_invocations =
        std::min(properties.limits.maxComputeWorkGroupInvocations, properties.limits.maxComputeWorkGroupSize[0]);
    report.group_count = properties.limits.maxComputeWorkGroupCount[0];
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
        report.driver = driver.driverName.data();
        if (driver.driverInfo[0] != 0)
            report.driver += fmt::format(" {}", driver.driverInfo.data());
    }
    describe_floats(physical, report);
    apply(taken, report);
    return report;
}

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    auto& implementation = *static_cast<Device::Implementation*>(user);
    // That a call returned an error is thrown already; memory that is short is no fault.
    if (data->pMessageIdName && std::string_view(data->pMessageIdName) == "UNASSIGNED-BestPractices-Error-Result")
        return VK_FALSE;
    const std::lock_guard lock(implementation.messages_mutex);
    implementation.messages.emplace_back(data->pMessage);
    return VK_FALSE;
}

const vk::ApplicationInfo kApplication("forceshade", 1, "forceshade", 1, kApiVersion);

/// While it lives, this thread's floats flush denormals to 0, and those of threads that it starts: a software driver's.
class Flushing {
public:
    explicit Flushing(bool wanted) : wanted_(wanted) {
        if (!wanted)
            return;
#if defined(__SSE2__)
        before_ = _mm_getcsr();
        _mm_setcsr(before_ | 0x8040u); // results to zero, operands as zero
#else
        throw DeviceError(DeviceError::Kind::unsupported,
                          fmt::format("{}: flush is for x86 processors", kLimitsVariable));
#endif
    }
    ~Flushing() {
#if defined(__SSE2__)
        if (wanted_)
            _mm_setcsr(before_);
#endif
    }
    Flushing(const Flushing&) = delete;
    Flushing& operator=(const Flushing&) = delete;

private:
    bool wanted_;
    unsigned before_ = 0;
};

/// The instance that all devices without validation layers share, to the end of the process: a driver of hardware that
/// is loaded and unloaded again and again has been seen not to be found any more.
/// \throws DeviceError (no_such_device) without a Vulkan loader, vk::IncompatibleDriverError without any driver.
std::shared_ptr<Loaded> shared_instance() {
    static std::mutex mutex;
    static std::shared_ptr<Loaded>* const kept = new std::shared_ptr<Loaded>; // outlives the drivers' own cleaning up
    const std::lock_guard lock(mutex);
    if (!*kept) {
        auto loaded = std::make_shared<Loaded>();
        loaded->instance = vk::raii::Instance(loaded->context, vk::InstanceCreateInfo({}, &kApplication));
        *kept = std::move(loaded);
    }
    return *kept;
}

/// An instance of this device alone, so that the layers' messages are about it.
void make_validated_instance(Device::Implementation& self, bool assisted) {
    const std::vector<const char*> layers{"VK_LAYER_KHRONOS_validation"};
    const std::vector<const char*> extensions{VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                              VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
    std::vector<vk::ValidationFeatureEnableEXT> enabled{vk::ValidationFeatureEnableEXT::eSynchronizationValidation,
                                                        vk::ValidationFeatureEnableEXT::eBestPractices};
    if (assisted)
        enabled.push_back(vk::ValidationFeatureEnableEXT::eGpuAssisted);
    const vk::ValidationFeaturesEXT features(enabled);
    self.loaded = std::make_shared<Loaded>();
    self.loaded->instance = vk::raii::Instance(
        self.loaded->context, vk::InstanceCreateInfo({}, &kApplication, layers, extensions, &features));
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    self.messenger = self.loaded->instance.createDebugUtilsMessengerEXT(
        {{}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, keep_message, &self});
}

// What Device::cache() gives: this, the sizes of work groups, the driver's own.
struct CacheHead {
    std::array<char, 8> magic{'f', 's', 'c', 'a', 'c', 'h', 'e', '1'};
    std::uint64_t groups = 0; // bytes
};

struct Cache {
    std::span<const std::byte> groups{}, pipelines{};

    explicit Cache(std::span<const std::byte> bytes) {
        CacheHead head;
        if (bytes.size() < sizeof(head))
            return;
        std::memcpy(&head, bytes.data(), sizeof(head));
        bytes = bytes.subspan(sizeof(head));
        if (head.magic != CacheHead{}.magic || head.groups > bytes.size())
            return;
        groups = bytes.first(head.groups);
        pipelines = bytes.subspan(head.groups);
    }
};

void make_device(Device::Implementation& self, const DeviceOptions& options) {
    const Cache cache(options.cache);
    self.queue_family = compute_family(self.physical).value();
    self.timestamp_bits = self.physical.getQueueFamilyProperties()[self.queue_family].timestampValidBits;
    self.limits = self.physical.getProperties().limits;
    self.memory = self.physical.getMemoryProperties();
    const float priority = 1.0f;
    const vk::DeviceQueueCreateInfo queue({}, self.queue_family, 1, &priority);
    vk::PhysicalDeviceFeatures features;
    const vk::PhysicalDeviceFeatures has = self.physical.getFeatures(); // of this instance
    features.shaderFloat64 = self.report.f64 && has.shaderFloat64;
    features.shaderInt64 = self.report.int64 && has.shaderInt64;
    std::vector<const char*> extensions;
    self.tells_budget = has_extension(self.physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    if (self.tells_budget)
        extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    if (self.report.single.any() || self.report.twice.any())
        extensions.push_back(VK_KHR_SHADER_FLOAT_CONTROLS_EXTENSION_NAME);
    self.device = self.physical.createDevice({{}, queue, {}, extensions, &features});
    const bool tries = !self.report.software || options.try_groups_on_software;
    self.groups = GroupSizes(std::min(self.report.group_invocations, self.limits.maxComputeWorkGroupSize[0]),
                             tries ? options.try_groups_after : INFINITY, cache.groups);
    self.queue = self.device.getQueue(self.queue_family, 0);
    try {
        self.pipeline_cache = self.device.createPipelineCache({{}, cache.pipelines.size(), cache.pipelines.data()});
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

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::string uuid_digits(const std::string& text) {
    std::string digits = lower(text);
    std::erase(digits, '-');
    return digits;
}

std::vector<std::string> refusals(const DeviceReport& device, bool needs_f64) {
    std::vector<std::string> reasons = device.refusals;
    if (needs_f64 && !device.f64)
        reasons.push_back("no double precision in kernels (shaderFloat64), which this run asks for");
    return reasons;
}

// `count`: how many devices there are; a number beyond them is part of a name ("4090").
bool is_wanted(const DeviceReport& device, const std::string& wanted, std::size_t count) {
    // A UUID first: one of digits alone would be read as an index.
    if (const std::string digits = uuid_digits(wanted); digits.size() == device.uuid.size())
        if (digits.find_first_not_of("0123456789abcdef") == std::string::npos)
            return device.uuid == digits;
    std::uint32_t index = 0;
    const char* end = wanted.data() + wanted.size();
    if (const auto [stop, error] = std::from_chars(wanted.data(), end, index);
        error == std::errc() && stop == end && index < count)
        return device.index == index;
    return lower(device.name).find(lower(wanted)) != std::string::npos;
}

std::string listing(const std::vector<DeviceReport>& devices, bool needs_f64) {
    if (devices.empty())
        return "\n  no Vulkan device at all: install a driver (package mesa-vulkan-drivers has the software one)";
    std::string text;
    for (const DeviceReport& device : devices) {
        const std::vector<std::string> reasons = refusals(device, needs_f64);
        text += fmt::format("\n  {}  {} ({}, {}): {}", device.index, device.name, device.type, device.uuid,
                            reasons.empty() ? "usable" : fmt::format("{}", fmt::join(reasons, "; ")));
    }
    return text;
}

} // namespace

Loaded::Loaded() : context(load()) {}

std::vector<DeviceReport> list_devices() {
    return checked("listing the Vulkan devices", [] {
        std::vector<DeviceReport> devices;
        const DeviceLimits taken = device_limits();
        const Flushing flushing(taken.flush);
        try {
            for (const vk::raii::PhysicalDevice& physical : shared_instance()->instance.enumeratePhysicalDevices())
                devices.push_back(describe(physical, static_cast<std::uint32_t>(devices.size()), taken));
        } catch (const vk::IncompatibleDriverError&) {
            devices.clear(); // the loader found no driver
        }
        return devices;
    });
}

bool may_have_hardware() {
    // What drivers talk to: of DRM (AMD, Intel, Nouveau, virtual ones), NVIDIA's own, Windows' below WSL, two of
    // phones.
    std::error_code none;
    for (const char* file : {"/dev/nvidiactl", "/dev/dxg", "/dev/mali0", "/dev/kgsl-3d0"})
        if (std::filesystem::exists(file, none))
            return true;
    for (const auto& entry : std::filesystem::directory_iterator("/dev/dri", none))
        if (entry.path().filename().string().starts_with("renderD"))
            return true;
    return false;
}

const DeviceReport& choose_device(const std::vector<DeviceReport>& devices, const std::string& wanted, bool needs_f64) {
    const auto usable = [&](const DeviceReport& device) { return refusals(device, needs_f64).empty(); };
    if (wanted.empty()) {
        const auto rank = [&](const DeviceReport& device) {
            return !usable(device)               ? 4
                   : device.software             ? 3
                   : device.type == "discrete"   ? 0
                   : device.type == "integrated" ? 1
                                                 : 2;
        };
        const auto found = std::ranges::min_element(devices, {}, rank);
        if (found != devices.end() && usable(*found))
            return *found;
        throw DeviceError(DeviceError::Kind::no_such_device,
                          "no usable Vulkan device (or use --engine cpu):" + listing(devices, needs_f64));
    }
    bool seen = false;
    for (const DeviceReport& device : devices) {
        if (!is_wanted(device, wanted, devices.size()))
            continue;
        if (usable(device))
            return device;
        seen = true;
    }
    throw DeviceError(DeviceError::Kind::no_such_device,
                      fmt::format("{} \"{}\"; available:{}", seen ? "cannot use the device" : "no such device", wanted,
                                  listing(devices, needs_f64)));
}

Device::Device(const DeviceOptions& options) {
    const DeviceReport chosen = choose_device(list_devices(), options.wanted, options.needs_f64);
    checked("opening " + chosen.name, [&] {
        implementation_ = std::make_unique<Implementation>();
        implementation_->report = chosen;
        implementation_->taken = device_limits();
        const Flushing flushing(implementation_->taken.flush);
        if (options.through_double)
            implementation_->report.nearest = false;
        if (options.validation)
            make_validated_instance(*implementation_, options.gpu_assisted);
        else
            implementation_->loaded = shared_instance();
        implementation_->physical =
            std::move(implementation_->loaded->instance.enumeratePhysicalDevices().at(chosen.index));
        make_device(*implementation_, options);
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

std::vector<std::byte> Device::cache() const {
    return checked("reading the pipeline cache", [&] {
        const std::vector<std::byte> groups = implementation_->groups.kept();
        CacheHead head;
        head.groups = groups.size();
        const auto start = std::as_bytes(std::span(&head, 1));
        std::vector<std::byte> bytes(start.begin(), start.end());
        bytes.insert(bytes.end(), groups.begin(), groups.end());
        for (const std::uint8_t byte : implementation_->pipeline_cache.getData())
            bytes.push_back(static_cast<std::byte>(byte));
        return bytes;
    });
}

std::optional<std::uint64_t> Device::Implementation::free_memory() const {
    if (taken.memory != 0)
        return taken.memory - std::min(taken.memory, allocated);
    if (!tells_budget)
        return std::nullopt;
    const auto chain =
        physical
            .getMemoryProperties2<vk::PhysicalDeviceMemoryProperties2, vk::PhysicalDeviceMemoryBudgetPropertiesEXT>();
    const auto& heaps = chain.get<vk::PhysicalDeviceMemoryProperties2>().memoryProperties;
    const auto& budget = chain.get<vk::PhysicalDeviceMemoryBudgetPropertiesEXT>();
    std::uint64_t free = 0;
    for (std::uint32_t heap = 0; heap < heaps.memoryHeapCount; ++heap)
        if (heaps.memoryHeaps[heap].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
            free = std::max<std::uint64_t>(free, budget.heapBudget[heap] -
                                                     std::min(budget.heapBudget[heap], budget.heapUsage[heap]));
    return free;
}

} // namespace forceshade::compute
