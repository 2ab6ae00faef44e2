// The shapes of the standard course, in mm: meshes, and the nominal surfaces that strokes follow.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/random.h"
#include "host/score/course.h"

namespace forceshade::score {
namespace {

constexpr double kRadius = 20;        // mm: of the spheres, and of the scan on average
constexpr double kSphereDepth = 0.7;  // mm: from the sphere to the nominal surface: half as deep as the coarsest facets
constexpr double kBumpWidth = 25.4;   // mm
constexpr double kBumpRadius = 15.24; // mm
constexpr double kBumpDepth = 0.2;    // mm: from the cylinder to the nominal surface: half as deep as the facets
constexpr double kSaddleRadius = 60;  // mm
constexpr double kGroove = 8;         // mm: depth and half width
constexpr double kRidge = 12;         // mm: half width
constexpr double kNeedleLength = 30;  // mm
constexpr double kNeedleTip = 10;     // mm: x of its tip
constexpr double kNeedleAcross = 0.15; // of v
constexpr double kNeedleRadius = 2;    // mm: at its base
constexpr int kNeedleSides = 12;
constexpr double kScanNoise = 0.02; // mm: root mean square along the normal

struct Triangles {
    std::vector<glm::dvec3> vertices; // mm
    std::vector<std::array<std::size_t, 3>> corners;

    std::string obj() const {
        std::string text;
        for (const glm::dvec3& v : vertices)
            text += fmt::format("v {} {} {}\n", fixed_decimals(v.x, 6), fixed_decimals(v.y, 6), fixed_decimals(v.z, 6));
        for (const auto& [a, b, c] : corners)
            text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
        return text;
    }
};

using Height = std::function<double(double x, double y)>; // mm

// A solid between a height above each place of a grid and a plane bottom.
std::string block(const std::vector<double>& xs, const std::vector<double>& ys, const Height& top, double bottom) {
    Triangles solid;
    const std::size_t columns = xs.size(), rows = ys.size(), below = columns * rows;
    const auto at = [&](std::size_t i, std::size_t j) { return i * rows + j; };
    for (const bool lower : {false, true})
        for (const double x : xs)
            for (const double y : ys)
                solid.vertices.emplace_back(x, y, lower ? bottom : top(x, y));
    for (std::size_t i = 0; i + 1 < columns; ++i)
        for (std::size_t j = 0; j + 1 < rows; ++j)
            for (const auto& [a, b, c] : {std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)},
                                          std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)}}) {
                solid.corners.push_back({a, b, c});
                solid.corners.push_back({c + below, b + below, a + below});
            }
    std::vector<std::size_t> rim; // counterclockwise seen from above
    for (std::size_t i = 0; i + 1 < columns; ++i)
        rim.push_back(at(i, 0));
    for (std::size_t j = 0; j + 1 < rows; ++j)
        rim.push_back(at(columns - 1, j));
    for (std::size_t i = columns - 1; i > 0; --i)
        rim.push_back(at(i, rows - 1));
    for (std::size_t j = rows - 1; j > 0; --j)
        rim.push_back(at(0, j));
    for (std::size_t k = 0; k < rim.size(); ++k) {
        const std::size_t a = rim[k], b = rim[(k + 1) % rim.size()];
        solid.corners.push_back({a + below, b + below, b});
        solid.corners.push_back({a + below, b, a});
    }
    return solid.obj();
}

// From -half to half.
std::vector<double> steps(double half, int cells) {
    std::vector<double> all;
    for (int i = 0; i <= cells; ++i)
        all.push_back(half * (2.0 * i / cells - 1));
    return all;
}

// Directions of an icosahedron whose facets were cut into four `levels` times, turned so that no edge is along an axis.
Triangles icosphere(int levels) {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    Triangles sphere;
    // The turn of the quaternion (8, 1, 2, 3).
    const glm::dvec3 turn_x(52, 52, -26), turn_y(-44, 58, 28), turn_z(38, -4, 68);
    for (const double a : {-1.0, 1.0})
        for (const double b : {-golden, golden})
            for (const glm::dvec3& v : {glm::dvec3(0, a, b), glm::dvec3(a, b, 0), glm::dvec3(b, 0, a)})
                sphere.vertices.push_back(glm::normalize(v.x * turn_x + v.y * turn_y + v.z * turn_z));
    const auto adjacent = [&](std::size_t a, std::size_t b) { // their angle is 63.4 deg, others' are above 116 deg
        return glm::dot(sphere.vertices[a], sphere.vertices[b]) > 0;
    };
    for (std::size_t a = 0; a < 12; ++a)
        for (std::size_t b = a + 1; b < 12; ++b)
            for (std::size_t c = b + 1; c < 12; ++c) {
                if (!adjacent(a, b) || !adjacent(b, c) || !adjacent(a, c))
                    continue;
                const auto& v = sphere.vertices;
                const bool outward = glm::dot(v[a], glm::cross(v[b], v[c])) > 0;
                sphere.corners.push_back(outward ? std::array{a, b, c} : std::array{a, c, b});
            }
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles;
        const auto middle = [&](std::size_t a, std::size_t b) {
            const auto [found, added] = middles.try_emplace(std::minmax(a, b), sphere.vertices.size());
            if (added)
                sphere.vertices.push_back(glm::normalize(sphere.vertices[a] + sphere.vertices[b]));
            return found->second;
        };
        std::vector<std::array<std::size_t, 3>> finer;
        for (const auto& [a, b, c] : sphere.corners) {
            const std::size_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        sphere.corners = std::move(finer);
    }
    return sphere;
}

std::string sphere(int levels) {
    Triangles solid = icosphere(levels);
    for (glm::dvec3& vertex : solid.vertices)
        vertex *= kRadius;
    return solid.obj();
}

// mm: of the needle, which lies along x, its tip at the end.
double needle_radius(double x) {
    return kNeedleRadius * std::max(0.0, kNeedleTip - x) / kNeedleLength;
}

std::string needle() {
    const double base = kNeedleTip - kNeedleLength;
    Triangles solid;
    solid.vertices = {glm::dvec3(kNeedleTip, 0, 0), glm::dvec3(base, 0, 0)};
    const auto at = [](int side) { return std::size_t(2 + side % kNeedleSides); };
    for (int side = 0; side < kNeedleSides; ++side) {
        const double angle = 2 * std::numbers::pi * (side + 0.3) / kNeedleSides;
        solid.vertices.emplace_back(base, kNeedleRadius * std::cos(angle), kNeedleRadius * std::sin(angle));
        solid.corners.push_back({0, at(side), at(side + 1)});
        solid.corners.push_back({1, at(side + 1), at(side)});
    }
    return solid.obj();
}

// mm: from the scan's middle to its surface.
double scan_radius(const glm::dvec3& d) {
    return kRadius + 1.5 * d.x * d.y + 1.2 * d.z * d.z + 3 * d.x * d.y * d.z - 1.4 * d.x * d.x * d.x + 0.9 * d.y;
}

// Between -1 and 1, near to normal, standard deviation 1/3.
double bell(Random& random) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        sum += random(-1, 1);
    return sum / 3;
}

// As a scanner would leave it: vertices denser on one side, at uneven distances, with noise along the normal.
std::string scan() {
    Triangles solid = icosphere(4);
    Random random(kCourseScanSeed);
    for (glm::dvec3& vertex : solid.vertices) {
        const double x = random(-0.012, 0.012), y = random(-0.012, 0.012), z = random(-0.012, 0.012);
        const glm::dvec3 direction = glm::normalize(vertex + glm::dvec3(x, y, z) + glm::dvec3(0.25, -0.1, 0.2));
        vertex = direction * (scan_radius(direction) + 3 * kScanNoise * bell(random));
    }
    return solid.obj();
}

// Nominal surfaces.

using Surface = std::function<SurfacePoint(double, double)>;

// Strokes over a height, lifted along z.
Surface height(const Height& z) {
    return [z](double u, double v) { return SurfacePoint{{u, v, z(u, v)}, {0, 0, 1}}; };
}

// Strokes along great circles, lifted along the radius.
Surface round(const std::function<double(const glm::dvec3&)>& radius) {
    return [radius](double u, double v) {
        const double a = u / kRadius, b = v / kRadius;
        const glm::dvec3 d(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
        return SurfacePoint{radius(d) * d, d};
    };
}

// Strokes over the upper side, v narrowed to its width, lifted along z.
SurfacePoint needle_surface(double u, double v) {
    const double y = kNeedleAcross * v, radius = needle_radius(u);
    const double z = radius > std::abs(y) ? radius - y * y / (2 * radius) : radius / 2;
    return {{u, y, z}, {0, 0, 1}};
}

double bump_height(double x, double) {
    const double half = kBumpWidth / 2;
    if (std::abs(x) >= half)
        return 0;
    const double cylinder = std::sqrt(kBumpRadius * kBumpRadius - x * x);
    return std::max(0.0, cylinder - std::sqrt(kBumpRadius * kBumpRadius - half * half) - kBumpDepth);
}

double flat_height(double, double) {
    return 0;
}
double groove_height(double x, double) {
    return std::min(0.0, std::abs(x) - kGroove);
}
double ridge_height(double x, double) {
    return std::max(0.0, kRidge - std::abs(x)) / std::sqrt(3.0);
}
double saddle_height(double x, double y) {
    return x * y / kSaddleRadius;
}

constexpr const char* kPlain = "[force]\nstiffness = \"1 N/mm\"\nshading = \"none\"\n";
constexpr const char* kSmoothSphere =
    "[force]\nstiffness = \"1 N/mm\"\nshading = \"barycentric\"\n\n"
    "[compare]\nsurface = { kind = \"sphere\", radius = \"20 mm\" }\ndepth = \"3 mm\"\n";
constexpr const char* kSmoothBump = "[force]\nstiffness = \"1 N/mm\"\nshading = \"reference\"\ndepth = \"normal\"\n\n"
                                    "[compare]\nsurface = { kind = \"cylinder\" }\ndepth = \"3 mm\"\n";
constexpr const char* kTexture = "[force]\nstiffness = \"1 N/mm\"\nshading = \"none\"\n\n"
                                 "[texture]\nstiffness = \"1 N/mm\"\nfunction = \"sine\"\nwidth = \"2.5 mm\"\n"
                                 "height = \"0.2 mm\"\n";

} // namespace

std::vector<CourseShape> course_shapes() {
    const std::vector<double> wide = steps(50, 1), middle = steps(30, 1), fine = steps(30, 24),
                              bent{-30, -kGroove, 0, kGroove, 30}, roof{-30, -kRidge, 0, kRidge, 30};
    const std::string plane = block(wide, wide, flat_height, -20);
    const Surface flat = height(flat_height), ball = round([](const glm::dvec3&) { return kRadius - kSphereDepth; });
    return {
        {"plane", "a plane: the top of a box of 100 x 100 x 20 mm", kPlain, plane, flat, 60},
        {"bump", "the bump of the paper: 4 facets on a cylinder of 600 mil, shaded by it", kSmoothBump, "",
         height(bump_height), 50},
        {"sphere_80", "a sphere of radius 20 mm, of 80 facets, shaded", kSmoothSphere, sphere(1), ball, 50},
        {"sphere_320", "a sphere of radius 20 mm, of 320 facets, shaded", kSmoothSphere, sphere(2), ball, 50},
        {"sphere_1280", "a sphere of radius 20 mm, of 1280 facets, shaded", kSmoothSphere, sphere(3), ball, 50},
        {"saddle", "a saddle z = x y / 60 mm, of cells of 2.5 mm", kPlain, block(fine, fine, saddle_height, -25),
         height(saddle_height), 50},
        {"groove", "a groove of 90 degrees, 8 mm deep", kPlain, block(bent, middle, groove_height, -20),
         height(groove_height), 50},
        {"ridge", "a ridge of 120 degrees, 24 mm wide", kPlain, block(roof, middle, ridge_height, -12),
         height(ridge_height), 50},
        {"thin_plate", "a plate of 60 x 60 x 2 mm", kPlain, block(middle, middle, flat_height, -2), flat, 50},
        {"needle", "a cone 30 mm long, 4 mm across its base, of 12 sides, that lies along x", kPlain, needle(),
         needle_surface, 24, 0.25},
        {"scan", "a blob of 5120 uneven facets with noise of 0.02 mm, as a scanner would leave it; made by a formula",
         kPlain, scan(), round(scan_radius), 50},
        {"textured_plane", "the plane with tangential forces by the gradient of a sine, 2.5 mm long and 0.2 mm high",
         kTexture, plane, flat, 60},
    };
}

} // namespace forceshade::score
