#include "host/path_output/path_npy.h"

#include <algorithm>
#include <limits>

#include "host/io/chunk_rows.h"
#include "host/io/npy.h"
#include "host/io/raw_rows.h"

namespace forceshade {
namespace {

// The samples of a row, and where the path ends with them what fills the array's row up.
template <typename Value>
void write_row(TemporaryFile& file, std::span<const Value> samples, std::size_t beyond, Value filler) {
    file.write(std::as_bytes(samples));
    constexpr std::size_t kOnce = 4096; // values
    const std::vector<Value> fillers(std::min(beyond, kOnce), filler);
    for (std::size_t rest = beyond; rest > 0; rest -= std::min(rest, kOnce))
        file.write(std::as_bytes(std::span(fillers).first(std::min(rest, kOnce))));
}

} // namespace

PathNpyWriter::PathNpyWriter(const std::filesystem::path& path, std::uint64_t paths, std::uint64_t steps,
                             std::uint32_t channel, Precision precision)
    : file_(path), steps_(steps), channel_(channel) {
    std::vector<std::uint64_t> shape{paths, steps};
    if (components_of(channel) == 3)
        shape.push_back(3);
    file_.write(npy_header(shape, channel, precision));
}

template <typename T> void PathNpyWriter::add(const PathRows<T>& rows) {
    const std::size_t components = components_of(channel_);
    for (std::size_t path = 0; path < rows.path_count; ++path) {
        const std::size_t first = path * rows.pitch * components, samples = rows.samples(path) * components;
        const std::size_t beyond = rows.ends(path) ? (steps_ - rows.steps[path]) * components : 0;
        if (channel_ == layout::kChannelFacet)
            write_row(file_, rows.facet.subspan(first, samples), beyond, layout::kNoFacet);
        else
            write_row(file_, values_of(rows, channel_).subspan(first, samples), beyond,
                      std::numeric_limits<T>::quiet_NaN());
    }
}

VolumeResult PathNpyWriter::finish() {
    return publish_raw(file_);
}

} // namespace forceshade
