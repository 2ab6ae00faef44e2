#include "host/output/raw_formats.h"

#include <chrono>
#include <span>
#include <vector>

#include <fmt/core.h>
#include <fmt/format.h>

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

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

} // namespace

std::size_t component_bytes(std::uint32_t channel, Precision precision) {
    return channel != layout::kChannelFacet && precision == Precision::f64 ? 8 : 4;
}

template <typename real>
void write_rows(TemporaryFile& file, const layout::FieldChunk<real>& chunk, std::uint32_t channel, std::size_t repeat_y,
                Precision precision) {
    const std::size_t components = components_of(channel), rows = chunk.y_count * chunk.z_count;
    const std::size_t pitch = chunk.x_pitch * components, count = chunk.x_count * components;
    if (channel == layout::kChannelFacet)
        write_rows_as<std::uint32_t>(file, ids_of(chunk), rows, pitch, count, repeat_y);
    else if (precision == Precision::f64)
        write_rows_as<double>(file, values_of(chunk, channel), rows, pitch, count, repeat_y);
    else
        write_rows_as<float>(file, values_of(chunk, channel), rows, pitch, count, repeat_y);
}

VolumeResult publish_raw(TemporaryFile& file) {
    VolumeResult result;
    const auto start = std::chrono::steady_clock::now();
    file.flush_to_disk();
    result.timings.flush = seconds_since(start);
    const auto flushed = std::chrono::steady_clock::now();
    result.sha256 = sha256_of_file(file.temporary_path());
    result.bytes = std::filesystem::file_size(file.temporary_path());
    result.timings.hash = seconds_since(flushed);
    file.publish();
    return result;
}

template void write_rows(TemporaryFile&, const layout::FieldChunk<float>&, std::uint32_t, std::size_t, Precision);
template void write_rows(TemporaryFile&, const layout::FieldChunk<double>&, std::uint32_t, std::size_t, Precision);

/// Format version 1.0; NumPy wants the data to begin at a multiple of 64 bytes.
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

struct NpyWriter::State {
    TemporaryFile file;
    RowOrder order;
    std::uint32_t channel;
    Precision precision;

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
        order.accept(chunk, repeat_y);
        write_rows(file, chunk, channel, repeat_y, precision);
    }
};

NpyWriter::NpyWriter(const std::filesystem::path& path, const std::array<std::uint64_t, 3>& size, std::uint32_t channel,
                     Precision precision)
    : state_(new State{TemporaryFile(path), RowOrder(size), channel, precision}) {
    std::vector<std::uint64_t> shape(size.rbegin(), size.rend());
    if (components_of(channel) == 3)
        shape.push_back(3);
    state_->file.write(npy_header(shape, channel, precision));
}
NpyWriter::~NpyWriter() = default;

void NpyWriter::write(const AnyFieldChunk& any, std::size_t repeat_y) {
    std::visit([&](const auto& chunk) { state_->write(chunk, repeat_y); }, any);
}

VolumeResult NpyWriter::finish() {
    state_->order.require_complete();
    return publish_raw(state_->file);
}

void CsvText::separate() {
    if (!first_)
        text_ += ',';
    first_ = false;
}

CsvText& CsvText::add(std::string_view text) {
    separate();
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
        text_ += text;
        return *this;
    }
    text_ += '"';
    for (const char c : text) {
        if (c == '"')
            text_ += '"';
        text_ += c;
    }
    text_ += '"';
    return *this;
}

CsvText& CsvText::add(double value) {
    separate();
    text_ += fmt::format("{}", value);
    return *this;
}

CsvText& CsvText::add(float value) {
    separate();
    text_ += fmt::format("{}", value);
    return *this;
}

void CsvText::end() {
    text_ += '\n';
    first_ = true;
}

namespace {

struct Array {
    std::uint32_t channel;
    std::uint64_t bytes;    /* of all samples */
    std::uint64_t position; /* in the file, where the next rows go */
};

std::vector<Array> arrays_of(const VtiHeader& header) {
    std::vector<Array> arrays;
    const std::uint64_t samples = header.size[0] * header.size[1] * header.size[2];
    for (const std::uint32_t channel : {layout::kChannelForce, layout::kChannelDepth, layout::kChannelFacet,
                                        layout::kChannelProxy, layout::kChannelUnshaded})
        if (header.channels & channel)
            arrays.push_back(
                {channel, samples * components_of(channel) * component_bytes(channel, header.precision), 0});
    return arrays;
}

const char* type_of(std::uint32_t channel, Precision precision) {
    if (channel == layout::kChannelFacet)
        return "UInt32";
    return precision == Precision::f64 ? "Float64" : "Float32";
}

/// All up to the appended data, which begins after the underscore.
std::string make_xml(const VtiHeader& header, const std::vector<Array>& arrays) {
    const std::string extent =
        fmt::format("0 {} 0 {} 0 {}", header.size[0] - 1, header.size[1] - 1, header.size[2] - 1);
    std::string xml = fmt::format("<?xml version=\"1.0\"?>\n"
                                  "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
                                  "header_type=\"UInt64\">\n"
                                  "<ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\">\n"
                                  "<Piece Extent=\"{}\">\n<PointData>\n",
                                  extent, header.origin[0], header.origin[1], header.origin[2], header.spacing[0],
                                  header.spacing[1], header.spacing[2], extent);
    std::uint64_t offset = 0;
    for (const Array& array : arrays) {
        xml += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
                           "offset=\"{}\"/>\n",
                           type_of(array.channel, header.precision), name_of_channel(array.channel),
                           components_of(array.channel), offset);
        offset += sizeof(std::uint64_t) + array.bytes;
    }
    return xml + "</PointData>\n<CellData/>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
}

} // namespace

struct VtiWriter::State {
    TemporaryFile file;
    RowOrder order;
    VtiHeader header;
    std::vector<Array> arrays;

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
        order.accept(chunk, repeat_y);
        for (Array& array : arrays) {
            file.seek(array.position);
            write_rows(file, chunk, array.channel, repeat_y, header.precision);
            array.position = file.tell();
        }
    }
};

VtiWriter::VtiWriter(const std::filesystem::path& path, const VtiHeader& header)
    : state_(new State{TemporaryFile(path), RowOrder(header.size), header, arrays_of(header)}) {
    state_->file.write(make_xml(header, state_->arrays));
    for (Array& array : state_->arrays) {
        state_->file.write(std::as_bytes(std::span(&array.bytes, 1)));
        array.position = state_->file.tell();
        state_->file.seek(array.position + array.bytes);
    }
}
VtiWriter::~VtiWriter() = default;

void VtiWriter::write(const AnyFieldChunk& any, std::size_t repeat_y) {
    std::visit([&](const auto& chunk) { state_->write(chunk, repeat_y); }, any);
}

VolumeResult VtiWriter::finish() {
    state_->order.require_complete();
    state_->file.write(std::string_view("\n</AppendedData>\n</VTKFile>\n"));
    return publish_raw(state_->file);
}

} // namespace forceshade
