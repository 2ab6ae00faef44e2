#include "compute/device_limits.h"

#include <charconv>
#include <cstdlib>

#include <fmt/format.h>

namespace forceshade::compute {
namespace {

template <typename Number> Number number_of(std::string_view item, std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number > Number(0)))
        throw DeviceError(
            DeviceError::Kind::unsupported,
            fmt::format("{}: \"{}\" needs a number above 0, as in \"memory=268435456\"", kLimitsVariable, item));
    return number;
}

template <typename Number> void lower(Number& number, Number limit) {
    if (limit != 0 && limit < number)
        number = limit;
}

} // namespace

DeviceLimits read_device_limits(std::string_view text) {
    DeviceLimits limits;
    while (!text.empty()) {
        const std::string_view item = text.substr(0, text.find(','));
        text.remove_prefix(std::min(text.size(), item.size() + 1));
        const std::string_view name = item.substr(0, item.find('='));
        const std::string_view value = item.substr(std::min(item.size(), name.size() + 1));
        if (item == "no-f64")
            limits.no_f64 = true;
        else if (item == "no-int64")
            limits.no_int64 = true;
        else if (item == "no-float-controls")
            limits.no_float_controls = true;
        else if (item == "flush")
            limits.flush = true;
        else if (item == "incoherent")
            limits.incoherent = true;
        else if (name == "memory")
            limits.memory = number_of<std::uint64_t>(item, value);
        else if (name == "buffer")
            limits.buffer_range = number_of<std::uint64_t>(item, value);
        else if (name == "group")
            limits.group_invocations = number_of<std::uint32_t>(item, value);
        else if (name == "lost-at")
            limits.lost_at = number_of<std::uint64_t>(item, value);
        else if (name == "short-at")
            limits.short_at = number_of<std::uint64_t>(item, value);
        else if (name == "longest")
            limits.longest = number_of<double>(item, value);
        else
            throw DeviceError(
                DeviceError::Kind::unsupported,
                fmt::format(
                    "{}: \"{}\" is none of no-f64, no-int64, no-float-controls, flush, incoherent, memory=BYTES, "
                    "buffer=BYTES, group=INVOCATIONS, lost-at=SUBMISSION, short-at=BUFFER, longest=SECONDS",
                    kLimitsVariable, item));
    }
    return limits;
}

DeviceLimits device_limits() {
    const char* const text = std::getenv(kLimitsVariable);
    return text ? read_device_limits(text) : DeviceLimits{};
}

void apply(const DeviceLimits& limits, DeviceReport& report) {
    report.f64 = report.f64 && !limits.no_f64;
    report.int64 = report.int64 && !limits.no_int64;
    if (limits.no_float_controls)
        report.single = report.twice = {};
    if (limits.flush)
        report.software = false;
    lower(report.memory, limits.memory);
    lower(report.buffer_range, limits.buffer_range);
    lower(report.group_invocations, limits.group_invocations);
    if (const char* const text = std::getenv(kLimitsVariable); text && *text)
        report.driver += fmt::format(", limited by {}={}", kLimitsVariable, text);
}

} // namespace forceshade::compute
