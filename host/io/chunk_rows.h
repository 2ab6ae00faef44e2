// What all sinks do alike with a chunk: check that its rows are the next ones, and find the values of a channel.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "shaders/shared/layout.h"

namespace forceshade {

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

} // namespace forceshade
