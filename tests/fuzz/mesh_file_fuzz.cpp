// A mesh file, after a byte that says of which format: read or refused, and what is read is written and read again as
// the same, in text and in binary.
#include <array>
#include <bit>
#include <optional>
#include <sstream>

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

template <typename T> void put_number(std::string& bytes, T value, bool big_endian) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (big_endian)
        std::ranges::reverse(raw);
    bytes.append(raw.data(), raw.size());
}

/// The same facets over vertices and normals of made-up whole numbers, as PLY of several types: text, and binary.
void check_mixed_ply(PolygonSoup soup) {
    const std::string properties = "property char x\nproperty short y\nproperty int z\nproperty float nx\nproperty "
                                   "double ny\nproperty uchar nz\n";
    std::string text, binary[2];
    std::vector<glm::dvec3> normals;
    for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
        const auto number = static_cast<std::int32_t>((i + 1) * 2654435761U);
        const auto x = static_cast<std::int8_t>(number);
        const auto y = static_cast<std::int16_t>(number);
        const auto nx = static_cast<float>(y) / 8;
        const double ny = number / 3.0;
        const auto nz = static_cast<std::uint8_t>(number >> 8);
        soup.vertices[i] = {x, y, number};
        normals.emplace_back(nx, ny, nz);
        text += fmt::format("{} {} {} {} {} {}\n", x, y, number, nx, ny, nz);
        for (const bool big : {false, true}) {
            put_number(binary[big], x, big);
            put_number(binary[big], y, big);
            put_number(binary[big], number, big);
            put_number(binary[big], nx, big);
            put_number(binary[big], ny, big);
            put_number(binary[big], nz, big);
        }
    }
    for (std::size_t facet = 0; facet < soup.facets(); ++facet) {
        const auto outline = soup.outline(facet);
        text += fmt::format("{} {}\n", outline.size(), fmt::join(outline, " "));
        for (const bool big : {false, true}) {
            put_number(binary[big], static_cast<std::uint16_t>(outline.size()), big);
            for (const std::uint32_t corner : outline)
                put_number(binary[big], corner, big);
        }
    }
    for (const auto& [format, bytes] :
         {std::pair("ascii", &text), {"binary_little_endian", &binary[0]}, {"binary_big_endian", &binary[1]}}) {
        const std::string header = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n{}element face {}\nproperty "
                                               "list ushort uint vertex_index\nend_header\n",
                                               format, soup.vertices.size(), properties, soup.facets());
        const PolygonSoup read = parse_polygons("a.ply", header + *bytes, true).polygons;
        require(same(read, soup), "not the same as {} PLY of several types", format);
        for (std::size_t i = 0; i < soup.corners.size(); ++i)
            require(read.normals[i] == normals[soup.corners[i]], "a normal is another in {} PLY", format);
    }
}

/// The vertices of an OFF file without comments, read another way; nothing of a file that this reader does not
/// understand.
std::optional<std::vector<glm::dvec3>> vertices_of_off(const std::string& text) {
    if (text.find_first_not_of("OF0123456789+-.eE \n") != text.npos)
        return {};
    std::istringstream words(text);
    std::string word;
    std::size_t count = 0;
    if (!(words >> word >> count) || word != "OFF" || count > text.size() || !std::getline(words, word))
        return {};
    std::vector<glm::dvec3> vertices(count);
    for (glm::dvec3& vertex : vertices) {
        std::getline(words >> std::ws, word);
        std::istringstream line(word);
        for (int axis = 0; axis < 3; ++axis) {
            char* end = nullptr;
            if (!(line >> word))
                return {};
            vertex[axis] = std::strtod(word.c_str(), &end);
            if (*end != '\0')
                return {};
        }
    }
    return vertices;
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
    if (name == "a.off")
        if (const auto expected = vertices_of_off(std::string(bytes)))
            require(soup.vertices == *expected, "vertices are read as others");
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
        check_mixed_ply(soup);
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
