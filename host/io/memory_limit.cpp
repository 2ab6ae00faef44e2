#include "host/io/memory_limit.h"

#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "host/error.h"

namespace forceshade {
namespace {

std::atomic<std::uint64_t> limit = kDefaultMemory;

constexpr std::array<std::pair<std::string_view, double>, 8> kUnits{{{"kB", 1e3},
                                                                     {"MB", 1e6},
                                                                     {"GB", 1e9},
                                                                     {"TB", 1e12},
                                                                     {"KiB", 0x1p10},
                                                                     {"MiB", 0x1p20},
                                                                     {"GiB", 0x1p30},
                                                                     {"TiB", 0x1p40}}};

/// Rounded to whole MiB or tenths of a GiB: what is needed up, what is allowed down, so that they differ.
std::string in_words(double bytes, double (*rounded)(double)) {
    return bytes < 0x1p30 ? fmt::format("{:.0f} MiB", rounded(bytes / 0x1p20))
                          : fmt::format("{:.1f} GiB", rounded(bytes / 0x1p30 * 10) / 10);
}

} // namespace

std::uint64_t parse_memory(const std::string& text) {
    double number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
    for (const auto& [name, bytes] : kUnits)
        if (error == std::errc() && (unit == name || (unit.starts_with(' ') && unit.substr(1) == name)))
            if (const double all = number * bytes; all >= 1 && all < 0x1p63)
                return static_cast<std::uint64_t>(all);
    throw UsageError(
        fmt::format("--max-memory {}: it is a number with kB, MB, GB, TB, KiB, MiB, GiB or TiB, for example "
                    "\"8 GiB\"",
                    text));
}

void set_memory_limit(std::uint64_t bytes) {
    limit = bytes;
}

void require_memory(const std::filesystem::path& file, const std::string& what, double bytes) {
    if (const auto most = static_cast<double>(limit.load()); bytes > most)
        throw UsageError(fmt::format("{}: {} needs about {} of memory, more than the {} that are allowed: make it "
                                     "smaller, or say --max-memory \"{}\"",
                                     file.string(), what, in_words(bytes, std::ceil), in_words(most, std::floor),
                                     in_words(bytes, std::ceil)));
}

} // namespace forceshade
