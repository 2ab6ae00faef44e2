// A channel's rows as raw little-endian numbers at the file's current position; for the formats without compression.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "host/output/files.h"
#include "host/output/rows.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

static_assert(std::endian::native == std::endian::little, "files are written in memory order");

/// Bytes of one component of a channel.
std::size_t component_bytes(std::uint32_t channel, Precision precision);

/// Writes the chunk's rows of a channel, each repeat_y times, reals converted to `precision`. Throws IoError.
template <typename real>
void write_rows(TemporaryFile& file, const layout::FieldChunk<real>& chunk, std::uint32_t channel, std::size_t repeat_y,
                Precision precision);

/// Flushes, hashes, publishes.
VolumeResult publish_raw(TemporaryFile& file);

// One channel of a field as a NumPy array, shape (nz, ny, nx, 3) for vectors and (nz, ny, nx) for scalars, streamed.

/// The bytes before the numbers of an array of a channel.
std::string npy_header(const std::vector<std::uint64_t>& shape, std::uint32_t channel, Precision precision);

class NpyWriter final : public ChunkSink {
public:
    /// `channel` is one layout::kChannel... bit; reals are stored as '<f4' or '<f8', ids as '<u4'. Throws IoError.
    NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
              Precision precision);
    ~NpyWriter() override;
    void write(const AnyFieldChunk& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

// Comma-separated values as RFC 4180 quotes them; numbers print so that they read back exactly, in every locale.

/// One line at a time: `row.add("a,b").add(0.1); row.end();` Lines end in a single line feed.
class CsvText {
public:
    CsvText& add(std::string_view text); /* quoted where it holds a comma, a quote or a line break */
    CsvText& add(const char* text) { return add(std::string_view(text)); }
    CsvText& add(double value); /* shortest text that reads back to the same double */
    CsvText& add(float value);
    CsvText& add(std::integral auto value) { return add(std::string_view(std::to_string(value))); }
    void end();
    const std::string& text() const noexcept { return text_; }

private:
    void separate();
    std::string text_;
    bool first_ = true;
};

// A field as ParaView's ImageData (.vti): raw appended arrays named as the channels, origin and spacing in metres,
// streamed.

struct VtiHeader {
    std::array<std::uint64_t, 3> size{};
    std::array<double, 3> origin{};  /* m */
    std::array<double, 3> spacing{}; /* m */
    std::uint32_t channels = layout::kChannelForce;
    Precision precision = Precision::f32; /* Float32 or Float64 */
};

class VtiWriter final : public ChunkSink {
public:
    /// Throws IoError.
    VtiWriter(const std::filesystem::path& path, const VtiHeader& header);
    ~VtiWriter() override;
    void write(const AnyFieldChunk& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace forceshade
