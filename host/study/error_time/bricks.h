// Volumes of precomputed forces that hold less than every sample of a grid: a narrow band, and samples closer where it
// matters.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/reference/elementary.h"

namespace forceshade::study::error_time {

/// Of the samples of a grid bricks of 8 cells a side in which a force of at most `most` acts somewhere. Elsewhere it
/// reads no force.
class NarrowBand {
public:
    /// `forces`, N: 3 a sample.
    NarrowBand(const GridSpec& grid, std::span<const float> forces, float most);

    /// N, at a place of the grid's axes, m, trilinear.
    reference::Vector<float> operator()(const reference::Vector<float>& place) const noexcept;
    double bytes() const { return double(sizeof(float) * forces_.size() + sizeof(std::uint32_t) * index_.size()); }

private:
    reference::Vector<float> origin_;
    float inverse_; /* 1/m */
    std::array<std::size_t, 3> size_, bricks_;
    std::vector<std::uint32_t> index_; // of a brick's samples in `forces_`, in bricks
    std::vector<float> forces_;
};

/// An octree of bricks of 4 cells a side, adaptively sampled (Frisken et al. 2000): the brick that is furthest off at
/// the middles of its cells is cut into eight, until as many bytes are used as asked for.
class AdaptiveVolume {
public:
    using ForceAt = std::function<reference::Vector<float>(const glm::dvec3&)>;
    /// `force`, N, at a place of the grid's axes, m; where it is larger than `most`, nothing is asked for.
    AdaptiveVolume(const GridSpec& grid, const ForceAt& force, float most, double bytes);

    /// N, at a place of the grid's axes, m, trilinear within a brick.
    reference::Vector<float> operator()(const reference::Vector<float>& place) const noexcept;
    double bytes() const { return double(sizeof(float) * forces_.size() + sizeof(std::uint32_t) * links_.size()); }

private:
    static constexpr std::uint32_t kLeaf = 1u << 31;
    struct Open;
    Open opened(const GridSpec& grid, const ForceAt& force, float most, Open leaf);

    reference::Vector<float> origin_;
    float inverse_; /* 1/m: of a root's edge */
    std::array<std::size_t, 3> roots_;
    std::vector<std::uint32_t> links_; // of a node: its first child's, or kLeaf and its samples' place in bricks
    std::vector<float> forces_;
};

} // namespace forceshade::study::error_time
