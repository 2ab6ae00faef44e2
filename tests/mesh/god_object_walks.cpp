#include "tests/mesh/god_object_walks.h"

#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "host/field/prepared_case.h"
#include "host/mesh/mesh_file.h"

namespace forceshade::walks {

using shapes::add_facet;
using shapes::double_cone;
using shapes::sharp_wedge;
using shapes::soup_of;

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

namespace {

double saddle(double x, double y) {
    return x * x - y * y;
}

double waves(double x, double y) {
    return 0.1 * std::sin(9 * x) * std::sin(8 * y);
}

/// Three reals of a table of them.
glm::dvec3 three(const std::vector<double>& table, std::size_t index) {
    return {table[3 * index], table[3 * index + 1], table[3 * index + 2]};
}

} // namespace

std::vector<Terrain> terrains() {
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

std::vector<Terrain> solids() {
    const std::vector<std::vector<std::uint32_t>> octahedron = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                                {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const std::vector<std::vector<std::uint32_t>> box = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                         {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    return {
        {"tetrahedron",
         soup_of({{2, 2, 2}, {-2, -2, 2}, {-2, 2, -2}, {2, -2, -2}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})},
        {"box",
         soup_of({{-4, -2, -1}, {4, -2, -1}, {4, 2, -1}, {-4, 2, -1}, {-4, -2, 1}, {4, -2, 1}, {4, 2, 1}, {-4, 2, 1}},
                 box)},
        {"octahedron", soup_of({{4, 0, 0}, {-4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 4}, {0, 0, -4}}, octahedron)},
        {"flat octahedron", soup_of({{4, 0, 0}, {-4, 0, 0}, {0, 4, 0}, {0, -4, 0}, {0, 0, 1}, {0, 0, -1}}, octahedron)},
        {"spindle", soup_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 8}, {0, 0, -8}}, octahedron)},
        {"pyramid", soup_of({{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}, {0, 0, 2}},
                            {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {3, 2, 1, 0}})},
        {"prism", soup_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {4, 0, 4}, {0, 4, 4}},
                          {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}})},
        {"frustum",
         soup_of({{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}, {-2, -2, 2}, {2, -2, 2}, {2, 2, 2}, {-2, 2, 2}},
                 box)},
        {"L", soup_of({{0, 0, 0},
                       {4, 0, 0},
                       {4, 2, 0},
                       {2, 2, 0},
                       {2, 4, 0},
                       {0, 4, 0},
                       {0, 0, 2},
                       {4, 0, 2},
                       {4, 2, 2},
                       {2, 2, 2},
                       {2, 4, 2},
                       {0, 4, 2}},
                      {{5, 4, 3, 2, 1, 0},
                       {6, 7, 8, 9, 10, 11},
                       {0, 1, 7, 6},
                       {1, 2, 8, 7},
                       {2, 3, 9, 8},
                       {3, 4, 10, 9},
                       {4, 5, 11, 10},
                       {5, 0, 6, 11}})},
        {"icosahedron", shapes::icosphere(0)}};
}

std::vector<Terrain> meshes(const std::vector<std::string>& files) {
    std::vector<Terrain> result = {{"sphere 80", shapes::icosphere(1)},
                                   {"sphere 1280", shapes::icosphere(3)},
                                   {"saddle", shapes::patch(shapes::Cells::triangles, 10, saddle)},
                                   {"waves", shapes::patch(shapes::Cells::hexagons, 12, waves)},
                                   {"wedge 5 degrees", wedge(0.0873)},
                                   {"wedge 60 degrees", wedge(1.047)},
                                   {"wedge 0.01 degrees", wedge(1.745e-4)},
                                   {"plate", shapes::plate(5e-4)},
                                   {"near folds", touching_folds(6, 1e-6)},
                                   {"bump", bump(16, 6)},
                                   {"pit 8", pit(8, 0.3), 8},
                                   {"pit 40", pit(40, 0.05), 40},
                                   {"polyhedra", shapes::random_polyhedra(20, 7)},
                                   {"needle", shapes::needle_fan(12, 3.0), 12},
                                   {"prism of 17", shapes::many_gon_prism(17)}};
    for (const std::string& file : files)
        result.push_back({file, read_polygons(file).polygons});
    return result;
}

PolygonSoup soup(unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(-1, 1);
    PolygonSoup soup;
    const auto count = static_cast<std::uint32_t>(2 + random() % 12);
    for (std::uint32_t i = 0; i < count; ++i) {
        for (int corner = 0; corner < 3; ++corner)
            soup.vertices.push_back({place(random), place(random), place(random)});
        add_facet(soup, {3 * i, 3 * i + 1, 3 * i + 2});
    }
    return soup;
}

PolygonSoup grooved_block(double degrees) {
    const double half = std::tan(degrees * std::acos(-1.0) / 360);
    PolygonSoup soup;
    constexpr std::uint32_t kCorners = 7;
    for (const double y : {-1.0, 1.0})
        for (const glm::dvec2& at : {glm::dvec2(-2, -1.5), {2, -1.5}, {2, 0}, {half, 0}, {0, -1}, {-half, 0}, {-2, 0}})
            soup.vertices.push_back({at.x, y, at.y});
    for (std::uint32_t i = 0; i < kCorners; ++i)
        add_facet(soup, {i, (i + 1) % kCorners, kCorners + (i + 1) % kCorners, kCorners + i});
    add_facet(soup, {6, 5, 4, 3, 2, 1, 0});
    add_facet(soup, {7, 8, 9, 10, 11, 12, 13});
    return soup;
}

std::vector<Terrain> narrow_solids() {
    std::vector<Terrain> result;
    for (const double degrees : {60.0, 10.0, 1.0, 0.1, 0.01, 1e-3, 1e-5, 1e-7, 1e-10})
        result.push_back({fmt::format("wedge {}", degrees), sharp_wedge(degrees)});
    for (const unsigned facets : {20U, 224U, 1000U, 20000U})
        result.push_back({fmt::format("pole {}", facets), double_cone(facets, 0.5), facets});
    result.push_back({"flat pole 20", double_cone(20, 1e-4), 20});
    for (const double degrees : {90.0, 10.0, 0.1, 1e-3})
        result.push_back({fmt::format("groove {}", degrees), grooved_block(degrees)});
    result.push_back({"needle", shapes::needle_fan(12, 30), 12});
    result.push_back({"shell 5e-4", shapes::plate(5e-4)});
    result.push_back({"shell 1e-7", shapes::plate(1e-7)});
    result.push_back({"nested shells", shapes::nested_shells(1, true)});
    result.push_back({"sliver box", shapes::sliver_box(50, 1000)});
    return result;
}

std::vector<Terrain> open_meshes() {
    std::vector<Terrain> result = {
        {"sheet", shapes::single_triangle()},
        {"open cube", shapes::open_cube()},
        {"bow tie", soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0.3}}, {{0, 1, 2}, {0, 3, 4}})},
        {"solid bow tie", shapes::merged(shapes::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}),
                                         shapes::tetrahedron({0, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}))},
        {"three at an edge",
         soup_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.2}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}})},
        {"doubled facet", soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}}, {{0, 1, 2}, {0, 2, 1}, {1, 3, 2}})},
        {"saddle", shapes::patch(shapes::Cells::triangles, 10, saddle)},
        {"pit 40", pit(40, 0.05), 40},
        {"pit 8", pit(8, 0.3), 8},
        {"touching folds", touching_folds(6, 0)},
        {"near folds", touching_folds(6, 1e-6)},
        {"crossing tetrahedra", shapes::random_polyhedra(20, 7)}};
    for (unsigned seed = 1; seed < 4; ++seed)
        result.push_back({fmt::format("soup {}", seed), soup(seed)});
    return result;
}

glm::dvec3 RandomPlaces::direction() {
    std::normal_distribution<double> one;
    const double x = one(random_), y = one(random_);
    return glm::normalize(glm::dvec3(x, y, one(random_)));
}

glm::dvec3 RandomPlaces::vertex(std::size_t v) const {
    return three(structure_.reals->vertices, v);
}

glm::dvec3 RandomPlaces::corner(std::size_t triangle, std::size_t i) const {
    return vertex(structure_.parts->triangle_corners[3 * triangle + i]);
}

glm::dvec3 RandomPlaces::normal(std::size_t triangle) const {
    const glm::dvec3 a = corner(triangle, 0);
    const glm::dvec3 area = glm::cross(corner(triangle, 1) - a, corner(triangle, 2) - a);
    const double size = glm::length(area);
    return size > 0 ? area / size : glm::dvec3(0, 0, 1);
}

glm::dvec3 RandomPlaces::place_on(std::size_t triangle) {
    double u = random(0, 1), v = random(0, 1);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const glm::dvec3 a = corner(triangle, 0);
    return a + u * (corner(triangle, 1) - a) + v * (corner(triangle, 2) - a);
}

Wanderer::Wanderer(const MeshStructure& structure, std::uint64_t seed, std::optional<glm::dvec3> focus)
    : RandomPlaces(structure, seed) {
    if (focus)
        focus_ = to_mesh_frame(structure, *focus);
    double area = 0;
    for (std::size_t t = 0; t < structure.triangles(); ++t)
        area += glm::length(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
    facet_ = std::sqrt(area / static_cast<double>(structure.triangles()));
}

glm::dvec3 Wanderer::direction() {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random_), normal(random_), normal(random_)));
}

glm::dvec3 Wanderer::near_surface() {
    if (focus_)
        return *focus_ + std::pow(10.0, random(-4, -1)) * direction();
    const glm::dvec3 place = place_on(random_() % structure_.triangles());
    const double depth = facet_ * std::pow(10.0, random(-4, 0.5));
    return place + depth * direction();
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

/// Of a corner (0 to 2) or an edge (3 to 5).
glm::dvec3 Prober::pseudonormal(std::size_t triangle, std::size_t i) const {
    glm::dvec3 sum = normal(triangle);
    if (i < 3) {
        sum = three(structure_.reals->vertex_pseudonormals, structure_.parts->triangle_corners[3 * triangle + i]);
    } else if (const std::size_t across = structure_.parts->triangle_neighbours[3 * triangle + i - 3];
               across < structure_.triangles()) {
        sum += normal(across);
    }
    const double size = glm::length(sum);
    return size > 1e-9 ? sum / size : normal(triangle);
}

/// Half the distance to the nearest of some planes behind a place.
double Prober::half_way_in(const glm::dvec3& place, const glm::dvec3& outwards) {
    double nearest = 1;
    for (int i = 0; i < 8; ++i) {
        const std::size_t other = random_() % structure_.triangles();
        const glm::dvec3 plane = normal(other);
        const double distance = glm::dot(plane, place - corner(other, 0)) / glm::dot(plane, outwards);
        if (distance > 1e-12 && distance < nearest)
            nearest = distance;
    }
    return nearest / 2;
}

glm::dvec3 Prober::target() {
    const std::size_t triangle = random_() % structure_.triangles(), i = random_() % 3;
    const glm::dvec3 here = corner(triangle, i);
    const glm::dvec3 beside = random(0, 1) < 0.3 ? glm::dvec3(0) : length(1e-12, 1e-3) * direction();
    const double depth = (random(0, 1) < 0.8 ? -1 : 1) * length(1e-12, 2);
    switch (random_() % 6) {
    case 0:
        return here + depth * pseudonormal(triangle, i) + beside;
    case 1:
        return here + random(0, 1) * (corner(triangle, (i + 1) % 3) - here) + depth * pseudonormal(triangle, i + 3) +
               beside;
    case 2:
        return place_on(triangle) + depth * normal(triangle) + beside;
    case 3:
        return 0.5 * (here + vertex(random_() % (structure_.reals->vertices.size() / 3))) + beside;
    case 4:
        return here + beside;
    default: {
        const glm::dvec3 place = place_on(triangle), outwards = normal(triangle);
        return place - half_way_in(place, outwards) * outwards + beside;
    }
    }
}

glm::dvec3 Prober::begin() {
    if (random(0, 1) < 0.6)
        return 1.5 * direction();
    return random(0, 1) < 0.5 ? glm::dvec3(random(-1, 1), random(-1, 1), random(-1, 1)) : target();
}

glm::dvec3 Prober::step(const glm::dvec3& from) {
    const std::uint64_t kind = random_() % 8;
    if (kind == 0)
        return from + length(1e-12, 10) * direction();
    if (kind == 1)
        return 10.0 * direction();
    const glm::dvec3 there = target();
    if (kind == 2)
        return from + random(0, 2) * (there - from);
    const double far = glm::length(there - from);
    if (kind == 3 && far > 0)
        return from + std::min(far, length(1e-9, 1)) / far * (there - from);
    return there;
}

glm::dvec3 Stroker::begin() {
    const std::size_t triangle = random_() % structure_.triangles();
    inwards_ = -normal(triangle);
    return place_on(triangle) - 0.01 * inwards_;
}

glm::dvec3 Stroker::step(const glm::dvec3& from) {
    const bool first = inwards_ != glm::dvec3(0), grazes = first && random(0, 1) < 0.3;
    const double far = grazes ? length(1e-9, 1e-6) * (random(0, 1) < 0.5 ? -1 : 1) : length(1e-4, 0.1);
    const glm::dvec3 displacement = first ? (0.01 + far) * inwards_ : far * direction();
    inwards_ = glm::dvec3(0);
    return from + displacement;
}

Aimer::Aimer(const MeshStructure& structure, std::uint64_t seed)
    : RandomPlaces(structure, seed), around_(structure.reals->vertices.size() / 3) {
    const auto& corners = structure.parts->triangle_corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        around_[corners[i]].push_back(static_cast<std::uint32_t>(i / 3));
}

/// Nothing, or 1e-12 to 1e-4 sizes in any direction.
glm::dvec3 Aimer::beside() {
    return random(0, 1) < 0.3 ? glm::dvec3(0) : length(1e-12, 1e-4) * direction();
}

/// Along an edge to its other end, in another of the triangles there.
void Aimer::go_on() {
    corner_ = (corner_ + 1 + random_() % 2) % 3;
    const std::uint32_t vertex = structure_.parts->triangle_corners[3 * triangle_ + corner_];
    triangle_ = around_[vertex][random_() % around_[vertex].size()];
    for (corner_ = 0; structure_.parts->triangle_corners[3 * triangle_ + corner_] != vertex;)
        ++corner_;
}

glm::dvec3 Aimer::begin() {
    triangle_ = random_() % structure_.triangles();
    corner_ = random_() % 3;
    offset_ = beside();
    const glm::dvec3 at = corner(triangle_, corner_);
    return random(0, 1) < 0.5 ? 1.5 * at + offset_ : 1.5 * direction();
}

glm::dvec3 Aimer::step(const glm::dvec3& from) {
    const glm::dvec3 here = corner(triangle_, corner_), along = corner(triangle_, (corner_ + 1) % 3) - here;
    const glm::dvec3 other = corner(triangle_, (corner_ + 2) % 3) - here;
    const glm::dvec3 normal = glm::normalize(glm::cross(along, other));
    if (random(0, 1) < 0.3)
        offset_ = beside();
    switch (random_() % 12) {
    case 0:
    case 1:
        return here + offset_; // with the next of these, from corner to corner along an edge
    case 2:
    case 3:
        go_on();
        return corner(triangle_, corner_) + offset_;
    case 4:
        return here + 0.5 * along + offset_;
    case 5:
        return from + 2.0 * (here + 0.5 * along - from) + offset_; // through the middle of an edge
    case 6:
        return from + (random(0, 1) < 0.5 ? 1.0 : -1.0) * length(1e-12, 10) * glm::normalize(along);
    case 7:
        return from + length(1e-12, 10) * glm::normalize(random(-1, 1) * along + random(-1, 1) * other);
    case 8:
        return from - length(1e-12, 1) * normal;
    case 9:
        return 0.5 * here + offset_; // deep inside, most likely
    case 10: {
        const double cells = std::ldexp(1.0, static_cast<int>(random_() % 5));
        return glm::round(cells * glm::dvec3(random(-1.5, 1.5), random(-1.5, 1.5), random(-1.5, 1.5))) / cells;
    }
    default:
        triangle_ = random_() % structure_.triangles();
        return random(0, 1) < 0.5 ? corner(triangle_, corner_) + offset_ : from + length(1e-12, 10) * direction();
    }
}

} // namespace forceshade::walks
