#include "host/io/npy.h"

#include <fmt/format.h>

#include "host/io/chunk_rows.h"
#include "host/io/raw_rows.h"
#include "host/io/temporary_file.h"

namespace forceshade {
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

void NpyWriter::write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}
void NpyWriter::write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

VolumeResult NpyWriter::finish() {
    state_->order.require_complete();
    return publish_raw(state_->file);
}

} // namespace forceshade
