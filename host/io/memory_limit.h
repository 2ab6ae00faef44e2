// How much memory a file's contents may take: what a few bytes announce can be more than the machine has.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace forceshade {

inline constexpr std::uint64_t kDefaultMemory = 4ull << 30; /* bytes */

/// "4 GiB", "500 MB": a number and kB, MB, GB, TB, KiB, MiB, GiB or TiB. \throws UsageError
std::uint64_t parse_memory(const std::string& text);

/// For the whole process; kDefaultMemory until it is set.
void set_memory_limit(std::uint64_t bytes);

/// \throws UsageError `FILE: WHAT needs about 8.6 GB of memory, more than ...` if `bytes`, expected from the file's
/// header or size, are more than the limit. To be called before anything of that size is allocated.
void require_memory(const std::filesystem::path& file, const std::string& what, double bytes);

} // namespace forceshade
