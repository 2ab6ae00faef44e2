#include "host/mesh/places.h"

#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "host/reference/elementary.h"

namespace forceshade {

namespace {

// Equal for equal numbers, 0 and -0 too, and for the same NaN.
std::uint64_t bits(double value) {
    return std::bit_cast<std::uint64_t>(value + 0.0);
}

std::uint64_t mixed(std::uint64_t hash, double value) {
    hash = (hash ^ bits(value)) * 0x9E3779B97F4A7C15u;
    return hash ^ (hash >> 29);
}

std::uint64_t hash_of(double x, double y, double z) {
    return mixed(mixed(mixed(0, x), y), z);
}

bool comes_before(const glm::dvec3& one, const glm::dvec3& other) {
    return std::tie(one.x, one.y, one.z) < std::tie(other.x, other.y, other.z);
}

// Points in cells that are wide enough for most to have all within the distance in their own: what is near one is in
// one of 8 at most.
class NearPoints {
public:
    NearPoints(std::span<const glm::dvec3> points, double distance)
        : points_(points), distance_(distance), heads_(std::bit_ceil(points.size() + 1), kNone),
          next_(points.size(), kNone) {
        double farthest = 0;
        for (const glm::dvec3& point : points)
            farthest = std::max(farthest, reference::largest_coordinate(point));
        margin_ = distance * (1 + 1e-6) + 8 * std::numeric_limits<double>::epsilon() * farthest; // rounding of cells
        size_ = std::max(4 * margin_, farthest / std::sqrt(static_cast<double>(points.size()) + 1));
    }

    /// Calls use(other, distance) for the points added before that are near, then adds this one.
    template <typename Use> void add(std::uint32_t point, const Use& use) {
        const glm::dvec3& at = points_[point];
        std::array<std::array<double, 2>, 3> cells;
        std::array<std::size_t, 3> counts;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double place = at[static_cast<int>(axis)] / size_, cell = std::floor(place);
            const double below = (place - cell) * size_, above = size_ - below;
            cells[axis] = {cell, below <= above ? cell - 1 : cell + 1};
            counts[axis] = std::min(below, above) <= margin_ ? 2 : 1;
        }
        for (std::size_t i = 0; i < counts[0]; ++i)
            for (std::size_t j = 0; j < counts[1]; ++j)
                for (std::size_t k = 0; k < counts[2]; ++k)
                    for (std::uint32_t other = heads_[slot(cells[0][i], cells[1][j], cells[2][k])]; other != kNone;
                         other = next_[other]) {
                        const glm::dvec3 apart = points_[other] - at;
                        const double square = reference::dot(apart, apart);
                        if (square <= distance_ * distance_)
                            use(other, std::sqrt(square));
                    }
        std::uint32_t& head = heads_[slot(cells[0][0], cells[1][0], cells[2][0])];
        next_[point] = std::exchange(head, point);
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

    std::size_t slot(double x, double y, double z) const { return hash_of(x, y, z) & (heads_.size() - 1); }

    std::span<const glm::dvec3> points_;
    double distance_, margin_ = 0, size_ = 0; // of a cell
    std::vector<std::uint32_t> heads_, next_; // of cells that share a slot
};

} // namespace

DisjointSets::DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), 0u);
}

std::size_t DisjointSets::count() const noexcept {
    std::size_t sets = 0;
    for (std::size_t i = 0; i < parents_.size(); ++i)
        sets += parents_[i] == i;
    return sets;
}

FacetSides::FacetSides(const PolygonSoup& polygons) : polygons_(polygons), facets_(polygons.corners.size()) {
    for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet)
        std::fill_n(facets_.begin() + polygons.begins[facet], polygons.corners_of(facet), facet);
}

std::vector<std::uint32_t> weld(std::span<const double> vertices) {
    const std::size_t count = vertices.size() / 3;
    FirstOfEqual vertices_seen(count);
    std::vector<std::uint32_t> places(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double* at = &vertices[3 * i];
        const auto equals = [&](std::uint32_t other) {
            const double* there = &vertices[3 * std::size_t(other)];
            return bits(at[0]) == bits(there[0]) && bits(at[1]) == bits(there[1]) && bits(at[2]) == bits(there[2]);
        };
        places[i] = vertices_seen.add(hash_of(at[0], at[1], at[2]), static_cast<std::uint32_t>(i), equals);
    }
    return places;
}

std::vector<std::uint32_t> weld(const PolygonSoup& polygons) {
    if (polygons.vertices.empty())
        return {};
    return weld(std::span(&polygons.vertices[0].x, 3 * polygons.vertices.size()));
}

std::vector<std::uint32_t> weld_within(const PolygonSoup& polygons, double distance) {
    std::vector<std::uint32_t> places = weld(polygons);
    DisjointSets sets(places.size());
    NearPoints near(polygons.vertices, distance);
    for (std::uint32_t vertex = 0; vertex < places.size(); ++vertex)
        if (places[vertex] == vertex)
            near.add(vertex, [&](std::uint32_t other, double) { sets.join(vertex, other); });
    for (std::uint32_t& place : places)
        place = sets.find(place);
    return places;
}

JoinedVertices join_vertices(PolygonSoup& polygons, double distance) {
    const std::vector<std::uint32_t> exact = weld(polygons);
    const std::vector<std::uint32_t> places = distance > 0 ? weld_within(polygons, distance) : exact;
    std::vector<glm::dvec3>& vertices = polygons.vertices;
    if (distance > 0)
        for (std::size_t vertex = 0; vertex < places.size(); ++vertex)
            if (comes_before(vertices[vertex], vertices[places[vertex]]))
                vertices[places[vertex]] = vertices[vertex];
    JoinedVertices joined;
    std::vector<std::uint32_t> numbers(places.size());
    std::uint32_t kept = 0;
    for (std::size_t vertex = 0; vertex < places.size(); ++vertex) {
        const bool stands = places[vertex] == vertex;
        numbers[vertex] = stands ? kept : numbers[places[vertex]];
        if (stands)
            vertices[kept++] = vertices[vertex];
    }
    joined.vertices = vertices.size() - kept;
    if (joined.vertices == 0)
        return joined;
    vertices.resize(kept);
    const auto places_of = [](std::span<const std::uint32_t> corners) {
        std::size_t changes = 0;
        for (std::size_t i = 0; i < corners.size(); ++i)
            changes += corners[i] != corners[i == 0 ? corners.size() - 1 : i - 1];
        return changes;
    };
    const bool with_normals = !polygons.normals.empty();
    std::vector<std::uint32_t> given, before, after;
    std::uint32_t end = 0; // of what is written; never beyond what is read
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const std::uint32_t first = polygons.begins[facet], last = polygons.begins[facet + 1];
        polygons.begins[facet] = end;
        const auto corners = std::span(polygons.corners).subspan(first, last - first);
        given.assign(corners.begin(), corners.end());
        before.clear(), after.clear();
        for (const std::uint32_t corner : given) {
            before.push_back(exact[corner]);
            after.push_back(numbers[corner]);
        }
        const bool vanishes = places_of(after) < 3;
        joined.facets += vanishes && places_of(before) >= 3;
        for (std::uint32_t i = 0; i < after.size(); ++i) {
            const std::size_t previous = i == 0 ? after.size() - 1 : i - 1;
            if (!vanishes && after[i] == after[previous] && given[i] != given[previous])
                continue;
            polygons.corners[end] = after[i];
            if (with_normals)
                polygons.normals[end] = polygons.normals[first + i];
            ++end;
        }
    }
    polygons.begins.back() = end;
    polygons.corners.resize(end);
    if (with_normals)
        polygons.normals.resize(end);
    return joined;
}

namespace {

// The edges of a mesh that an odd number of facets have, and what becomes of them where their ends are joined.
class Gaps {
public:
    explicit Gaps(const PolygonSoup& polygons) {
        const FacetSides all(polygons);
        std::vector<std::uint32_t> numbers(polygons.vertices.size(), kNone);
        const auto number = [&](std::uint32_t vertex) {
            if (numbers[vertex] == kNone) {
                numbers[vertex] = static_cast<std::uint32_t>(points_.size());
                points_.push_back(polygons.vertices[vertex]);
            }
            return numbers[vertex];
        };
        all.for_each_edge([&](std::span<const std::uint32_t> sides) {
            const std::uint32_t start = all.start(sides[0]), end = all.end(sides[0]);
            if (start != end && sides.size() % 2 == 1)
                edges_.emplace_back(number(start), number(end));
        });
    }

    bool empty() const { return edges_.empty(); }

    bool close_within(double distance) const {
        DisjointSets sets(points_.size());
        NearPoints near(points_, distance);
        for (std::uint32_t point = 0; point < points_.size(); ++point)
            near.add(point, [&](std::uint32_t other, double) { sets.join(point, other); });
        std::vector<std::uint64_t> left;
        for (const auto& [start, end] : edges_)
            if (sets.find(start) != sets.find(end))
                left.push_back(edge_of(sets.find(start), sets.find(end)));
        std::ranges::sort(left);
        for (std::size_t i = 0; i < left.size(); i += 2)
            if (i + 1 == left.size() || left[i] != left[i + 1])
                return false;
        return true;
    }

    /// Between points, ascending; of those that are within `most` the ones further apart than `least`.
    std::vector<double> distances(double least, double most) const {
        std::vector<double> all;
        NearPoints near(points_, most);
        for (std::uint32_t point = 0; point < points_.size(); ++point)
            near.add(point, [&](std::uint32_t, double distance) {
                if (distance > least)
                    all.push_back(distance);
            });
        std::ranges::sort(all);
        return all;
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
    std::vector<glm::dvec3> points_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges_;
};

} // namespace

std::optional<double> closing_distance(const PolygonSoup& polygons) {
    const Gaps gaps(polygons);
    if (gaps.empty())
        return std::nullopt;
    const MeshBox box = bounding_box(polygons);
    const glm::dvec3 size = box.high - box.low;
    const double most = 0.01 * std::sqrt(reference::dot(size, size));
    if (!std::isfinite(most) || !(most > 0))
        return std::nullopt;
    double low = 0;
    for (double high = most * 0x1p-48; high <= most; low = high, high *= 2) {
        if (!gaps.close_within(high))
            continue;
        // The least of the distances in between: joining more does not open what is closed but in odd cases.
        const std::vector<double> candidates = gaps.distances(low, high);
        const auto closes = std::ranges::partition_point(
            candidates, [&](double distance) { return !gaps.close_within(distance * (1 + 0x1p-40)); });
        return closes == candidates.end() ? high : *closes;
    }
    return std::nullopt;
}

} // namespace forceshade
