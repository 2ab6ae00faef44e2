// Polygons to make meshes of: a sphere of triangles, the paper's bump of hexagons.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/vec3.hpp>

namespace forceshade::testing {

using Polygon = std::vector<glm::dvec3>;

struct Plane {
    glm::dvec3 point, normal;
};

inline double dot(const glm::dvec3& a, const glm::dvec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline double length(const glm::dvec3& a) {
    return std::sqrt(dot(a, a));
}

// Newell's normal, in long double.
inline Plane plane_of(const Polygon& polygon) {
    long double x = 0, y = 0, z = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
        x += static_cast<long double>(a.y) * b.z - static_cast<long double>(a.z) * b.y;
        y += static_cast<long double>(a.z) * b.x - static_cast<long double>(a.x) * b.z;
        z += static_cast<long double>(a.x) * b.y - static_cast<long double>(a.y) * b.x;
    }
    const long double size = std::sqrt(x * x + y * y + z * z);
    return {polygon[0], {double(x / size), double(y / size), double(z / size)}};
}

// As an OBJ file in metres, equal vertices once.
inline std::string obj(const std::vector<Polygon>& polygons) {
    std::vector<glm::dvec3> vertices;
    std::string facets;
    for (const Polygon& polygon : polygons) {
        facets += 'f';
        for (const glm::dvec3& corner : polygon) {
            const auto known = std::find(vertices.begin(), vertices.end(), corner);
            facets += fmt::format(" {}", known - vertices.begin() + 1);
            if (known == vertices.end())
                vertices.push_back(corner);
        }
        facets += '\n';
    }
    std::string text;
    for (const glm::dvec3& v : vertices)
        text += fmt::format("v {} {} {}\n", v.x, v.y, v.z);
    return text + facets;
}

// Triangles of an octahedron, each cut into four and put on the sphere, `times` over.
inline std::vector<Polygon> sphere(double radius, int times) {
    const glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    std::vector<Polygon> triangles{{x, y, z},  {y, -x, z},  {-x, -y, z},  {-y, x, z},
                                   {y, x, -z}, {-x, y, -z}, {-y, -x, -z}, {x, -y, -z}};
    for (int time = 0; time < times; ++time) {
        std::vector<Polygon> finer;
        for (const Polygon& t : triangles) {
            const auto middle = [](const glm::dvec3& a, const glm::dvec3& b) {
                const glm::dvec3 sum{a.x + b.x, a.y + b.y, a.z + b.z};
                return sum / length(sum);
            };
            const glm::dvec3 a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
        }
        triangles = std::move(finer);
    }
    for (Polygon& triangle : triangles)
        for (glm::dvec3& corner : triangle)
            corner *= radius;
    return triangles;
}

// G2: n facets inscribed in a cylinder of 600 mil over 1000 mil, each cut into two hexagons (a quad and the middles of
// its long sides), with the plane on both sides as one polygon each.
inline std::vector<Polygon> bump(int facets) {
    const double a = 0.0127, radius = 0.01524, half = 0.02;
    const double edge = std::asin(a / radius);
    const auto at = [&](int i, double y) {
        const double angle = edge * (2.0 * i / facets - 1);
        return glm::dvec3{radius * std::sin(angle), y,
                          i == 0 || i == facets ? 0 : radius * (std::cos(angle) - std::cos(edge))};
    };
    std::vector<Polygon> polygons{
        {{-0.03, -half, 0}, at(0, -half), at(0, -half / 2), at(0, 0), at(0, half / 2), at(0, half), {-0.03, half, 0}}};
    for (int i = 0; i < facets; ++i)
        for (const double y : {-half, 0.0})
            polygons.push_back({at(i, y), at(i + 1, y), at(i + 1, y + half / 2), at(i + 1, y + half), at(i, y + half),
                                at(i, y + half / 2)});
    polygons.push_back({at(facets, -half),
                        {0.03, -half, 0},
                        {0.03, half, 0},
                        at(facets, half),
                        at(facets, half / 2),
                        at(facets, 0),
                        at(facets, -half / 2)});
    return polygons;
}

} // namespace forceshade::testing
