#include "tests/mesh/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "host/mesh/mesh_file.h"
#include "tests/places.h"

namespace forceshade::shapes {
namespace {

double length(const glm::dvec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/// Each triangle cut into four; `settle` moves the new vertices.
template <typename Settle> PolygonSoup quartered(const PolygonSoup& coarse, const Settle& settle) {
    PolygonSoup fine;
    fine.vertices = coarse.vertices;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [at, fresh] =
            middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
        if (fresh)
            fine.vertices.push_back(settle((fine.vertices[a] + fine.vertices[b]) / 2.0));
        return at->second;
    };
    for (std::size_t facet = 0; facet < coarse.facets(); ++facet)
        for (std::uint32_t i = coarse.begins[facet] + 1; i + 1 < coarse.begins[facet + 1]; ++i) {
            const std::uint32_t a = coarse.corners[coarse.begins[facet]], b = coarse.corners[i],
                                c = coarse.corners[i + 1];
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            add_facet(fine, {a, ab, ca});
            add_facet(fine, {ab, b, bc});
            add_facet(fine, {ca, bc, c});
            add_facet(fine, {ab, bc, ca});
        }
    return fine;
}

/// Vertices made once for each place of a lattice.
class Lattice {
public:
    Lattice(PolygonSoup& polygons, const std::function<double(double, double)>& height)
        : polygons_(polygons), height_(height) {}

    std::uint32_t vertex(long column, long row, double x, double y) {
        const auto [at, fresh] =
            numbers_.try_emplace({column, row}, static_cast<std::uint32_t>(polygons_.vertices.size()));
        if (fresh)
            polygons_.vertices.push_back({x, y, height_(x, y)});
        return at->second;
    }

private:
    PolygonSoup& polygons_;
    const std::function<double(double, double)>& height_;
    std::map<std::pair<long, long>, std::uint32_t> numbers_;
};

PolygonSoup hexagon_patch(unsigned cells, const std::function<double(double, double)>& height) {
    PolygonSoup result;
    Lattice lattice(result, height);
    const double half = 0.5 / cells;                    // half a width
    const double side = 2 * half / std::numbers::sqrt3; // of a hexagon with its flats to the left and right
    const long reach = static_cast<long>(cells) + 1;
    for (long row = -reach; row <= reach; ++row)
        for (long column = -2 * reach; column <= 2 * reach; ++column) {
            if ((column + row) % 2 != 0)
                continue;
            const double x = double(column) * half, y = double(row) * 1.5 * side;
            if (std::abs(x) > 0.5 + 1e-12 || std::abs(y) > 0.5 + 1e-12)
                continue;
            // Corners on a lattice of half widths and half sides.
            constexpr long kSteps[6][2] = {{1, -1}, {1, 1}, {0, 2}, {-1, 1}, {-1, -1}, {0, -2}};
            for (const auto& step : kSteps) {
                const long i = column + step[0], j = 3 * row + step[1];
                result.corners.push_back(lattice.vertex(i, j, double(i) * half, double(j) * 0.5 * side));
            }
            result.end_facet();
        }
    return result;
}

} // namespace

Mesh mesh_of(PolygonSoup polygons, VertexNormals normals) {
    return prepare_mesh(std::move(polygons), MeshPlacement{}, normals);
}

void add_facet(PolygonSoup& polygons, std::initializer_list<std::uint32_t> corners) {
    polygons.corners.insert(polygons.corners.end(), corners);
    polygons.end_facet();
}

PolygonSoup icosphere(unsigned levels) {
    const double g = std::numbers::phi;
    PolygonSoup sphere;
    const auto settle = [](const glm::dvec3& v) { return v / length(v); };
    const double corners[12][3] = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    for (const auto& v : corners)
        sphere.vertices.push_back(settle({v[0], v[1], v[2]}));
    constexpr std::uint32_t kFaces[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                             {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                             {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                             {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (const auto& face : kFaces)
        add_facet(sphere, {face[0], face[1], face[2]});
    for (unsigned level = 0; level < levels; ++level)
        sphere = quartered(sphere, settle);
    return sphere;
}

PolygonSoup cube(bool triangles) {
    PolygonSoup result;
    for (int i = 0; i < 8; ++i)
        result.vertices.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    constexpr std::uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                            {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : kFaces)
        if (triangles) {
            add_facet(result, {face[0], face[1], face[2]});
            add_facet(result, {face[0], face[2], face[3]});
        } else {
            add_facet(result, {face[0], face[1], face[2], face[3]});
        }
    return result;
}

PolygonSoup open_cube() {
    const PolygonSoup closed = cube();
    return kept_facets(closed, [&](std::size_t facet) {
        return std::ranges::any_of(closed.outline(facet), [&](std::uint32_t v) { return closed.vertices[v].z < 1; });
    });
}

PolygonSoup kept_facets(const PolygonSoup& polygons, const std::function<bool(std::size_t facet)>& keeps) {
    PolygonSoup result;
    result.vertices = polygons.vertices;
    for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet)
        if (keeps(facet)) {
            const auto corners = polygons.outline(facet);
            result.corners.insert(result.corners.end(), corners.begin(), corners.end());
            result.end_facet();
        }
    return result;
}

PolygonSoup tetrahedron(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
    const glm::dvec3 u = b - a, v = c - a, w = d - a;
    const double volume = u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
    PolygonSoup result;
    result.vertices = volume > 0 ? std::vector{a, b, c, d} : std::vector{a, c, b, d};
    add_facet(result, {0, 2, 1});
    add_facet(result, {0, 1, 3});
    add_facet(result, {1, 2, 3});
    add_facet(result, {0, 3, 2});
    return result;
}

PolygonSoup patch(Cells kind, unsigned cells, const std::function<double(double, double)>& height) {
    if (kind == Cells::hexagons)
        return hexagon_patch(cells, height);
    PolygonSoup result;
    for (std::uint32_t j = 0; j <= cells; ++j)
        for (std::uint32_t i = 0; i <= cells; ++i) {
            const double x = double(i) / cells - 0.5, y = double(j) / cells - 0.5;
            result.vertices.push_back({x, y, height(x, y)});
        }
    for (std::uint32_t j = 0; j < cells; ++j)
        for (std::uint32_t i = 0; i < cells; ++i) {
            const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = b + cells + 1, d = a + cells + 1;
            if (kind == Cells::quads) {
                add_facet(result, {a, b, c, d});
            } else {
                add_facet(result, {a, b, c});
                add_facet(result, {a, c, d});
            }
        }
    return result;
}

PolygonSoup random_polyhedra(unsigned count, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&random](double low, double high) {
        return low + (high - low) * (double(random()) + 0.5) / 4294967296.0;
    };
    PolygonSoup result;
    for (unsigned i = 0; i < count; ++i) {
        const glm::dvec3 centre(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        const double size = std::exp(uniform(-4, -0.5));
        glm::dvec3 corners[4];
        for (glm::dvec3& corner : corners)
            corner = centre + size * glm::dvec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        result = merged(result, tetrahedron(corners[0], corners[1], corners[2], corners[3]));
    }
    return result;
}

PolygonSoup needle_fan(unsigned valence, double height) {
    PolygonSoup result;
    result.vertices.push_back({0, 0, height});
    for (unsigned i = 0; i < valence; ++i) {
        const double angle = 2 * std::numbers::pi * i / valence;
        result.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    }
    for (std::uint32_t i = 0; i < valence; ++i)
        add_facet(result, {0, 1 + i, 1 + (i + 1) % valence});
    for (std::uint32_t i = valence; i > 0; --i)
        result.corners.push_back(i);
    result.end_facet();
    return result;
}

PolygonSoup sliver_box(unsigned slivers, double aspect) {
    PolygonSoup result;
    const double width = 2 / aspect;
    for (unsigned i = 0; i <= slivers; ++i)
        for (int j = 0; j < 4; ++j)
            result.vertices.push_back({j & 1 ? 1 : -1, width * i, j & 2 ? 1.0 : 0.0});
    const auto side = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        add_facet(result, {a, b, c});
        add_facet(result, {a, c, d});
    };
    for (std::uint32_t i = 0; i < slivers; ++i) {
        const std::uint32_t at = 4 * i;
        side(at + 0, at + 4, at + 5, at + 1); // below
        side(at + 2, at + 3, at + 7, at + 6); // above
        side(at + 0, at + 2, at + 6, at + 4); // at x = -1
        side(at + 1, at + 5, at + 7, at + 3); // at x = 1
    }
    side(0, 1, 3, 2);
    const std::uint32_t last = 4 * slivers;
    side(last + 0, last + 2, last + 3, last + 1);
    return result;
}

PolygonSoup plate(double thickness) {
    return moved(cube(), {0.5, 0.5, 0.5 * thickness}, {0, 0, 0});
}

PolygonSoup nested_shells(unsigned levels, bool cavity) {
    const PolygonSoup inner = moved(icosphere(levels), glm::dvec3(0.5), glm::dvec3(0));
    return merged(icosphere(levels), cavity ? reversed(inner) : inner);
}

PolygonSoup notched_block() {
    PolygonSoup block;
    const double w = 0.5 * std::tan(0.17453292519943295);
    const std::array<glm::dvec3, 7> outline{glm::dvec3(-1, 0, -1), {1, 0, -1},  {1, 0, 0.5}, {w, 0, 0.5}, {0, 0, 0},
                                            {-w, 0, 0.5},          {-1, 0, 0.5}};
    for (const double y : {-1.0, 1.0})
        for (const glm::dvec3& at : outline)
            block.vertices.push_back({at.x, y, at.z});
    for (std::uint32_t i = 0; i < 7; ++i) {
        const std::uint32_t next = (i + 1) % 7;
        add_facet(block, {next, i, 7 + i, 7 + next});
    }
    add_facet(block, {0, 1, 2, 3, 4, 5, 6});
    add_facet(block, {13, 12, 11, 10, 9, 8, 7});
    return block;
}

PolygonSoup sharp_wedge(double degrees) {
    const double half = std::tan(degrees * std::numbers::pi / 360);
    return soup_of({{0, 0, 0}, {0, 1, 0}, {1, 1, -half}, {1, 1, half}, {1, 0, -half}, {1, 0, half}},
                   {{0, 1, 2}, {0, 2, 4}, {0, 5, 3}, {0, 3, 1}, {1, 3, 2}, {0, 4, 5}, {4, 2, 3}, {4, 3, 5}});
}

PolygonSoup double_cone(unsigned facets, double height) {
    PolygonSoup soup;
    soup.vertices = {{0, 0, height}, {0, 0, -height}};
    for (unsigned i = 0; i < facets; ++i) {
        const double angle = 2 * std::numbers::pi * i / facets;
        soup.vertices.push_back({std::cos(angle), std::sin(angle), 0});
        const std::uint32_t a = 2 + i, b = 2 + (i + 1) % facets;
        add_facet(soup, {0, a, b});
        add_facet(soup, {1, b, a});
    }
    return soup;
}

PolygonSoup soup_of(std::vector<glm::dvec3> vertices, const std::vector<std::vector<std::uint32_t>>& facets) {
    PolygonSoup result;
    result.vertices = std::move(vertices);
    for (const std::vector<std::uint32_t>& facet : facets) {
        result.corners.insert(result.corners.end(), facet.begin(), facet.end());
        result.end_facet();
    }
    return result;
}

PolygonSoup polygon(std::vector<glm::dvec3> corners) {
    PolygonSoup result;
    result.vertices = std::move(corners);
    for (std::uint32_t i = 0; i < result.vertices.size(); ++i)
        result.corners.push_back(i);
    result.end_facet();
    return result;
}

PolygonSoup single_triangle() {
    return polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

PolygonSoup spot() {
    return read_polygons(in_source("tests/data/spot.obj")).polygons;
}

PolygonSoup many_gon_prism(unsigned corners) {
    PolygonSoup result;
    for (unsigned i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        result.vertices.push_back({std::cos(angle), std::sin(angle), 0});
        result.vertices.push_back({std::cos(angle), std::sin(angle), 1});
    }
    for (std::uint32_t i = 0; i < corners; ++i)
        result.corners.push_back(2 * i + 1);
    result.end_facet();
    for (std::uint32_t i = corners; i > 0; --i)
        result.corners.push_back(2 * (i - 1));
    result.end_facet();
    for (std::uint32_t i = 0; i < corners; ++i) {
        const std::uint32_t next = (i + 1) % corners;
        add_facet(result, {2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    }
    return result;
}

PolygonSoup subdivided(const PolygonSoup& polygons) {
    return quartered(polygons, [](const glm::dvec3& v) { return v; });
}

PolygonSoup merged(const PolygonSoup& one, const PolygonSoup& other) {
    PolygonSoup result = one;
    const auto vertices = static_cast<std::uint32_t>(one.vertices.size());
    const auto corners = static_cast<std::uint32_t>(one.corners.size());
    result.vertices.insert(result.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const std::uint32_t corner : other.corners)
        result.corners.push_back(corner + vertices);
    for (std::size_t facet = 0; facet < other.facets(); ++facet)
        result.begins.push_back(other.begins[facet + 1] + corners);
    return result;
}

PolygonSoup moved(PolygonSoup polygons, const glm::dvec3& scale, const glm::dvec3& shift) {
    for (glm::dvec3& vertex : polygons.vertices)
        vertex = vertex * scale + shift;
    return polygons;
}

PolygonSoup reversed(PolygonSoup polygons) {
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet)
        std::reverse(polygons.corners.begin() + polygons.begins[facet],
                     polygons.corners.begin() + polygons.begins[facet + 1]);
    return polygons;
}

PolygonSoup split(const PolygonSoup& polygons) {
    PolygonSoup result;
    for (const std::uint32_t corner : polygons.corners) {
        result.corners.push_back(static_cast<std::uint32_t>(result.vertices.size()));
        result.vertices.push_back(polygons.vertices[corner]);
    }
    result.begins = polygons.begins;
    return result;
}

} // namespace forceshade::shapes
