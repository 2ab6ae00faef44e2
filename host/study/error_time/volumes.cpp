#include "host/study/error_time/volumes.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <thread>

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "host/field/case_law.h"
#include "host/field/engine.h"
#include "host/reference/mesh_contact.h"
#include "host/threads.h"

namespace forceshade::study::error_time {
namespace {

using Sample = reference::Vector<float>;
using Samples = std::array<std::size_t, 3>;

constexpr std::size_t kBandCells = 8, kBandSamples = kBandCells + 1;
constexpr std::size_t kTreeCells = 4, kTreeSamples = kTreeCells + 1;
constexpr std::size_t kTreeFloats = 3 * kTreeSamples * kTreeSamples * kTreeSamples;
constexpr double kRoot = 32;      // of the spacing asked for: a root's edge
constexpr double kShallow = 0.02; // of the largest force that counts: smaller ones' errors count as those of this one

template <typename Visit> void for_each(const Samples& size, const Visit& visit) {
    for (std::size_t k = 0; k < size[2]; ++k)
        for (std::size_t j = 0; j < size[1]; ++j)
            for (std::size_t i = 0; i < size[0]; ++i)
                visit(Samples{i, j, k});
}

Sample trilinear(const float* forces, std::size_t samples, const Samples& first, const Sample& share) noexcept {
    Sample result(0.0F);
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t j = 0; j < 2; ++j) {
            const float* at = forces + 3 * (((first[2] + k) * samples + first[1] + j) * samples + first[0]);
            const Sample one(at[0], at[1], at[2]), other(at[3], at[4], at[5]);
            result += (k ? share.z : 1 - share.z) * (j ? share.y : 1 - share.y) * (one + share.x * (other - one));
        }
    return result;
}

// The whole part of a coordinate, at least 0 and below `count`; the rest is left in `at`.
std::size_t whole_of(float& at, std::size_t count) noexcept {
    const float whole = std::floor(std::clamp(at, 0.0F, static_cast<float>(count - 1)));
    at -= whole;
    return static_cast<std::size_t>(whole);
}

Samples whole_of(Sample& at, const Samples& count) noexcept {
    return {whole_of(at.x, count[0]), whole_of(at.y, count[1]), whole_of(at.z, count[2])};
}

} // namespace

GridSpec volume_grid(const glm::dvec3& low, const glm::dvec3& high, double spacing, const glm::dvec3& offset) {
    GridSpec grid;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        grid.origin[axis] = low[i] - (2 + offset[i]) * spacing;
        grid.spacing[axis] = spacing;
        grid.size[axis] = static_cast<std::uint64_t>(std::ceil((high[i] - low[i]) / spacing)) + 6;
    }
    return grid;
}

TurnedGrid::TurnedGrid(const glm::dvec3& low, const glm::dvec3& high, double spacing, const glm::dvec3& offset,
                       const glm::dmat3& turn)
    : middle(0.5 * (low + high)), axes(turn) {
    const glm::dmat3 sizes(glm::abs(turn[0]), glm::abs(turn[1]), glm::abs(turn[2]));
    const glm::dvec3 reach = 0.5 * (high - low) * sizes;
    grid = volume_grid(middle - reach, middle + reach, spacing, offset);
}

glm::dmat3 turn_and_tilt(double turn, double tilt, double aside) {
    const auto about_z = [](double angle) {
        return glm::dmat3(std::cos(angle), std::sin(angle), 0, -std::sin(angle), std::cos(angle), 0, 0, 0, 1);
    };
    const glm::dmat3 about_x(1, 0, 0, 0, std::cos(tilt), std::sin(tilt), 0, -std::sin(tilt), std::cos(tilt));
    return about_z(aside) * about_x * about_z(turn - aside);
}

std::vector<float> sampled(const PreparedCase& prepared, const TurnedGrid& turned) {
    const GridSpec& grid = turned.grid;
    if (turned.axes == glm::dmat3(1)) {
        PreparedCase there = prepared;
        there.one.scene.output.channels = layout::kChannelForce;
        there.one.scene.grid = grid;
        EngineOptions oracle;
        oracle.cpu = true;
        return evaluate<float>(there, *make_engine(oracle)).force;
    }
    const CaseLaw<float> law(prepared);
    const std::size_t layer = grid.size[0] * grid.size[1];
    std::vector<float> forces(3 * layer * grid.size[2]);
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < most_threads(); ++thread)
        threads.emplace_back([&, thread] {
            layout::uint hint = 0;
            for (std::size_t k = thread; k < grid.size[2]; k += most_threads())
                for (std::size_t i = 0; i < layer; ++i) {
                    const auto force = law.at(turned.place_of(i % grid.size[0], i / grid.size[0], k), hint).force;
                    for (int axis = 0; axis < 3; ++axis)
                        forces[3 * (k * layer + i) + std::size_t(axis)] = force[axis];
                }
        });
    threads.clear();
    return forces;
}

bool has_depths(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    if (scene.texture)
        return false;
    return scene.surface.kind == SurfaceKind::mesh ? scene.force.shading != Shading::two_pass
                                                   : scene.force.depth == DepthReading::vertical;
}

namespace {

// Of a mesh: the distance from its nearest point, and the force's direction there.
std::vector<float> mesh_depths(const PreparedCase& prepared, const TurnedGrid& turned) {
    const GridSpec& grid = turned.grid;
    const CaseLaw<double> of_case(prepared);
    const layout::Law<double>& law = of_case.law();
    std::vector<float> values;
    layout::uint hint = 0;
    for_each({grid.size[0], grid.size[1], grid.size[2]}, [&](const Samples& at) {
        const reference::Vector<double> place = of_case.rounded(turned.place_of(at[0], at[1], at[2]));
        const reference::Nearest<double> found = reference::nearest(law.mesh, place, hint);
        hint = found.triangle;
        const bool inside = reference::is_inside(law, found, place);
        const reference::Contact<double> contact = reference::contact_with(law, found, place);
        const reference::Vector<double> normal = reference::vector_at(law.mesh.facet_normals, found.facet);
        // Seen from outside an unshaded force points to the surface.
        const bool turns = reference::dot(contact.force, normal) < 0;
        const double size = reference::length(contact.force);
        const glm::dvec3 direction(size > 0 ? (turns ? -1 : 1) / size * contact.force : normal);
        values.insert(values.end(), {float(inside ? contact.depth : -contact.depth), float(direction.x),
                                     float(direction.y), float(direction.z)});
    });
    return values;
}

} // namespace

std::vector<float> sampled_depths(const PreparedCase& prepared, const TurnedGrid& turned) {
    if (prepared.images.mesh)
        return mesh_depths(prepared, turned);
    const GridSpec& grid = turned.grid;
    const CaseLaw<double> law(prepared);
    const bool upright = turned.axes[2] == glm::dvec3(0, 0, 1);
    const glm::dvec3 reach = sample_place(grid, grid.size[0], grid.size[1], grid.size[2]) - sample_place(grid, 0, 0, 0);
    const double below = turned.middle.z - reference::length(reach) - 1; // m: far below any surface
    std::vector<glm::dvec4> columns;                                     // height above `below`, direction
    std::vector<float> values;
    for (std::size_t k = 0; k < grid.size[2]; ++k) {
        if (!upright)
            columns.clear();
        for (std::size_t column = 0; column < grid.size[0] * grid.size[1]; ++column) {
            const glm::dvec3 place = turned.place_of(column % grid.size[0], column / grid.size[0], k);
            if (column == columns.size()) {
                const auto found = law.at({place.x, place.y, below});
                const glm::dvec3 direction = glm::dvec3(found.force) / reference::length(found.force);
                columns.emplace_back(found.depth, direction.x, direction.y, direction.z);
            }
            const glm::dvec4& at = columns[column];
            values.insert(values.end(), {float(at.x - (place.z - below)), float(at.y), float(at.z), float(at.w)});
        }
    }
    return values;
}

NarrowBand::NarrowBand(const GridSpec& grid, std::span<const float> forces, float most)
    : origin_(grid.origin[0], grid.origin[1], grid.origin[2]),
      inverse_(float(1 / grid.spacing[0])), size_{grid.size[0], grid.size[1], grid.size[2]} {
    for (std::size_t axis = 0; axis < 3; ++axis)
        bricks_[axis] = (size_[axis] - 1 + kBandCells - 1) / kBandCells;
    std::uint32_t stored = 0;
    for_each(bricks_, [&](const Samples& brick) {
        bool met = false;
        std::vector<float> samples;
        for_each({kBandSamples, kBandSamples, kBandSamples}, [&](const Samples& within) {
            Samples at; // the last sample stands for those beyond it
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis] = std::min(kBandCells * brick[axis] + within[axis], size_[axis] - 1);
            const float* force = &forces[3 * ((at[2] * size_[1] + at[1]) * size_[0] + at[0])];
            const float size = reference::length(Sample(force[0], force[1], force[2]));
            met = met || (size > 0 && size <= most);
            samples.insert(samples.end(), force, force + 3);
        });
        index_.push_back(met ? stored++ : UINT32_MAX);
        if (met)
            forces_.insert(forces_.end(), samples.begin(), samples.end());
    });
}

Sample NarrowBand::operator()(const Sample& place) const noexcept {
    Sample share = (place - origin_) * inverse_;
    const Samples at = whole_of(share, {size_[0] - 1, size_[1] - 1, size_[2] - 1});
    const std::uint32_t stored =
        index_[(at[2] / kBandCells * bricks_[1] + at[1] / kBandCells) * bricks_[0] + at[0] / kBandCells];
    if (stored == UINT32_MAX)
        return Sample(0.0F);
    return trilinear(&forces_[3 * kBandSamples * kBandSamples * kBandSamples * stored], kBandSamples,
                     {at[0] % kBandCells, at[1] % kBandCells, at[2] % kBandCells}, share);
}

// A leaf: its node, where it is, how far it is off.
struct AdaptiveVolume::Open {
    double error; /* m^3: its volume times the square of the relative error */
    std::uint32_t node, brick;
    glm::dvec3 low; /* m */
    double edge;    /* m */

    bool operator<(const Open& other) const { return std::pair(error, other.node) < std::pair(other.error, node); }
};

AdaptiveVolume::AdaptiveVolume(const GridSpec& grid, const ForceAt& force, float most, double bytes)
    : origin_(grid.origin[0], grid.origin[1], grid.origin[2]), inverse_(float(1 / (kRoot * grid.spacing[0]))) {
    const double edge = kRoot * grid.spacing[0];
    const glm::dvec3 origin = sample_place(grid, 0, 0, 0);
    for (std::size_t axis = 0; axis < 3; ++axis)
        roots_[axis] = static_cast<std::size_t>(std::ceil(double(grid.size[axis] - 1) / kRoot));
    links_.resize(roots_[0] * roots_[1] * roots_[2]);
    std::priority_queue<Open> open;
    std::uint32_t node = 0;
    for_each(roots_, [&](const Samples& root) {
        open.push(
            opened(grid, force, most, {0, node, node, origin + edge * glm::dvec3(root[0], root[1], root[2]), edge}));
        ++node;
    });
    // Eight leaves in place of one.
    while (!open.empty() && open.top().error > 0 &&
           this->bytes() + double(7 * sizeof(float) * kTreeFloats + 8 * sizeof(std::uint32_t)) <= bytes) {
        const Open worst = open.top();
        open.pop();
        const auto first = static_cast<std::uint32_t>(links_.size());
        links_[worst.node] = first;
        links_.resize(links_.size() + 8);
        const double half = worst.edge / 2;
        for (std::uint32_t child = 0; child < 8; ++child)
            open.push(opened(grid, force, most,
                             {0, first + child,
                              child == 0 ? worst.brick : static_cast<std::uint32_t>(forces_.size() / kTreeFloats),
                              worst.low + half * glm::dvec3(child & 1, child >> 1 & 1, child >> 2), half}));
    }
}

// Samples a leaf.
AdaptiveVolume::Open AdaptiveVolume::opened(const GridSpec& grid, const ForceAt& force, float most, Open leaf) {
    const double cell = leaf.edge / kTreeCells;
    const glm::dvec3 high = sample_place(grid, grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
    const auto place = [&](const Samples& at, double aside) {
        return leaf.low + cell * (glm::dvec3(at[0], at[1], at[2]) + aside);
    };
    std::vector<float> samples;
    for_each({kTreeSamples, kTreeSamples, kTreeSamples}, [&](const Samples& at) {
        const Sample found = force(place(at, 0));
        samples.insert(samples.end(), {found.x, found.y, found.z});
    });
    forces_.resize(std::max(forces_.size(), (leaf.brick + 1) * kTreeFloats));
    std::ranges::copy(samples, forces_.begin() + static_cast<std::ptrdiff_t>(leaf.brick * kTreeFloats));
    links_[leaf.node] = kLeaf | leaf.brick;
    for_each({kTreeCells, kTreeCells, kTreeCells}, [&](const Samples& at) {
        const glm::dvec3 middle = place(at, 0.5);
        if (glm::any(glm::greaterThan(middle, high)))
            return;
        const Sample truth = force(middle), read = trilinear(samples.data(), kTreeSamples, at, Sample(0.5F));
        const float size = reference::length(truth), off = reference::length(truth - read);
        if (size <= most)
            leaf.error += double(off) * off * cell * cell * cell / std::pow(double(size) + kShallow * double(most), 2);
    });
    return leaf;
}

Sample AdaptiveVolume::operator()(const Sample& place) const noexcept {
    Sample share = (place - origin_) * inverse_;
    const Samples root = whole_of(share, roots_);
    std::uint32_t link = links_[(root[2] * roots_[1] + root[1]) * roots_[0] + root[0]];
    while (!(link & kLeaf)) {
        share *= 2.0F;
        const Samples half = whole_of(share, {2, 2, 2});
        link = links_[link + half[0] + 2 * half[1] + 4 * half[2]];
    }
    share *= float(kTreeCells);
    const Samples at = whole_of(share, {kTreeCells, kTreeCells, kTreeCells});
    return trilinear(&forces_[kTreeFloats * (link & ~kLeaf)], kTreeSamples, at, share);
}

} // namespace forceshade::study::error_time
