#include "host/io/pixel_rows.h"

#include <bit>
#include <cmath>
#include <cstring>

#include <half.h>

namespace forceshade {
namespace {

constexpr std::uint32_t kMagnitude = 0x7fffffffu;
constexpr std::uint32_t kInfinity = 0x7f800000u;

/// Bits of the largest magnitude: integers compare as the floats do, NaN above infinity above all numbers, and
/// vectorise.
std::int32_t largest_magnitude(std::span<const float> values) {
    std::int32_t largest = 0;
    for (const float value : values) {
        const auto bits = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(value) & kMagnitude);
        largest = bits > largest ? bits : largest;
    }
    return largest;
}

} // namespace

float round_to_float24(float value) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits & ~kMagnitude;
    const std::uint32_t magnitude = bits & kMagnitude;
    std::uint32_t rounded = 0;
    if (magnitude > kInfinity) // a NaN must keep a bit of its payload to stay one
        rounded = (magnitude & 0x007fff00u) == 0 ? kInfinity | 0x100u : magnitude & ~0xffu;
    else
        rounded = (magnitude + (magnitude & 0x80u)) & ~0xffu;
    if (magnitude < kInfinity && rounded >= kInfinity)
        rounded = magnitude & ~0xffu;
    return std::bit_cast<float>(sign | rounded);
}

bool overflows_half(float value) noexcept {
    return std::isfinite(value) && Imath::half(value).isInfinity();
}

void encode_row(std::span<const float> values, PixelFormat format, std::byte* bytes) {
    if (format == PixelFormat::half) {
        for (const float value : values) {
            const std::uint16_t bits = Imath::half(value).bits();
            std::memcpy(bytes, &bits, sizeof bits);
            bytes += sizeof bits;
        }
    } else if (format == PixelFormat::float24) {
        for (const float value : values) {
            const float rounded = round_to_float24(value);
            std::memcpy(bytes, &rounded, sizeof rounded);
            bytes += sizeof rounded;
        }
    } else {
        std::memcpy(bytes, values.data(), values.size_bytes());
    }
}

void PixelWatch::add(std::span<const float> values, std::uint64_t y, std::uint64_t z, std::uint64_t repeat,
                     std::uint64_t x) {
    const Voxel first{x, y, z};
    const std::int32_t largest = largest_magnitude(values);
    if (largest >= static_cast<std::int32_t>(kInfinity))
        add_non_finite(values, first, repeat);
    const auto magnitude = static_cast<double>(std::bit_cast<float>(largest));
    if (!largest_.found || !(magnitude <= std::abs(largest_.value)))
        add_largest(values, first);
    // No sample of this row is longer than sqrt(3) times its largest component.
    if (!longest_.found || !(magnitude * 1.7320508075688775 <= longest_.value))
        add_longest(values, first);
}

void PixelWatch::add_largest(std::span<const float> values, const Voxel& first) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = static_cast<double>(values[i]);
        if (std::isfinite(value) && (!largest_.found || std::abs(value) > std::abs(largest_.value)))
            largest_ = {value, {first[0] + i / components_, first[1], first[2]}, true};
    }
}

void PixelWatch::add_longest(std::span<const float> values, const Voxel& first) {
    std::size_t where = values.size();
    for (std::size_t i = 0; i < values.size(); i += components_) {
        double squared = 0; // of floats, in double: cannot overflow
        for (std::size_t c = 0; c < components_; ++c)
            squared += static_cast<double>(values[i + c]) * static_cast<double>(values[i + c]);
        if (squared > longest_squared_ && std::isfinite(squared)) {
            longest_squared_ = squared;
            where = i;
        }
    }
    if (where < values.size())
        longest_ = {std::sqrt(longest_squared_), {first[0] + where / components_, first[1], first[2]}, true};
}

void PixelWatch::add_non_finite(std::span<const float> values, const Voxel& first, std::uint64_t repeat) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isfinite(values[i]))
            continue;
        non_finite_ += repeat;
        if (!first_non_finite_.found)
            first_non_finite_ = {
                static_cast<double>(values[i]), {first[0] + i / components_, first[1], first[2]}, true};
    }
}

} // namespace forceshade
