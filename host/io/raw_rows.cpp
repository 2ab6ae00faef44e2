#include "host/io/raw_rows.h"

#include <chrono>
#include <span>
#include <vector>

#include "host/io/chunk_rows.h"
#include "host/io/hash.h"

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

} // namespace forceshade
