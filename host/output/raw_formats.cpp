#include "host/output/raw_formats.h"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/output/files.h"
#include "host/output/rows.h"
#include "host/program.h"

namespace forceshade {

namespace {

template <typename Stored, typename Target, typename Value>
void write_rows_as(Target& file, std::span<const Value> values, std::size_t rows, std::size_t pitch, std::size_t count,
                   std::size_t repeat_y) {
    std::vector<Stored> row(count);
    for (std::size_t r = 0; r < rows; ++r) {
        check_interrupt();
        for (std::size_t i = 0; i < count; ++i)
            row[i] = static_cast<Stored>(values[r * pitch + i]);
        for (std::size_t copy = 0; copy < repeat_y; ++copy)
            file.write(std::as_bytes(std::span(row)));
    }
}

// Writes the chunk's rows of a channel, each repeat_y times, reals converted to `precision`; proxies whose origin is
// not 0 as doubles in the world. Throws IoError.
template <typename Target>
void write_rows(Target& file, const AnyFieldChunk& any, std::uint32_t channel, std::size_t repeat_y,
                Precision precision, const glm::dvec3& origin) {
    const auto write = [&](const auto& chunk) {
        const std::size_t components = components_of(channel), rows = chunk.y_count * chunk.z_count;
        const std::size_t pitch = chunk.x_pitch * components, count = chunk.x_count * components;
        if (channel == layout::kChannelFacet)
            write_rows_as<std::uint32_t>(file, ids_of(chunk), rows, pitch, count, repeat_y);
        else if (is_moved(channel, origin))
            write_rows_as<double>(file, std::span<const double>(in_world(values_of(chunk, channel), origin)), rows,
                                  pitch, count, repeat_y);
        else if (precision == Precision::f64)
            write_rows_as<double>(file, values_of(chunk, channel), rows, pitch, count, repeat_y);
        else
            write_rows_as<float>(file, values_of(chunk, channel), rows, pitch, count, repeat_y);
    };
    std::visit(write, any);
}

} // namespace

VolumeResult publish_raw(TemporaryFile& file) {
    VolumeResult result;
    timed(result.timings.flush, [&] { file.flush_to_disk(); });
    timed(result.timings.hash, [&] { result.sha256 = file.sha256(); });
    result.bytes = std::filesystem::file_size(file.temporary_path());
    file.publish();
    return result;
}

// Format version 1.0; NumPy wants the data to begin at a multiple of 64 bytes.
std::string npy_header(std::vector<std::uint64_t> shape, std::uint32_t channel, Precision precision,
                       const glm::dvec3& origin) {
    if (components_of(channel) == 3)
        shape.push_back(3);
    const bool is_double = precision == Precision::f64 || is_moved(channel, origin);
    const char* type = channel == layout::kChannelFacet ? "<u4" : is_double ? "<f8" : "<f4";
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}", type,
                                   fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
    constexpr std::size_t kPreamble = 10;
    text.resize((kPreamble + text.size() + 1 + 63) / 64 * 64 - kPreamble - 1, ' ');
    text += '\n';
    std::string preamble("\x93NUMPY\x01\x00", 8);
    preamble += static_cast<char>(text.size() & 0xff);
    preamble += static_cast<char>(text.size() >> 8);
    return preamble + text;
}

NpyWriter::NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
                     Precision precision, const glm::dvec3& origin)
    : file_(path, true), order_(size), channel_(channel), precision_(precision), origin_(origin) {
    file_.write(npy_header({size.rbegin(), size.rend()}, channel, precision, origin));
}

void NpyWriter::write(const AnyFieldChunk& chunk, std::size_t repeat_y) {
    order_.accept(chunk, repeat_y);
    write_rows(file_, chunk, channel_, repeat_y, precision_, origin_);
}

VolumeResult NpyWriter::finish() {
    order_.require_complete();
    return publish_raw(file_);
}

CsvText& CsvText::add(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t'; }; // which readers may take off a cell
    const bool plain = text.find_first_of(",\"\r\n") == std::string_view::npos &&
                       (text.empty() || (!is_blank(text.front()) && !is_blank(text.back())));
    const char* const quote = plain ? "" : "\"";
    text_ += quote;
    for (const char c : text)
        text_.append(c == '"' ? 2 : 1, c);
    text_ += quote;
    text_ += ',';
    return *this;
}

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

namespace {

// Where write_rows puts a channel's samples.
struct VtiTarget {
    VtkFile& file;
    const char* name;
    void write(std::span<const std::byte> bytes) { file.write(name, bytes); }
};

std::vector<VtkArray> vti_arrays(const VtiHeader& header) {
    const auto& [size, origin, spacing, channels, precision, place_origin] = header;
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", size[0] - 1, size[1] - 1, size[2] - 1);
    const char* scalars = channels & layout::kChannelDepth   ? " Scalars=\"depth\""
                          : channels & layout::kChannelFacet ? " Scalars=\"facet\""
                                                             : "";
    std::vector<VtkArray> arrays;
    for (const std::uint32_t channel : kFieldChannels)
        if (channels & channel)
            arrays.push_back({name_of_channel(channel),
                              channel == layout::kChannelFacet ? "Int32" // what UInt32 calls no facet is -1
                              : precision == Precision::f64 || is_moved(channel, place_origin) ? "Float64"
                                                                                               : "Float32",
                              components_of(channel), size[0] * size[1] * size[2]});
    arrays.front().before = fmt::format("<ImageData WholeExtent=\"{}\" Origin=\"{}\" Spacing=\"{}\">\n"
                                        "<Piece Extent=\"{}\">\n<PointData Vectors=\"force\"{}>\n",
                                        extent, fmt::join(origin, " "), fmt::join(spacing, " "), extent, scalars);
    return arrays;
}

} // namespace

VtiWriter::VtiWriter(const std::filesystem::path& path, const VtiHeader& header)
    : order_(header.size), header_(header),
      file_(path, "ImageData", vti_arrays(header), "</PointData>\n<CellData/>\n</Piece>\n</ImageData>\n") {}

void VtiWriter::write(const AnyFieldChunk& chunk, std::size_t repeat_y) {
    order_.accept(chunk, repeat_y);
    for (const std::uint32_t channel : kFieldChannels)
        if (header_.channels & channel) {
            VtiTarget target{file_, name_of_channel(channel)};
            write_rows(target, chunk, channel, repeat_y, header_.precision, header_.place_origin);
        }
}

VolumeResult VtiWriter::finish() {
    order_.require_complete();
    return file_.finish();
}

} // namespace forceshade
