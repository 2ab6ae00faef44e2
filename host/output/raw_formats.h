// NPY, VTI and CSV.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "host/output/files.h"
#include "host/output/rows.h"
#include "host/output/vtk_file.h"
#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

static_assert(std::endian::native == std::endian::little, "files are written in memory order");

/// Flushes, hashes, publishes.
VolumeResult publish_raw(TemporaryFile& file);

// One channel of a field as a NumPy array, shape (nz, ny, nx, 3) for vectors and (nz, ny, nx) for scalars, streamed.

/// The bytes before the numbers of an array of a channel; `shape` without the components of a sample.
std::string npy_header(std::vector<std::uint64_t> shape, std::uint32_t channel, Precision precision,
                       const glm::dvec3& origin);

class NpyWriter final : public ChunkSink {
public:
    /// `channel` is one layout::kChannel... bit; reals are stored as '<f4' or '<f8', ids as '<u4'. `origin`, m, in the
    /// world: what proxies are measured from. Throws IoError.
    NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
              Precision precision, const glm::dvec3& origin = glm::dvec3(0));
    void write(const AnyFieldChunk& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    TemporaryFile file_;
    RowOrder order_;
    std::uint32_t channel_;
    Precision precision_;
    glm::dvec3 origin_; /* m */
};

// Comma-separated values as RFC 4180 quotes them; numbers print so that they read back exactly, in every locale.

/// One line at a time: `row.add("a,b").add(0.1).end();` Lines end in a single line feed; the last is to be ended.
class CsvText {
public:
    /// Quoted where it holds a comma, a quote or a line break, or begins or ends with a blank.
    CsvText& add(std::string_view text);
    CsvText& add(const char* text) { return add(std::string_view(text)); }
    CsvText& add(std::floating_point auto value) { return add(fmt::format("{}", value)); } /* reads back the same */
    CsvText& add(std::integral auto value) { return add(std::string_view(std::to_string(value))); }
    void end() { text_.back() = '\n'; } // in place of the last comma
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_;
};

// A field as ParaView's ImageData (.vti): compressed appended arrays named as the channels, force active, origin and
// spacing in metres, streamed. Out of contact the facet is -1.

struct VtiHeader {
    std::array<std::uint64_t, 3> size{};
    std::array<double, 3> origin{};  /* m */
    std::array<double, 3> spacing{}; /* m */
    std::uint32_t channels = layout::kChannelForce;
    Precision precision = Precision::f32; /* Float32 or Float64 */
    glm::dvec3 place_origin{0};           /* m, in the world: what proxies are measured from */
};

class VtiWriter final : public ChunkSink {
public:
    /// Throws IoError.
    VtiWriter(const std::filesystem::path& path, const VtiHeader& header);
    void write(const AnyFieldChunk& chunk, std::size_t repeat_y) override;
    VolumeResult finish() override;

private:
    RowOrder order_;
    VtiHeader header_;
    VtkFile file_;
};

} // namespace forceshade
