#include "host/output/rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/core.h>
#include <half.h>

namespace forceshade {

namespace {

template <typename T, typename real>
std::span<const T> require_samples(std::span<const T> samples, const layout::FieldChunk<real>& chunk,
                                   std::uint32_t channel) {
    const std::size_t rows = chunk.y_count * chunk.z_count;
    if (rows > 0 && samples.size() < ((rows - 1) * chunk.x_pitch + chunk.x_count) * components_of(channel))
        throw std::logic_error(fmt::format("chunk lacks samples of channel {}", name_of_channel(channel)));
    return samples;
}

} // namespace

const char* name_of_channel(std::uint32_t channel) {
    static constexpr std::pair<std::uint32_t, const char*> kNames[] = {{layout::kChannelForce, "force"},
                                                                       {layout::kChannelDepth, "depth"},
                                                                       {layout::kChannelFacet, "facet"},
                                                                       {layout::kChannelProxy, "proxy"},
                                                                       {layout::kChannelUnshaded, "unshaded"},
                                                                       {layout::kChannelPosition, "position"},
                                                                       {kChannelAngle, "angle"},
                                                                       {kChannelMagnitudeError, "magnitude_error"}};
    for (const auto& [known, name] : kNames)
        if (known == channel)
            return name;
    throw std::logic_error(fmt::format("no channel {}", channel));
}

void RowOrder::accept(const AnyFieldChunk& any, std::size_t repeat_y) {
    const auto accept = [&](const auto& chunk) {
        const auto [nx, ny, nz] = size_;
        const bool repeated = repeat_y > 1;
        const bool whole_layers = chunk.y_first == 0 && (repeated ? chunk.y_count == 1 : chunk.y_count == ny);
        const bool in_order = chunk.z_first * ny + chunk.y_first == next_row_;
        const bool inside = chunk.x_count == nx && chunk.x_pitch >= nx && chunk.y_first + chunk.y_count <= ny &&
                            chunk.z_first + chunk.z_count <= nz;
        const bool one_layer = chunk.z_count == 1 && !repeated;
        if (!in_order || !inside || !(whole_layers || one_layer) || (repeated && repeat_y != ny))
            throw std::logic_error(fmt::format("chunk of y {}+{}, z {}+{} is not what follows row {} of {} x {} x {}",
                                               chunk.y_first, chunk.y_count, chunk.z_first, chunk.z_count, next_row_,
                                               nx, ny, nz));
        next_row_ += chunk.z_count * chunk.y_count * (repeated ? repeat_y : 1);
    };
    std::visit(accept, any);
}

void RowOrder::require_complete() const {
    if (next_row_ != size_[1] * size_[2])
        throw std::logic_error(fmt::format("only {} of {} rows were written", next_row_, size_[1] * size_[2]));
}

template <typename real> std::span<const real> values_of(const layout::FieldChunk<real>& chunk, std::uint32_t channel) {
    for (const auto& [known, samples] : {std::pair(layout::kChannelForce, chunk.force),
                                         {layout::kChannelDepth, chunk.depth},
                                         {layout::kChannelProxy, chunk.proxy},
                                         {layout::kChannelUnshaded, chunk.unshaded},
                                         {kChannelAngle, chunk.angle},
                                         {kChannelMagnitudeError, chunk.magnitude_error}})
        if (known == channel)
            return require_samples(samples, chunk, channel);
    throw std::logic_error(fmt::format("channel {} holds no reals", channel));
}

template <typename real> std::span<const layout::uint> ids_of(const layout::FieldChunk<real>& chunk) {
    return require_samples(chunk.facet, chunk, layout::kChannelFacet);
}

template std::span<const float> values_of(const layout::FieldChunk<float>&, std::uint32_t);
template std::span<const double> values_of(const layout::FieldChunk<double>&, std::uint32_t);
template std::span<const layout::uint> ids_of(const layout::FieldChunk<float>&);
template std::span<const layout::uint> ids_of(const layout::FieldChunk<double>&);

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
    const auto put = [&bytes](auto stored) {
        std::memcpy(bytes, &stored, sizeof stored);
        bytes += sizeof stored;
    };
    if (format == PixelFormat::half)
        for (const float value : values)
            put(Imath::half(value).bits());
    else if (format == PixelFormat::float24)
        for (const float value : values)
            put(round_to_float24(value));
    else
        std::memcpy(bytes, values.data(), values.size_bytes());
}

void PixelWatch::add(std::span<const float> values, std::uint64_t y, std::uint64_t z, std::uint64_t repeat,
                     std::uint64_t x) {
    const auto most = static_cast<double>(std::bit_cast<float>(largest_magnitude(values)));
    // No sample of this row is longer than sqrt(3) times its largest component.
    if (largest_.found && most <= std::abs(largest_.value) && most * 1.7320508075688775 <= longest_.value)
        return;
    for (std::size_t i = 0; i < values.size(); i += components_) {
        const Voxel at{x + i / components_, y, z};
        double squared = 0; // of floats, in double: cannot overflow
        for (const float one : values.subspan(i, components_)) {
            const auto value = static_cast<double>(one);
            squared += value * value;
            if (!std::isfinite(value)) {
                non_finite_ += repeat;
                if (!first_non_finite_.found)
                    first_non_finite_ = {value, at, true};
            } else if (!largest_.found || std::abs(value) > std::abs(largest_.value)) {
                largest_ = {value, at, true};
            }
        }
        if (std::isfinite(squared) && squared > longest_squared_) {
            longest_squared_ = squared;
            longest_ = {std::sqrt(squared), at, true};
        }
    }
}

namespace {

// Where the steps of a chunk go in rows of `width` samples.
struct Window {
    std::size_t paths, pitch, first, count, width;
};

// From step after step to path after path, in tiles so that what is read stays in the nearest memory.
template <typename Value>
void transpose(const Window& window, std::span<const Value> from, std::size_t components, std::vector<Value>& to) {
    constexpr std::size_t kTile = 128; // steps
    if (from.empty())
        return;
    to.resize(window.paths * window.width * components);
    for (std::size_t tile = 0; tile < window.count; tile += kTile)
        for (std::size_t path = 0; path < window.paths; ++path)
            for (std::size_t step = tile; step < std::min(tile + kTile, window.count); ++step)
                for (std::size_t c = 0; c < components; ++c)
                    to[(path * window.width + window.first + step) * components + c] =
                        from[(step * window.pitch + path) * components + c];
}

} // namespace

template <typename T> std::span<const T> values_of(const PathRows<T>& rows, std::uint32_t channel) {
    const std::span<const T> values = channel == layout::kChannelForce      ? rows.force
                                      : channel == layout::kChannelPosition ? rows.position
                                      : channel == layout::kChannelDepth    ? rows.depth
                                      : channel == kChannelAngle            ? rows.angle
                                      : channel == kChannelMagnitudeError   ? rows.magnitude_error
                                                                            : rows.proxy;
    if (values.size() < rows.path_count * rows.pitch * components_of(channel))
        throw std::logic_error(fmt::format("paths lack samples of channel {}", name_of_channel(channel)));
    return values;
}
template std::span<const float> values_of(const PathRows<float>&, std::uint32_t);
template std::span<const double> values_of(const PathRows<double>&, std::uint32_t);

std::size_t path_sample_bytes(layout::uint channels, std::size_t real_bytes) {
    std::size_t bytes = 0;
    for (const std::uint32_t channel : {layout::kChannelForce, layout::kChannelPosition, layout::kChannelProxy,
                                        layout::kChannelDepth, layout::kChannelFacet})
        if (channels & channel)
            bytes += components_of(channel) * (channel == layout::kChannelFacet ? sizeof(layout::uint) : real_bytes);
    return bytes;
}

template <typename T> void RowGatherer<T>::add(const layout::PathChunk<T>& chunk) {
    if (chunk.step_first != next_step_ || chunk.path_count != source_.lengths().size())
        throw std::logic_error(fmt::format("steps from {} of {} paths are not what follows step {} of {}",
                                           chunk.step_first, chunk.path_count, next_step_, source_.lengths().size()));
    const bool alone = chunk.path_count == 1;
    const std::size_t begin = alone ? chunk.step_first : 0; // of the rows
    const std::size_t width = alone ? chunk.step_count : source_.longest();
    const Window window{chunk.path_count, chunk.pitch, chunk.step_first - begin, chunk.step_count, width};
    Rows& rows = rows_[filled_];
    transpose(window, chunk.position, 3, rows.position);
    transpose(window, chunk.force, 3, rows.force);
    transpose(window, chunk.depth, 1, rows.depth);
    transpose(window, chunk.facet, 1, rows.facet);
    transpose(window, chunk.proxy, 3, rows.proxy);
    next_step_ += chunk.step_count;
    const bool whole = next_step_ >= source_.longest();
    if (whole)
        next_step_ = 0;
    if (!whole && !alone)
        return;
    rows.steps.assign(source_.lengths().begin(), source_.lengths().end());
    receive_({chunk.path_first, chunk.path_count, width, rows.steps, rows.position, rows.force, rows.depth, rows.facet,
              rows.proxy, begin});
    filled_ = 1 - filled_;
}

template class RowGatherer<float>;
template class RowGatherer<double>;

} // namespace forceshade
