// Triangle strips of PLY files; random ones: fuzz_mesh_file.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh_file.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using testing::says;

using Strip = std::vector<std::int64_t>;

void put(std::string& bytes, std::uint64_t value, std::size_t size, bool big_endian) {
    for (std::size_t i = 0; i < size; ++i)
        bytes += static_cast<char>(value >> 8 * (big_endian ? size - 1 - i : i));
}

struct Type {
    const char* name;
    std::size_t size; // bytes
};

/// A file of strips, whose first 8 vertices are the corners of the unit cube.
std::string ply_of(int encoding, const std::vector<Strip>& strips, std::size_t vertices = 8, Type count = {"int", 4},
                   Type index = {"int", 4}) {
    constexpr const char* kEncodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    std::string bytes = fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty uchar x\nproperty uchar y\n"
                                    "property uchar z\nelement tristrips {}\nproperty list {} {} vertex_indices\n"
                                    "end_header\n",
                                    kEncodings[encoding], vertices, strips.size(), count.name, index.name);
    const auto add = [&](std::int64_t value, std::size_t size) {
        if (encoding == 0)
            bytes += fmt::format("{} ", value);
        else
            put(bytes, static_cast<std::uint64_t>(value), size, encoding == 2);
    };
    const auto end_line = [&] { bytes += encoding == 0 ? "\n" : ""; };
    for (std::size_t i = 0; i < vertices; ++i) {
        for (const std::size_t axis : {i & 1, i >> 1 & 1, i >> 2 & 1})
            add(static_cast<std::int64_t>(axis), 1);
        end_line();
    }
    for (const Strip& strip : strips) {
        add(static_cast<std::int64_t>(strip.size()), count.size);
        for (const std::int64_t vertex : strip)
            add(vertex, index.size);
        end_line();
    }
    return bytes;
}

PolygonFile read(const std::string& bytes) {
    return parse_polygons("a.ply", bytes);
}

std::string refusal(const std::string& bytes) {
    return testing::message_of<IoError>([&] { read(bytes); });
}

const Strip kCubeFaces{0, 1, 4, 5, -1, 1, 3, 5, 7, -1, 3, 2, 7, 6, -1, 2, 0, 6, 4, -1, 4, 5, 6, 7, -1, 0, 2, 1, 3, -1};

void expect_cube(const PolygonFile& file) {
    const MeshFindings found = inspect(file.polygons);
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.facets, 12u);
    EXPECT_EQ(found.misoriented_edges, 0u);
    EXPECT_DOUBLE_EQ(found.volume, 1);
    EXPECT_TRUE(file.warnings.empty());
}

TEST(Strips, ACubeInEveryEncodingAndForm) {
    const Strip without_last(kCubeFaces.begin(), kCubeFaces.end() - 1);
    Strip doubled_ends;
    for (const std::int64_t vertex : kCubeFaces)
        doubled_ends.insert(doubled_ends.end(), vertex == -1 ? 2 : 1, vertex);
    std::vector<Strip> faces(1);
    for (const std::int64_t vertex : without_last)
        if (vertex == -1)
            faces.emplace_back();
        else
            faces.back().push_back(vertex);
    // One strip for the side, which is turned round the corner, and two for the ends.
    const std::vector<Strip> around{{0, 4, 2, 6, 3, 7, 1, 5, 0, 4}, {4, 5, 6, 7}, {0, 2, 1, 3}};
    std::vector<Strip> turned = around;
    std::ranges::reverse(turned[0]); // an even number of vertices: the same side
    for (int encoding = 0; encoding < 3; ++encoding) {
        expect_cube(read(ply_of(encoding, {kCubeFaces})));
        expect_cube(read(ply_of(encoding, {without_last})));
        expect_cube(read(ply_of(encoding, {doubled_ends, {}})));
        expect_cube(read(ply_of(encoding, faces)));
        expect_cube(read(ply_of(encoding, {kCubeFaces}, 8, {"uchar", 1}, {"char", 1})));
        expect_cube(read(ply_of(encoding, {kCubeFaces}, 8, {"ushort", 2}, {"short", 2})));
        expect_cube(read(ply_of(encoding, {kCubeFaces}, 8, {"uint", 4}, {"int32", 4})));
        expect_cube(read(ply_of(encoding, around)));
        expect_cube(read(ply_of(encoding, turned)));
    }
}

TEST(Strips, UnsignedEnds) {
    for (const auto& [name, size] : {Type{"uchar", 1}, {"ushort", 2}, {"uint", 4}}) {
        Strip faces = kCubeFaces;
        std::ranges::replace(faces, -1, (std::int64_t{1} << 8 * size) - 1);
        for (int encoding = 0; encoding < 3; ++encoding)
            expect_cube(read(ply_of(encoding, {faces}, 8, {"int", 4}, {name, size})));
    }
    // With 256 vertices the last is one of them: at the place of the cube's last.
    EXPECT_EQ(read(ply_of(1, {{0, 1, 255, 2}}, 256, {"int", 4}, {"uchar", 1})).polygons.corners,
              (std::vector<std::uint32_t>{0, 1, 7, 7, 1, 2}));
}

TEST(Strips, ShortStripsAreSkippedWithACount) {
    const PolygonFile file = read(ply_of(0, {{0, 1, 2, -1, 3, 4, -1, 5, -1, -1}, {6, 7}}));
    EXPECT_EQ(file.polygons.facets(), 1u);
    EXPECT_EQ(file.warnings,
              (std::vector<std::string>{"3 strips of fewer than three vertices: skipped (the first in line 18)"}));
}

TEST(Strips, BesideFacesAndOtherProperties) {
    const std::string file = "ply\nformat ascii 1.0\nelement tristrips 2\nproperty uchar red\nproperty list int int "
                             "vertex_index\nproperty float more\nelement face 1\nproperty list uchar int "
                             "vertex_indices\nelement vertex 5\nproperty float x\nproperty float y\nproperty float "
                             "z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
                             "9 4 0 1 2 3 0.5\n9 3 2 3 4 1\n4 0 2 3 1\n"
                             "0 0 0 1 0 0\n1 0 0 2 0 0\n0 1 0 3 0 0\n1 1 0 4 0 0\n2 2 0 5 0 0\n";
    const PolygonSoup soup = parse_polygons("a.ply", file, true).polygons;
    EXPECT_EQ(soup.begins, (std::vector<std::uint32_t>{0, 3, 6, 9, 13}));
    EXPECT_EQ(soup.corners, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 2, 3, 4, 0, 2, 3, 1}));
    for (std::size_t i = 0; i < soup.corners.size(); ++i)
        EXPECT_EQ(soup.normals[i], glm::dvec3(soup.corners[i] + 1, 0, 0));
    EXPECT_EQ(parse_polygons("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float "
                                      "y\nproperty float z\nelement face 0\nelement tristrips 0\nend_header\n")
                  .polygons.facets(),
              0u);
}

TEST(Strips, Refusals) {
    for (int encoding = 0; encoding < 3; ++encoding) {
        EXPECT_TRUE(says(refusal(ply_of(encoding, {{0, 1, 8}})), "vertex 8"));
        EXPECT_TRUE(says(refusal(ply_of(encoding, {{0, 0, 8}})), "vertex 8"));
        EXPECT_TRUE(says(refusal(ply_of(encoding, {{0, 1, 2, -2}})), "vertex -2"));
        const std::string whole = ply_of(encoding, {kCubeFaces, {0, 1, 2}});
        for (std::size_t size = 0; size + 2 < whole.size(); ++size)
            EXPECT_NE(refusal(whole.substr(0, size)), "") << encoding << " " << size;
    }
    const std::string begin = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                              "float z\nelement tristrips 1\nproperty list int ";
    const std::string vertices = "end_header\n0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_TRUE(says(refusal(begin + "int vertex_indices\n" + vertices + "-3 0 1 2\n"), "list of -3"));
    EXPECT_TRUE(says(refusal(begin + "int vertex_indices\n" + vertices + "2000000000 0 1 2\n"), "2000000000"));
    EXPECT_TRUE(says(refusal(begin + "int vertex_indices\n" + vertices + "3 0 nan 2\n"), "\"nan\""));
    EXPECT_TRUE(says(refusal(begin + "int vertex_indices\n" + vertices + "3 0 1 2 2\n"), "behind"));
    EXPECT_TRUE(says(refusal(begin + "float vertex_indices\n" + vertices + "3 0 1 2\n"), "list of integers"));
    EXPECT_TRUE(says(refusal(begin + "int strip\n" + vertices + "3 0 1 2\n"), "the triangle strips have no list"));
}

} // namespace
} // namespace forceshade
