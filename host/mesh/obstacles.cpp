#include <algorithm>

#include "host/mesh/structure.h"
#include "host/reference/chunks.h"
#include "host/reference/mesh_neighbourhood.h"

namespace forceshade {

using layout::uint;
using reference::Vector;

namespace {

/// Whether a proxy that slides over the front of a triangle, from place to place above it to a skin beyond its edges,
/// may meet another: errs on the side of meeting it.
template <typename T> class SlideOver {
    using Skin = reference::Skin<T>;

public:
    SlideOver(const layout::MeshView<T>& mesh, uint index)
        : mesh_(mesh), index_(index), triangle_(reference::triangle_at(mesh, index)) {
        for (uint i = 0; i < 3; ++i) {
            const Vector<T> edge = triangle_.corners[(i + 1) % 3] - triangle_.corners[i];
            inwards_[i] = reference::cross(triangle_.normal, edge);
            aside_[i] = -kReach * std::sqrt(reference::dot(edge, edge));
        }
    }

    /// Appends what it may meet; kMeshAnyObstacle if that is much, which the tree finds faster.
    void find(std::vector<uint>& obstacles) const {
        constexpr std::size_t kMost = 48;
        const std::size_t before = obstacles.size();
        const auto add = [&](const layout::MeshNode& node, unsigned i) {
            reference::visit_leaf(node.child[i], [&](uint triangle, uint end) {
                for (; triangle < end; ++triangle)
                    if (may_meet(triangle))
                        obstacles.push_back(triangle);
            });
            return obstacles.size() - before <= kMost;
        };
        const bool has_area = reference::dot(triangle_.normal, triangle_.normal) > T(0);
        if (has_area && reference::visit_leaves(mesh_, box(), add))
            return;
        obstacles.resize(before);
        obstacles.push_back(layout::kMeshAnyObstacle);
    }

private:
    reference::MoveBox box() const {
        reference::MoveBox box;
        for (int i = 0; i < 3; ++i) {
            const auto [low, high] =
                std::minmax({triangle_.corners[0][i], triangle_.corners[1][i], triangle_.corners[2][i]});
            box.low[i] = static_cast<float>(low) - kMargin;
            box.high[i] = static_cast<float>(high) + kMargin;
        }
        return box;
    }

    bool may_meet(uint other) const {
        if (other == index_)
            return false;
        const reference::Triangle<T> triangle = reference::triangle_at(mesh_, other);
        T heights[3];
        for (int i = 0; i < 3; ++i)
            heights[i] = reference::dot(triangle_.normal, triangle.corners[i] - triangle_.corners[0]);
        const auto [low, high] = std::minmax({heights[0], heights[1], heights[2]});
        // As TouchPool::lies_below has it, to the bit.
        if (high <= Skin::kFlush || low > kReach)
            return false;
        for (uint i = 0; i < 3; ++i) {
            const auto side = [&](int corner) {
                return reference::dot(inwards_[i], triangle.corners[corner] - triangle_.corners[i]);
            };
            if (std::max({side(0), side(1), side(2)}) < aside_[i])
                return false;
        }
        return true;
    }

    static constexpr T kReach = Skin::kCorner; /* four times what a slide reaches over the face and beyond its edges */
    static constexpr float kMargin = reference::kBoxMargin<T>;
    const layout::MeshView<T>& mesh_;
    uint index_;
    reference::Triangle<T> triangle_;
    Vector<T> inwards_[3];
    T aside_[3];
};

} // namespace

template <typename T> void find_obstacles(MeshTables<T>& tables, unsigned threads) {
    constexpr std::size_t kShare = 4096; // triangles that a thread takes at once
    const layout::MeshView<T> mesh = tables.view();
    const std::size_t count = mesh.triangle_facets.size();
    std::vector<std::vector<uint>> shares((count + kShare - 1) / kShare);
    auto found = std::make_shared<MeshObstacles>();
    found->begins.resize(count + 1);
    reference::share_out(threads, shares.size(), [&](std::size_t, std::size_t share) {
        const std::size_t end = std::min(count, (share + 1) * kShare);
        for (std::size_t i = share * kShare; i < end; ++i) {
            SlideOver<T>(mesh, static_cast<uint>(i)).find(shares[share]);
            found->begins[i + 1] = static_cast<uint>(shares[share].size());
        }
    });
    for (std::size_t share = 0; share < shares.size(); ++share) {
        const auto first = static_cast<uint>(found->triangles.size());
        for (std::size_t i = share * kShare; i < std::min(count, (share + 1) * kShare); ++i)
            found->begins[i + 1] += first;
        found->triangles.insert(found->triangles.end(), shares[share].begin(), shares[share].end());
    }
    tables.obstacles = std::move(found);
}

template void find_obstacles(MeshTables<float>&, unsigned);
template void find_obstacles(MeshTables<double>&, unsigned);

} // namespace forceshade
