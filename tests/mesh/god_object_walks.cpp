#include "tests/mesh/god_object_walks.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "host/surface/facet_vertices.h"

namespace forceshade::walks {

using shapes::add_facet;

PolygonSoup wedge(double angle) {
    // A prism whose ridge, along y, has this angle.
    const double half = std::tan(0.5 * angle);
    PolygonSoup soup;
    soup.vertices = {{0, -0.7, 0}, {0, 0.7, 0}, {-half, -0.7, -1}, {half, -0.7, -1}, {-half, 0.7, -1}, {half, 0.7, -1}};
    add_facet(soup, {0, 1, 4, 2});
    add_facet(soup, {1, 0, 3, 5});
    add_facet(soup, {0, 2, 3});
    add_facet(soup, {1, 5, 4});
    add_facet(soup, {2, 4, 5, 3});
    return soup;
}

PolygonSoup touching_folds(unsigned folds, double gap) {
    PolygonSoup soup;
    for (unsigned i = 0; i <= 2 * folds; ++i) {
        // Up the crests touch each other, down the valleys do: crests lean over as far as their neighbours.
        const double x = (i % 2 == 0) ? 0.2 * i : 0.2 * i + ((i / 2) % 2 == 0 ? 0.2 - 0.5 * gap : -0.2 + 0.5 * gap);
        const double z = (i % 2 == 0) ? 0.0 : 0.5;
        soup.vertices.push_back({x, 0, z});
        soup.vertices.push_back({x, 1, z});
    }
    for (unsigned i = 0; i < 2 * folds; ++i)
        add_facet(soup, {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    return soup;
}

PolygonSoup pit(unsigned valence, double relief, unsigned seed, double depth) {
    std::mt19937 random(seed);
    PolygonSoup soup;
    soup.vertices.push_back({0, 0, -depth});
    for (unsigned i = 0; i < valence; ++i) {
        const double angle = 2 * std::acos(-1.0) * i / valence;
        const double height = relief * (2 * double(random()) / double(std::mt19937::max()) - 1);
        soup.vertices.push_back({std::cos(angle), std::sin(angle), height});
    }
    for (unsigned i = 0; i < valence; ++i)
        add_facet(soup, {0, 1 + i, 1 + (i + 1) % valence});
    return soup;
}

PolygonSoup bump(unsigned facets, unsigned rows) {
    const double half = 0.5, radius = 0.6;
    const std::vector<double> xs = facet_vertices<double>(facets, half, radius, FacetSpacing::equal_arc);
    std::vector<glm::dvec2> profile{{-1.0, 0.0}};
    const double base = std::sqrt(radius * radius - half * half);
    for (const double x : xs)
        profile.push_back({x, std::abs(x) < half ? std::sqrt(radius * radius - x * x) - base : 0.0});
    profile.push_back({1.0, 0.0});
    PolygonSoup soup;
    const auto columns = static_cast<std::uint32_t>(profile.size());
    for (unsigned row = 0; row <= rows; ++row)
        for (const glm::dvec2& point : profile)
            soup.vertices.push_back({point.x, -0.5 + static_cast<double>(row) / rows, point.y});
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t i = 0; i + 1 < columns; ++i)
            add_facet(soup,
                      {row * columns + i, row * columns + i + 1, (row + 1) * columns + i + 1, (row + 1) * columns + i});
    return soup;
}

std::vector<Terrain> terrains() {
    const auto saddle = [](double x, double y) { return x * x - y * y; };
    const auto waves = [](double x, double y) { return 0.1 * std::sin(9 * x) * std::sin(8 * y); };
    return {{"sphere", shapes::icosphere(2)},
            {"coarse sphere", shapes::icosphere(0)},
            {"wedge 5 degrees", wedge(0.0873)},
            {"wedge 60 degrees", wedge(1.047)},
            {"saddle", shapes::patch(shapes::Cells::triangles, 10, saddle)},
            {"waves", shapes::patch(shapes::Cells::triangles, 12, waves)},
            {"plate", shapes::plate(5e-4)},
            {"folds", touching_folds(6, 0.0)},
            {"near folds", touching_folds(6, 1e-6)},
            {"bump", bump(16, 1)},
            {"bump rows", bump(16, 6)},
            {"cube", shapes::cube()},
            {"polyhedra", shapes::random_polyhedra(20, 7)}};
}

std::vector<Terrain> pits() {
    std::vector<Terrain> result;
    for (const unsigned valence : {8U, 40U, 100U, 300U, 1000U})
        for (const double relief : {0.0, 0.05, 0.3})
            result.push_back(
                {fmt::format("pit {} {}", valence, relief), pit(valence, relief), valence, glm::dvec3(0, 0, -0.3)});
    return result;
}

Wanderer::Wanderer(const MeshStructure& structure, std::uint64_t seed, std::optional<glm::dvec3> focus)
    : structure_(structure), random_(seed) {
    if (focus)
        focus_ = to_mesh_frame(structure, *focus);
    double area = 0;
    const auto& parts = *structure.parts;
    for (std::size_t t = 0; t < structure.triangles(); ++t) {
        const auto at = [&](std::size_t i) {
            const std::size_t v = 3 * std::size_t(parts.triangle_corners[3 * t + i]);
            const auto& vertices = structure.reals->vertices;
            return glm::dvec3(vertices[v], vertices[v + 1], vertices[v + 2]);
        };
        area += glm::length(glm::cross(at(1) - at(0), at(2) - at(0)));
    }
    facet_ = std::sqrt(area / static_cast<double>(structure.triangles()));
}

glm::dvec3 Wanderer::direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
}

glm::dvec3 Wanderer::near_surface() {
    if (focus_)
        return *focus_ + std::pow(10.0, random(-4, -1)) * direction();
    const auto& parts = *structure_.parts;
    const std::size_t t = random_() % structure_.triangles();
    double u = random(0, 1), v = random(0, 1);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const auto at = [&](std::size_t i) {
        const std::size_t place = 3 * std::size_t(parts.triangle_corners[3 * t + i]);
        const auto& vertices = structure_.reals->vertices;
        return glm::dvec3(vertices[place], vertices[place + 1], vertices[place + 2]);
    };
    const double depth = facet_ * std::pow(10.0, random(-4, 0.5));
    return at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0)) + depth * direction();
}

glm::dvec3 Wanderer::begin() {
    goal_ = near_surface();
    return glm::dvec3(random(-1.2, 1.2), random(-1.2, 1.2), random(-1.2, 1.2));
}

glm::dvec3 Wanderer::step(const glm::dvec3& from) {
    const double length = facet_ * std::pow(10.0, random(-7, 1));
    if (random(0, 1) < 0.05)
        goal_ = near_surface();
    if (random(0, 1) < 0.3)
        return from + length * direction();
    const glm::dvec3 way = goal_ - from;
    const double far = glm::length(way);
    if (far < length)
        return random(0, 1) < 0.5 ? goal_ : from + length * direction() * 0.1;
    return from + (length / far) * (way + 0.3 * far * direction());
}

} // namespace forceshade::walks
