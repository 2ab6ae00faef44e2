// Rows of evaluated fields and paths, and where they go: files that receive them in order and are published when
// complete.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "shaders/shared/law.h"

namespace forceshade {

struct VolumeTimings {
    double encode = 0;    /* s: converting, compressing, handing to the kernel */
    double flush = 0;     /* s: until the disk has it */
    double read_back = 0; /* s: reading, decompressing, comparing */
    double hash = 0;      /* s: SHA-256 of the file */
    double check = 0;     /* s: against the oracle; not the writer's own */

    double sum() const { return encode + flush + read_back + hash + check; }
    VolumeTimings& operator+=(const VolumeTimings& other) {
        encode += other.encode;
        flush += other.flush;
        read_back += other.read_back;
        hash += other.hash;
        check += other.check;
        return *this;
    }
};

/// What became of a finished file. NPY, VTI and VTP files fill in only hash and size.
struct VolumeResult {
    std::string sha256;      /* of the file's bytes */
    std::uint64_t bytes = 0; /* of the file */
    VolumeTimings timings;
    double largest_force = 0;                     /* N: largest |F|, of the values rounded to float */
    std::array<std::uint64_t, 3> largest_voxel{}; /* where it stands first in file order */
};

/// In either precision; it only points to samples.
using AnyFieldChunk = std::variant<layout::FieldChunk<float>, layout::FieldChunk<double>>;

/// Chunks arrive in row order: row = z * ny + y. A chunk covers whole layers, or rows of one layer. With `repeat_y` > 1
/// (a field that does not depend on y) it holds one row a layer, which stands for repeat_y = ny rows.
/// A sink that is destroyed before finish() leaves no file.
class ChunkSink {
public:
    virtual ~ChunkSink() = default;
    /// Throws IoError; std::logic_error if rows come out of order or a channel is missing.
    virtual void write(const AnyFieldChunk& chunk, std::size_t repeat_y) = 0;
    /// After the last row, once. Throws IoError.
    virtual VolumeResult finish() = 0;
};

// What all sinks do with a chunk: check that its rows are the next ones, and find the values of a channel.

/// Channels that no kernel computes, besides layout::kChannel...: how far forces are from those of [compare].
inline constexpr std::uint32_t kChannelAngle = 64, kChannelMagnitudeError = 128,
                               kComparedChannels = kChannelAngle | kChannelMagnitudeError;

/// What a field's files may hold, in their order.
inline constexpr std::array kFieldChannels{layout::kChannelForce, layout::kChannelDepth,    layout::kChannelFacet,
                                           layout::kChannelProxy, layout::kChannelUnshaded, kChannelAngle,
                                           kChannelMagnitudeError};
/// The same for paths.
inline constexpr std::array kPathChannels{layout::kChannelForce, layout::kChannelPosition, layout::kChannelDepth,
                                          layout::kChannelFacet, layout::kChannelProxy,    kChannelAngle,
                                          kChannelMagnitudeError};

/// Reals (or ids) a sample of a channel: 3 for vectors, else 1.
constexpr std::size_t components_of(std::uint32_t channel) {
    return channel & (layout::kChannelDepth | layout::kChannelFacet | kComparedChannels) ? 1 : 3;
}

/// Channels of places, m. Engines measure them from the scene's origin (host/mesh/structure.h), which is 0 but for
/// meshes far from the world's. Files whose numbers may be doubles hold them in the world, as doubles where the origin
/// is not 0; an EXR, which has floats, holds them as they come, and the origin as an attribute.
constexpr bool is_place(std::uint32_t channel) {
    return channel == layout::kChannelPosition || channel == layout::kChannelProxy;
}

/// Whether a channel's numbers are doubles of the world, whatever the run's precision.
inline bool is_moved(std::uint32_t channel, const glm::dvec3& origin) {
    return is_place(channel) && origin != glm::dvec3(0);
}

/// Places in the world, m, three numbers each, for an origin, m.
template <typename T> std::vector<double> in_world(std::span<const T> places, const glm::dvec3& origin) {
    std::vector<double> world(places.size());
    for (std::size_t i = 0; i < world.size(); ++i)
        world[i] = origin[static_cast<int>(i % 3)] + static_cast<double>(places[i]);
    return world;
}

/// A chunk's channel behind the rows that came before, without padding, each row `repeats` times.
template <typename Value, typename T>
void append_rows(const layout::FieldChunk<T>& chunk, std::span<const Value> channel, std::size_t components,
                 std::size_t repeats, std::vector<Value>& into) {
    for (std::size_t row = 0; !channel.empty() && row < chunk.y_count * chunk.z_count; ++row) {
        const auto values = channel.subspan(row * chunk.x_pitch * components, chunk.x_count * components);
        for (std::size_t i = 0; i < repeats; ++i)
            into.insert(into.end(), values.begin(), values.end());
    }
}

/// The channel's name as a part, an array or a file calls it: force, depth, facet, proxy, unshaded, position, angle,
/// magnitude_error.
const char* name_of_channel(std::uint32_t channel);

/// Follows the rows of a grid in file order, row = z * ny + y.
class RowOrder {
public:
    explicit RowOrder(const std::array<std::uint64_t, 3>& size) : size_(size) {}
    /// Throws std::logic_error unless the chunk's rows are the next ones.
    void accept(const AnyFieldChunk& chunk, std::size_t repeat_y);
    /// Throws std::logic_error unless every row has come.
    void require_complete() const;

private:
    std::array<std::uint64_t, 3> size_;
    std::uint64_t next_row_ = 0;
};

/// The samples of a channel that is not the facet id. Throws std::logic_error if the chunk lacks it.
template <typename real> std::span<const real> values_of(const layout::FieldChunk<real>& chunk, std::uint32_t channel);
/// The facet ids.
template <typename real> std::span<const layout::uint> ids_of(const layout::FieldChunk<real>& chunk);

// Rows of floats on their way into a file: rounded to its pixel type, and watched for values that it must not hold.

/// How a value stands in the file. float24 is what PXR24 keeps of a float: 15 bits of fraction, the other 8 zero.
enum class PixelFormat { float32, float24, half, id };

constexpr std::size_t bytes_of(PixelFormat format) {
    return format == PixelFormat::half ? 2 : 4;
}

/// Rounded to nearest, ties away from zero, as the PXR24 compressor rounds; never from finite to infinite.
float round_to_float24(float value) noexcept;
bool overflows_half(float value) noexcept; /* finite, but infinite as half */

/// Writes values.size() * bytes_of(format) bytes.
void encode_row(std::span<const float> values, PixelFormat format, std::byte* bytes);

using Voxel = std::array<std::uint64_t, 3>;

struct WatchedValue {
    double value = 0;
    Voxel voxel{};
    bool found = false;
};

/// What the rows of one channel held, so far.
class PixelWatch {
public:
    explicit PixelWatch(std::size_t components) : components_(components) {}
    /// Values of the row at (y, z), which stands `repeat` times; the first of them belongs to its sample `x`.
    void add(std::span<const float> values, std::uint64_t y, std::uint64_t z, std::uint64_t repeat,
             std::uint64_t x = 0);

    std::uint64_t non_finite() const noexcept { return non_finite_; }
    const WatchedValue& first_non_finite() const noexcept { return first_non_finite_; }
    /// The finite value of largest magnitude, with its sign; of equal ones the first.
    const WatchedValue& largest() const noexcept { return largest_; }
    /// The largest Euclidean length among the finite samples; of equal ones the first.
    const WatchedValue& longest() const noexcept { return longest_; }

private:
    std::size_t components_;
    std::uint64_t non_finite_ = 0;
    WatchedValue first_non_finite_;
    WatchedValue largest_;
    WatchedValue longest_;
    double longest_squared_ = -1.0;
};

// Paths as rows.

/// Consecutive paths, complete, or some steps of one path. Sample (path, step) stands at path * pitch + step -
/// step_first. Channels that were not asked for are empty.
template <typename T> struct PathRows {
    std::size_t path_first = 0, path_count = 0;
    std::size_t pitch = 0;                         // samples of a row
    std::span<const layout::uint> steps;           // of each path, in all; what follows in its row is undefined
    std::span<const T> position;                   // m, 3 a sample
    std::span<const T> force;                      // N, 3 a sample
    std::span<const T> depth;                      // m
    std::span<const layout::uint> facet;           // id
    std::span<const T> proxy;                      // m, 3 a sample
    std::size_t step_first = 0;                    // of the rows
    std::span<const T> angle{}, magnitude_error{}; // deg, N: against [compare]

    /// How many samples of a path stand here.
    std::size_t samples(std::size_t path) const {
        return std::min(pitch, std::max<std::size_t>(steps[path], step_first) - step_first);
    }
    /// True if a path has no samples after these.
    bool ends(std::size_t path) const { return step_first + pitch >= steps[path]; }
};

/// The reals of a channel that is not the facet id. Throws std::logic_error if the rows lack it.
template <typename T> std::span<const T> values_of(const PathRows<T>& rows, std::uint32_t channel);

using AnyPathRows = std::variant<PathRows<float>, PathRows<double>>;

/// Paths arrive in order, steps of one in order. A sink that is destroyed before finish() leaves no file.
class PathSink {
public:
    virtual ~PathSink() = default;
    /// Throws IoError; std::logic_error if paths come out of order or a channel is missing.
    virtual void write(const AnyPathRows& rows) = 0;
    /// After the last path, once. Throws IoError.
    virtual VolumeResult finish() = 0;
};

// Engines hand over steps of many paths at a time; files want path after path. A batch of paths is held in between, but
// a batch of one path goes on as it comes.

/// Most bytes of rows that are held at once.
inline constexpr std::size_t kRowBytes = std::size_t(16) << 20;
/// Most samples of a batch whose metrics alone are asked for: an interrupt is noticed between two batches.
inline constexpr std::size_t kMetricSamples = std::size_t(1) << 24;
/// The same on a mesh, where a sample takes longer.
inline constexpr std::size_t kMeshMetricSamples = std::size_t(1) << 22;

/// Bytes of a sample with these channels.
std::size_t path_sample_bytes(layout::uint channels, std::size_t real_bytes);

/// The samples of a batch whose rows fit into kRowBytes, or whose metrics come soon enough.
template <typename T> std::size_t samples_that_fit(const layout::PathInput<T>& input) {
    const bool mesh = input.law.features.surface == layout::kSurfaceMesh;
    const std::size_t bytes = path_sample_bytes(input.features.channels, sizeof(T));
    return bytes ? kRowBytes / bytes : mesh ? kMeshMetricSamples : kMetricSamples;
}
/// The paths of such a batch, at least 1. Of recorded paths, whose lengths differ, their source knows better how many.
template <typename T> std::size_t paths_that_fit(const layout::PathInput<T>& input) {
    constexpr std::size_t kMostPaths = 16384; // tables of more need not be there at once
    constexpr std::size_t kLanes = 256;       // fewer leave a device idle
    if (input.features.motion == layout::kMotionRecorded)
        return kMostPaths;
    const std::size_t least = input.features.channels ? 1 : kLanes;
    return std::clamp(samples_that_fit(input) / input.steps, least, kMostPaths);
}

/// Gives an engine fewer paths at a time than it asks for, passes it the length of the longest of them, and remembers
/// of them what metrics do not contain.
template <typename T> class BatchedSource final : public layout::PathSource<T> {
public:
    /// `steps` of the longest path. `paths` must outlive this.
    BatchedSource(layout::PathSource<T>& paths, std::size_t steps, std::size_t most)
        : paths_(paths), steps_(steps), most_(most) {}

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override {
        layout::PathBatch<T> batch = paths_.batch(first, std::min(count, most_));
        lengths_.assign(batch.steps.begin(), batch.steps.end());
        if (batch.steps.empty())
            lengths_.assign(batch.count, static_cast<layout::uint>(steps_));
        longest_ = batch.longest = *std::ranges::max_element(lengths_);
        inside_.clear();
        for (const layout::ProxyStart<T>& proxy : batch.proxies)
            inside_.push_back(proxy.inside != 0);
        return batch;
    }
    std::span<const T> positions(std::size_t step, std::size_t steps) override { return paths_.positions(step, steps); }

    /// Of the present batch: the samples of each path and of the longest, and whether a path began behind the surface
    /// (empty without a mesh).
    std::span<const layout::uint> lengths() const { return lengths_; }
    std::size_t longest() const { return longest_; }
    const std::vector<bool>& inside() const { return inside_; }

private:
    layout::PathSource<T>& paths_;
    std::size_t steps_, most_, longest_ = 0;
    std::vector<layout::uint> lengths_;
    std::vector<bool> inside_;
};

template <typename T> class RowGatherer {
public:
    using Receiver = std::function<void(const PathRows<T>&)>;
    /// `receive` gets every batch of paths when its last step has come, of a batch of one path every chunk; what it got
    /// stays until it has returned from the next. `source` gives the chunks' batches.
    RowGatherer(const BatchedSource<T>& source, Receiver receive) : source_(source), receive_(std::move(receive)) {}

    /// The next steps of a batch. \throws std::logic_error if they come out of order.
    void add(const layout::PathChunk<T>& chunk);

private:
    const BatchedSource<T>& source_;
    Receiver receive_;
    struct Rows {
        std::vector<T> position, force, depth, proxy;
        std::vector<layout::uint> facet, steps;
    };
    std::size_t next_step_ = 0;
    std::array<Rows, 2> rows_; // that are filled, and that were handed over before
    std::size_t filled_ = 0;
};

extern template class RowGatherer<float>;
extern template class RowGatherer<double>;

} // namespace forceshade
