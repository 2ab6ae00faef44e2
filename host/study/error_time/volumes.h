// Volumes of precomputed forces, or of depths with directions, read between their samples: trilinear, or tricubic
// (Catmull & Rom 1974; as a convolution: Keys 1981). And volumes that hold less than every sample of a grid: a narrow
// band, and samples closer where it matters.
#pragma once

#include <Imath/half.h>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "host/reference/elementary.h"
#include "host/touch/places.h"

namespace forceshade::study::error_time {

/// The grid of cubic samples over a box, with two more on each side than it needs, for the tricubic reading; moved down
/// by `offset` spacings, 0 to 1 each.
GridSpec volume_grid(const glm::dvec3& low, const glm::dvec3& high, double spacing, const glm::dvec3& offset);

/// Such a grid turned about the middle of the box, large enough to hold it.
struct TurnedGrid {
    /// `turn`: the grid's axes in the world; 1 leaves it along those of the world.
    TurnedGrid(const glm::dvec3& low, const glm::dvec3& high, double spacing, const glm::dvec3& offset,
               const glm::dmat3& turn = glm::dmat3(1));

    glm::dvec3 in_grid(const glm::dvec3& place) const { return middle + (place - middle) * axes; }
    glm::dvec3 in_world(const glm::dvec3& place) const { return middle + axes * (place - middle); }
    /// In the world.
    glm::dvec3 place_of(std::size_t i, std::size_t j, std::size_t k) const {
        return in_world(sample_place(grid, i, j, k));
    }

    glm::dvec3 middle; /* m */
    glm::dmat3 axes;
    GridSpec grid; /* in its own axes */
};

/// A turn about the vertical, rad, then by `tilt`, rad, about a horizontal axis at `aside`, rad, from x.
glm::dmat3 turn_and_tilt(double turn, double tilt, double aside);

/// The scene's forces at the samples of a grid, N, 3 a sample, along the world's axes, by the oracle on all cores.
std::vector<float> sampled(const PreparedCase& prepared, const TurnedGrid& turned);

/// Of a surface over x and y whose depth is read vertically, or of a mesh: depth, m, below 0 above the surface, and the
/// direction of the force below it, 4 a sample.
std::vector<float> sampled_depths(const PreparedCase& prepared, const TurnedGrid& turned);
bool has_depths(const PreparedCase& prepared);

/// N numbers a sample, as Stored (half, float, double), read in the arithmetic of T at places of the world, m.
template <typename Stored, typename T, int N> class Volume {
public:
    using Value = glm::vec<N, T, glm::highp>;

    Volume(const GridSpec& grid, std::vector<Stored> values)
        : grid_(grid), values_(std::move(values)), origin_(grid.origin[0], grid.origin[1], grid.origin[2]),
          inverse_(T(1 / grid.spacing[0])) {}

    Value trilinear(const reference::Vector<T>& place) const noexcept {
        const Cell x = cell_at(place, 0), y = cell_at(place, 1), z = cell_at(place, 2);
        Value result(T(0));
        for (std::size_t k = 0; k < 2; ++k)
            for (std::size_t j = 0; j < 2; ++j) {
                const std::size_t at = ((z.first + k) * grid_.size[1] + y.first + j) * grid_.size[0] + x.first;
                const Value row = value_at(at) + x.share * (value_at(at + 1) - value_at(at));
                result += (k ? z.share : T(1) - z.share) * (j ? y.share : T(1) - y.share) * row;
            }
        return result;
    }

    Value tricubic(const reference::Vector<T>& place) const noexcept {
        const Cell x = cell_at(place, 0), y = cell_at(place, 1), z = cell_at(place, 2);
        const Weights along_x = weights(x.share), along_y = weights(y.share), along_z = weights(z.share);
        Value result(T(0));
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t j = 0; j < 4; ++j) {
                const std::size_t at =
                    ((z.first + k - 1) * grid_.size[1] + y.first + j - 1) * grid_.size[0] + x.first - 1;
                const Value row = along_x[0] * value_at(at) + along_x[1] * value_at(at + 1) +
                                  along_x[2] * value_at(at + 2) + along_x[3] * value_at(at + 3);
                result += along_z[k] * along_y[j] * row;
            }
        return result;
    }

    double bytes() const { return double(sizeof(Stored) * values_.size()); }

private:
    struct Cell {
        std::size_t first;
        T share;
    };
    using Weights = std::array<T, 4>;

    // The sample below a place on an axis, such that the tricubic reading stays within the volume.
    Cell cell_at(const reference::Vector<T>& place, int axis) const noexcept {
        const T at = (place[axis] - origin_[axis]) * inverse_;
        const T most = static_cast<T>(grid_.size[static_cast<std::size_t>(axis)] - 3);
        const T whole = std::floor(at < T(1) ? T(1) : (at > most ? most : at));
        return {static_cast<std::size_t>(whole), at - whole};
    }

    static Weights weights(T t) noexcept {
        const T square = t * t, cube = square * t;
        return {T(0.5) * (square + square - t - cube), T(1) - T(2.5) * square + T(1.5) * cube,
                T(0.5) * t + (square + square) - T(1.5) * cube, T(0.5) * (cube - square)};
    }

    Value value_at(std::size_t sample) const noexcept {
        const Stored* of = values_.data() + N * sample;
        Value value;
        for (int i = 0; i < N; ++i)
            value[i] = T(of[i]);
        return value;
    }

    GridSpec grid_;
    std::vector<Stored> values_;
    reference::Vector<T> origin_;
    T inverse_; /* 1/m */
};

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
