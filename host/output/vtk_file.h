// Files in VTK's XML form, for ParaView: the arrays stand behind the XML, compressed in blocks, as they are streamed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "host/output/files.h"
#include "host/output/rows.h"

namespace forceshade {

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

} // namespace forceshade
