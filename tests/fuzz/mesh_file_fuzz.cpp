// A mesh file, after a byte that says of which format: read or refused, and what is read is written and read again as
// the same, in text and in binary, as triangle strips, and with what is no facet between the facets.
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

/// The same facets over vertices and normals of made-up whole numbers, as PLY of several types, with a sign or without:
/// text, and binary.
template <typename Byte, typename Short, typename Int>
void check_mixed_ply(PolygonSoup soup, std::string_view unsigned_mark) {
    const std::string properties = fmt::format("property {0}char x\nproperty {0}short y\nproperty {0}int z\nproperty "
                                               "float nx\nproperty double ny\nproperty uchar nz\n",
                                               unsigned_mark);
    std::string text, binary[2];
    std::vector<glm::dvec3> normals;
    for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
        const auto number = static_cast<Int>((i + 1) * 2654435761U);
        const auto x = static_cast<Byte>(number);
        const auto y = static_cast<Short>(number);
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

/// The same polygons as OBJ with a normal for each corner, counted from either end. Each vertex is there twice, and
/// where a facet has no two equal corners side by side, each corner may be followed by its copy: joined, that goes.
void check_obj_normals(const PolygonSoup& soup) {
    std::string text;
    for (int copy = 0; copy < 2; ++copy)
        for (const glm::dvec3& vertex : soup.vertices)
            text += fmt::format("v {} {} {}\n", vertex.x, vertex.y, vertex.z);
    std::vector<glm::dvec3> normals;
    std::size_t there = 0; // normals
    for (std::size_t facet = 0; facet < soup.facets(); ++facet) {
        const auto outline = soup.outline(facet);
        bool plain = outline.front() != outline.back();
        for (std::size_t i = 1; i < outline.size(); ++i)
            plain = plain && outline[i] != outline[i - 1];
        std::string line = "f", before;
        const std::size_t last = there + (plain ? 2 : 1) * outline.size();
        for (const std::uint32_t corner : outline)
            for (std::size_t copy = 0; copy < (plain ? 2U : 1U); ++copy) {
                const glm::dvec3 normal(1 + static_cast<double>(there), static_cast<double>(facet), -1);
                before += fmt::format("vn {} {} {}\n", normal.x, normal.y, normal.z);
                if (copy == 0)
                    normals.push_back(normal);
                const std::size_t number = ++there;
                line += fmt::format(" {}//{}", corner + 1 + copy * soup.vertices.size(),
                                    number / 2 % 2
                                        ? static_cast<std::int64_t>(number)
                                        : static_cast<std::int64_t>(number) - static_cast<std::int64_t>(last) - 1);
            }
        text += before + line + "\n";
    }
    const PolygonSoup read = parse_polygons("a.obj", text, true).polygons;
    require(same(read, soup), "not the same as OBJ with normals");
    require(read.normals == normals, "normals of OBJ are others");
}

/// The corners of the facets, one behind the other, as triangle strips, ended now and then. Two registers take the
/// vertices in turn, and each further vertex makes a triangle with both: the rule of the hardware that strips are from.
void check_strips(const PolygonSoup& soup) {
    std::vector<std::uint32_t> expected;
    std::string text, binary[2];
    std::int64_t registers[2] = {-1, -1};
    std::size_t filled = 0, length = 0;
    const auto add = [&](std::int32_t vertex) {
        ++length;
        text += fmt::format(" {}", vertex);
        for (const bool big : {false, true})
            put_number(binary[big], vertex, big);
    };
    for (const std::uint32_t corner : soup.corners) {
        const std::int64_t a = registers[0], b = registers[1], c = corner;
        if (filled >= 2 && a != b && a != c && b != c)
            for (const std::int64_t one : {a, b, c})
                expected.push_back(static_cast<std::uint32_t>(one));
        registers[filled++ % 2] = c;
        add(static_cast<std::int32_t>(corner));
        if ((corner * 2654435761U + filled) >> 8 & 1) {
            filled = 0;
            add(-1);
        }
    }
    for (const bool is_text : {true, false})
        for (const bool big : {false, true}) {
            std::string file = fmt::format(
                "ply\nformat {} 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex "
                "{}\nproperty char x\nproperty char y\nproperty char z\nend_header\n",
                is_text ? "ascii"
                : big   ? "binary_big_endian"
                        : "binary_little_endian",
                soup.vertices.size());
            if (is_text)
                file += fmt::format("{}{}\n", length, text);
            else
                put_number(file, static_cast<std::int32_t>(length), big), file += binary[big];
            for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
                const std::size_t x = i % 100, y = i / 100 % 100, z = i / 10000; // all elsewhere
                file += is_text ? fmt::format("{} {} {}\n", x, y, z)
                                : std::string{static_cast<char>(x), static_cast<char>(y), static_cast<char>(z)};
            }
            const PolygonSoup read = parse_polygons("a.ply", file).polygons;
            require(read.corners == expected, "strips are other triangles");
            require(read.facets() * 3 == expected.size(), "strips have other facets than triangles");
        }
}

/// Every second line followed by another.
std::string with_lines(const std::string& text, std::string_view line, std::string_view after) {
    std::string result;
    std::size_t number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin) + 1;
        const std::string_view own = std::string_view(text).substr(begin, end - begin);
        result += own;
        if (own.starts_with(after) && number++ % 2 == 0)
            result += fmt::format("{}\n", line);
        begin = end;
    }
    return result;
}

/// The same polygons with what is no facet between them: it is skipped with a warning, and changes nothing.
void check_skipped(const PolygonSoup& soup) {
    const auto check = [&](const char* name, const std::string& file, std::size_t warnings) {
        const PolygonFile read = parse_polygons(name, file);
        require(std::ranges::equal(
                    read.polygons.corners, soup.corners,
                    [&](std::uint32_t a, std::uint32_t b) { return read.polygons.vertices[a] == soup.vertices[b]; }),
                "{} is read as other facets beside what is skipped", name);
        require(read.polygons.begins == soup.begins, "{} has other facets beside what is skipped", name);
        require(read.warnings.size() == warnings, "{} has {} warnings, not {}", name, read.warnings.size(), warnings);
        std::string lines;
        for (const char c : file)
            lines += c == '\n' ? "\r\n" : std::string(1, c);
        const PolygonFile ended = parse_polygons(name, lines);
        require(same(ended.polygons, read.polygons) && ended.warnings == read.warnings,
                "{} is another if its lines end in two characters", name);
    };
    const std::string obj = testing::as_obj(soup);
    for (const std::string_view line : {"l 1 2", "p 1", "f 1 1", "f 1", "f", "a remark", "surf 0 1 0 1 1"})
        check("a.obj", with_lines(obj, line, "f "), 1);
    check("a.obj", with_lines(obj, "usemtl a\\", "f "), 0);
    check("a.ply", testing::as_ply_text(soup), 0);
    const std::string counts = fmt::format("\n{} {} 0\n", soup.vertices.size(), soup.facets());
    std::string off = testing::as_off(soup);
    off.replace(3, counts.size(), fmt::format("{} {} 0\n", soup.vertices.size(), soup.facets() + 2));
    check("a.off", off + "2 0 0\n1 0\n", 2);
    std::string shortest = fmt::format("OFF\n{} {} 0\n", soup.vertices.size(), soup.facets());
    for (std::size_t i = 0; i < soup.vertices.size(); ++i)
        shortest += "0 0 0\n";
    for (std::size_t facet = 0; facet < soup.facets(); ++facet)
        shortest += "0\n";
    shortest.pop_back();
    require(parse_polygons("a.off", shortest).joined_vertices + 1 == soup.vertices.size(),
            "the shortest OFF is another");
    if (soup.corners.size() == 3 * soup.facets()) {
        const std::string stl = testing::as_stl_text(soup);
        for (const std::string_view after : {"solid", " facet", "   vertex", "  endloop", " endfacet", "endsolid"})
            check("a.stl", "\xEF\xBB\xBF" + with_lines(stl, "color 1 0 0", after), 1);
    }
}

/// The places of the vertices of an OFF file without comments, read another way; nothing of a file that this reader
/// does not understand.
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
    std::vector<glm::dvec3> places;
    for (const glm::dvec3& vertex : vertices)
        if (std::ranges::find(places, vertex) == places.end())
            places.push_back(vertex);
    return places;
}

/// Triangles corner by corner.
bool same_places(const PolygonSoup& one, const PolygonSoup& other) {
    return std::ranges::equal(one.corners, other.corners,
                              [&](std::uint32_t a, std::uint32_t b) { return one.vertices[a] == other.vertices[b]; });
}

void check_file(const std::string& name, std::string_view bytes, bool normals) {
    PolygonSoup soup;
    std::size_t joined = 0;
    try {
        PolygonFile file = parse_polygons(name, bytes, normals);
        soup = std::move(file.polygons);
        joined = file.joined_vertices;
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
    if (name == "a.ply" && normals && joined == 0) { // they are the vertices'
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
        const std::string binary = testing::as_stl_binary(rounded);
        if (finite)
            require(same_places(parse_polygons("a.stl", binary).polygons, rounded), "not as STL");
        if (finite)
            require(same_places(parse_polygons("a.stl", binary + std::string(bytes.substr(0, 40))).polygons, rounded),
                    "not as STL with bytes behind it");
    }
    require(same(soup, parse_polygons("a.ply", testing::as_ply_binary(soup, true, false, true)).polygons),
            "not the same as PLY");
    if (soup.corners.size() < 200) {
        check_mixed_ply<std::int8_t, std::int16_t, std::int32_t>(soup, "");
        check_mixed_ply<std::uint8_t, std::uint16_t, std::uint32_t>(soup, "u");
        check_obj_normals(soup);
        check_strips(soup);
        check_skipped(soup);
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
