#include "compute/float_controls.h"

#include <array>
#include <cstring>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::compute {
namespace {

// Of the SPIR-V specification.
constexpr std::size_t kHeader = 5; // words
constexpr std::uint32_t kOpExtension = 10, kOpEntryPoint = 15, kOpExecutionMode = 16, kOpCapability = 17;
constexpr std::uint32_t kFloat64 = 10;
constexpr std::string_view kExtension = "SPV_KHR_float_controls";

struct Control {
    bool FloatControls::*offered;
    std::uint32_t capability, mode;
};
constexpr std::array kControls{Control{&FloatControls::denormals, 4464, 4459},
                               Control{&FloatControls::special, 4466, 4461},
                               Control{&FloatControls::nearest_even, 4467, 4462}};

using Words = std::vector<std::uint32_t>;

std::uint32_t opening(std::uint32_t operation, std::size_t words) {
    return static_cast<std::uint32_t>(words) << 16 | operation;
}

} // namespace

std::string text_of(const FloatControls& controls) {
    std::vector<const char*> kept;
    for (const auto& [offered, name] : {std::pair(&FloatControls::denormals, "denormals"),
                                        {&FloatControls::special, "infinities and NaN"},
                                        {&FloatControls::nearest_even, "nearest"}})
        if (controls.*offered)
            kept.push_back(name);
    return fmt::format("{}", fmt::join(kept, ", "));
}

std::vector<std::uint32_t> with_float_controls(std::span<const std::uint32_t> kernel, const FloatControls& single,
                                               const FloatControls& twice) {
    // Where each comes: capabilities first, extensions behind them, execution modes behind the entry point.
    std::size_t capabilities = kHeader, modes = kHeader;
    std::uint32_t entry = 0;
    bool in_double = false;
    for (std::size_t at = kHeader; at < kernel.size() && entry == 0; at += kernel[at] >> 16) {
        const std::uint32_t operation = kernel[at] & 0xFFFFu;
        if (operation == kOpCapability) {
            capabilities = at + 2;
            in_double = in_double || kernel[at + 1] == kFloat64;
        } else if (operation == kOpEntryPoint) {
            entry = kernel[at + 2];
            modes = at + (kernel[at] >> 16);
        }
    }
    Words asked, how;
    for (const Control& control : kControls) {
        bool wanted = false;
        for (const auto& [controls, width] : {std::pair(&single, 32u), {&twice, 64u}})
            if (controls->*control.offered && (width == 32 || in_double)) {
                how.insert(how.end(), {opening(kOpExecutionMode, 4), entry, control.mode, width});
                wanted = true;
            }
        if (wanted)
            asked.insert(asked.end(), {opening(kOpCapability, 2), control.capability});
    }
    if (asked.empty() || entry == 0)
        return {kernel.begin(), kernel.end()};
    Words extension(1 + kExtension.size() / sizeof(std::uint32_t) + 1);
    extension[0] = opening(kOpExtension, extension.size());
    std::memcpy(&extension[1], kExtension.data(), kExtension.size());
    Words all(kernel.begin(), kernel.begin() + static_cast<std::ptrdiff_t>(capabilities));
    const auto add = [&](auto&& words) { all.insert(all.end(), words.begin(), words.end()); };
    add(asked);
    add(extension);
    add(kernel.subspan(capabilities, modes - capabilities));
    add(how);
    add(kernel.subspan(modes));
    return all;
}

} // namespace forceshade::compute
