#include "tests/mesh/written_files.h"

#include <algorithm>
#include <bit>
#include <concepts>
#include <span>

#include <fmt/format.h>

namespace forceshade::testing {
namespace {

std::span<const std::uint32_t> corners_of(const PolygonSoup& polygons, std::size_t facet) {
    return std::span(polygons.corners)
        .subspan(polygons.begins[facet], polygons.begins[facet + 1] - polygons.begins[facet]);
}

std::string numbers(const glm::dvec3& v) {
    return fmt::format("{} {} {}", v.x, v.y, v.z);
}

template <typename T> void put(std::string& bytes, T value, bool big_endian = false) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian)
        std::ranges::reverse(raw);
    bytes.append(raw.data(), raw.size());
}

std::string facet_lines(const PolygonSoup& polygons) {
    std::string text;
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const auto corners = corners_of(polygons, facet);
        text += fmt::format("{} {}\n", corners.size(), fmt::join(corners, " "));
    }
    return text;
}

std::string vertex_lines(const PolygonSoup& polygons) {
    std::string text;
    for (const glm::dvec3& vertex : polygons.vertices)
        text += numbers(vertex) + "\n";
    return text;
}

std::string ply_header(const PolygonSoup& polygons, std::string_view format, std::string_view number,
                       std::string_view length) {
    return fmt::format("ply\nformat {} 1.0\ncomment a test\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty "
                       "{} z\nelement face {}\nproperty list {} int vertex_indices\nend_header\n",
                       format, polygons.vertices.size(), number, number, number, polygons.facets(), length);
}

} // namespace

std::string as_obj(const PolygonSoup& polygons) {
    std::string text = "# a test\n";
    for (const glm::dvec3& vertex : polygons.vertices)
        text += "v " + numbers(vertex) + "\n";
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        text += "f";
        for (const std::uint32_t corner : corners_of(polygons, facet))
            text += fmt::format(" {}", corner + 1);
        text += "\n";
    }
    return text;
}

std::string as_off(const PolygonSoup& polygons) {
    return fmt::format("OFF\n{} {} 0\n", polygons.vertices.size(), polygons.facets()) + vertex_lines(polygons) +
           facet_lines(polygons);
}

std::string as_ply_text(const PolygonSoup& polygons) {
    return ply_header(polygons, "ascii", "double", "uchar") + vertex_lines(polygons) + facet_lines(polygons);
}

std::string as_ply_binary(const PolygonSoup& polygons, bool big_endian, bool floats, bool long_lists) {
    std::string bytes = ply_header(polygons, big_endian ? "binary_big_endian" : "binary_little_endian",
                                   floats ? "float" : "double", long_lists ? "int" : "uchar");
    for (const glm::dvec3& vertex : polygons.vertices)
        for (int axis = 0; axis < 3; ++axis)
            if (floats)
                put(bytes, static_cast<float>(vertex[axis]), big_endian);
            else
                put(bytes, vertex[axis], big_endian);
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        const auto corners = corners_of(polygons, facet);
        if (long_lists)
            put(bytes, static_cast<std::int32_t>(corners.size()), big_endian);
        else
            put(bytes, static_cast<std::uint8_t>(corners.size()), big_endian);
        for (const std::uint32_t corner : corners)
            put(bytes, static_cast<std::int32_t>(corner), big_endian);
    }
    return bytes;
}

std::string as_stl_text(const PolygonSoup& polygons) {
    std::string text = "solid a test\n";
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        text += " facet normal 0 0 nan\n  outer loop\n";
        for (const std::uint32_t corner : corners_of(polygons, facet))
            text += "   vertex " + numbers(polygons.vertices[corner]) + "\n";
        text += "  endloop\n endfacet\n";
    }
    return text + "endsolid a test\n";
}

std::string as_stl_binary(const PolygonSoup& polygons) {
    std::string bytes(80, 's');
    put(bytes, static_cast<std::uint32_t>(polygons.facets()));
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        bytes.append(12, '\0');
        for (const std::uint32_t corner : corners_of(polygons, facet))
            for (int axis = 0; axis < 3; ++axis)
                put(bytes, static_cast<float>(polygons.vertices[corner][axis]));
        bytes.append(2, '\0');
    }
    return bytes;
}

std::vector<WrittenFile> all_formats(const PolygonSoup& triangles) {
    return {{".obj", as_obj(triangles)},
            {".off", as_off(triangles)},
            {".ply", as_ply_text(triangles)},
            {".ply", as_ply_binary(triangles, false)},
            {".ply", as_ply_binary(triangles, true, true, true)},
            {".stl", as_stl_text(triangles)},
            {".stl", as_stl_binary(triangles)}};
}

PolygonSoup fine_tetrahedron(bool floats) {
    PolygonSoup soup;
    soup.vertices = {
        {0.1, 1.0 / 3, -2e-7}, {1.1, 0.2, 1e-300}, {0.3, 123456.789012345678, 0.7}, {0.4, 0.5, 5e5 + 1e-9}};
    if (floats)
        for (glm::dvec3& vertex : soup.vertices)
            for (int axis = 0; axis < 3; ++axis)
                vertex[axis] = static_cast<double>(static_cast<float>(vertex[axis]));
    soup.corners = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    soup.begins = {0, 3, 6, 9, 12};
    return soup;
}

} // namespace forceshade::testing
