// NPY, VTI, VTP and CSV, and what compresses the blocks of EXR, VTI and VTP files.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "host/output/files.h"
#include "host/output/rows.h"
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

// Files in VTK's XML form, for ParaView: the arrays stand behind the XML, compressed in blocks, as they are streamed.

/// Library and version, which decide a file's bytes: "libdeflate 1.14".
std::string deflate_name();

/// libdeflate's level: packs a field's blocks in 0.7 of the time of OpenEXR's 4, to 0.1 % more bytes.
inline constexpr int kDeflateLevel = 1;
/// In zlib's format. The same bytes on every machine. \throws std::bad_alloc, std::runtime_error if what was packed is
/// not what comes out again.
void deflate(std::span<const std::byte> from, std::vector<std::byte>& to, int level = kDeflateLevel);

/// CRC-32 of bytes that follow others, whose own is `before`.
std::uint32_t crc32_of(std::span<const std::byte> bytes, std::uint32_t before);

struct VtkArray {
    std::string name;       /* other than that of any array of the file */
    std::string_view type;  /* Float32, Float64, Int32 or Int64 */
    std::size_t components; /* of a sample */
    std::uint64_t samples;
    std::string before{}; /* XML that stands between it and the array before it */
};

/// What VTK calls the numbers of a T.
template <typename T> constexpr std::string_view vtk_type() {
    return std::is_same_v<T, float>          ? "Float32"
           : std::is_same_v<T, double>       ? "Float64"
           : std::is_same_v<T, std::int32_t> ? "Int32"
                                             : "Int64";
}

/// Arrays in a compressed file of VTK. Samples come in order within an array; how arrays take turns, and in which
/// pieces they come, makes no difference to the bytes. Memory does not grow with the samples: an array is compressed as
/// it comes, the first one into the file itself, each other one into a separate file that is appended at the end.
/// Numbers are stored as they are, NaN and infinite ones too. A file that is destroyed before finish() leaves no file.
class VtkFile {
public:
    /// `kind`: ImageData or PolyData. `after`: XML that stands behind the last array. \throws IoError, as do the
    /// others.
    VtkFile(const std::filesystem::path& path, std::string_view kind, std::vector<VtkArray> arrays, std::string after);

    /// The next bytes of the array of this name.
    void write(std::string_view name, std::span<const std::byte> bytes);
    /// Publishes. \throws std::logic_error if samples are missing.
    VolumeResult finish();

private:
    struct Array {
        VtkArray description;
        std::uint64_t bytes;                  /* of all samples */
        std::uint64_t written = 0;            /* bytes */
        std::unique_ptr<TemporaryFile> aside; /* null: the first */
        std::vector<std::byte> block, packed; /* the samples that are not compressed yet; room */
        std::vector<std::uint64_t> header;    /* blocks, bytes of a block, of the last one, of each compressed */
        std::uint64_t offset = 0;             /* of its header in the appended data */
    };

    std::string make_xml() const;
    TemporaryFile& file_of(Array& array) { return array.aside ? *array.aside : file_; }
    void flush_block(Array& array);
    void append(Array& array);

    TemporaryFile file_;
    std::string kind_, after_;
    std::vector<Array> arrays_;
};

/// Polygons or polylines with numbers on points and on cells.
struct PolyData {
    bool polygons = true; /* false: polylines */
    std::uint64_t points = 0, cells = 0;
    std::uint64_t corners = 0;                        /* of all cells */
    std::string_view point_type = vtk_type<double>(); /* of coordinates */
    std::vector<VtkArray> point_data, cell_data;
    std::string active_points, active_cells; /* attributes of their elements: "Vectors=\"force\"" */
    std::string field_data;                  /* XML about the whole file; may be empty */
};

/// A file (.vtp) of `data`; besides its arrays it has `Points`, 3 numbers a point, `connectivity`, std::int64_t, the
/// point of each corner, and `offsets`, std::int64_t, the corners up to the end of each cell. \throws IoError.
VtkFile make_vtp(const std::filesystem::path& path, PolyData data);

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
