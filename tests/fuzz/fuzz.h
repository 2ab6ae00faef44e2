// What the fuzz targets share: how they tell a defect, how bytes become numbers, and files in memory.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

namespace forceshade::fuzz {

/// Ends the process where something does not hold: libFuzzer keeps the input then.
template <typename... Parts> void require(bool holds, fmt::format_string<Parts...> what, Parts&&... parts) {
    if (holds)
        return;
    fmt::print(stderr, "defect: {}\n", fmt::format(what, std::forward<Parts>(parts)...));
    std::fflush(stderr);
    std::abort();
}

/// The input, taken from the front; zeros behind its end.
class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : text_(reinterpret_cast<const char*>(data), size) {}

    bool empty() const { return text_.empty(); }
    std::string_view rest() const { return text_; }
    std::uint8_t byte() {
        if (text_.empty())
            return 0;
        const auto byte = static_cast<std::uint8_t>(text_.front());
        text_.remove_prefix(1);
        return byte;
    }
    /// Of a byte; `count` is at most 256.
    std::size_t below(std::size_t count) { return byte() % count; }
    std::uint64_t bits() {
        std::uint64_t bits = 0;
        for (int i = 0; i < 8; ++i)
            bits = bits << 8 | byte();
        return bits;
    }
    /// Up to so many bytes.
    std::string_view text(std::size_t most) {
        const std::string_view text = text_.substr(0, most);
        text_.remove_prefix(text.size());
        return text;
    }
    /// Mostly eighths from -2 to 2, some of them hardly moved; else of any size that a double has.
    double number() {
        const std::uint8_t kind = byte();
        const double eighths = static_cast<double>(kind % 33) / 8 - 2;
        if (kind < 33 * 5)
            return eighths;
        if (kind < 33 * 7)
            return eighths + std::ldexp(static_cast<double>(byte()) - 128, -static_cast<int>(byte() % 80));
        const auto any = std::bit_cast<double>(bits());
        return std::isfinite(any) ? any : 0;
    }

private:
    std::string_view text_;
};

/// A file in memory, for what reads files by their names.
class MemoryFile {
public:
    MemoryFile() : descriptor_(::memfd_create("fuzz", 0)) {
        if (descriptor_ < 0)
            throw std::runtime_error("no file in memory");
    }
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;

    /// Replaces what is in it.
    void write(std::string_view bytes) {
        require(::ftruncate(descriptor_, 0) == 0 &&
                    ::pwrite(descriptor_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()),
                "the file in memory is full");
    }
    std::filesystem::path path() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

private:
    int descriptor_;
};

/// A folder of its own, in memory where the machine has such a place.
class Folder {
public:
    Folder() {
        std::string name =
            std::filesystem::exists("/dev/shm") ? "/dev/shm/forceshade-XXXXXX" : "/tmp/forceshade-XXXXXX";
        require(::mkdtemp(name.data()) != nullptr, "no folder");
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

} // namespace forceshade::fuzz
