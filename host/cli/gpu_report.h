// forceshade doctor --gpu-report: what a machine's Vulkan devices compute, how right and how fast, in a folder to send.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "compute/device.h"
#include "host/cli/command.h"

namespace forceshade {

/// What the driver says of a device.
nlohmann::ordered_json json_of(const compute::DeviceReport& device);

/// Of the device that is asked for, or of every usable one: each law in both precisions against the oracle and timed,
/// and the bandwidths that bound it; of several devices all at once, too. Writes report.md and report.json; a minute or
/// two. Returns whether all agree. \throws UsageError for a folder that is there already, compute::DeviceError,
/// IoError.
bool write_gpu_report(const std::filesystem::path& folder, const CommonOptions& common);

} // namespace forceshade
