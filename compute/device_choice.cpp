#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "compute/device.h"

namespace forceshade::compute {
namespace {

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

const DeviceReport& choose_device(const std::vector<DeviceReport>& devices, const std::string& wanted, bool needs_f64) {
    const auto usable = [&](const DeviceReport& device) { return refusals(device, needs_f64).empty(); };
    if (wanted.empty()) {
        auto found = std::find_if(devices.begin(), devices.end(),
                                  [&](const DeviceReport& device) { return device.software && usable(device); });
        if (found == devices.end())
            found = std::find_if(devices.begin(), devices.end(), usable);
        if (found != devices.end())
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
                      fmt::format("{} \"{}\"; there is:{}", seen ? "cannot use the device" : "no such device", wanted,
                                  listing(devices, needs_f64)));
}

} // namespace forceshade::compute
