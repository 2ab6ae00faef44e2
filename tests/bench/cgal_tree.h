// A peer: nearest points by the AABB tree of CGAL.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <glm/vec3.hpp>

namespace forceshade::bench {

class CgalTree {
public:
    /// Three coordinates a vertex, three vertices a triangle; built for distances at once.
    CgalTree(std::span<const double> vertices, std::span<const std::uint32_t> corners);
    ~CgalTree();

    struct Nearest {
        std::uint32_t triangle;
        double square; /* of the distance */
    };
    Nearest nearest(const glm::dvec3& place) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

} // namespace forceshade::bench
