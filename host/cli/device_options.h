// The options of a device, its loop and its safety: those of live and of experiment.
#pragma once

#include <cstdint>
#include <optional>

#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/scene/quantity.h"

namespace forceshade {

struct DeviceArguments {
    device::SessionOptions session; /* what the options say directly */
    std::optional<double> damping;  /* N s/m */
    bool without_fade = false;
};

void describe_device(Options& options, DeviceArguments& arguments);
void describe_safety(Options& options, DeviceArguments& arguments);

/// A quantity that must be positive; `flag` as "--duration TIME", in SI units.
void read_positive(Options& options, const char* flag, std::optional<double>& value, Dimension dimension,
                   const char* help);

/// A button's number. \throws UsageError.
unsigned read_button(const char* flag, const std::string& text);

/// What --port says: of a page on this machine; 0: any that is free. \throws UsageError.
std::uint16_t page_port(const std::optional<int>& port);

/// \throws UsageError for what does not fit together.
device::SessionOptions checked_options(const DeviceArguments& arguments);

/// Who guides a check: a person at the terminal; no one for a simulated hand, or where the device is `held` in any
/// case.
device::CheckGuide check_guide(const DeviceArguments& arguments, bool held, const CommonOptions& common);

} // namespace forceshade
