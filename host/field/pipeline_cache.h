// Compiled kernels kept on disk between runs, one file a device: a damaged or foreign file is ignored.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace forceshade {

/// The bytes kept for a device, or none without an intact file. `device` identifies device and driver. Never
/// throws for the file's sake.
std::vector<std::byte> read_pipeline_cache(const std::filesystem::path& folder, const std::string& device);

/// Keeps the bytes; a folder that cannot be written is not an error.
void write_pipeline_cache(const std::filesystem::path& folder, const std::string& device,
                          std::span<const std::byte> bytes);

/// Where they are kept.
std::filesystem::path pipeline_cache_path(const std::filesystem::path& folder, const std::string& device);

/// $XDG_CACHE_HOME/forceshade or ~/.cache/forceshade; empty if neither is known.
std::filesystem::path default_cache_folder();

} // namespace forceshade
