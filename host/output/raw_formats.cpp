#include "host/output/raw_formats.h"

#include <span>
#include <vector>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/output/files.h"
#include "host/output/rows.h"

namespace forceshade {

namespace {

template <typename Stored, typename Value>
void write_rows_as(TemporaryFile& file, std::span<const Value> values, std::size_t rows, std::size_t pitch,
                   std::size_t count, std::size_t repeat_y) {
    std::vector<Stored> row(count);
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t i = 0; i < count; ++i)
            row[i] = static_cast<Stored>(values[r * pitch + i]);
        for (std::size_t copy = 0; copy < repeat_y; ++copy)
            file.write(std::as_bytes(std::span(row)));
    }
}

// Writes the chunk's rows of a channel, each repeat_y times, reals converted to `precision`. Throws IoError.
void write_rows(TemporaryFile& file, const AnyFieldChunk& any, std::uint32_t channel, std::size_t repeat_y,
                Precision precision) {
    const auto write = [&](const auto& chunk) {
        const std::size_t components = components_of(channel), rows = chunk.y_count * chunk.z_count;
        const std::size_t pitch = chunk.x_pitch * components, count = chunk.x_count * components;
        if (channel == layout::kChannelFacet)
            write_rows_as<std::uint32_t>(file, ids_of(chunk), rows, pitch, count, repeat_y);
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
    Clock::time_point start = Clock::now();
    file.flush_to_disk();
    result.timings.flush = seconds_since(start);
    start = Clock::now();
    result.sha256 = sha256_of_file(file.temporary_path());
    result.bytes = std::filesystem::file_size(file.temporary_path());
    result.timings.hash = seconds_since(start);
    file.publish();
    return result;
}

// Format version 1.0; NumPy wants the data to begin at a multiple of 64 bytes.
std::string npy_header(const std::vector<std::uint64_t>& shape, std::uint32_t channel, Precision precision) {
    const char* type = channel == layout::kChannelFacet ? "<u4" : precision == Precision::f64 ? "<f8" : "<f4";
    std::string text =
        fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, fmt::join(shape, ", "));
    constexpr std::size_t kPreamble = 10;
    text.resize((kPreamble + text.size() + 1 + 63) / 64 * 64 - kPreamble - 1, ' ');
    text += '\n';
    std::string preamble("\x93NUMPY\x01\x00", 8);
    preamble += static_cast<char>(text.size() & 0xff);
    preamble += static_cast<char>(text.size() >> 8);
    return preamble + text;
}

NpyWriter::NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
                     Precision precision)
    : file_(path), order_(size), channel_(channel), precision_(precision) {
    std::vector<std::uint64_t> shape(size.rbegin(), size.rend());
    if (components_of(channel) == 3)
        shape.push_back(3);
    file_.write(npy_header(shape, channel, precision));
}

void NpyWriter::write(const AnyFieldChunk& chunk, std::size_t repeat_y) {
    order_.accept(chunk, repeat_y);
    write_rows(file_, chunk, channel_, repeat_y, precision_);
}

VolumeResult NpyWriter::finish() {
    order_.require_complete();
    return publish_raw(file_);
}

CsvText& CsvText::add(std::string_view text) {
    const char* const quote = text.find_first_of(",\"\r\n") == std::string_view::npos ? "" : "\"";
    text_ += quote;
    for (const char c : text)
        text_.append(c == '"' ? 2 : 1, c);
    text_ += quote;
    text_ += ',';
    return *this;
}

VtiWriter::VtiWriter(const std::filesystem::path& path, const VtiHeader& header)
    : file_(path), order_(header.size), header_(header) {
    const std::uint64_t samples = header.size[0] * header.size[1] * header.size[2];
    for (const std::uint32_t channel : {layout::kChannelForce, layout::kChannelDepth, layout::kChannelFacet,
                                        layout::kChannelProxy, layout::kChannelUnshaded})
        if (header.channels & channel) {
            const bool doubles = channel != layout::kChannelFacet && header.precision == Precision::f64;
            arrays_.push_back({channel, samples * components_of(channel) * (doubles ? 8 : 4), 0});
        }
    file_.write(make_xml());
    for (Array& array : arrays_) {
        file_.write(std::as_bytes(std::span(&array.bytes, 1)));
        array.position = file_.tell();
        file_.seek(array.position + array.bytes);
    }
}

// All up to the appended data, which begins after the underscore.
std::string VtiWriter::make_xml() const {
    const auto& [size, origin, spacing, channels, precision] = header_;
    const std::string extent = fmt::format("0 {} 0 {} 0 {}", size[0] - 1, size[1] - 1, size[2] - 1);
    std::string xml = fmt::format("<?xml version=\"1.0\"?>\n"
                                  "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                                  "header_type=\"UInt64\">\n"
                                  "<ImageData WholeExtent=\"{}\" Origin=\"{}\" Spacing=\"{}\">\n"
                                  "<Piece Extent=\"{}\">\n<PointData>\n",
                                  extent, fmt::join(origin, " "), fmt::join(spacing, " "), extent);
    std::uint64_t offset = 0;
    for (const Array& array : arrays_) {
        const char* type = array.channel == layout::kChannelFacet ? "UInt32"
                           : precision == Precision::f64          ? "Float64"
                                                                  : "Float32";
        xml += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
                           "offset=\"{}\"/>\n",
                           type, name_of_channel(array.channel), components_of(array.channel), offset);
        offset += sizeof(std::uint64_t) + array.bytes;
    }
    return xml + "</PointData>\n<CellData/>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
}

void VtiWriter::write(const AnyFieldChunk& chunk, std::size_t repeat_y) {
    order_.accept(chunk, repeat_y);
    for (Array& array : arrays_) {
        file_.seek(array.position);
        write_rows(file_, chunk, array.channel, repeat_y, header_.precision);
        array.position = file_.tell();
    }
}

VolumeResult VtiWriter::finish() {
    order_.require_complete();
    file_.write(std::string_view("\n</AppendedData>\n</VTKFile>\n"));
    return publish_raw(file_);
}

} // namespace forceshade
