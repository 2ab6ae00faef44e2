// A sphere of as many triangles as a bench wants.
#pragma once

#include <array>
#include <cmath>
#include <map>

#include "tests/mesh/shapes.h"

namespace forceshade::bench {

/// Unit sphere: each facet of an icosahedron cut into `frequency` squared triangles.
inline PolygonSoup geodesic(unsigned frequency) {
    const PolygonSoup coarse = shapes::icosphere(0);
    PolygonSoup sphere;
    std::map<std::array<long, 3>, std::uint32_t> known;
    const auto vertex = [&](const glm::dvec3& place) {
        const glm::dvec3 unit = place / std::sqrt(place.x * place.x + place.y * place.y + place.z * place.z);
        const std::array<long, 3> key{std::lround(unit.x * 1e9), std::lround(unit.y * 1e9), std::lround(unit.z * 1e9)};
        const auto [found, added] = known.emplace(key, static_cast<std::uint32_t>(sphere.vertices.size()));
        if (added)
            sphere.vertices.push_back(unit);
        return found->second;
    };
    for (std::size_t f = 0; f < coarse.facets(); ++f) {
        const auto corner = [&](std::size_t i) { return coarse.vertices[coarse.corners[coarse.begins[f] + i]]; };
        const auto grid = [&](unsigned i, unsigned j) {
            return vertex(double(frequency - i - j) * corner(0) + double(i) * corner(1) + double(j) * corner(2));
        };
        for (unsigned j = 0; j < frequency; ++j)
            for (unsigned i = 0; i + j < frequency; ++i) {
                shapes::add_facet(sphere, {grid(i, j), grid(i + 1, j), grid(i, j + 1)});
                if (i + j + 1 < frequency)
                    shapes::add_facet(sphere, {grid(i + 1, j), grid(i + 1, j + 1), grid(i, j + 1)});
            }
    }
    return sphere;
}

} // namespace forceshade::bench
