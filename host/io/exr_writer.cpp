#include <cstring>
#include <span>

#include <fmt/core.h>

#include "host/io/chunk_rows.h"
#include "host/io/exr_rows.h"
#include "host/io/exr_volume.h"
#include "host/io/pixel_rows.h"

namespace forceshade {
namespace {

exr::Sheet sheet_of(const VolumeHeader& volume) {
    exr::require_possible(volume);
    exr::Sheet sheet{volume.size[0], volume.size[1] * volume.size[2], exr::parts_of(volume), {}, volume.threads};
    for (const exr::Part& part : sheet.parts)
        sheet.headers.push_back(exr::make_header(part, volume));
    return sheet;
}

} // namespace

struct VolumeWriter::State {
    State(const std::filesystem::path& path, const VolumeHeader& volume)
        : rows(path, sheet_of(volume), volume.allow_non_finite), order(volume.size) {}

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y);
    VolumeResult finish();

private:
    template <typename real>
    void convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat, exr::PartRows& part);

    exr::RowsWriter rows;
    RowOrder order;
    std::vector<float> rounded; // one row of doubles, as floats
};

template <typename real> void VolumeWriter::State::write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
    const exr::Stopwatch stopwatch(rows.timings.encode);
    order.accept(chunk, repeat_y);
    for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
        for (exr::PartRows& part : rows.parts())
            convert_row(chunk, row, repeat_y, part);
        rows.advance();
        for (std::size_t copy = 1; copy < repeat_y; ++copy)
            rows.repeat();
    }
}

template <typename real>
void VolumeWriter::State::convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat,
                                      exr::PartRows& part) {
    std::byte* target = rows.target(part);
    const std::size_t components = components_of(part.part.channel);
    const std::size_t first = row * chunk.x_pitch * components, count = chunk.x_count * components;
    if (part.part.format == PixelFormat::id) {
        std::memcpy(target, ids_of(chunk).subspan(first, count).data(), count * sizeof(layout::uint));
        return;
    }
    const std::span<const real> values = values_of(chunk, part.part.channel).subspan(first, count);
    std::span<const float> floats;
    if constexpr (std::is_same_v<real, float>) {
        floats = values;
    } else {
        rounded.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            rounded[i] = static_cast<float>(values[i]);
        floats = rounded;
    }
    part.watch.add(floats, chunk.y_first + row % chunk.y_count, chunk.z_first + row / chunk.y_count, repeat);
    encode_row(floats, part.part.format, target);
}

VolumeResult VolumeWriter::State::finish() {
    order.require_complete();
    return rows.finish(
        [](const Voxel& voxel) { return fmt::format("voxel ({}, {}, {})", voxel[0], voxel[1], voxel[2]); });
}

VolumeWriter::VolumeWriter(const std::filesystem::path& path, const VolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
VolumeWriter::~VolumeWriter() = default;

void VolumeWriter::write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

void VolumeWriter::write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

VolumeResult VolumeWriter::finish() {
    return state_->finish();
}

} // namespace forceshade
