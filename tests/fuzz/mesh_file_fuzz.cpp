// A mesh file, after a byte that says of which format: read or refused, and what is read is written and read again as
// the same, in text and in binary.
#include "host/error.h"
#include "host/mesh/mesh_file.h"
#include "tests/fuzz/meshes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

using fuzz::require;

bool same(const PolygonSoup& one, const PolygonSoup& other) {
    return one.vertices == other.vertices && one.begins == other.begins && one.corners == other.corners;
}

/// The same polygons with indices from the end.
std::string as_relative_obj(const PolygonSoup& soup) {
    std::string text = testing::as_obj(soup);
    text.resize(text.find("\nf ") + 1);
    for (std::size_t facet = 0; facet < soup.facets(); ++facet) {
        text += "f";
        for (const std::uint32_t corner : soup.outline(facet))
            text +=
                fmt::format(" {}", static_cast<std::int64_t>(corner) - static_cast<std::int64_t>(soup.vertices.size()));
        text += "\n";
    }
    return text;
}

/// Triangles corner by corner.
bool same_places(const PolygonSoup& one, const PolygonSoup& other) {
    return std::ranges::equal(one.corners, other.corners,
                              [&](std::uint32_t a, std::uint32_t b) { return one.vertices[a] == other.vertices[b]; });
}

void check_file(const std::string& name, std::string_view bytes, bool normals) {
    PolygonSoup soup;
    try {
        soup = parse_polygons(name, bytes, normals).polygons;
    } catch (const Error& error) {
        require(std::string_view(error.what()).find(name) != std::string_view::npos, "a message without the file: {}",
                error.what());
        return;
    }
    fuzz::check_sound(soup);
    require(normals != soup.normals.empty() || soup.corners.empty(), "normals are not as asked for");
    if (soup.facets() == 0)
        return;
    if (name == "a.ply" && normals) { // they are the vertices'
        std::vector<const glm::dvec3*> normal_of(soup.vertices.size());
        for (std::size_t i = 0; i < soup.corners.size(); ++i) {
            const glm::dvec3*& known = normal_of[soup.corners[i]];
            known = known ? known : &soup.normals[i];
            require(*known == soup.normals[i], "vertex {} has two normals", soup.corners[i]);
        }
    }
    soup.normals.clear();
    require(same(soup, parse_polygons("a.obj", testing::as_obj(soup)).polygons), "not the same as OBJ");
    require(same(soup, parse_polygons("a.off", testing::as_off(soup)).polygons), "not the same as OFF");
    require(same(soup, parse_polygons("a.obj", as_relative_obj(soup)).polygons), "not the same from the end");
    require(same(soup, parse_polygons("a.ply", testing::as_ply_text(soup)).polygons), "not the same as text PLY");
    if (soup.corners.size() == 3 * soup.facets()) {
        require(same_places(parse_polygons("a.stl", testing::as_stl_text(soup)).polygons, soup), "not as text STL");
        PolygonSoup rounded = soup;
        bool finite = true;
        for (glm::dvec3& vertex : rounded.vertices)
            for (int axis = 0; axis < 3; ++axis) {
                finite = finite && std::abs(vertex[axis]) < 1e38;
                vertex[axis] = finite ? static_cast<double>(static_cast<float>(vertex[axis])) : 0;
            }
        if (finite)
            require(same_places(parse_polygons("a.stl", testing::as_stl_binary(rounded)).polygons, rounded),
                    "not as STL");
    }
    require(same(soup, parse_polygons("a.ply", testing::as_ply_binary(soup, true, false, true)).polygons),
            "not the same as PLY");
    if (soup.corners.size() < 200) {
        fuzz::Bytes places(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        fuzz::check_preparation(soup, places);
    }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const char* const kNames[] = {"a.obj", "a.off", "a.ply", "a.stl"};
    forceshade::fuzz::Bytes bytes(data, size);
    const std::uint8_t kind = bytes.byte();
    forceshade::check_file(kNames[kind % 4], bytes.rest(), (kind & 4) != 0);
    return 0;
}
