// Whether two triangles that no corner joins come near each other, as about narrow slits and in thin walls, and whether
// slits narrow down to a corner or an edge.
#include "host/mesh/clearance.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

#include "host/reference/chunks.h"
#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"
#include "host/reference/mesh_neighbourhood.h"

namespace forceshade {

namespace {

using glm::dvec3;
using layout::uint;
using reference::cross;
using reference::dot;

struct Corners {
    std::array<dvec3, 3> at;
    std::array<uint, 3> vertices;
    dvec3 normal, low, high; /* 1; of its box */
};

Corners corners_of(const MeshParts& parts, const MeshReals<double>& reals, uint triangle) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
        corners.vertices[i] = parts.triangle_corners[3 * std::size_t(triangle) + i];
        corners.at[i] = reference::vector_at<double>(reals.vertices, corners.vertices[i]);
    }
    corners.low = corners.high = corners.at[0];
    for (std::size_t i = 1; i < 3; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            corners.low[axis] = std::min(corners.low[axis], corners.at[i][axis]);
            corners.high[axis] = std::max(corners.high[axis], corners.at[i][axis]);
        }
    corners.normal = reference::vector_at<double>(reals.triangle_normals, triangle);
    return corners;
}

// Whether a plane across this direction has more than `gap` between the triangles.
bool separates(const dvec3& direction, const Corners& one, const Corners& other, double gap) {
    const double square = dot(direction, direction);
    const auto extent = [&](const Corners& corners) {
        return std::minmax(
            {dot(direction, corners.at[0]), dot(direction, corners.at[1]), dot(direction, corners.at[2])});
    };
    const auto [low, high] = extent(one);
    const auto [other_low, other_high] = extent(other);
    const double between = std::max(other_low - high, low - other_high);
    return between > 0 && between * between > gap * gap * square;
}

// Along the normals, across edges in the planes, across pairs of edges: where no such plane separates two triangles,
// they meet (Gottschalk et al. 1996), or come about as near as the gap.
bool are_apart(const Corners& one, const Corners& other, double gap) {
    if (separates(one.normal, one, other, gap) || separates(other.normal, one, other, gap))
        return true;
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec3 edge = one.at[(i + 1) % 3] - one.at[i], its = other.at[(i + 1) % 3] - other.at[i];
        if (separates(cross(one.normal, edge), one, other, gap) || separates(cross(other.normal, its), one, other, gap))
            return true;
        for (std::size_t j = 0; j < 3; ++j)
            if (separates(cross(edge, dvec3(other.at[(j + 1) % 3] - other.at[j])), one, other, gap))
                return true;
    }
    return false;
}

// Whether two triangles with a common corner face each other across a slit sharper than about 11 degrees.
bool is_slit(const Corners& one, const Corners& other) {
    constexpr double kSharp = -0.98; // cosine between the normals
    if (!(dot(one.normal, other.normal) < kSharp))
        return false;
    const auto in_front = [](const Corners& of, const Corners& which) {
        return std::ranges::any_of(which.at, [&](const dvec3& at) { return dot(of.normal, dvec3(at - of.at[0])) > 0; });
    };
    return in_front(one, other) && in_front(other, one);
}

bool share_a_corner(const Corners& one, const Corners& other) {
    bool shared = false;
    for (const uint vertex : one.vertices)
        for (const uint its : other.vertices)
            shared |= vertex == its;
    return shared;
}

bool overlap(const dvec3& low, const dvec3& high, const Corners& other) {
    return other.low.x <= high.x && other.high.x >= low.x && other.low.y <= high.y && other.high.y >= low.y &&
           other.low.z <= high.z && other.high.z >= low.z;
}

// `one` has its box grown by the gap.
bool keep_apart(const Corners& one, const Corners& other, double gap) {
    if (!overlap(one.low, one.high, other))
        return true;
    return share_a_corner(one, other) ? !is_slit(one, other) : are_apart(one, other, gap);
}

// A leaf of the tree against all triangles that come after its own; counts those that come near in `near`.
bool leaf_keeps_apart(const MeshParts& parts, const MeshReals<double>& reals, uint leaf, double gap,
                      std::size_t& near) {
    std::array<Corners, layout::kMeshLeafTriangles> own;
    std::size_t count = 0;
    const uint begin = reference::leaf_begin(leaf);
    dvec3 low(2), high(-2);
    reference::visit_leaf(leaf, [&](uint triangle, uint end) {
        for (; triangle < end; ++triangle) {
            Corners& added = own[count++] = corners_of(parts, reals, triangle);
            added.low -= gap;
            added.high += gap;
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], added.low[axis]);
                high[axis] = std::max(high[axis], added.high[axis]);
            }
        }
    });
    constexpr float kLoose = 0x1p-20F; // more than rounding to single precision makes of a coordinate
    reference::MoveBox box;
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = static_cast<float>(low[axis]) - kLoose;
        box.high[axis] = static_cast<float>(high[axis]) + kLoose;
    }
    bool apart = true;
    const auto check = [&](uint triangle, uint end) {
        for (triangle = std::max(triangle, begin); triangle < end; ++triangle) {
            const Corners other = corners_of(parts, reals, triangle);
            if (!overlap(low, high, other))
                continue;
            ++near;
            for (std::size_t k = 0; k < count && begin + k < triangle; ++k)
                apart = apart && keep_apart(own[k], other, gap);
        }
    };
    uint stack[reference::kMeshStack];
    uint height = 0;
    stack[height++] = 0;
    while (height > 0 && apart) {
        const layout::MeshNode& node = parts.nodes[stack[--height]];
        for (unsigned meeting = reference::children_meeting(node, box); meeting != 0; meeting &= meeting - 1) {
            const uint child = node.child[std::countr_zero(meeting)];
            if ((child & layout::kMeshLeaf) == 0)
                stack[height++] = child;
            else if (reference::leaf_begin(child) >= begin)
                reference::visit_leaf(child, check);
        }
    }
    return apart;
}

bool keeps_apart(const MeshParts& parts, const MeshReals<double>& reals, double gap, unsigned threads) {
    std::vector<uint> leaves; // as their nodes have them
    for (const layout::MeshNode& node : parts.nodes)
        for (const uint child : node.child)
            if (child != layout::kMeshNoChild && (child & layout::kMeshLeaf) != 0)
                leaves.push_back(child);
    std::atomic<bool> apart{true};
    std::atomic<std::size_t> near{0};
    // Needles round a vertex of high valence all come near each other.
    const std::size_t most_near = 20'000'000 + 50 * parts.triangle_facets.size();
    constexpr std::size_t kRun = 64;
    reference::share_out(reference::threads_for(threads), (leaves.size() + kRun - 1) / kRun,
                         [&](std::size_t, std::size_t run) {
                             const std::size_t end = std::min(leaves.size(), (run + 1) * kRun);
                             std::size_t mine = 0;
                             for (std::size_t i = run * kRun; i < end && apart; ++i)
                                 if (!leaf_keeps_apart(parts, reals, leaves[i], gap, mine) || mine > most_near)
                                     apart = false;
                             if ((near += mine) > most_near)
                                 apart = false;
                         });
    return apart;
}

} // namespace

Clearance::Clearance(std::shared_ptr<const MeshParts> parts, std::shared_ptr<const MeshReals<double>> reals)
    : parts_(std::move(parts)), reals_(std::move(reals)) {}

Clearance::Clearance(bool is_enough) {
    std::call_once(once_, [&] { is_enough_ = is_enough; });
}

bool Clearance::is_enough(unsigned threads) const {
    std::call_once(once_, [&] { is_enough_ = keeps_apart(*parts_, *reals_, kLeastGap, threads); });
    return is_enough_;
}

} // namespace forceshade
