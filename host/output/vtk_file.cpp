#include "host/output/vtk_file.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "host/output/deflate.h"
#include "host/output/raw_formats.h"
#include "host/output/reading.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr std::uint64_t kBlockBytes = 1 << 18; // compressed at once
constexpr std::size_t kBlockCounts = 3;        // that stand before the sizes of the blocks

std::uint64_t blocks_of(std::uint64_t bytes) {
    return (bytes + kBlockBytes - 1) / kBlockBytes;
}

} // namespace

VtkFile::VtkFile(const std::filesystem::path& path, std::string_view kind, std::vector<VtkArray> arrays,
                 std::string after)
    : file_(path), kind_(kind), after_(std::move(after)) {
    for (VtkArray& description : arrays) {
        Array& array = arrays_.emplace_back();
        array.bytes = description.samples * description.components * (description.type.ends_with("64") ? 8 : 4);
        array.header = {blocks_of(array.bytes), kBlockBytes, array.bytes % kBlockBytes};
        if (arrays_.size() > 1)
            array.aside = std::make_unique<TemporaryFile>(path.string() + "." + description.name);
        array.description = std::move(description);
    }
    file_.write(make_xml()); // both take their room now and are written at the end
    file_.seek(file_.tell() + (kBlockCounts + blocks_of(arrays_.front().bytes)) * sizeof(std::uint64_t));
}

// All up to the appended data, which begins after the underscore. As long whatever the offsets are.
std::string VtkFile::make_xml() const {
    std::string xml =
        fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
                    "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n",
                    kind_);
    for (const Array& array : arrays_)
        xml += fmt::format(
            "{}<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{:020}\"/>\n",
            array.description.before, array.description.type, array.description.name, array.description.components,
            array.offset);
    return xml + after_ + "<AppendedData encoding=\"raw\">\n_";
}

void VtkFile::write(std::string_view name, std::span<const std::byte> bytes) {
    const auto array =
        std::ranges::find_if(arrays_, [&](const Array& candidate) { return candidate.description.name == name; });
    if (array == arrays_.end() || bytes.size() > array->bytes - array->written)
        throw std::logic_error(
            fmt::format("{} has no room for {} bytes of {}", file_.path().filename().string(), bytes.size(), name));
    array->written += bytes.size();
    while (!bytes.empty()) {
        const std::size_t part = std::min<std::size_t>(bytes.size(), kBlockBytes - array->block.size());
        array->block.insert(array->block.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(part));
        bytes = bytes.subspan(part);
        if (array->block.size() == kBlockBytes)
            flush_block(*array);
    }
}

void VtkFile::flush_block(Array& array) {
    if (array.block.empty())
        return;
    deflate(array.block, array.packed);
    array.header.push_back(array.packed.size());
    file_of(array).write(array.packed);
    array.block.clear();
}

// What stands aside follows what is in the file.
void VtkFile::append(Array& array) {
    file_.write(std::as_bytes(std::span(array.header)));
    array.aside->flush_to_disk();
    const ReadableFile from(array.aside->temporary_path());
    std::vector<std::byte> part(kBlockBytes);
    for (std::uint64_t offset = 0;;) {
        check_interrupt();
        const std::size_t got = from.read_some(offset, part);
        file_.write(std::span(part).first(got));
        offset += got;
        if (got < part.size())
            return;
    }
}

VolumeResult VtkFile::finish() {
    const std::uint64_t data = make_xml().size();
    for (Array& array : arrays_) {
        if (array.written != array.bytes)
            throw std::logic_error(fmt::format("{}: {} of {} bytes of {} have come", file_.path().filename().string(),
                                               array.written, array.bytes, array.description.name));
        flush_block(array);
        array.offset = array.aside ? file_.tell() - data : 0;
        if (array.aside)
            append(array);
        array.aside.reset();
    }
    file_.write(std::string_view("\n</AppendedData>\n</VTKFile>\n"));
    file_.seek(0);
    file_.write(make_xml());
    file_.write(std::as_bytes(std::span(arrays_.front().header)));
    return publish_raw(file_);
}

VtkFile make_vtp(const std::filesystem::path& path, PolyData data) {
    const char* const element = data.polygons ? "Polys" : "Lines";
    std::vector<VtkArray> arrays;
    // XML in front of the next array.
    std::string before =
        fmt::format("<PolyData>\n{}<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{}\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n<PointData {}>\n",
                    data.field_data, data.points, data.polygons ? 0 : data.cells, data.polygons ? data.cells : 0,
                    data.active_points);
    const auto add = [&](VtkArray array) {
        array.before = std::move(before);
        before.clear();
        arrays.push_back(std::move(array));
    };
    for (VtkArray& array : data.point_data)
        add(std::move(array));
    before += fmt::format("</PointData>\n<CellData {}>\n", data.active_cells);
    for (VtkArray& array : data.cell_data)
        add(std::move(array));
    before += "</CellData>\n<Points>\n";
    add({"Points", data.point_type, 3, data.points});
    before += fmt::format("</Points>\n<{}>\n", element);
    add({"connectivity", vtk_type<std::int64_t>(), 1, data.corners});
    add({"offsets", vtk_type<std::int64_t>(), 1, data.cells});
    return {path, "PolyData", std::move(arrays), fmt::format("</{}>\n</Piece>\n</PolyData>\n", element)};
}

} // namespace forceshade
