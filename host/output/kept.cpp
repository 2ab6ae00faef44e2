#include "host/output/kept.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "host/program.h"

namespace forceshade {

namespace {

constexpr std::size_t kDigest = 64;                 // hex digits of the SHA-256 at a file's end
constexpr std::uint64_t kLargestSmall = 256u << 20; // bytes; a larger file is not ours
constexpr const char* kSuffix = ".bin";

} // namespace

std::filesystem::path default_cache_folder() {
    if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
        return std::filesystem::path(folder) / "forceshade";
    if (const char* home = std::getenv("HOME"); home && *home)
        return std::filesystem::path(home) / ".cache" / "forceshade";
    return {};
}

std::filesystem::path kept_path(const std::filesystem::path& folder, const std::string& kind, const std::string& of) {
    return folder.empty() ? folder : folder / (kind + "-" + sha256_of(of).substr(0, 16) + kSuffix);
}

KeptWriter::KeptWriter(const std::filesystem::path& path) : file_(path) {}

void KeptWriter::write(std::span<const std::byte> bytes) {
    digest_.update(bytes);
    file_.write(bytes);
}

void KeptWriter::publish() {
    file_.write(digest_.finish());
    file_.publish(false); // what a crash leaves has another digest
}

KeptReader::KeptReader(const std::filesystem::path& path) : file_(path) {
    if (file_.size() < kDigest)
        throw IoError("{} is damaged: it has {} bytes", path.string(), file_.size());
    end_ = file_.size() - kDigest;
}

void KeptReader::read(std::span<std::byte> bytes) {
    if (bytes.size() > left() || file_.read_some(at_, bytes) != bytes.size())
        throw IoError("{} is damaged: it ends at byte {}", file_.path().string(), end_);
    digest_.update(bytes);
    at_ += bytes.size();
}

void KeptReader::finish() {
    std::string expected(kDigest, '\0');
    if (left() > 0 || file_.read_some(end_, std::as_writable_bytes(std::span(expected))) != kDigest ||
        digest_.finish() != expected)
        throw IoError("{} is damaged: its SHA-256 is not the one at its end", file_.path().string());
}

std::vector<std::byte> read_kept(const std::filesystem::path& path) {
    std::error_code error;
    if (path.empty() || !std::filesystem::is_regular_file(path, error))
        return {};
    try {
        KeptReader file(path);
        if (file.left() > kLargestSmall)
            return {};
        std::vector<std::byte> bytes(file.left());
        file.read(bytes);
        file.finish();
        return bytes;
    } catch (const IoError& damage) {
        log_line(fmt::format("{}; it is made anew", damage.what()));
        return {};
    }
}

void write_kept(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    if (path.empty() || bytes.empty())
        return;
    try {
        std::filesystem::create_directories(path.parent_path());
        KeptWriter file(path);
        file.write(bytes);
        file.publish();
    } catch (const std::exception& error) {
        log_line(fmt::format("not kept for later runs: {}", error.what()));
    }
}

void limit_kept(const std::filesystem::path& folder, const std::string& kind, std::uint64_t most) {
    struct Kept {
        std::filesystem::file_time_type used;
        std::uint64_t bytes;
        std::filesystem::path path;
    };
    std::vector<Kept> files;
    std::error_code error;
    for (const auto& one : std::filesystem::directory_iterator(folder, error))
        if (const std::string name = one.path().filename().string();
            name.starts_with(kind + "-") && name.ends_with(kSuffix))
            files.push_back({one.last_write_time(error), one.file_size(error), one.path()});
    std::ranges::sort(files, std::greater(), &Kept::used);
    std::uint64_t sum = 0;
    for (const Kept& file : files)
        if (sum + file.bytes > most)
            std::filesystem::remove(file.path, error);
        else
            sum += file.bytes;
}

} // namespace forceshade
