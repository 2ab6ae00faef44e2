#include "host/field/pipeline_cache.h"

#include <cstdlib>
#include <fstream>

#include <spdlog/spdlog.h>

#include "host/output/files.h"

namespace forceshade {

namespace {

constexpr std::size_t kDigest = 64;             // hex digits of the SHA-256 that the file begins with
constexpr std::uintmax_t kLargest = 256u << 20; // bytes; a larger file is not ours

} // namespace

std::filesystem::path pipeline_cache_path(const std::filesystem::path& folder, const std::string& device) {
    return folder / ("pipelines-" + sha256_of(device).substr(0, 16) + ".bin");
}

std::vector<std::byte> read_pipeline_cache(const std::filesystem::path& folder, const std::string& device) {
    if (folder.empty())
        return {};
    const std::filesystem::path path = pipeline_cache_path(folder, device);
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || size < kDigest || size > kLargest)
        return {};
    std::string content(size, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(content.data(), static_cast<std::streamsize>(size));
    const std::span<const std::byte> bytes = std::as_bytes(std::span(content)).subspan(kDigest);
    if (!file || content.substr(0, kDigest) != sha256_of(bytes)) {
        spdlog::info("{} is damaged: kernels are compiled anew", path.string());
        return {};
    }
    return {bytes.begin(), bytes.end()};
}

void write_pipeline_cache(const std::filesystem::path& folder, const std::string& device,
                          std::span<const std::byte> bytes) {
    if (folder.empty() || bytes.empty())
        return;
    try {
        std::filesystem::create_directories(folder);
        std::string content = sha256_of(bytes);
        content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        write_file_atomically(pipeline_cache_path(folder, device), content);
    } catch (const std::exception& error) {
        spdlog::debug("compiled kernels are not kept: {}", error.what());
    }
}

std::filesystem::path default_cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return std::filesystem::path(folder) / "forceshade";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "forceshade";
    return {};
}

} // namespace forceshade
