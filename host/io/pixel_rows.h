// Rows of floats on their way into a file: rounded to its pixel type, and watched for values that it must not hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace forceshade {

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
