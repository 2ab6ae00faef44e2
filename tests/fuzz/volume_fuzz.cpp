// A volume of this program: read or refused as damaged, row by row the same as at once.
#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::Bytes;
using fuzz::require;

constexpr std::uint64_t kMostValues = std::uint64_t{1} << 20;

/// NaN is what it is.
bool same(const float* one, const float* other, std::size_t count) {
    return std::memcmp(one, other, count * sizeof(float)) == 0;
}

bool reads(const auto& read) {
    try {
        read();
        return true;
    } catch (const IoError&) {
        return false;
    }
}

void check_volume(const std::filesystem::path& path) {
    VolumeReader reader(path);
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
        if (!reads([&] { reader.read(channel, 0, reader.rows(), all); }))
            continue;
        const std::size_t width = header.size[0] * components_of(channel);
        require(all.size() == width * reader.rows(), "{} values of {} rows", all.size(), reader.rows());
        for (std::uint64_t i = reader.rows(); i-- > 0;) {
            require(reads([&] { reader.read(channel, i, 1, row); }), "row {} cannot be read alone", i);
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

/// A file that ends too soon, or a block that says that it is shorter than its pixels, is noticed.
void check_damaged(const std::filesystem::path& path, const VolumeHeader& header) {
    std::string bytes = read_file(path);
    static fuzz::MemoryFile file;
    const auto is_read = [&] {
        file.write(bytes);
        return reads([] {
            std::vector<float> values;
            VolumeReader reader(file.path());
            reader.read(layout::kChannelUnshaded, 0, reader.rows(), values);
        });
    };
    // The last block is a row of the last part, unshaded forces: its part, its row, its size, 4 bytes each, its pixels.
    const std::size_t row = 3 * header.size[0] * (header.pixel == PixelType::half ? 2 : 4);
    if (header.compression == Compression::none) {
        std::uint32_t size = 0;
        char* const at = &bytes[bytes.size() - row - sizeof size];
        std::memcpy(&size, at, sizeof size);
        require(size == row, "the last block is no row of forces");
        --size;
        std::memcpy(at, &size, sizeof size);
        require(!is_read(), "a block may be shorter than its pixels");
    }
    bytes.pop_back();
    require(!is_read(), "the last byte may be missing");
}

/// What a format keeps of a number: so many digits of its binary fraction; halves even out, the others go away from 0.
float kept(float value, const VolumeHeader& header) {
    const bool half = header.pixel == PixelType::half;
    if (!half && header.compression != Compression::pxr24)
        return value;
    const int digits = half ? 11 : 16;
    int exponent = 0;
    const double fraction = std::ldexp(std::frexp(static_cast<double>(value), &exponent), digits);
    return static_cast<float>(std::ldexp(half ? std::nearbyint(fraction) : std::round(fraction), exponent - digits));
}

/// A volume whose rows are all alike is written and read: so large a one that not all of its rows are in memory.
void check_repeated() {
    static const fuzz::Folder folder;
    const std::filesystem::path path = folder.path() / "volume.exr";
    VolumeHeader header;
    header.size = {22000, 20, 1}; // 16 rows are 4 MiB
    header.compression = Compression::none;
    std::vector<float> force(3 * header.size[0]);
    for (std::size_t i = 0; i < force.size(); ++i)
        force[i] = static_cast<float>(i % 1001);
    VolumeWriter writer(path, header);
    writer.write(layout::FieldChunk<float>{header.size[0], header.size[0], 0, 1, 0, 1, force, {}, {}, {}, {}},
                 header.size[1]);
    writer.finish();
    VolumeReader reader(path);
    std::vector<float> read;
    for (std::uint64_t row = 0; row < header.size[1]; ++row) {
        reader.read(layout::kChannelForce, row, 1, read);
        require(read == force, "row {} is another", row);
    }
}

/// A volume out of bytes is written, in pieces, and read as the same.
void check_written(Bytes bytes) {
    static const fuzz::Folder folder;
    const std::filesystem::path path = folder.path() / "volume.exr";
    VolumeHeader header;
    header.size = {1 + bytes.below(4), 1 + bytes.below(5), 1 + bytes.below(9)};
    header.origin = {bytes.number(), bytes.number(), bytes.number()};
    header.spacing = {bytes.number(), bytes.number(), bytes.number()};
    header.scene = bytes.text(3);
    header.version = "1";
    header.omitted = "proxy";
    header.compression = static_cast<Compression>(bytes.below(4));
    header.pixel = static_cast<PixelType>(bytes.below(2));
    header.channels = layout::kChannelForce | layout::kChannelUnshaded | layout::kChannelDepth | layout::kChannelFacet |
                      layout::kChannelProxy;
    header.place_origin = {bytes.number(), bytes.number(), bytes.number()};
    const std::size_t pitch = header.size[0] + bytes.below(3), layer = pitch * header.size[1];
    const std::size_t samples = layer * header.size[2];
    const std::size_t first = bytes.below(header.size[2] + 1); // layers that are written first
    std::vector<float> force, unshaded, depth;
    std::vector<layout::uint> ids;
    for (std::size_t i = 0; i < 3 * samples; ++i) {
        force.push_back(static_cast<float>(static_cast<int>(bytes.byte()) - 128 + static_cast<int>(i % 3)) / 4);
        unshaded.push_back((1 - force.back()) *
                           static_cast<float>(1 + static_cast<double>(i * 40503 % 65536) * 0x1p-20));
    }
    for (std::size_t i = 0; i < samples; ++i) {
        depth.push_back(force[3 * i] * 2);
        ids.push_back(static_cast<layout::uint>(i * 2654435761U));
    }
    VolumeWriter writer(path, header);
    for (const auto& [begin, count] : {std::pair(std::size_t(0), first), {first, header.size[2] - first}}) {
        if (count == 0)
            continue;
        layout::FieldChunk<float> chunk{header.size[0], pitch, 0, header.size[1], begin, count, {}, {}, {}, {}, {}};
        chunk.force = std::span(force).subspan(3 * layer * begin, 3 * layer * count);
        chunk.unshaded = chunk.proxy = std::span(unshaded).subspan(3 * layer * begin, 3 * layer * count);
        chunk.depth = std::span(depth).subspan(layer * begin, layer * count);
        chunk.facet = std::span(ids).subspan(layer * begin, layer * count);
        writer.write(chunk, 1);
    }
    const VolumeResult result = writer.finish();
    VolumeReader reader(path);
    const VolumeHeader& found = reader.header();
    require(found.size == header.size && found.channels == header.channels && found.pixel == header.pixel &&
                found.compression == header.compression && found.origin == header.origin &&
                found.spacing == header.spacing && found.scene == header.scene && found.version == header.version &&
                found.omitted == header.omitted && found.place_origin == header.place_origin,
            "the header is another");
    std::vector<float> read;
    std::vector<std::uint32_t> read_ids;
    const auto at = [&](std::size_t x, std::size_t row) { return row * pitch + x; }; // a sample
    for (const auto& [channel, values] : {std::pair(layout::kChannelForce, &force),
                                          {layout::kChannelUnshaded, &unshaded},
                                          {layout::kChannelProxy, &unshaded},
                                          {layout::kChannelDepth, &depth}}) {
        reader.read(channel, 0, reader.rows(), read);
        const std::size_t components = components_of(channel);
        std::size_t next = 0;
        for (std::size_t row = 0; row < reader.rows(); ++row)
            for (std::size_t i = 0; i < header.size[0] * components; ++i, ++next)
                require(next < read.size() && read[next] == kept((*values)[at(0, row) * components + i], header),
                        "{} is read as other values", name_of_channel(channel));
        require(next == read.size(), "{} has other samples", name_of_channel(channel));
    }
    reader.read_ids(0, reader.rows(), read_ids);
    double longest = 0;
    for (std::size_t row = 0, next = 0; row < reader.rows(); ++row)
        for (std::size_t x = 0; x < header.size[0]; ++x) {
            require(read_ids.at(next++) == ids[at(x, row)], "ids are read as others");
            const float* const one = &force[3 * at(x, row)];
            longest = std::max(longest, std::hypot(double{one[0]}, double{one[1]}, double{one[2]}));
        }
    const auto& [x, y, z] = result.largest_voxel;
    const float* const one = &force[3 * at(x, z * header.size[1] + y)];
    require(std::abs(result.largest_force - longest) <= 1e-12 * longest &&
                std::abs(std::hypot(double{one[0]}, double{one[1]}, double{one[2]}) - longest) <= 1e-12 * longest,
            "the longest force is {}, not {}", longest, result.largest_force);
    check_damaged(path, header);
}

/// Paths out of bytes are written, and some of them read.
void check_written_paths(Bytes bytes) {
    static const fuzz::Folder folder;
    const std::filesystem::path path = folder.path() / "paths.exr";
    PathVolumeHeader header;
    header.steps = 1 + bytes.below(20);
    header.paths = 1 + bytes.below(12);
    header.compression = static_cast<Compression>(bytes.below(4));
    header.channels = layout::kChannelForce | layout::kChannelPosition;
    std::vector<float> force, position;
    for (std::size_t i = 0; i < 3 * header.steps * header.paths; ++i) {
        force.push_back(static_cast<float>(i + bytes.byte()));
        position.push_back(static_cast<float>(i) / 4);
    }
    header.place_origin = {bytes.number(), bytes.number(), bytes.number()};
    const std::vector<layout::uint> steps(header.paths, static_cast<layout::uint>(header.steps));
    PathVolumeWriter writer(path, header);
    PathRows<float> rows;
    rows.path_count = header.paths;
    rows.pitch = header.steps;
    rows.steps = steps;
    rows.force = force;
    rows.position = position;
    writer.write(rows);
    writer.finish();
    const std::size_t most_paths = 1 + bytes.below(12), most_steps = 1 + bytes.below(20);
    std::size_t every_path = 1, every_step = 1;
    while (every_path * most_paths < header.paths)
        ++every_path;
    while (every_step * most_steps < header.steps)
        ++every_step;
    std::vector<float> some_force, some_position;
    for (std::size_t one = 0; one < header.paths; one += every_path)
        for (std::size_t step = 0; step < header.steps; step += every_step)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                some_force.push_back(force[3 * (one * header.steps + step) + axis]);
                some_position.push_back(position[3 * (one * header.steps + step) + axis]);
            }
    const PathSamples read = read_paths(path, most_paths, most_steps);
    require(read.every_step == every_step && read.paths * read.steps * 3 == some_force.size(), "{} paths of {} steps",
            read.paths, read.steps);
    require(read.origin == header.place_origin, "paths are measured from elsewhere");
    require(read.force == some_force && read.position == some_position, "paths are read as others");
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
    if (size > 0 && data[0] < 2) {
        const fuzz::Bytes bytes(data + 1, size - 1);
        data[0] == 0 ? check_written(bytes) : check_written_paths(bytes);
        [[maybe_unused]] static const bool once = (check_repeated(), true); // it takes long
        return 0;
    }
    file.write({reinterpret_cast<const char*>(data), size});
    attempt([] { check_volume(file.path()); });
    attempt([] {
        if (holds_paths(file.path()))
            check_paths(file.path());
    });
    return 0;
}
