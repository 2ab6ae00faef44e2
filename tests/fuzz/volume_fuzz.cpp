// A volume of this program: read or refused as damaged, row by row the same as at once, with threads and without.
#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/reading.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::require;

constexpr std::uint64_t kMostValues = std::uint64_t{1} << 20;

/// NaN is what it is.
bool same(const float* one, const float* other, std::size_t count) {
    return std::memcmp(one, other, count * sizeof(float)) == 0;
}

void check_volume(const std::filesystem::path& path) {
    VolumeReader reader(path), threaded(path, 2);
    const VolumeHeader& header = reader.header();
    require(header.size[0] > 0 && reader.rows() == header.size[1] * header.size[2], "{} rows of {} x {}", reader.rows(),
            header.size[1], header.size[2]);
    if (header.size[0] * reader.rows() > kMostValues)
        return;
    std::vector<float> all, row;
    for (const std::uint32_t channel :
         {layout::kChannelForce, layout::kChannelDepth, layout::kChannelProxy, layout::kChannelUnshaded}) {
        if ((header.channels & channel) == 0)
            continue;
        reader.read(channel, 0, reader.rows(), all);
        const std::size_t width = header.size[0] * components_of(channel);
        require(all.size() == width * reader.rows(), "{} values of {} rows", all.size(), reader.rows());
        threaded.read(channel, 0, reader.rows(), row);
        require(row.size() == all.size() && same(row.data(), all.data(), all.size()), "threads read otherwise");
        for (std::uint64_t i = reader.rows(); i-- > 0;) {
            reader.read(channel, i, 1, row);
            require(row.size() == width && same(row.data(), &all[i * width], width), "row {} is another alone", i);
        }
    }
    std::vector<std::uint32_t> ids;
    if (header.channels & layout::kChannelFacet) {
        reader.read_ids(0, reader.rows(), ids);
        require(ids.size() == header.size[0] * reader.rows(), "{} ids", ids.size());
    }
}

void check_paths(const std::filesystem::path& path) {
    const PathSamples some = read_paths(path, 5, 7, true);
    const std::uint64_t samples = some.paths * some.steps;
    require(some.paths <= 5 && some.steps <= 7 && some.force.size() == 3 * samples &&
                some.position.size() == 3 * samples,
            "{} paths of {} steps", some.paths, some.steps);
    for (const auto* scalars : {&some.depth, &some.angle, &some.magnitude_error})
        require(scalars->empty() || scalars->size() == samples, "{} scalars", scalars->size());
}

template <typename Read> void attempt(const Read& read) {
    try {
        read();
    } catch (const IoError&) {
    }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace forceshade;
    static fuzz::MemoryFile file;
    set_memory_limit(std::uint64_t{16} << 20); // what is announced and not there takes long to fill
    file.write({reinterpret_cast<const char*>(data), size});
    attempt([] { check_volume(file.path()); });
    attempt([] {
        if (holds_paths(file.path()))
            check_paths(file.path());
    });
    return 0;
}
