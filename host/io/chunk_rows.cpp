#include "host/io/chunk_rows.h"

#include <stdexcept>

#include <fmt/core.h>

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
    switch (channel) {
    case layout::kChannelForce:
        return "force";
    case layout::kChannelDepth:
        return "depth";
    case layout::kChannelFacet:
        return "facet";
    case layout::kChannelProxy:
        return "proxy";
    case layout::kChannelUnshaded:
        return "unshaded";
    case layout::kChannelPosition:
        return "position";
    default:
        throw std::logic_error(fmt::format("no channel {}", channel));
    }
}

template <typename real> void RowOrder::accept(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
    const auto [nx, ny, nz] = size_;
    const bool repeated = repeat_y > 1;
    const bool whole_layers = chunk.y_first == 0 && (repeated ? chunk.y_count == 1 : chunk.y_count == ny);
    const bool in_order = chunk.z_first * ny + chunk.y_first == next_row_;
    const bool inside = chunk.x_count == nx && chunk.x_pitch >= nx && chunk.y_first + chunk.y_count <= ny &&
                        chunk.z_first + chunk.z_count <= nz;
    if (!in_order || !inside || !(whole_layers || (chunk.z_count == 1 && !repeated)) || (repeated && repeat_y != ny))
        throw std::logic_error(fmt::format("chunk of y {}+{}, z {}+{} is not what follows row {} of {} x {} x {}",
                                           chunk.y_first, chunk.y_count, chunk.z_first, chunk.z_count, next_row_, nx,
                                           ny, nz));
    next_row_ += chunk.z_count * chunk.y_count * (repeated ? repeat_y : 1);
}

void RowOrder::require_complete() const {
    if (next_row_ != size_[1] * size_[2])
        throw std::logic_error(fmt::format("only {} of {} rows were written", next_row_, size_[1] * size_[2]));
}

template <typename real> std::span<const real> values_of(const layout::FieldChunk<real>& chunk, std::uint32_t channel) {
    switch (channel) {
    case layout::kChannelForce:
        return require_samples(chunk.force, chunk, channel);
    case layout::kChannelDepth:
        return require_samples(chunk.depth, chunk, channel);
    case layout::kChannelProxy:
        return require_samples(chunk.proxy, chunk, channel);
    case layout::kChannelUnshaded:
        return require_samples(chunk.unshaded, chunk, channel);
    default:
        throw std::logic_error(fmt::format("channel {} holds no reals", channel));
    }
}

template <typename real> std::span<const layout::uint> ids_of(const layout::FieldChunk<real>& chunk) {
    return require_samples(chunk.facet, chunk, layout::kChannelFacet);
}

template void RowOrder::accept(const layout::FieldChunk<float>&, std::size_t);
template void RowOrder::accept(const layout::FieldChunk<double>&, std::size_t);
template std::span<const float> values_of(const layout::FieldChunk<float>&, std::uint32_t);
template std::span<const double> values_of(const layout::FieldChunk<double>&, std::uint32_t);
template std::span<const layout::uint> ids_of(const layout::FieldChunk<float>&);
template std::span<const layout::uint> ids_of(const layout::FieldChunk<double>&);

} // namespace forceshade
