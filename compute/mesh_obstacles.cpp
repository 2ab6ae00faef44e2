#include "compute/inputs.h"
#include "host/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>
#include <type_traits>

namespace forceshade::compute {
namespace {

using layout::uint;

template <typename T> using Point = std::array<T, 3>;

// The skin of the law (Skin<T>::kWidth), and how far below a plane a corner may be above it.
template <typename T> constexpr T kSkin = std::is_same_v<T, double> ? T(0x1p-40) : T(0x1p-15);
template <typename T> constexpr T kFlush = kSkin<T>* T(0.015625) * T(0.25);
constexpr std::size_t kMostListed = 48; // of either side

template <typename T> Point<T> minus(const Point<T>& u, const Point<T>& v) {
    return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}

template <typename T> T product(const Point<T>& u, const Point<T>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

template <typename T> Point<T> cross(const Point<T>& u, const Point<T>& v) {
    return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

template <typename T> struct Shape {
    std::array<Point<T>, 3> corners;
    Point<T> normal;

    Shape(const layout::MeshView<T>& mesh, std::size_t triangle) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t corner = 3 * std::size_t(mesh.triangle_corners[3 * triangle + i]);
            corners[i] = {mesh.vertices[corner], mesh.vertices[corner + 1], mesh.vertices[corner + 2]};
            normal[i] = mesh.triangle_normals[3 * triangle + i];
        }
    }
};

// Where a proxy may be that slides over a triangle, and what lies near there.
template <typename T> class Surroundings {
public:
    Surroundings(const layout::MeshView<T>& mesh, std::size_t triangle)
        : mesh_(mesh), own_(triangle), shape_(mesh, triangle) {
        double sharpest = 1; // sine of half an angle
        for (std::size_t i = 0; i < 3; ++i) {
            const Point<T> edge = minus(shape_.corners[(i + 1) % 3], shape_.corners[i]);
            const Point<T> other = minus(shape_.corners[(i + 2) % 3], shape_.corners[i]);
            const double cosine =
                double(product(edge, other)) / std::sqrt(double(product(edge, edge)) * double(product(other, other)));
            sharpest = std::min(sharpest, std::sqrt(std::max(0.0, (1 - cosine) / 2)));
            inwards_[i] = cross(shape_.normal, edge);
            lengths_[i] = std::sqrt(product(edge, edge));
        }
        const T reach = kSkin<T> * (T(4) + T(2 / std::max(sharpest, 1e-6)));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax({shape_.corners[0][axis], shape_.corners[1][axis], shape_.corners[2][axis]});
            low_[axis] = low - reach;
            high_[axis] = high + reach;
        }
    }

    // Adds what lies near to `front` and `back`; false if it is too much.
    bool find(std::vector<uint>& front, std::vector<uint>& back) {
        constexpr std::size_t kMostLooked = 1024;
        std::size_t looked = 0;
        stack_.assign(1, 0);
        while (!stack_.empty()) {
            const layout::MeshNode& node = mesh_.nodes[stack_.back()];
            stack_.pop_back();
            for (uint i = 0; i < layout::kMeshChildren; ++i) {
                if (node.child[i] == layout::kMeshNoChild || !meets(node, i))
                    continue;
                if ((node.child[i] & layout::kMeshLeaf) == 0) {
                    stack_.push_back(node.child[i]);
                    continue;
                }
                const uint first = (node.child[i] & ~layout::kMeshLeaf) / layout::kMeshLeafTriangles;
                for (uint t = first; t <= first + node.child[i] % layout::kMeshLeafTriangles; ++t)
                    put(t, front, back);
                if (++looked > kMostLooked || front.size() > kMostListed || back.size() > kMostListed)
                    return false;
            }
        }
        return true;
    }

private:
    bool meets(const layout::MeshNode& node, uint i) const {
        return T(node.low_x[i]) <= high_[0] && T(node.high_x[i]) >= low_[0] && T(node.low_y[i]) <= high_[1] &&
               T(node.high_y[i]) >= low_[1] && T(node.low_z[i]) <= high_[2] && T(node.high_z[i]) >= low_[2];
    }

    void put(uint triangle, std::vector<uint>& front, std::vector<uint>& back) const {
        if (triangle == own_)
            return;
        constexpr T kReach = T(4) * kSkin<T>;
        const Shape<T> other(mesh_, triangle);
        std::array<T, 3> heights;
        for (std::size_t i = 0; i < 3; ++i)
            heights[i] = product(shape_.normal, minus(other.corners[i], shape_.corners[0]));
        if (std::ranges::all_of(heights, [](T h) { return h > kReach; }) ||
            std::ranges::all_of(heights, [](T h) { return h < -kReach; }))
            return;
        for (std::size_t edge = 0; edge < 3; ++edge)
            if (std::ranges::all_of(other.corners, [&](const Point<T>& corner) {
                    return product(inwards_[edge], minus(corner, shape_.corners[edge])) < -kReach * lengths_[edge];
                }))
                return;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto [low, high] =
                std::minmax({other.corners[0][axis], other.corners[1][axis], other.corners[2][axis]});
            if (low > high_[axis] || high < low_[axis])
                return;
        }
        // As the law has it, to the last bit.
        if (!std::ranges::all_of(heights, [](T h) { return h <= kFlush<T>; }))
            front.push_back(triangle);
        if (!std::ranges::all_of(heights, [](T h) { return -h <= kFlush<T>; }))
            back.push_back(triangle);
    }

    const layout::MeshView<T>& mesh_;
    std::size_t own_;
    Shape<T> shape_;
    std::array<Point<T>, 3> inwards_;
    std::array<T, 3> lengths_;
    Point<T> low_, high_;
    std::vector<uint> stack_;
};

template <typename T> MeshObstacles obstacles_of(const layout::MeshView<T>& mesh, std::size_t first, std::size_t last) {
    MeshObstacles part;
    std::vector<uint> front, back;
    for (std::size_t t = first; t < last; ++t) {
        front.clear();
        back.clear();
        const bool crowded = !Surroundings<T>(mesh, t).find(front, back);
        if (crowded) {
            front.clear();
            back.clear();
        }
        part.crowded.push_back(crowded);
        part.front.push_back(static_cast<uint>(part.triangles.size()));
        part.triangles.insert(part.triangles.end(), front.begin(), front.end());
        part.back.push_back(static_cast<uint>(part.triangles.size()));
        part.triangles.insert(part.triangles.end(), back.begin(), back.end());
    }
    return part;
}

} // namespace

template <typename T> MeshObstacles find_obstacles(const layout::MeshView<T>& mesh) {
    const std::size_t count = mesh.triangle_facets.size();
    const std::size_t threads = std::clamp<std::size_t>(most_threads(), 1, 1 + count / 4096);
    std::vector<MeshObstacles> parts(threads);
    {
        std::vector<std::jthread> helpers;
        for (std::size_t i = 0; i < threads; ++i)
            helpers.emplace_back(
                [&, i] { parts[i] = obstacles_of(mesh, count * i / threads, count * (i + 1) / threads); });
    }
    MeshObstacles all;
    for (const MeshObstacles& part : parts) {
        const auto begin = static_cast<uint>(all.triangles.size());
        all.triangles.insert(all.triangles.end(), part.triangles.begin(), part.triangles.end());
        for (const uint at : part.front)
            all.front.push_back(begin + at);
        for (const uint at : part.back)
            all.back.push_back(begin + at);
        all.crowded.insert(all.crowded.end(), part.crowded.begin(), part.crowded.end());
    }
    all.front.push_back(static_cast<uint>(all.triangles.size()));
    return all;
}

template MeshObstacles find_obstacles<float>(const layout::MeshView<float>&);
template MeshObstacles find_obstacles<double>(const layout::MeshView<double>&);

} // namespace forceshade::compute
