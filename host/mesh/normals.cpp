#include "host/mesh/normals.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/mesh/exact.h"
#include "host/mesh/structure.h"

namespace forceshade {
namespace {

using TwofoldVector = std::array<Twofold, 3>;

// Products of edges outside this range are scaled first, so that nothing is lost to overflow and underflow.
constexpr double kLargest = 1e70, kSmallest = 1e-70;

double largest_component(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

TwofoldVector exact_edge(const glm::dvec3& from, const glm::dvec3& to) {
    return {exact_difference(to.x, from.x), exact_difference(to.y, from.y), exact_difference(to.z, from.z)};
}

double largest_component(const TwofoldVector& v) {
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

glm::dvec3 unit(glm::dvec3 v) {
    if (const int exponent = rescaling(largest_component(v)); exponent != 0)
        v = {std::scalbn(v.x, exponent), std::scalbn(v.y, exponent), std::scalbn(v.z, exponent)};
    const double square = v.x * v.x + v.y * v.y + v.z * v.z;
    return square > 0 ? v / std::sqrt(square) : glm::dvec3(0);
}

glm::dvec3 rounded(const TwofoldVector& v) {
    return {v[0].high, v[1].high, v[2].high}; // sums are normalised: the low parts are below half a unit
}

// The area vector of a facet of four corners or more, as a sum over triangles at its first corner.
glm::dvec3 newell_normal(const PolygonSoup& polygons, std::size_t facet) {
    const std::uint32_t begin = polygons.begins[facet], end = polygons.begins[facet + 1];
    const glm::dvec3& first = polygons.vertices[polygons.corners[begin]];
    const auto vertex = [&](std::uint32_t i) -> const glm::dvec3& { return polygons.vertices[polygons.corners[i]]; };
    double size = 0;
    for (std::uint32_t i = begin + 1; i < end; ++i)
        size = std::max(size, largest_component(vertex(i) - first));
    const int exponent = rescaling(size);
    TwofoldVector total{}, previous = exact_edge(first, vertex(begin + 1));
    scale(previous, exponent);
    double magnitude = 0;
    for (std::uint32_t i = begin + 2; i < end; ++i) {
        TwofoldVector next = exact_edge(first, vertex(i));
        if (exponent != 0)
            scale(next, exponent);
        const TwofoldVector part = cross(previous, next);
        for (std::size_t axis = 0; axis < 3; ++axis)
            total[axis] = sum(total[axis], part[axis]);
        magnitude += largest_component(previous) * largest_component(next);
        previous = next;
    }
    const glm::dvec3 area = rounded(total);
    return largest_component(area) > 0x1p-92 * magnitude ? unit(area) : glm::dvec3(0);
}

// The angle of a facet at a corner, from the edge that leaves it to the edge that comes in, about the facet's normal.
double corner_angle(const glm::dvec3& previous, const glm::dvec3& here, const glm::dvec3& next,
                    const glm::dvec3& normal, bool triangle) {
    glm::dvec3 a = next - here, b = previous - here;
    const double a_size = largest_component(a), b_size = largest_component(b);
    if (!(a_size > 0) || !(b_size > 0))
        return 0;
    a /= a_size;
    b /= b_size;
    const glm::dvec3 turn(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    const double cosine = a.x * b.x + a.y * b.y + a.z * b.z;
    const double length = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
    const double side = turn.x * normal.x + turn.y * normal.y + turn.z * normal.z;
    if (triangle || side >= 0)
        return std::atan2(length, cosine);
    // A spike of no width is no full turn.
    const double angle = std::atan2(length, cosine);
    return angle < 1e-9 ? angle : 2 * M_PI - angle;
}

struct WeightedNormal {
    glm::dvec3 sum{0};
    double weight = 0;
};

void add_plain(std::vector<WeightedNormal>& normals, const PolygonSoup& polygons, std::size_t facet,
               const glm::dvec3& normal, std::vector<std::uint32_t>& last_facet) {
    for (std::uint32_t i = polygons.begins[facet]; i < polygons.begins[facet + 1]; ++i) {
        const std::uint32_t vertex = polygons.corners[i];
        if (last_facet[vertex] == facet)
            continue;
        last_facet[vertex] = static_cast<std::uint32_t>(facet);
        normals[vertex].sum += normal;
        normals[vertex].weight += 1;
    }
}

void add_by_angle(std::vector<WeightedNormal>& normals, const PolygonSoup& polygons, std::size_t facet,
                  const glm::dvec3& normal) {
    const std::uint32_t begin = polygons.begins[facet], end = polygons.begins[facet + 1];
    const auto vertex = [&](std::uint32_t i) -> const glm::dvec3& { return polygons.vertices[polygons.corners[i]]; };
    for (std::uint32_t i = begin; i < end; ++i) {
        const double angle = corner_angle(vertex(i == begin ? end - 1 : i - 1), vertex(i),
                                          vertex(i + 1 == end ? begin : i + 1), normal, end - begin == 3);
        normals[polygons.corners[i]].sum += angle * normal;
        normals[polygons.corners[i]].weight += angle;
    }
}

} // namespace

glm::dvec3 triangle_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    TwofoldVector u = exact_edge(a, b), v = exact_edge(a, c);
    if (const int exponent = rescaling(std::max(largest_component(u), largest_component(v))); exponent != 0) {
        scale(u, exponent);
        scale(v, exponent);
    }
    const glm::dvec3 area = rounded(cross(u, v));
    const double size = largest_component(area);
    // Twice the precision is enough unless cancellation has taken half of it; 0 is right where the edges are exact.
    if (size > 0x1p-48 * largest_component(u) * largest_component(v) || (size == 0 && is_exact(u) && is_exact(v)))
        return unit(area);
    return unit(exact_cross_direction(a, b, c));
}

std::vector<glm::dvec3> facet_normals(const PolygonSoup& polygons) {
    std::vector<glm::dvec3> normals(polygons.facets());
    for (std::size_t facet = 0; facet < normals.size(); ++facet) {
        const std::uint32_t begin = polygons.begins[facet];
        if (polygons.begins[facet + 1] - begin == 3)
            normals[facet] = triangle_normal(polygons.vertices[polygons.corners[begin]],
                                             polygons.vertices[polygons.corners[begin + 1]],
                                             polygons.vertices[polygons.corners[begin + 2]]);
        else if (polygons.begins[facet + 1] - begin > 3)
            normals[facet] = newell_normal(polygons, facet);
        else
            normals[facet] = glm::dvec3(0);
    }
    return normals;
}

std::vector<glm::dvec3> vertex_normals(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals,
                                       VertexNormals weights, std::span<const std::uint32_t> left_out) {
    std::vector<WeightedNormal> sums(polygons.vertices.size());
    std::vector<std::uint32_t> last_facet(weights == VertexNormals::plain ? sums.size() : 0, 0xFFFFFFFFu);
    auto next = left_out.begin();
    for (std::size_t facet = 0; facet < facet_normals.size(); ++facet) {
        const glm::dvec3& normal = facet_normals[facet];
        const bool is_left_out = next != left_out.end() && *next == facet;
        next += is_left_out ? 1 : 0;
        if (is_left_out || normal == glm::dvec3(0))
            continue;
        if (weights == VertexNormals::plain)
            add_plain(sums, polygons, facet, normal, last_facet);
        else
            add_by_angle(sums, polygons, facet, normal);
    }
    std::vector<glm::dvec3> normals(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
        normals[i] = largest_component(sums[i].sum) > 1e-12 * sums[i].weight ? unit(sums[i].sum) : glm::dvec3(0);
    return normals;
}

} // namespace forceshade
