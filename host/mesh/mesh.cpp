// Normals of facets, vertices and corners, of which a triangle's is good to a few units in the last place whatever its
// shape; and a mesh placed in the world.
#include "host/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "host/error.h"
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

// The corners at one vertex, in sets that share a normal: of those of the same smoothing group.
DisjointSets sets_by_group(std::span<const FacetCorner> corners, std::span<const std::uint32_t> groups) {
    DisjointSets sets(corners.size());
    std::map<std::uint32_t, std::uint32_t> firsts; // the first corner of each group
    for (std::uint32_t i = 0; i < corners.size(); ++i)
        if (const std::uint32_t group = groups[corners[i].facet]; group != 0)
            sets.join(firsts.try_emplace(group, i).first->second, i);
    return sets;
}

// The same of those connected across edges at which the facets' normals differ by no more than an angle.
DisjointSets sets_by_crease(std::span<const FacetCorner> corners, std::span<const glm::dvec3> normals, double angle) {
    DisjointSets sets(corners.size());
    const auto angle_between = [&](std::uint32_t one, std::uint32_t other) {
        return reference::angle_between(normals[corners[one].facet], normals[corners[other].facet]);
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides; // the vertex at the edge's other end, corner
    for (std::uint32_t i = 0; i < corners.size(); ++i)
        sides.insert(sides.end(), {{corners[i].before, i}, {corners[i].after, i}});
    std::ranges::sort(sides);
    for (std::size_t first = 0, end = 0; end < sides.size(); ++end) {
        if (sides[end].first != sides[first].first)
            first = end;
        for (std::size_t i = first; i < end; ++i)
            if (angle_between(sides[i].second, sides[end].second) <= angle)
                sets.join(sides[i].second, sides[end].second);
    }
    return sets;
}

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
        DisjointSets sets = smoothing.weights == VertexNormals::groups
                                ? sets_by_group(corners, polygons.groups)
                                : sets_by_crease(corners, facet_normals, smoothing.crease);
        sums.assign(corners.size(), glm::dvec3(0));
        for (std::uint32_t i = 0; i < corners.size(); ++i)
            if (i == 0 || corners[i].facet != corners[i - 1].facet)
                sums[sets.find(i)] += facet_normals[corners[i].facet];
        for (std::uint32_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3& sum = sums[sets.find(i)];
            const std::uint32_t facet = corners[i].facet;
            if (reference::largest_coordinate(sum) > 1e-12)
                for (std::uint32_t at = polygons.begins[facet]; at < polygons.begins[facet + 1]; ++at)
                    if (polygons.corners[at] == vertex)
                        normals[at] = reference::normalised(sum);
        }
    }
    return normals;
}

MeshBox bounding_box(const PolygonSoup& polygons) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t corner : polygons.corners) {
        low = glm::min(low, polygons.vertices[corner]);
        high = glm::max(high, polygons.vertices[corner]);
    }
    return {low, high};
}

MeshFrame frame_of(const PolygonSoup& polygons) {
    const auto [low, high] = bounding_box(polygons);
    const glm::dvec3 centre = low / 2.0 + high / 2.0;
    double reach = 0;
    for (int axis = 0; axis < 3; ++axis)
        reach = std::max({reach, centre[axis] - low[axis], high[axis] - centre[axis]});
    int exponent = 0;
    if (std::frexp(reach, &exponent) == 0.5)
        --exponent;
    const double scale = reach > 0 ? std::ldexp(1.0, exponent) : 1.0;
    if (!std::isfinite(reach) || !std::isfinite(scale))
        throw UsageError("the mesh is too large: its bounding box is not finite in metres");
    return {centre, scale};
}

namespace {

struct Turn {
    double cosine = 1, sine = 0;
};
using Turns = std::array<Turn, 3>; // about x, then y, then z

// A quarter turn in radians is not a binary number, but a mesh turned by one should keep its zeros.
Turn turn_of(double angle) {
    const double quarters = angle / (M_PI / 2), nearest = std::nearbyint(quarters);
    if (std::abs(quarters - nearest) > 4e-16 * std::abs(quarters))
        return {std::cos(angle), std::sin(angle)};
    constexpr std::array<Turn, 4> kQuarters{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
    return kQuarters[static_cast<std::size_t>(std::fmod(nearest, 4) + 4) % 4];
}

void turn(double& first, double& second, const Turn& by) {
    const double before = first;
    first = by.cosine * before - by.sine * second;
    second = by.sine * before + by.cosine * second;
}

void turn(glm::dvec3& v, const Turns& turns) {
    turn(v.y, v.z, turns[0]);
    turn(v.z, v.x, turns[1]);
    turn(v.x, v.y, turns[2]);
}

Turns turns_of(const MeshPlacement& placement) {
    return {turn_of(placement.rotate[0]), turn_of(placement.rotate[1]), turn_of(placement.rotate[2])};
}

void place(std::vector<glm::dvec3>& vertices, const MeshPlacement& placement) {
    const double factor = placement.unit * placement.scale;
    if (!(factor > 0) || !std::isfinite(factor))
        throw UsageError("a mesh's unit times its scale must be positive, got {} * {}", placement.unit,
                         placement.scale);
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (!std::ranges::all_of(placement.rotate, is_finite) || !std::ranges::all_of(placement.translate, is_finite))
        throw UsageError("a mesh's rotation and translation must be finite");
    const Turns turns = turns_of(placement);
    const glm::dvec3 shift(placement.translate[0], placement.translate[1], placement.translate[2]);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        glm::dvec3& v = vertices[i];
        v *= factor;
        turn(v, turns);
        v += shift;
        constexpr double kFarthest = 1e100; // m: volumes and squares stay finite
        if (!(std::abs(v.x) < kFarthest && std::abs(v.y) < kFarthest && std::abs(v.z) < kFarthest))
            throw UsageError("vertex {} (counted from 1) lies at ({}, {}, {}) m; a coordinate may not be beyond {} m",
                             i + 1, v.x, v.y, v.z, kFarthest);
    }
}

std::size_t count_opposed(const Mesh& mesh) {
    std::size_t opposed = 0;
    for (std::size_t facet = 0; facet < mesh.polygons.facets(); ++facet)
        for (const std::uint32_t vertex : mesh.polygons.outline(facet))
            opposed += reference::dot(mesh.vertex_normals[vertex], mesh.facet_normals[facet]) < 0;
    return opposed;
}

// Gives each vertex its corners' normal; corners with another one get a vertex of their own at the same place.
// Triangles stay as they are. `given`: a unit vector a corner.
void split_by_normals(Mesh& mesh, const std::vector<glm::dvec3>& given) {
    constexpr std::uint32_t kLast = 0xFFFFFFFF;
    PolygonSoup& polygons = mesh.polygons;
    std::vector<std::uint32_t> next(polygons.vertices.size(), kLast); // vertex at the same place
    std::vector<bool> known(next.size());
    mesh.vertex_normals.assign(next.size(), glm::dvec3(0));
    for (std::size_t i = 0; i < polygons.corners.size(); ++i) {
        const glm::dvec3& normal = given[i];
        std::uint32_t vertex = polygons.corners[i];
        while (known[vertex] && mesh.vertex_normals[vertex] != normal && next[vertex] != kLast)
            vertex = next[vertex];
        if (known[vertex] && mesh.vertex_normals[vertex] != normal) {
            next[vertex] = static_cast<std::uint32_t>(polygons.vertices.size());
            polygons.vertices.push_back(glm::dvec3(polygons.vertices[vertex]));
            mesh.vertex_normals.emplace_back(0);
            known.push_back(false);
            next.push_back(kLast);
            vertex = next[vertex];
        }
        mesh.vertex_normals[vertex] = normal;
        known[vertex] = true;
        polygons.corners[i] = vertex;
    }
    mesh.opposed_normals = count_opposed(mesh);
}

// Those of the file, turned with the mesh.
std::vector<glm::dvec3> take_file_normals(Mesh& mesh, const MeshPlacement& placement) {
    std::vector<glm::dvec3> normals = std::exchange(mesh.polygons.normals, {});
    const Turns turns = turns_of(placement);
    for (glm::dvec3& normal : normals) {
        turn(normal, turns);
        normal = unit_vector(normal);
    }
    return normals;
}

} // namespace

Mesh prepare_mesh(PolygonSoup polygons, const MeshPlacement& placement, const Smoothing& smoothing,
                  const Connectivity* known) {
    Mesh mesh;
    mesh.polygons = std::move(polygons);
    place(mesh.polygons.vertices, placement);
    mesh.facet_normals = facet_normals(mesh.polygons);
    mesh.redundant_facets = find_coincident(mesh.polygons, mesh.facet_normals).redundant;
    mesh.triangles = triangulate(mesh.polygons, mesh.facet_normals);
    if (smoothing.weights == VertexNormals::file) {
        split_by_normals(mesh, take_file_normals(mesh, placement));
        return mesh;
    }
    const Connectivity connected = known ? Connectivity(mesh.polygons, *known) : Connectivity(mesh.polygons);
    if (smoothing.weights == VertexNormals::groups || smoothing.weights == VertexNormals::crease)
        split_by_normals(mesh, corner_normals(connected, mesh.facet_normals, smoothing, mesh.redundant_facets));
    else
        mesh.vertex_normals = vertex_normals(connected, mesh.facet_normals, smoothing.weights, mesh.redundant_facets);
    return mesh;
}

} // namespace forceshade
