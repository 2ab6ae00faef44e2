#include "host/mesh/creases.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/mesh/connectivity.h"
#include "host/mesh/places.h"
#include "host/reference/elementary.h"

namespace forceshade {

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
