#include "host/io/vti.h"

#include <vector>

#include <fmt/core.h>

#include "host/io/chunk_rows.h"
#include "host/io/raw_rows.h"
#include "host/io/temporary_file.h"

namespace forceshade {
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

void VtiWriter::write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}
void VtiWriter::write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

VolumeResult VtiWriter::finish() {
    state_->order.require_complete();
    state_->file.write(std::string_view("\n</AppendedData>\n</VTKFile>\n"));
    return publish_raw(state_->file);
}

} // namespace forceshade
