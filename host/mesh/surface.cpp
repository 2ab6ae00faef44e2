// The triangles that a mesh's facets are cut into, and those of them that the laws use.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/exact.h"
#include "host/mesh/places.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

using reference::cross, reference::dot;
using Corners = std::array<std::uint32_t, 3>;

class Triangulation {
public:
    Triangulation(const PolygonSoup& polygons, std::span<const glm::dvec3> normals)
        : polygons_(polygons), normals_(normals) {
        const std::size_t corners = polygons.corners.size(), facets = polygons.facets();
        triangles_.corners.reserve(corners > 2 * facets ? corners - 2 * facets : 0);
        triangles_.facets.reserve(triangles_.corners.capacity());
        triangles_.normals.reserve(triangles_.corners.capacity());
    }

    MeshTriangles run() {
        for (std::size_t facet = 0; facet < polygons_.facets(); ++facet) {
            corners_ = polygons_.outline(facet);
            const bool has_area = normals_[facet] != glm::dvec3(0);
            if (corners_.size() == 4 && has_area)
                cut_quadrilateral(normals_[facet]);
            else if (corners_.size() < 5 || !has_area || !cut_by_delaunay(normals_[facet]))
                cut_fan();
            for (std::size_t i = triangles_.facets.size(); i < triangles_.corners.size(); ++i) {
                const auto& [a, b, c] = triangles_.corners[i];
                const auto& at = polygons_.vertices;
                triangles_.facets.push_back(static_cast<std::uint32_t>(facet));
                triangles_.normals.push_back(corners_.size() == 3 ? normals_[facet]
                                                                  : triangle_normal(at[a], at[b], at[c]));
            }
        }
        return std::move(triangles_);
    }

private:
    const glm::dvec3& vertex(std::size_t corner) const { return polygons_.vertices[corners_[corner]]; }

    void add(std::size_t a, std::size_t b, std::size_t c) {
        triangles_.corners.push_back({corners_[a], corners_[b], corners_[c]});
    }

    void cut_fan() {
        for (std::size_t corner = 1; corner + 1 < corners_.size(); ++corner)
            add(0, corner, corner + 1);
    }

    void cut_quadrilateral(const glm::dvec3& normal) {
        int not_convex = 0;
        std::size_t apex = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec3& here = vertex(i);
            const glm::dvec3 turn = cross(here - vertex((i + 3) % 4), vertex((i + 1) % 4) - here);
            if (!(dot(turn, normal) > 0)) {
                ++not_convex;
                apex = i;
            }
        }
        bool from_first = true;
        if (not_convex == 0) {
            const glm::dvec3 first = vertex(2) - vertex(0), second = vertex(3) - vertex(1);
            from_first = dot(first, first) <= dot(second, second);
        } else if (not_convex == 1) {
            from_first = apex % 2 == 0;
        }
        if (from_first) {
            cut_fan();
        } else {
            add(0, 1, 3);
            add(1, 2, 3);
        }
    }

    bool cut_by_delaunay(const glm::dvec3& normal) {
        project(normal);
        cut_.clear();
        if (!planar_delaunay(projection_, cut_))
            return false;
        for (const auto& triangle : cut_)
            add(triangle[0], triangle[1], triangle[2]);
        return true;
    }

    // Onto two axes that make a right-handed frame with the normal; one is perpendicular to the normal's least
    // component. A quarter of the size, so that the largest numbers do not overflow.
    void project(const glm::dvec3& normal) {
        const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
        const glm::dvec3 least = x <= y && x <= z ? glm::dvec3(1, 0, 0)
                                 : y <= z         ? glm::dvec3(0, 1, 0)
                                                  : glm::dvec3(0, 0, 1);
        glm::dvec3 right = cross(least, normal);
        right /= std::sqrt(dot(right, right));
        const glm::dvec3 up = cross(normal, right);
        projection_.clear();
        for (std::size_t i = 0; i < corners_.size(); ++i) {
            const glm::dvec3 offset = 0.25 * vertex(i) - 0.25 * vertex(0);
            projection_.push_back({dot(offset, right), dot(offset, up)});
        }
    }

    const PolygonSoup& polygons_;
    std::span<const glm::dvec3> normals_;
    MeshTriangles triangles_;
    std::span<const std::uint32_t> corners_; // of the facet at hand
    std::vector<std::array<double, 2>> projection_;
    std::vector<Corners> cut_;
};

} // namespace

MeshTriangles triangulate(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals) {
    return Triangulation(polygons, facet_normals).run();
}

namespace {

enum class Shape : std::uint8_t { plain, needle, cap };

Shape shape_of(const PolygonSoup& polygons, const Corners& corners, const glm::dvec3& normal, const MeshFrame& frame) {
    // Placing a mesh rounds each coordinate a few times; the shape of one far away is not known better.
    constexpr double kRoundings = 16 * std::numeric_limits<double>::epsilon(), kMost = 1e-6;
    if (normal == glm::dvec3(0))
        return Shape::cap;
    // Of the frame: a cap's height at most, its shorter sides at least.
    const double most_height =
        std::min(kRoundings * (1 + reference::largest_coordinate(frame.centre) / frame.scale), kMost);
    const double least_side = 1024 * most_height;
    const double inverse = 1 / std::max(frame.scale, 0x1p-1000); // sides of a smaller mesh seem too short for caps
    glm::dvec3 at[3], sides[3];
    for (std::size_t i = 0; i < 3; ++i)
        at[i] = polygons.vertices[corners[i]];
    double longest = 0, shortest = std::numeric_limits<double>::infinity(); // squares
    for (std::size_t i = 0; i < 3; ++i) {
        sides[i] = (at[(i + 1) % 3] - at[i]) * inverse;
        longest = std::max(longest, dot(sides[i], sides[i]));
        shortest = std::min(shortest, dot(sides[i], sides[i]));
    }
    if (shortest > least_side * least_side) {
        const glm::dvec3 area = cross(sides[0], sides[1]);
        return dot(area, area) <= most_height * most_height * longest ? Shape::cap : Shape::plain;
    }
    const glm::dvec3 a = frame.local(at[0]), b = frame.local(at[1]), c = frame.local(at[2]);
    return a == b || b == c || c == a ? Shape::needle : Shape::plain;
}

/// Cuts triangles where caps say that a vertex lies on an edge. Caps that rounding has made contradict each other, so
/// that cutting would go in circles: no cap is used twice.
class CapCutter {
public:
    CapCutter(const PolygonSoup& polygons, std::size_t triangles)
        : polygons_(polygons), places_(weld(polygons)), ends_(places_.size()),
          most_steps_(kMostSteps + kStepsPerTriangle * triangles) {}

    void add_cap(const Corners& cap) {
        std::vector<Corners> waiting{cap};
        while (!waiting.empty()) {
            const Corners corners = waiting.back();
            waiting.pop_back();
            if (same(corners[0], corners[1]) || same(corners[1], corners[2]) || same(corners[2], corners[0]))
                continue;
            if (!seen_caps_.insert(key(corners)).second)
                continue;
            count_step();
            const auto [start, middle, end] = along(corners);
            const auto [hint, is_new] = hints_.try_emplace(edge(start, end), middle);
            const std::uint32_t other = hint->second;
            ends_[places_[start]] = ends_[places_[end]] = true;
            if (is_new || same(other, middle))
                continue;
            waiting.push_back({start, other, middle}); // both on one edge: the second one on a part of it
            waiting.push_back({other, middle, end});
        }
    }

    /// Calls use(corners) for the pieces of a triangle.
    template <typename Use> void cut(const Corners& triangle, const Use& use) {
        if (ends_[places_[triangle[0]]] + ends_[places_[triangle[1]]] + ends_[places_[triangle[2]]] < 2) {
            use(triangle); // as most
            return;
        }
        std::set<Corners> seen;
        std::vector<Corners> waiting{triangle};
        while (!waiting.empty()) {
            const Corners corners = waiting.back();
            waiting.pop_back();
            std::size_t side = 0;
            std::optional<std::uint32_t> between;
            for (; side < 3 && !between; ++side)
                between = vertex_on_side(corners, side);
            if (!between || !seen.insert(key(corners)).second) {
                use(corners);
                continue;
            }
            count_step();
            const std::uint32_t start = corners[side - 1], end = corners[side % 3], tip = corners[(side + 1) % 3];
            waiting.push_back({*between, end, tip});
            waiting.push_back({start, *between, tip});
        }
    }

private:
    static constexpr std::size_t kMostSteps = std::size_t(1) << 20, kStepsPerTriangle = 64;

    void count_step() {
        if (++steps_ > most_steps_)
            throw UsageError("facets without area lie on each other and cut the mesh's other facets into "
                             "more than {} pieces; remove the facets without area",
                             most_steps_);
    }

    /// The places of the corners in ascending order.
    Corners key(const Corners& corners) const {
        Corners result{places_[corners[0]], places_[corners[1]], places_[corners[2]]};
        std::ranges::sort(result);
        return result;
    }

    bool same(std::uint32_t one, std::uint32_t other) const { return places_[one] == places_[other]; }

    std::uint64_t edge(std::uint32_t start, std::uint32_t end) const { return edge_of(places_[start], places_[end]); }

    /// A cap's corners in their order along the axis on which it is longest.
    Corners along(Corners corners) const {
        int axis = 0;
        double longest = 0;
        const auto at = [&](std::uint32_t vertex) -> const glm::dvec3& { return polygons_.vertices[vertex]; };
        for (int i = 0; i < 3; ++i) {
            const double a = at(corners[0])[i], b = at(corners[1])[i], c = at(corners[2])[i];
            const double length = std::max({a, b, c}) - std::min({a, b, c});
            if (length > longest) {
                longest = length;
                axis = i;
            }
        }
        std::ranges::sort(corners, {}, [&](std::uint32_t vertex) { return at(vertex)[axis]; });
        return corners;
    }

    std::optional<std::uint32_t> vertex_on_side(const Corners& corners, std::size_t side) const {
        const auto hint = hints_.find(edge(corners[side], corners[(side + 1) % 3]));
        if (hint == hints_.end() || same(hint->second, corners[(side + 2) % 3]))
            return std::nullopt;
        return hint->second;
    }

    const PolygonSoup& polygons_;
    std::vector<std::uint32_t> places_;
    std::vector<bool> ends_;                                 // by place: of edges with hints
    std::unordered_map<std::uint64_t, std::uint32_t> hints_; // by edge: the vertex that lies on it
    std::set<Corners> seen_caps_;                            // keys of caps
    std::size_t most_steps_, steps_ = 0;
};

} // namespace

std::size_t count_caps(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals) {
    const MeshFrame frame = frame_of(polygons);
    std::size_t caps = 0;
    for (std::size_t facet = 0; facet < facet_normals.size(); ++facet) {
        const auto outline = polygons.outline(facet);
        caps += facet_normals[facet] == glm::dvec3(0) ||
                (outline.size() == 3 &&
                 shape_of(polygons, {outline[0], outline[1], outline[2]}, facet_normals[facet], frame) == Shape::cap);
    }
    return caps;
}

std::optional<MeshTriangles> make_surface(const Mesh& mesh, const MeshFrame& frame) {
    const MeshTriangles& all = mesh.triangles;
    std::vector<std::size_t> kept, caps;
    auto redundant = mesh.redundant_facets.begin();
    for (std::size_t triangle = 0; triangle < all.corners.size(); ++triangle) {
        redundant = std::find_if(redundant, mesh.redundant_facets.end(),
                                 [&](std::uint32_t facet) { return facet >= all.facets[triangle]; });
        if (redundant != mesh.redundant_facets.end() && *redundant == all.facets[triangle])
            continue;
        const Shape shape = shape_of(mesh.polygons, all.corners[triangle], all.normals[triangle], frame);
        if (shape != Shape::needle)
            (shape == Shape::plain ? kept : caps).push_back(triangle);
    }
    if (kept.empty() || (kept.size() == all.corners.size() && mesh.redundant_facets.empty()))
        return std::nullopt;
    std::vector<std::pair<std::size_t, Corners>> pieces; // of which triangle
    CapCutter cutter(mesh.polygons, all.corners.size());
    for (const std::size_t cap : caps)
        cutter.add_cap(all.corners[cap]);
    for (const std::size_t triangle : kept)
        cutter.cut(all.corners[triangle], [&](const Corners& corners) { pieces.emplace_back(triangle, corners); });
    std::ranges::stable_sort(pieces, {}, &std::pair<std::size_t, Corners>::first);
    MeshTriangles surface;
    for (const auto& [triangle, corners] : pieces) {
        surface.corners.push_back(corners);
        surface.facets.push_back(all.facets[triangle]);
        surface.normals.push_back(all.normals[triangle]);
    }
    return surface;
}

} // namespace forceshade
