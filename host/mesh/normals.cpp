// Normals of facets, vertices and corners. A triangle's is good to a few units in the last place whatever its shape.
#include "host/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/mesh/connectivity.h"
#include "host/mesh/exact.h"
#include "host/mesh/places.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

using reference::cross, reference::dot, reference::largest_coordinate;

/// A number as the unevaluated sum of two doubles: differences and products of doubles without rounding (Dekker 1971,
/// Knuth TAOCP 2, 4.2.2). Needs a compiler that neither contracts nor reorders.
struct Twofold {
    double high = 0, low = 0;
};

/// a + b, exactly.
Twofold exact_sum(double a, double b) noexcept {
    const double sum = a + b, b_part = sum - a;
    return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// a + b to about 2^-104 of |a| + |b|, its high part being the whole rounded to double.
Twofold sum(const Twofold& a, const Twofold& b) noexcept {
    const Twofold high = exact_sum(a.high, b.high);
    return exact_sum(high.high, high.low + (a.low + b.low));
}

/// a * b to about 2^-104 of itself; exactly if both low parts are 0.
Twofold product(const Twofold& a, const Twofold& b) noexcept {
    const double high = a.high * b.high;
    return {high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high)};
}

/// a - b to about 2^-104 of |a| + |b|; 0 if they are the same.
Twofold difference(const Twofold& a, const Twofold& b) noexcept {
    return sum(a, {-b.high, -b.low});
}

using TwofoldVector = std::array<Twofold, 3>;

// Products of edges outside this range are scaled first, so that they neither overflow nor underflow.
constexpr double kLargest = 1e70, kSmallest = 1e-70;

TwofoldVector exact_edge(const glm::dvec3& from, const glm::dvec3& to) {
    return {exact_sum(to.x, -from.x), exact_sum(to.y, -from.y), exact_sum(to.z, -from.z)};
}

double largest_coordinate(const TwofoldVector& v) {
    return std::max({std::abs(v[0].high), std::abs(v[1].high), std::abs(v[2].high)});
}

bool is_exact(const TwofoldVector& v) {
    return v[0].low == 0 && v[1].low == 0 && v[2].low == 0;
}

void scale(TwofoldVector& v, int exponent) {
    for (Twofold& component : v)
        component = {std::scalbn(component.high, exponent), std::scalbn(component.low, exponent)};
}

TwofoldVector cross(const TwofoldVector& a, const TwofoldVector& b) {
    return {difference(product(a[1], b[2]), product(a[2], b[1])), difference(product(a[2], b[0]), product(a[0], b[2])),
            difference(product(a[0], b[1]), product(a[1], b[0]))};
}

// The power of two that brings a size near 1, where it needs that.
int rescaling(double size) {
    return size > kLargest || (size < kSmallest && size > 0) ? -std::ilogb(size) : 0;
}

glm::dvec3 rounded(const TwofoldVector& v) {
    return {v[0].high, v[1].high, v[2].high}; // sums are normalised: the low parts are below half a unit
}

// The area vector of a facet of four corners or more, as a sum over triangles at its first corner.
glm::dvec3 newell_normal(const std::vector<glm::dvec3>& vertices, std::span<const std::uint32_t> outline) {
    const glm::dvec3& first = vertices[outline[0]];
    double size = 0;
    for (const std::uint32_t vertex : outline.subspan(1))
        size = std::max(size, largest_coordinate(vertices[vertex] - first));
    const int exponent = rescaling(size);
    TwofoldVector total{}, previous = exact_edge(first, vertices[outline[1]]);
    scale(previous, exponent);
    double magnitude = 0;
    for (const std::uint32_t vertex : outline.subspan(2)) {
        TwofoldVector next = exact_edge(first, vertices[vertex]);
        if (exponent != 0)
            scale(next, exponent);
        const TwofoldVector part = cross(previous, next);
        for (std::size_t axis = 0; axis < 3; ++axis)
            total[axis] = sum(total[axis], part[axis]);
        magnitude += largest_coordinate(previous) * largest_coordinate(next);
        previous = next;
    }
    const glm::dvec3 area = rounded(total);
    return largest_coordinate(area) > 0x1p-92 * magnitude ? unit_vector(area) : glm::dvec3(0);
}

// The angle of a facet at a corner, from the edge that leaves it to the edge that comes in, about the facet's normal.
double corner_angle(const glm::dvec3& previous, const glm::dvec3& here, const glm::dvec3& next,
                    const glm::dvec3& normal, bool triangle) {
    glm::dvec3 a = next - here, b = previous - here;
    const double a_size = largest_coordinate(a), b_size = largest_coordinate(b);
    if (!(a_size > 0) || !(b_size > 0))
        return 0;
    a /= a_size;
    b /= b_size;
    const glm::dvec3 turn = cross(a, b);
    const double angle = std::atan2(reference::length(turn), dot(a, b));
    // A spike without width is not a full turn.
    return triangle || dot(turn, normal) >= 0 || angle < 1e-9 ? angle : 2 * M_PI - angle;
}

} // namespace

glm::dvec3 unit_vector(glm::dvec3 v) {
    if (const int exponent = rescaling(largest_coordinate(v)); exponent != 0)
        v = {std::scalbn(v.x, exponent), std::scalbn(v.y, exponent), std::scalbn(v.z, exponent)};
    return reference::normalised(v);
}

glm::dvec3 triangle_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    TwofoldVector u = exact_edge(a, b), v = exact_edge(a, c);
    if (const int exponent = rescaling(std::max(largest_coordinate(u), largest_coordinate(v))); exponent != 0) {
        scale(u, exponent);
        scale(v, exponent);
    }
    const glm::dvec3 area = rounded(cross(u, v));
    const double size = largest_coordinate(area);
    // Twice the precision is enough unless cancellation has taken half of it; 0 is right where the edges are exact.
    if (size > 0x1p-48 * largest_coordinate(u) * largest_coordinate(v) || (size == 0 && is_exact(u) && is_exact(v)))
        return unit_vector(area);
    return unit_vector(exact_cross_direction(a, b, c));
}

std::vector<glm::dvec3> facet_normals(const PolygonSoup& polygons) {
    const std::vector<glm::dvec3>& vertices = polygons.vertices;
    std::vector<glm::dvec3> normals(polygons.facets(), glm::dvec3(0));
    for (std::size_t facet = 0; facet < normals.size(); ++facet) {
        const auto outline = polygons.outline(facet);
        if (outline.size() == 3)
            normals[facet] = triangle_normal(vertices[outline[0]], vertices[outline[1]], vertices[outline[2]]);
        else if (outline.size() > 3)
            normals[facet] = newell_normal(vertices, outline);
    }
    return normals;
}

std::vector<glm::dvec3> vertex_normals(const Connectivity& mesh, std::span<const glm::dvec3> facet_normals,
                                       VertexNormals weights, std::span<const std::uint32_t> left_out) {
    const PolygonSoup& polygons = mesh.polygons();
    const std::vector<glm::dvec3>& vertices = polygons.vertices;
    std::vector<bool> counts(facet_normals.size());
    for (std::size_t facet = 0; facet < counts.size(); ++facet)
        counts[facet] = facet_normals[facet] != glm::dvec3(0);
    for (const std::uint32_t facet : left_out)
        counts[facet] = false;
    std::vector<glm::dvec3> normals(vertices.size());
    std::vector<FacetCorner> fan;
    for (std::uint32_t vertex = 0; vertex < normals.size(); ++vertex) {
        glm::dvec3 sum(0);
        double all = 0;
        mesh->fan(vertex, fan);
        for (std::size_t i = 0; i < fan.size(); ++i) {
            const std::uint32_t facet = fan[i].facet;
            const bool again = i > 0 && fan[i - 1].facet == facet;
            if (!counts[facet] || (again && weights == VertexNormals::plain))
                continue;
            const glm::dvec3& normal = facet_normals[facet];
            const bool triangle = polygons.corners_of(facet) == 3;
            const double weight =
                weights == VertexNormals::plain
                    ? 1
                    : corner_angle(vertices[fan[i].before], vertices[vertex], vertices[fan[i].after], normal, triangle);
            sum += weight * normal;
            all += weight;
        }
        normals[vertex] = largest_coordinate(sum) > 1e-12 * all ? unit_vector(sum) : glm::dvec3(0);
    }
    return normals;
}

namespace {

// The corners at one vertex, in sets that share a normal.
class Fan {
public:
    Fan(const std::vector<FacetCorner>& corners, std::span<const glm::dvec3> normals)
        : corners_(corners), normals_(normals), sets_(corners.size()) {}

    void join_groups(std::span<const std::uint32_t> groups) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> by_group; // group, corner
        for (std::uint32_t i = 0; i < corners_.size(); ++i)
            if (const std::uint32_t group = groups[corners_[i].facet]; group != 0)
                by_group.emplace_back(group, i);
        std::ranges::sort(by_group);
        for (std::size_t i = 1; i < by_group.size(); ++i)
            if (by_group[i].first == by_group[i - 1].first)
                sets_.join(by_group[i].second, by_group[i - 1].second);
    }

    void join_smooth_edges(double angle) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> sides; // the vertex at the edge's other end, corner
        for (std::uint32_t i = 0; i < corners_.size(); ++i) {
            sides.emplace_back(corners_[i].before, i);
            sides.emplace_back(corners_[i].after, i);
        }
        std::ranges::sort(sides);
        for (std::size_t first = 0; first < sides.size();) {
            std::size_t end = first + 1;
            for (; end < sides.size() && sides[end].first == sides[first].first; ++end)
                for (std::size_t i = first; i < end; ++i)
                    if (angle_between(sides[i].second, sides[end].second) <= angle)
                        sets_.join(sides[i].second, sides[end].second);
            first = end;
        }
    }

    std::uint32_t set_of(std::uint32_t corner) { return sets_.find(corner); }

private:
    double angle_between(std::uint32_t one, std::uint32_t other) const {
        const glm::dvec3 &a = normals_[corners_[one].facet], &b = normals_[corners_[other].facet];
        return std::atan2(reference::length(reference::cross(a, b)), reference::dot(a, b));
    }

    const std::vector<FacetCorner>& corners_;
    std::span<const glm::dvec3> normals_;
    DisjointSets sets_;
};

} // namespace

std::vector<glm::dvec3> corner_normals(const Connectivity& mesh, std::span<const glm::dvec3> facet_normals,
                                       const Smoothing& smoothing, std::span<const std::uint32_t> left_out) {
    const PolygonSoup& polygons = mesh.polygons();
    std::vector<glm::dvec3> normals(polygons.corners.size(), glm::dvec3(0)), sums;
    std::vector<FacetCorner> corners;
    const auto counts = [&](std::uint32_t facet) {
        return facet_normals[facet] != glm::dvec3(0) && !std::ranges::binary_search(left_out, facet);
    };
    for (std::uint32_t vertex = 0; vertex < polygons.vertices.size(); ++vertex) {
        mesh->fan(vertex, corners);
        std::erase_if(corners, [&](const FacetCorner& corner) { return !counts(corner.facet); });
        Fan fan(corners, facet_normals);
        if (smoothing.weights == VertexNormals::groups)
            fan.join_groups(polygons.groups);
        else
            fan.join_smooth_edges(smoothing.crease);
        sums.assign(corners.size(), glm::dvec3(0));
        for (std::uint32_t i = 0; i < corners.size(); ++i)
            if (i == 0 || corners[i].facet != corners[i - 1].facet)
                sums[fan.set_of(i)] += facet_normals[corners[i].facet];
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3& sum = sums[fan.set_of(i)];
            const std::uint32_t facet = corners[i].facet;
            if (reference::largest_coordinate(sum) > 1e-12)
                for (std::uint32_t at = polygons.begins[facet]; at < polygons.begins[facet + 1]; ++at)
                    if (polygons.corners[at] == vertex)
                        normals[at] = reference::normalised(sum);
        }
    }
    return normals;
}

} // namespace forceshade
