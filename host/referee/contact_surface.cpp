#include "host/referee/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <Eigen/QR>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "host/norm.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using reference::cross;
using reference::dot;
using reference::largest_coordinate;

constexpr double kWhole = 1e-2;      // how far a winding number may be from a whole one: the tree's are good to 1e-4
constexpr double kBothWays = 0.125;  // of a direction
constexpr double kSameNormal = 1e-5; // squared difference of normals that are one: well below what is allowed of forces
constexpr std::size_t kManyFaces = 40;

// The volume's sign in Real; rounding of the differences, products and sums is below 16 roundings of the same with
// positive terms.
template <typename Real>
int sign_in(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const glm::vec<3, Real> u = glm::vec<3, Real>(a) - glm::vec<3, Real>(d),
                            v = glm::vec<3, Real>(b) - glm::vec<3, Real>(d),
                            w = glm::vec<3, Real>(c) - glm::vec<3, Real>(d);
    const Real vw = v.x * w.y, wv = w.x * v.y, wu = w.x * u.y, uw = u.x * w.y, uv = u.x * v.y, vu = v.x * u.y;
    const Real volume = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
    const Real size = std::abs(u.z) * (std::abs(vw) + std::abs(wv)) + std::abs(v.z) * (std::abs(wu) + std::abs(uw)) +
                      std::abs(w.z) * (std::abs(uv) + std::abs(vu));
    const Real error = 16 * std::numeric_limits<Real>::epsilon() * size + Real(1e-290);
    return volume > error ? 1 : volume < -error ? -1 : 0;
}

std::optional<int> whole(double winding) {
    const double nearest = std::nearbyint(winding);
    return std::abs(winding - nearest) < kWhole ? std::optional(static_cast<int>(nearest)) : std::nullopt;
}

// A segment against boxes that are aligned with the axes: separating axes, a little too near on purpose.
struct SegmentBoxes {
    SegmentBoxes(const glm::dvec3& from, const glm::dvec3& to)
        : middle(0.5 * (from + to)), half(0.5 * (to - from)),
          slack(16 * std::numeric_limits<double>::epsilon() *
                (1 + std::max(largest_coordinate(from), largest_coordinate(to)))) {
        for (int i = 0; i < 3; ++i)
            extent[i] = std::abs(half[i]) + slack;
    }

    bool meets(const layout::MeshNode& node, layout::uint i) const {
        const double ex = 0.5 * (double(node.high_x[i]) - node.low_x[i]) + slack,
                     ey = 0.5 * (double(node.high_y[i]) - node.low_y[i]) + slack,
                     ez = 0.5 * (double(node.high_z[i]) - node.low_z[i]) + slack;
        const double x = 0.5 * (double(node.high_x[i]) + node.low_x[i]) - middle.x,
                     y = 0.5 * (double(node.high_y[i]) + node.low_y[i]) - middle.y,
                     z = 0.5 * (double(node.high_z[i]) + node.low_z[i]) - middle.z;
        if (std::abs(x) > ex + extent.x || std::abs(y) > ey + extent.y || std::abs(z) > ez + extent.z)
            return false;
        const double far = slack * (std::abs(x) + std::abs(y) + std::abs(z));
        return std::abs(y * half.z - z * half.y) <= ey * extent.z + ez * extent.y + far &&
               std::abs(z * half.x - x * half.z) <= ez * extent.x + ex * extent.z + far &&
               std::abs(x * half.y - y * half.x) <= ex * extent.y + ey * extent.x + far;
    }

    glm::dvec3 middle, half, extent{0};
    double slack;
};

} // namespace

int volume_sign(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const int sign = sign_in<double>(a, b, c, d);
    return sign != 0 ? sign : sign_in<long double>(a, b, c, d);
}

Meets segment_meets(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle) {
    const auto& [a, b, c] = triangle;
    const int begin = volume_sign(a, b, c, from), end = volume_sign(a, b, c, to);
    if (begin * end > 0)
        return Meets::no;
    int above = 0, below = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const int side = volume_sign(from, to, triangle[i], triangle[(i + 1) % 3]);
        above += side > 0;
        below += side < 0;
    }
    if (above > 0 && below > 0)
        return Meets::no;
    return begin * end < 0 && above + below == 3 ? Meets::yes : Meets::unsure;
}

ContactSurface::ContactSurface(const Mesh& mesh, MeshStructure structure, std::vector<double> vertices)
    : mesh_(mesh), structure_(std::move(structure)), origin_(origin_of(structure_)), vertices_(std::move(vertices)),
      referee_(mesh, {}) {
    if (!structure_.winding)
        structure_.winding = make_winding(structure_);
    tables_ = make_mesh_tables<double>(structure_, 0);
    law_.features.surface = layout::kSurfaceMesh;
    law_.mesh = tables_.view();
    law_.mesh.vertices = vertices_;
    const std::span<const layout::uint> facets = law_.mesh.triangle_facets;
    facet_begins_.assign(mesh.polygons.facets() + 1, 0);
    for (const layout::uint facet : facets)
        ++facet_begins_[facet + 1];
    for (std::size_t i = 1; i < facet_begins_.size(); ++i)
        facet_begins_[i] += facet_begins_[i - 1];
    facet_triangles_.resize(facets.size());
    std::vector<std::uint32_t> next = facet_begins_;
    double volume = 0;
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
        facet_triangles_[next[facets[i]]++] = i;
        const auto [a, b, c] = corners(i);
        volume += dot(a, cross(b, c));
    }
    if (structure_.solid && closed())
        front_ = volume > 0 ? 0 : -1;
}

std::array<glm::dvec3, 3> ContactSurface::corners(std::uint32_t triangle) const {
    const layout::uint* vertices = &law_.mesh.triangle_corners[3 * std::size_t(triangle)];
    return {reference::vector_at(law_.mesh.vertices, vertices[0]),
            reference::vector_at(law_.mesh.vertices, vertices[1]),
            reference::vector_at(law_.mesh.vertices, vertices[2])};
}

glm::dvec3 ContactSurface::normal(std::uint32_t triangle) const {
    return reference::vector_at(law_.mesh.triangle_normals, triangle);
}

Meets ContactSurface::meets(const glm::dvec3& from, const glm::dvec3& to) const {
    const SegmentBoxes segment(from, to);
    Meets found = Meets::no;
    reference::visit_tree(
        law_.mesh, [&](layout::uint) { return found != Meets::yes; },
        [&](const layout::MeshNode& node, layout::uint i) { return segment.meets(node, i); },
        [&](layout::uint first, layout::uint end) {
            for (layout::uint i = first; i < end && found != Meets::yes; ++i)
                found = std::max(found, segment_meets(from, to, corners(i)));
        });
    return found;
}

bool ContactSurface::is_clear(const glm::dvec3& from, const glm::dvec3& to, double aside) const {
    if (meets(from, to) != Meets::no)
        return false;
    const glm::dvec3 along = reference::normalised(glm::dvec3(to - from));
    const glm::dvec3 axis = std::abs(along.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 one = aside * reference::normalised(cross(along, axis)), other = cross(along, one);
    for (const glm::dvec3& shift : {one, -one, other, -other})
        if (meets(from + shift, to + shift) != Meets::no || meets(from + shift, to) != Meets::no)
            return false;
    return true;
}

double ContactSurface::distance(const glm::dvec3& place) const {
    return norm(reference::nearest(law_.mesh, place).offset);
}

std::optional<int> ContactSurface::side_by_tree(const glm::dvec3& place, double nearest) const {
    return distance(place) > nearest ? whole(reference::winding_number(law_.mesh, place)) : std::nullopt;
}

std::optional<int> ContactSurface::side_by_loops(const glm::dvec3& place, double nearest) const {
    const glm::dvec3 world = to_world(place);
    const double rounded = 4 * std::numeric_limits<double>::epsilon() * reference::largest_coordinate(world); /* m */
    return double(referee_.nearest(world).distance) > nearest * scale() + rounded
               ? whole(double(referee_.winding_number(world)))
               : std::nullopt;
}

std::optional<int> ContactSurface::side_of_start(const glm::dvec3& probe, double nearest, bool by_winding) const {
    layout::Law<double> law = law_;
    law.features.inside = by_winding ? layout::kInsideWinding : layout::kInsidePseudonormal;
    const auto found = reference::nearest(law.mesh, probe);
    const std::optional<int> side = side_by_tree(probe, nearest);
    if (!side || !reference::is_inside(law, found, probe))
        return side;
    if (front_) // through a solid's surface, however narrow it is beyond
        return *side + (reference::inside_by_pseudonormal(law.mesh, found) ? -1 : 1);
    // None where another surface is as near beyond that one.
    return side_by_tree(probe + found.offset + 2 * nearest * reference::normalised(found.offset), 1.9 * nearest);
}

int ContactSurface::facing(std::optional<int> side) const {
    if (!front_ || !side)
        return 0;
    return *side == *front_ ? 1 : *side == *front_ + 1 ? -1 : 0;
}

std::vector<std::uint32_t> ContactSurface::crossing(std::span<const std::uint32_t> triangles) const {
    std::vector<std::uint32_t> found;
    if (triangles.empty() || std::ranges::any_of(corners(triangles[0]), [&](const glm::dvec3& pole) {
            return std::ranges::all_of(triangles,
                                       [&](std::uint32_t one) { return std::ranges::count(corners(one), pole) > 0; });
        }))
        return found; // all at one corner: not each with each of many
    std::ranges::copy_if(triangles, std::back_inserter(found), [&](std::uint32_t one) {
        return std::ranges::any_of(triangles, [&](std::uint32_t other) { return !share_a_corner(one, other); });
    });
    return found;
}

bool ContactSurface::face_both_ways(const glm::dvec3& place, const glm::dvec3& towards, double reach) const {
    bool ahead = false, back = false;
    for (const std::uint32_t triangle : triangles_at(place, reach, reach)) {
        const double rate = dot(normal(triangle), towards);
        ahead = ahead || rate > kBothWays;
        back = back || rate < -kBothWays;
    }
    return ahead && back;
}

std::optional<std::uint32_t> ContactSurface::face_at(std::uint32_t facet, const glm::dvec3& place,
                                                     double margin) const {
    if (facet + 1 >= facet_begins_.size())
        return std::nullopt;
    for (std::uint32_t i = facet_begins_[facet]; i < facet_begins_[facet + 1]; ++i) {
        const std::uint32_t triangle = facet_triangles_[i];
        const glm::dvec3 up = normal(triangle);
        const std::array<glm::dvec3, 3> shape = corners(triangle);
        bool inside = dot(up, up) > 0 && std::abs(dot(up, place - shape[0])) <= margin;
        for (std::size_t k = 0; k < 3 && inside; ++k) {
            const glm::dvec3 edge = shape[(k + 1) % 3] - shape[k];
            const double height = dot(cross(up, edge), place - shape[k]);
            inside = height > 0 && height * height > margin * margin * dot(edge, edge);
        }
        if (inside)
            return triangle;
    }
    return std::nullopt;
}

std::vector<std::uint32_t> ContactSurface::triangles_at(const glm::dvec3& place, double reach, double margin) const {
    std::vector<std::uint32_t> found;
    const auto is_near = [&](double low, double high, double at) { return at >= low - reach && at <= high + reach; };
    reference::visit_tree(
        law_.mesh, [](layout::uint) { return true; },
        [&](const layout::MeshNode& node, layout::uint i) {
            return is_near(node.low_x[i], node.high_x[i], place.x) && is_near(node.low_y[i], node.high_y[i], place.y) &&
                   is_near(node.low_z[i], node.high_z[i], place.z);
        },
        [&](layout::uint first, layout::uint end) {
            for (layout::uint i = first; i < end; ++i) {
                const auto shape = reference::triangle_at(law_.mesh, i);
                if (dot(shape.normal, shape.normal) > 0 &&
                    std::abs(dot(shape.normal, place - shape.corners[0])) <= margin &&
                    reference::nearest_on_triangle(place, shape).square <= reach * reach)
                    found.push_back(i);
            }
        });
    return found;
}

bool ContactSurface::share_a_corner(std::uint32_t one, std::uint32_t other) const {
    const auto first = corners(one), second = corners(other); // by place: files may give a corner to each facet
    return std::ranges::any_of(first, [&](const glm::dvec3& v) { return std::ranges::count(second, v) > 0; });
}

// Whether two triangles are behind each other's planes, and not in them.
bool ContactSurface::is_convex(std::uint32_t one, std::uint32_t other, int facing, double margin) const {
    double lowest = 0;
    for (const auto& [plane, shape] : {std::pair(one, other), std::pair(other, one)}) {
        const glm::dvec3 up = double(facing) * normal(plane), at = corners(plane)[0];
        for (const glm::dvec3& corner : corners(shape)) {
            const double height = dot(up, corner - at);
            if (height > margin)
                return false;
            lowest = std::min(lowest, height);
        }
    }
    return lowest < -4 * margin;
}

double ContactSurface::residual(const glm::dvec3& pull, std::span<const std::uint32_t> triangles, int facing,
                                bool convex, double margin) const {
    std::vector<glm::dvec3> spans;
    std::vector<std::pair<std::uint32_t, int>> from;
    const auto add = [&](std::uint32_t triangle, int side) {
        const glm::dvec3 inward = -double(side) * normal(triangle);
        if (convex && triangles.size() <= kManyFaces && std::ranges::any_of(spans, [&](const glm::dvec3& span) {
                return dot(span - inward, span - inward) < kSameNormal;
            }))
            return;
        spans.push_back(inward);
        from.emplace_back(triangle, side);
    };
    for (const std::uint32_t triangle : triangles) {
        if (facing >= 0)
            add(triangle, 1);
        if (facing <= 0)
            add(triangle, -1);
    }
    if (spans.size() > kManyFaces)
        return distance_from_cone(pull, spans);
    return distance_from_cone(pull, spans, [&](std::size_t i, std::size_t j) {
        return convex ||
               (from[i].second == from[j].second && !is_convex(from[i].first, from[j].first, from[i].second, margin));
    });
}

double ContactSurface::kept_off(std::span<const std::uint32_t> triangles, int facing, double skin,
                                double margin) const {
    if (triangles.size() > 2 * kManyFaces && facing != 0) {
        std::vector<glm::dvec3> outward;
        for (const std::uint32_t triangle : triangles)
            outward.push_back(double(facing) * normal(triangle));
        return skin * distance_of_offset_planes(outward);
    }
    if (triangles.size() > 2 * kManyFaces)
        return std::numeric_limits<double>::infinity();
    double most = skin;
    const auto add_corner = [&](const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& w) {
        const double volume = std::abs(dot(u, cross(v, w)));
        if (volume > 1e-9)
            most = std::max(most, skin * norm(cross(v, w) + cross(w, u) + cross(u, v)) / volume);
    };
    for (std::size_t i = 0; i < triangles.size(); ++i)
        for (std::size_t j = i + 1; j < triangles.size(); ++j) {
            if (facing != 0 && is_convex(triangles[i], triangles[j], facing, margin))
                continue;
            const glm::dvec3 u = normal(triangles[i]), v = normal(triangles[j]);
            const double along = dot(u, v);
            // The half angle's sine; of triangles apart it is not known how they face each other.
            double sine = std::sqrt(std::max(0.0, (1 + along) / 2));
            if (facing == 0 && !share_a_corner(triangles[i], triangles[j]))
                sine = std::min(sine, std::sqrt(std::max(0.0, (1 - along) / 2)));
            most = sine > 1e-9 ? std::max(most, skin / sine) : std::numeric_limits<double>::infinity();
            for (std::size_t k = j + 1; k < triangles.size(); ++k)
                if (facing == 0 || (!is_convex(triangles[i], triangles[k], facing, margin) &&
                                    !is_convex(triangles[j], triangles[k], facing, margin)))
                    add_corner(u, v, normal(triangles[k]));
        }
    return most;
}

namespace {

using Real = long double;
constexpr Real kDependent =
    1e-13L;                      // length of a vector off the span of others, of the longest, below which it is in it
constexpr int kMostRounds = 200; // a few are needed; rounding could go round for ever

// The shares of the columns whose sum is nearest to a target; false if one of the columns depends on the others.
template <int N>
bool least_squares(const std::vector<glm::vec<N, Real>>& columns, const glm::vec<N, Real>& target,
                   std::array<Real, N + 1>& shares) {
    using Matrix = Eigen::Matrix<Real, N, Eigen::Dynamic, Eigen::ColMajor, N, N>;
    const auto count = static_cast<Eigen::Index>(columns.size());
    Eigen::ColPivHouseholderQR<Matrix> decomposition(Eigen::Map<const Matrix>(&columns[0][0], N, count));
    decomposition.setThreshold(kDependent);
    if (decomposition.rank() < count)
        return false;
    Eigen::Map<Eigen::Matrix<Real, Eigen::Dynamic, 1>>(shares.data(), count) =
        decomposition.solve(Eigen::Map<const Eigen::Matrix<Real, N, 1>>(&target[0]));
    return true;
}

// What a target leaves of itself off the cone that columns span.
template <int N>
glm::vec<N, Real> off_cone(const std::vector<glm::vec<N, Real>>& columns, const glm::vec<N, Real>& target) {
    constexpr std::size_t kMost = N + 1;
    std::vector<glm::vec<N, Real>> active;
    std::array<Real, kMost> held{}, wanted{};
    glm::vec<N, Real> left = target;
    for (int round = 0; round < kMostRounds; ++round) {
        const auto steepest = std::ranges::max_element(
            columns, {}, [&](const glm::vec<N, Real>& column) { return glm::dot(column, left); });
        if (steepest == columns.end() || !(glm::dot(*steepest, left) > 1e-15L * glm::length(target)))
            break;
        active.push_back(*steepest);
        held[active.size() - 1] = 0;
        if (active.size() == kMost || !least_squares(active, target, wanted))
            break;
        for (;;) {
            Real step = 1;
            for (std::size_t i = 0; i < active.size(); ++i)
                if (wanted[i] <= 0)
                    step = std::min(step, held[i] / (held[i] - wanted[i]));
            std::size_t kept = 0;
            for (std::size_t i = 0; i < active.size(); ++i) {
                const Real share = held[i] + step * (wanted[i] - held[i]);
                if (step < 1 && wanted[i] <= 0 && !(share > 1e-18L))
                    continue;
                active[kept] = active[i];
                held[kept++] = share;
            }
            active.resize(kept);
            if (step == 1 || !least_squares(active, target, wanted))
                break;
        }
        left = target;
        for (std::size_t i = 0; i < active.size(); ++i)
            left -= held[i] * active[i];
    }
    return left;
}

} // namespace

double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans,
                          const std::function<bool(std::size_t, std::size_t)>& together) {
    double least = norm(vector);
    for (std::size_t i = 0; i < spans.size(); ++i) {
        const glm::dvec3& u = spans[i];
        const double on_u = reference::dot(u, vector);
        if (on_u > 0)
            least = std::min(least, norm(vector - on_u * u));
        for (std::size_t j = i + 1; j < spans.size(); ++j) {
            if (!together(i, j))
                continue;
            const glm::dvec3& v = spans[j];
            const double on_v = reference::dot(v, vector), uv = reference::dot(u, v), square = 1 - uv * uv;
            if (square > 1e-14) {
                const double of_u = (on_u - uv * on_v) / square, of_v = (on_v - uv * on_u) / square;
                if (of_u >= 0 && of_v >= 0)
                    least = std::min(least, norm(vector - of_u * u - of_v * v));
            }
            for (std::size_t k = j + 1; k < spans.size(); ++k) {
                const glm::dvec3& w = spans[k];
                const glm::dvec3 vw = reference::cross(v, w);
                const double volume = reference::dot(u, vw);
                if (!(std::abs(volume) > 1e-12) || !together(i, k) || !together(j, k))
                    continue;
                if (reference::dot(vector, vw) / volume >= 0 &&
                    reference::dot(vector, reference::cross(w, u)) / volume >= 0 &&
                    reference::dot(vector, reference::cross(u, v)) / volume >= 0)
                    return 0;
            }
        }
    }
    return least;
}

double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans) {
    return double(glm::length(off_cone<3>({spans.begin(), spans.end()}, glm::vec<3, Real>(vector))));
}

double distance_of_offset_planes(std::span<const glm::dvec3> normals) {
    std::vector<glm::vec<4, Real>> columns;
    for (const glm::dvec3& normal : normals)
        columns.emplace_back(glm::vec<3, Real>(normal), 1);
    const glm::vec<4, Real> left = off_cone<4>(columns, {0, 0, 0, 1});
    return left.w > 1e-15L ? double(glm::length(glm::vec<3, Real>(left)) / left.w)
                           : std::numeric_limits<double>::infinity();
}

} // namespace forceshade
