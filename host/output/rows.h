// Where the rows of an evaluated field go: a file that receives them in order and is published when complete.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "shaders/shared/law.h"

namespace forceshade {

struct VolumeTimings {
    double encode = 0;    /* s: converting, compressing, handing to the kernel */
    double flush = 0;     /* s: until the disk has it */
    double read_back = 0; /* s: reading, decompressing, comparing */
    double hash = 0;      /* s: SHA-256 of the file */
};

/// What became of a finished file. NPY and VTI files fill in only hash and size.
struct VolumeResult {
    std::string sha256;      /* of the file's bytes */
    std::uint64_t bytes = 0; /* of the file */
    VolumeTimings timings;
    double largest_force = 0;                     /* N: largest |F|, of the values rounded to float */
    std::array<std::uint64_t, 3> largest_voxel{}; /* where it stands first in file order */
    std::uint64_t non_finite = 0;                 /* NaN and infinite values */
};

/// Chunks arrive in row order: row = z * ny + y. A chunk covers whole layers, or rows of one layer. With `repeat_y` > 1
/// (a field that does not depend on y) it holds one row a layer, which stands for repeat_y = ny rows.
/// A sink that is destroyed before finish() leaves no file.
class ChunkSink {
public:
    virtual ~ChunkSink() = default;
    /// Throws IoError; std::logic_error if rows come out of order or a channel is missing.
    virtual void write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) = 0;
    virtual void write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) = 0;
    /// After the last row, once. Throws IoError.
    virtual VolumeResult finish() = 0;
};

// What all sinks do alike with a chunk: check that its rows are the next ones, and find the values of a channel.

/// Reals (or ids) a sample of a channel: 3 for vectors, else 1.
constexpr std::size_t components_of(std::uint32_t channel) {
    return channel == layout::kChannelDepth || channel == layout::kChannelFacet ? 1 : 3;
}

/// The channel's name as a part, an array or a file calls it: force, depth, facet, proxy, unshaded, position.
const char* name_of_channel(std::uint32_t channel);

/// Follows the rows of a grid in file order, row = z * ny + y.
class RowOrder {
public:
    explicit RowOrder(const std::array<std::uint64_t, 3>& size) : size_(size) {}
    /// Throws std::logic_error unless the chunk's rows are the next ones.
    template <typename real> void accept(const layout::FieldChunk<real>& chunk, std::size_t repeat_y);
    /// Throws std::logic_error unless every row has come.
    void require_complete() const;

private:
    std::array<std::uint64_t, 3> size_;
    std::uint64_t next_row_ = 0;
};

/// The samples of a channel that is not the facet id. Throws std::logic_error if the chunk lacks it.
template <typename real> std::span<const real> values_of(const layout::FieldChunk<real>& chunk, std::uint32_t channel);
/// Likewise the facet ids.
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
    void add_largest(std::span<const float> values, const Voxel& first);
    void add_longest(std::span<const float> values, const Voxel& first);
    void add_non_finite(std::span<const float> values, const Voxel& first, std::uint64_t repeat);

    std::size_t components_;
    std::uint64_t non_finite_ = 0;
    WatchedValue first_non_finite_;
    WatchedValue largest_;
    WatchedValue longest_;
    double longest_squared_ = -1.0;
};

} // namespace forceshade
