// Beams of rays through the samples of a grid, slice by slice: what sweeps the regions of region_sweep.h.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "host/mesh/region_sweep.h"
#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

/// Some samples that a beam meets.
struct SampleRun {
    static constexpr std::size_t kMost = 128;

    std::size_t count = 0;
    std::array<float, kMost> x, y, z; /* of the mesh's frame */
    std::array<float, kMost> known;   /* squared distance of their cells */
    std::array<std::uint32_t, kMost> cells;
    std::array<float, kMost> square, beyond; /* to the region's feature; how far outside of a face's prism */

    reference::Vector<float> at(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// A triangle, and the unit vectors in its plane that point out of it across its edges.
struct SweptFace {
    reference::Triangle<float> triangle;
    std::array<reference::Vector<float>, 3> sides;
    layout::uint index;
    /// Fills the run's squares and `beyond`.
    void measure(SampleRun& run) const;
};
/// An edge of a triangle.
struct SweptEdge {
    reference::Vector<float> start, along;
    float per_square; /* 1 / |along|^2 */
    layout::uint index;
    void measure(SampleRun& run) const;
};
/// A corner of a triangle.
struct SweptCorner {
    reference::Vector<float> place;
    layout::uint index;
    void measure(SampleRun& run) const;
};

/// The samples of some slices that a beam may meet, first to last along both axes across.
struct BeamSections {
    static constexpr std::size_t kSlices = 8;
    std::array<std::array<int, kSlices>, 2> first, last;
};

/// Where a beam's four rays are in the first of the slices, and by how much they move with each; in samples across.
struct BeamRays {
    std::array<std::array<float, 4>, 2> at, step;
};

/// `gone`: slices since those of the rays. Sections are larger by `margin`, within the samples low to high. A bit for
/// each that is not empty.
unsigned find_sections(const BeamRays& rays, float gone, float margin, const std::array<int, 2>& low,
                       const std::array<int, 2>& high, BeamSections& sections);

/// What of a region is swept at once: the hull of the rays from `corners`, on the region's face, edge or corner, along
/// `steps`, across it and as long as takes them to the next slice of samples. Four corners are two by two.
template <std::size_t N> struct Beam { std::array<glm::dvec3, N> corners, steps; };

/// Where a beam goes: slices along `axis`, numbered backwards where it goes down.
struct BeamCourse {
    int axis;
    bool forward;

    std::array<int, 2> across() const { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }
};

/// Sends beams through a grid.
class BeamSweep {
public:
    explicit BeamSweep(const SweepInput& input) : input_(input), grid_(input.grid) {
        hiding_ = 2 * input.slack.at(input.surface.deepest);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int i = static_cast<int>(axis);
            origin_[i] = grid_.origin[axis];
            spacing_[i] = grid_.spacing[axis];
            per_spacing_[i] = 1 / spacing_[i];
            at_[axis] = grid_.at[axis].data();
            part_[axis] = grid_.part[axis].data() - grid_.first(i);
        }
    }

    const glm::dvec3& spacing() const { return spacing_; }

    /// As long as takes a direction to the next slice.
    glm::dvec3 step_of(const glm::dvec3& direction, int axis) const {
        return direction * (spacing_[axis] / std::abs(direction[axis]));
    }

    /// Calls use(run) with the samples of a beam, measured, but for those of which it is known that something else is
    /// nearer; it says whether some of them are about as near as what is known. From a slice on.
    template <std::size_t N, typename Region, typename Use>
    void sweep(const Beam<N>& beam, const BeamCourse& course, const Region& region, const Use& use,
               double from = -std::numeric_limits<double>::infinity()) {
        const int axis = course.axis;
        const auto across = course.across();
        std::array<double, N> start; // slice of the corner
        std::array<float, N> lengths;
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t i = 0; i < N; ++i) {
            const double at = (beam.corners[i][axis] - origin_[axis]) * per_spacing_[axis];
            start[i] = course.forward ? at : -at;
            low = std::min(low, start[i]);
            high = std::max(high, start[i]);
            lengths[i] = static_cast<float>(std::sqrt(reference::dot(beam.steps[i], beam.steps[i])));
        }
        const int end = grid_.end(axis), begin = grid_.first(axis);
        from = std::max({from, std::ceil(low - input_.margin), course.forward ? double(begin) : double(1 - end)});
        // A face's samples are as deep as their rays are long; others are no nearer than by their slices.
        const double step = N == 3 ? static_cast<double>(lengths[0]) : spacing_[axis];
        const double most =
            std::min(course.forward ? end - 1.0 : -double(begin), std::floor(high + input_.surface.deepest / step + 1));
        const std::array<int, 2> low_sample{grid_.first(across[0]), grid_.first(across[1])},
            high_sample{grid_.end(across[0]) - 1, grid_.end(across[1]) - 1};
        from += slices_before(beam, across, start, from, low_sample, high_sample);
        if (!(from <= most))
            return;
        const int first = static_cast<int>(from), last = static_cast<int>(most);
        // Relative to the first slice, so that single precision is enough.
        BeamRays rays;
        for (std::size_t side = 0; side < 2; ++side)
            for (std::size_t i = 0; i < 4; ++i) {
                const std::size_t j = i < N ? i : 0;
                rays.at[side][i] = static_cast<float>(place_of(beam, across[side], j, from - start[j]));
                rays.step[side][i] = static_cast<float>(beam.steps[j][across[side]] * per_spacing_[across[side]]);
            }
        const auto margin = static_cast<float>(input_.margin);
        std::size_t beaten = 0; // samples of the last slices
        for (int slice = first; slice <= last; slice += int(BeamSections::kSlices)) {
            if (slice > high) {
                if (is_hidden(beam, start, lengths, slice, beaten >= kSuspicious))
                    return;
                beaten = beaten >= kSuspicious ? 0 : beaten;
            }
            const auto gone = static_cast<float>(slice - first);
            if (const std::size_t edge = widest_edge<N>(rays, gone); edge < 4) {
                if (has_left(rays, gone, low_sample, high_sample))
                    return;
                sweep(half(beam, edge, 0), course, region, use, slice);
                sweep(half(beam, edge, 1), course, region, use, slice);
                return;
            }
            BeamSections sections;
            unsigned some = find_sections(rays, gone, margin, low_sample, high_sample, sections);
            if (some == 0) {
                if (has_left(rays, gone, low_sample, high_sample))
                    return;
                continue;
            }
            run_.count = 0;
            const auto finish = [&] {
                region.measure(run_);
                beaten = use(run_) ? 0 : beaten + run_.count;
                run_.count = 0;
            };
            for (; some != 0; some &= some - 1) {
                const auto k = static_cast<std::size_t>(std::countr_zero(some));
                if (slice + int(k) > last)
                    break;
                const int deep = course.forward ? slice + int(k) : -slice - int(k);
                reference::Vector<float> place;
                place[axis] = at_[std::size_t(axis)][deep];
                for (int j = sections.first[1][k]; j <= sections.last[1][k]; ++j) {
                    const std::size_t row =
                        std::size_t(part_[std::size_t(axis)][deep]) + part_[std::size_t(across[1])][j];
                    place[across[1]] = at_[std::size_t(across[1])][j];
                    for (int i = sections.first[0][k]; i <= sections.last[0][k]; ++i) {
                        place[across[0]] = at_[std::size_t(across[0])][i];
                        add(row + part_[std::size_t(across[0])][i], place);
                        if (run_.count == SampleRun::kMost)
                            finish();
                    }
                }
            }
            if (run_.count > 0)
                finish();
        }
    }

private:
    static constexpr float kWidest = 4;           // samples: wider beams are halved
    static constexpr std::size_t kSuspicious = 6; // samples: from this loss on a closer look pays

    // Of a ray along an axis across, in samples.
    template <std::size_t N> double place_of(const Beam<N>& beam, int axis, std::size_t ray, double steps) const {
        return (beam.corners[ray][axis] + beam.steps[ray][axis] * steps - origin_[axis]) * per_spacing_[axis];
    }

    // How many slices a beam may skip from one on, until it reaches the samples: infinite if it does not.
    template <std::size_t N>
    double slices_before(const Beam<N>& beam, const std::array<int, 2>& across, const std::array<double, N>& start,
                         double from, const std::array<int, 2>& low, const std::array<int, 2>& high) const {
        double skipped = 0;
        for (std::size_t side = 0; side < 2; ++side) {
            double to_low = std::numeric_limits<double>::infinity(), to_high = to_low;
            for (std::size_t i = 0; i < N; ++i) {
                const double at = place_of(beam, across[side], i, from - start[i]);
                const double step = beam.steps[i][across[side]] * per_spacing_[across[side]];
                const double below = low[side] - 1 - at, above = at - high[side] - 1;
                to_low = std::min(to_low, below <= 0 ? 0 : step > 0 ? below / step : to_low);
                to_high = std::min(to_high, above <= 0 ? 0 : step < 0 ? above / -step : to_high);
            }
            skipped = std::max({skipped, to_low, to_high});
        }
        return std::floor(skipped);
    }

    void add(std::size_t cell, const reference::Vector<float>& place) {
        run_.x[run_.count] = place.x;
        run_.y[run_.count] = place.y;
        run_.z[run_.count] = place.z;
        run_.known[run_.count] = square_of(input_.known(cell));
        run_.cells[run_.count++] = static_cast<std::uint32_t>(cell);
    }

    static Beam<3> half(const Beam<3>& beam, std::size_t edge, std::size_t part) {
        Beam<3> half = beam;
        const std::size_t next = (edge + 1) % 3;
        half.corners[part == 0 ? edge : next] = (beam.corners[edge] + beam.corners[next]) / 2.0;
        return half;
    }

    static Beam<4> half(const Beam<4>& beam, std::size_t edge, std::size_t part) {
        Beam<4> half = beam;
        const std::size_t stride = edge % 2 == 0 ? 1 : 2, other = 3 - stride;
        for (const std::size_t first : {std::size_t(0), other}) {
            const std::size_t second = first + stride, moved = part == 0 ? second : first;
            half.corners[moved] = (beam.corners[first] + beam.corners[second]) / 2.0;
            half.steps[moved] = (beam.steps[first] + beam.steps[second]) / 2.0;
        }
        return half;
    }

    // The edge along which a section is the widest, if it is too wide; else 4. Even edges of four corners go one way,
    // odd ones the other.
    template <std::size_t N> static std::size_t widest_edge(const BeamRays& rays, float gone) {
        constexpr std::array<std::array<std::size_t, 2>, 4> kThree{{{0, 1}, {1, 2}, {2, 0}, {0, 0}}},
            kFour{{{0, 1}, {0, 2}, {2, 3}, {1, 3}}};
        std::size_t widest = 4;
        float width = kWidest;
        for (std::size_t edge = 0; edge < N; ++edge) {
            const auto [i, j] = N == 3 ? kThree[edge] : kFour[edge];
            for (std::size_t side = 0; side < 2; ++side) {
                const auto& at = rays.at[side];
                const auto& step = rays.step[side];
                const float wide = std::abs(at[i] - at[j] + (step[i] - step[j]) * gone);
                if (wide > width) {
                    width = wide;
                    widest = edge;
                }
            }
        }
        return widest;
    }

    // Whether the section is beyond the grid, and only goes further.
    static bool has_left(const BeamRays& rays, float gone, const std::array<int, 2>& low,
                         const std::array<int, 2>& high) {
        for (std::size_t side = 0; side < 2; ++side) {
            bool below = true, above = true;
            for (std::size_t i = 0; i < 4; ++i) {
                const float step = rays.step[side][i], at = rays.at[side][i] + step * gone;
                below = below && step <= 0 && at < static_cast<float>(low[side]) - 1;
                above = above && step >= 0 && at > static_cast<float>(high[side]) + 1;
            }
            if (below || above)
                return true;
        }
        return false;
    }

    // Whether from a slice on all of a beam is nearer to one point of the surface than to its region's feature. What is
    // nearer to a point than to a plane, a line or another point, by a length, is convex, so that the section's corners
    // decide; and what is once nearer, on one ray, stays nearer by as much: by slack, even where that is largest.
    // `thorough`: also by the nearest point that is known of the middle.
    template <std::size_t N>
    bool is_hidden(const Beam<N>& beam, const std::array<double, N>& start, const std::array<float, N>& lengths,
                   int slice, bool thorough) const {
        std::array<reference::Vector<float>, N> section;
        std::array<float, N> spares; // squares: what is nearer hides it
        reference::Vector<float> middle(0);
        for (std::size_t i = 0; i < N; ++i) {
            const double along = slice - start[i];
            section[i] = reference::Vector<float>(beam.corners[i] + beam.steps[i] * along);
            middle += section[i] * (1.0f / N);
            const float distance = lengths[i] * static_cast<float>(along);
            const float spare = distance - hiding_;
            if (!(spare > 0))
                return false;
            spares[i] = spare * spare;
        }
        std::array<int, 3> sample;
        for (int axis = 0; axis < 3; ++axis) {
            const int last = static_cast<int>(grid_.at[std::size_t(axis)].size()) - 1;
            const double above = (double(middle[axis]) - origin_[axis]) * per_spacing_[axis] + 0.5; // rounds
            if (!(above > -0.5 && above < last + 1.5))
                return false;
            sample[std::size_t(axis)] = std::min(static_cast<int>(above), last);
        }
        const auto hides = [&](const reference::Vector<float>& witness) {
            for (std::size_t i = 0; i < N; ++i) {
                const reference::Vector<float> apart = section[i] - witness;
                if (!(reference::dot(apart, apart) < spares[i]))
                    return false;
            }
            return true;
        };
        if (hides(input_.near_vertices.at(sample)))
            return true;
        if (!thorough || sample[2] < grid_.z_first || sample[2] >= grid_.z_end)
            return false;
        const std::uint64_t known = input_.known(grid_.cell(sample[0], sample[1], sample[2]));
        if (known == kOutsideCell || triangle_of(known) == kNoTriangle)
            return false;
        const reference::Vector<float> at{at_[0][sample[0]], at_[1][sample[1]], at_[2][sample[2]]};
        const std::size_t triangle = triangle_of(known);
        const auto [a, b, c] = input_.surface.triangle_corners(triangle);
        const auto normal = reference::vector_at(std::span<const float>(input_.surface.normals), triangle);
        return hides(at + reference::nearest_on_triangle(at, a, b, c, normal).offset);
    }

    const SweepInput& input_;
    const SweptGrid& grid_;
    float hiding_; // 1: by how much a point must be nearer to hide a section
    glm::dvec3 origin_, spacing_, per_spacing_;
    std::array<const float*, 3> at_;
    std::array<const std::uint32_t*, 3> part_; // of the samples from the grid's first on
    SampleRun run_;
};

} // namespace forceshade
