#include "host/output/raw_formats.h"

#include <algorithm>
#include <span>
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
    timed(result.timings.hash, [&] { result.sha256 = sha256_of_file(file.temporary_path()); });
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
                     Precision precision, const glm::dvec3& origin)
    : file_(path), order_(size), channel_(channel), precision_(precision), origin_(origin) {
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
