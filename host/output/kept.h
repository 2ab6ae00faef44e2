// Bytes kept on disk between runs, which only save time: a damaged or foreign file counts as none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/output/files.h"

namespace forceshade {

/// $XDG_CACHE_HOME/forceshade or ~/.cache/forceshade; empty if neither is known.
std::filesystem::path default_cache_folder();

/// `FOLDER/KIND-<16 hex digits>.bin`, by all that the bytes depend on; empty without a folder.
std::filesystem::path kept_path(const std::filesystem::path& folder, const std::string& kind, const std::string& of);

/// Such a file as it is written: its bytes, then their SHA-256. \throws IoError
class KeptWriter {
public:
    explicit KeptWriter(const std::filesystem::path& path);
    void write(std::span<const std::byte> bytes);
    void publish();

private:
    TemporaryFile file_;
    Sha256 digest_;
};

/// What was read is to be trusted after finish() only. \throws IoError without an intact file.
class KeptReader {
public:
    explicit KeptReader(const std::filesystem::path& path);
    /// Bytes that are left to be read.
    std::uint64_t left() const noexcept { return end_ - at_; }
    void read(std::span<std::byte> bytes);
    void finish();

private:
    ReadableFile file_;
    Sha256 digest_;
    std::uint64_t at_ = 0, end_ = 0;
};

/// The bytes of a small file, or none without an intact one. Never throws for the file's sake.
std::vector<std::byte> read_kept(const std::filesystem::path& path);
/// Keeps them; a folder that cannot be written is not an error.
void write_kept(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Removes the files of a kind that were used the longest ago until the others have no more than `most` bytes.
void limit_kept(const std::filesystem::path& folder, const std::string& kind, std::uint64_t most);

} // namespace forceshade
