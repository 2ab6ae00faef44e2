#include "host/path_output/path_npy.h"

#include <algorithm>
#include <limits>

#include "host/io/chunk_rows.h"
#include "host/io/npy.h"
#include "host/io/raw_rows.h"

namespace forceshade {
namespace {

// A row of values, its end filled up.
template <typename Value>
void write_row(TemporaryFile& file, std::span<const Value> row, std::size_t samples, Value beyond) {
    std::vector<Value> values(row.begin(), row.end());
    std::fill(values.begin() + static_cast<std::ptrdiff_t>(samples), values.end(), beyond);
    file.write(std::as_bytes(std::span(values)));
}

} // namespace

PathNpyWriter::PathNpyWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps,
                             std::uint32_t channel, Precision precision)
    : file_(path), channel_(channel) {
    std::vector<std::uint64_t> shape{paths, steps};
    if (components_of(channel) == 3)
        shape.push_back(3);
    file_.write(npy_header(shape, channel, precision));
}

template <typename T> void PathNpyWriter::add(const PathRows<T>& rows) {
    const std::size_t components = components_of(channel_), width = rows.pitch * components;
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        const std::size_t samples = rows.steps[path] * components;
        if (channel_ == layout::kChannelFacet)
            write_row(file_, rows.facet.subspan(path * width, width), samples, layout::kNoFacet);
        else
            write_row(file_, values_of(rows, channel_).subspan(path * width, width), samples,
                      std::numeric_limits<T>::quiet_NaN());
    }
}

VolumeResult PathNpyWriter::finish() {
    return publish_raw(file_);
}

} // namespace forceshade
