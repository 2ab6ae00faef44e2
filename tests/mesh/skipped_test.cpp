// What a file has beside its facets is skipped with a warning, and what is missing is an error.
#include "host/mesh/mesh_file.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

using testing::says;

using Warnings = std::vector<std::string>;

template <typename E> std::string refusal(const std::string& name, const std::string& bytes) {
    return testing::message_of<E>([&] { parse_polygons(name, bytes); });
}

void expect_refusal(const std::string& name, const std::string& bytes, const std::string& words) {
    EXPECT_TRUE(says(refusal<IoError>(name, bytes), words)) << bytes;
}

void expect_read(const std::string& name, const std::string& bytes, const PolygonSoup& expected,
                 const Warnings& warnings) {
    SCOPED_TRACE(bytes);
    EXPECT_EQ(refusal<Error>(name, bytes), "");
    const PolygonFile file = parse_polygons(name, bytes);
    EXPECT_EQ(file.polygons.vertices, expected.vertices);
    EXPECT_EQ(file.polygons.begins, expected.begins);
    EXPECT_EQ(file.polygons.corners, expected.corners);
    EXPECT_EQ(file.warnings, warnings);
}

std::string with_crs(const std::string& text) {
    std::string result;
    for (const char c : text)
        result += c == '\n' ? std::string("\r\n") : std::string(1, c);
    return result;
}

PolygonSoup quad() {
    return shapes::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
}

PolygonSoup triangle() {
    return shapes::single_triangle();
}

const std::string kObjQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Skipped, WellFormedFilesHaveNoWarnings) {
    for (const auto& [extension, bytes] : testing::all_formats(testing::fine_tetrahedron()))
        EXPECT_EQ(parse_polygons("a" + extension, bytes).warnings, Warnings()) << extension;
}

TEST(Skipped, ObjElementsThatAreNoFacets) {
    expect_read("a.obj", kObjQuad + "f 1 2\nf 1 2 3 4\nf 2/1 3/1\nf 3//1\nf\n", quad(),
                {"2 faces of two corners: skipped (the first in line 5)", "1 face of one corner: skipped (in line 8)",
                 "1 face without corners: skipped (in line 9)"});
    expect_read(
        "a.obj", kObjQuad + "l 1 2 3\np 1\nf 1 2 3 4\np 2 3\nl 1/1 2/2\n", quad(),
        {"2 line elements (l): skipped (the first in line 5)", "2 point elements (p): skipped (the first in line 6)"});
    expect_read("a.obj", kObjQuad + "fo 1 2 3 4\ncstype bezier\ncurv 0 1 1 2\nsurf 0 1 0 1 1 2 3 4\nend\n", quad(),
                {"1 free-form curve (curv): skipped (in line 7)", "1 free-form surface (surf): skipped (in line 8)"});
    // Corners of what is skipped are corners of the file all the same.
    expect_refusal("a.obj", kObjQuad + "f 1 2 3 4\nf 1 9\n", ":6: this facet has vertex 9");
    expect_refusal("a.obj", kObjQuad + "f 1 x\n", "\"x\" is not a corner");
    // Where the file ends within the line, corners may be missing.
    for (const char* cut : {"f", "f 1", "f 1 2", "f 1 2 "})
        expect_refusal("a.obj", kObjQuad + cut, ":5: a facet has three corners or more");
}

TEST(Skipped, NormalsOfSkippedFacesAreSkippedToo) {
    const PolygonFile file =
        parse_polygons("a.obj", kObjQuad + "vn 0 0 1\nvn 0 1 0\nf 1//2 2//2\nf 1\nf 1//1 2//1 3//2 4//1\n", true);
    EXPECT_EQ(file.polygons.corners, quad().corners);
    EXPECT_EQ(file.polygons.normals, (std::vector<glm::dvec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {0, 0, 1}}));
}

TEST(Skipped, ObjTextThatIsNoStatement) {
    expect_read("a.obj", "Exported by a program, v 1.2\n" + kObjQuad + "f 1 2 3 4\nthank you\n", quad(),
                {"2 lines of text: skipped (the first in line 1)"});
    // Numbers may be a vertex or a facet.
    for (const char* line : {"vertex 1 2 3", "ff 1 2 3", "g1 2", "4", "4 3/1", "0.5 0.5"})
        expect_refusal("a.obj", kObjQuad + line + "\nf 1 2 3 4\n", ":5: ");
    expect_refusal("a.obj", "hello\n", "no");
    expect_refusal("a.obj", "<html>\n<body>\n</body>\n", "vertex");
}

TEST(Skipped, ObjLinesThatGoOn) {
    for (const char* facet :
         {"f 1 2 \\ \n 3 4\n", "f 1 2 \\\t \n 3 4\n", "f 1 2\\ \n 3\\\t\n4\n", "f 1 2 \\ # so\n3 4\n",
          "f 1 2 \\\n3 4\n", "f \\ \n1 2 3 4\n", "f 1 2 3 4 \\ \n\n", "f 1 2 3 4 \\\n# no\n"}) {
        expect_read("a.obj", kObjQuad + facet, quad(), {});
        expect_read("a.obj", with_crs(kObjQuad + facet), quad(), {});
    }
    expect_read("a.obj", "v 0 \\ \n0 0\nv 1 0 0\nv 1 1 0\nv 0 1 \\\n 0\nf 1 2 3 4\n", quad(), {});
    for (const char* facet : {"f 1 2 3 \\", "f 1 2 3 \\ ", "f 1 2 3 \\\n4 \\  \n"})
        expect_refusal("a.obj", kObjQuad + facet, "to be continued");
}

TEST(Skipped, ObjNamesThatEndInABackslash) {
    for (const char* name : {"usemtl a\\", "g a\\", "o C:\\", "mtllib a\\b\\ ", "usemap x\\", "g \\", "maplib a b\\"}) {
        expect_read("a.obj", kObjQuad + name + "\nf 1 2 3 4\n", quad(), {});
        expect_read("a.obj", std::string(name) + "\n" + kObjQuad + "f 1 2 3 4\n", quad(), {});
        expect_read("a.obj", kObjQuad + name + "\n\nf 1 2 3 4\n", quad(), {});
        expect_read("a.obj", kObjQuad + name + "\n# f\nf 1 2 3 4\n", quad(), {});
        expect_read("a.obj", kObjQuad + name + "\n" + name + "\ns 1\n f 1 2 3 4\n" + name, quad(), {});
    }
    // A list of names may go on in the next line.
    expect_read("a.obj", kObjQuad + "g a \\\n b c \\ \n d\nf 1 2 3 4\n", quad(), {});
    expect_read("a.obj", "written to C:\\\n" + kObjQuad + "f 1 2 3 4\n", quad(),
                {"1 line of text: skipped (in line 1)"});
}

TEST(Skipped, OffKeywordsWithACount) {
    const std::string data = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
    for (const char* header : {"OFF4 1 0", "OFF4 1", "OFF4\t1 0", "COFF4 1 0", "NOFF4 1 0", "STOFF4 1 0 # so",
                               "# first\nOFF4 1 0", "OFF 4 1 0", "OFF\n4 1 0", "OFF\n\n# so\n4 1 0"}) {
        expect_read("a.off", header + ("\n" + data), quad(), {});
        expect_read("a.off", with_crs(header + ("\n" + data)), quad(), {});
    }
    expect_refusal("a.off", "OFF4x 1 0\n" + data, "begins with OFF");
    expect_refusal("a.off", "OFF-4 1 0\n" + data, "begins with OFF");
    expect_refusal("a.off", "OFF99999999999999999999 1 0\n" + data, "number of vertices");
    expect_refusal("a.off", "OFF4\n" + data, "number of facets");
    for (const std::string header :
         {"off\n4 1 0", "off4 1", "OFF\n4 1", "OFF\n4 1\n0", "OFF 4\n1\n0", "OFF\n4\n1 # facets\n\n0"})
        expect_read("a.off", header + ("\n" + data), quad(), {});
    expect_read("a.off", "4 1 0\n" + data, quad(), {"does not begin with OFF; read all the same"});
    expect_refusal("a.off", "4.0 1 0\n" + data, "begins with OFF");
    EXPECT_TRUE(says(refusal<UsageError>("a.off", "4OFF4 1 0\n0 0 0 1\n"), "three coordinates"));
    EXPECT_TRUE(says(refusal<UsageError>("a.obj", "OFF4 1 0\n" + data), "look like OFF"));
}

TEST(Skipped, OffFacetsOfFewCorners) {
    expect_read("a.off", "OFF\n4 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n4 0 1 2 3\n1 3\n2 1 2 0.5 0.5 0.5\n0", quad(),
                {"2 faces of two corners: skipped (the first in line 7)", "1 face of one corner: skipped (in line 9)",
                 "1 face without corners: skipped (in line 11)"});
    const std::string three = "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n";
    expect_read("a.off", three + "2 0\n 1\n3 0 1 2\n", triangle(), {"1 face of two corners: skipped (in line 6)"});
    expect_refusal("a.off", three + "2 0 3\n3 0 1 2\n", "no vertex 3");
    expect_refusal("a.off", three + "2 0 1\n", "facet 1 of 2");
    expect_refusal("a.off", three + "-2 0 1\n3 0 1 2\n", "\"-2\"");
    expect_read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\nthe end\n", triangle(),
                {"1 line of text: skipped (in line 7)"});
    expect_refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n", ":7: the file goes on");
}

TEST(Skipped, PlyFacesOfFewCornersAndEdges) {
    const std::string header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                               "float z\nelement face 4\nproperty list uchar int vertex_indices\nelement edge "
                               "2\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
    expect_read("a.ply", header + "2 0 1\n3 0 1 2\n0\n1 2\n0 1\n1 2\n", triangle(),
                {"1 face of two corners: skipped (in line 16)", "1 face without corners: skipped (in line 18)",
                 "1 face of one corner: skipped (in line 19)", "2 edges: skipped (the first in line 20)"});
    expect_read("a.ply", header + "2 0 1\n3 0 1 2\n0\n1 2\n0 1\n1 2\nmade by hand\n", triangle(),
                {"1 face of two corners: skipped (in line 16)", "1 face without corners: skipped (in line 18)",
                 "1 face of one corner: skipped (in line 19)", "2 edges: skipped (the first in line 20)",
                 "1 line of text: skipped (in line 22)"});
    expect_refusal("a.ply", header + "2 0 3\n3 0 1 2\n0\n1 2\n0 1\n1 2\n", "vertex 3");
    expect_refusal("a.ply", header + "2 0 1\n3 0 1 2\n0\n1 2\n0 1\n", "breaks off");
    // Binary: 3 corners of 4 bytes, 2 of 4 bytes.
    const std::string binary = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty char x\nproperty char "
                               "y\nproperty char z\nelement face 2\nproperty list uchar uchar "
                               "vertex_indices\nend_header\n" +
                               std::string("\0\0\0\1\0\0\0\1\0\2\0\1\3\0\1\2", 16);
    expect_read("a.ply", binary, triangle(),
                {fmt::format("1 face of two corners: skipped (at byte {})", binary.size() - 7)});
}

TEST(Skipped, BytesBehindABinaryStl) {
    const PolygonSoup cube = shapes::cube(true);
    const std::string bytes = testing::as_stl_binary(cube);
    const PolygonSoup expected = parse_polygons("a.stl", bytes).polygons;
    for (const std::size_t behind : {1, 2, 49, 51, 92, 1000001})
        for (const char filler : {'\0', '\xFF', '\n', 'x'})
            expect_read(
                "a.stl", bytes + std::string(behind, filler), expected,
                {fmt::format("{} byte{} behind the last triangle (the file announces 12): skipped (at byte 684)",
                             behind, behind == 1 ? "" : "s")});
    expect_read(
        "a.stl", bytes + std::string(150, '\0'), expected,
        {"150 bytes behind the last triangle (the file announces 12): skipped (at byte 684); they may be 3 more"});
    // Headers that look like another format.
    for (const std::string begin : {"solid x", "OFF", "v 1", "o part", "# so", "\n"}) {
        std::string named = bytes;
        named.replace(0, begin.size(), begin);
        expect_read("a.stl", named, expected, {});
        EXPECT_EQ(parse_polygons("a.stl", named + "behind").warnings.size(), 1u) << begin;
        expect_refusal("a.stl", named.substr(0, 683), "announces 12 triangles");
    }
    // Programs that write the count last, and do not come to it.
    std::string none = bytes;
    none.replace(80, 4, 4, '\0');
    expect_refusal("a.stl", none, "announces 0 triangles");
    EXPECT_EQ(parse_polygons("a.stl", none.substr(0, 84)).polygons.facets(), 0u);
    EXPECT_TRUE(says(refusal<UsageError>("a.ply", bytes + "behind"), "look like STL"));
}

TEST(Skipped, AByteOrderMark) {
    const PolygonSoup soup = testing::fine_tetrahedron();
    for (const auto& [extension, bytes] : testing::all_formats(soup)) {
        const bool binary_stl = extension == ".stl" && bytes.starts_with("sss");
        if (binary_stl)
            continue;
        const PolygonSoup expected = parse_polygons("a" + extension, bytes).polygons;
        expect_read("a" + extension, "\xEF\xBB\xBF" + bytes, expected, {});
        if (extension != ".ply")
            expect_read("a" + extension, "\xEF\xBB\xBF\r\n" + bytes, expected, {});
    }
    // Files that are joined as they are.
    const std::string stl = "\xEF\xBB\xBF" + testing::as_stl_text(soup);
    EXPECT_EQ(parse_polygons("a.stl", stl + stl).polygons.facets(), 8u);
    EXPECT_EQ(parse_polygons("a.stl", stl + stl).warnings, Warnings());
}

const std::string kStlFacet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n "
                              "endloop\nendfacet\n";

TEST(Skipped, StlTextThatIsNoFacet) {
    for (const char* name : {"a", "", "a\\", "a \\ ", "\\", "facet", "a facet normal"})
        expect_read("a.stl", fmt::format("solid {}\n{}endsolid {}\n", name, kStlFacet, name), triangle(), {});
    const Warnings one{"1 line of text: skipped (in line 1)"};
    for (const char* text :
         {"# made by hand", "; x 1 2", "// facets: 1", "\"a\"", "2026-11-25", "12 triangles", "COLOR=1 0 0"}) {
        expect_read("a.stl", fmt::format("{}\nsolid a\n{}endsolid a\n", text, kStlFacet), triangle(), one);
        expect_read("a.stl", fmt::format("solid a\n{}\n{}endsolid a\n", text, kStlFacet), triangle(),
                    {"1 line of text: skipped (in line 2)"});
        expect_read("a.stl", fmt::format("solid a\n{}{}\nendsolid a\n{}\n\x1A", kStlFacet, text, text), triangle(),
                    {"3 lines of text: skipped (the first in line 9)"});
    }
    // Within a facet wherever a keyword may be.
    const std::string coloured = "solid a\n" + kStlFacet + "endsolid a\n";
    for (const std::size_t before : {coloured.find(" outer"), coloured.find(" endloop"), coloured.find("endfacet")})
        expect_read("a.stl", std::string(coloured).insert(before, "color 1 0 0\n"), triangle(),
                    {fmt::format("1 line of text: skipped (in line {})",
                                 1 + std::ranges::count(coloured.substr(0, before), '\n'))});
    // Facets without a solid, and all in one line.
    expect_read("a.stl", kStlFacet + "endsolid\n", triangle(), {});
    std::string line = kStlFacet;
    std::ranges::replace(line, '\n', ' ');
    expect_read("a.stl", "solid a\n" + line + "endsolid a", triangle(), {});
}

TEST(Skipped, StlTextInWhichSomethingIsMissing) {
    const std::string whole = "solid a\n" + kStlFacet + "endsolid a\n";
    const auto without = [&](const std::string& words) {
        std::string text = whole;
        return text.erase(text.find(words), words.size());
    };
    expect_refusal("a.stl", without("  vertex 1 0 0\n"), ":6: expected vertex, got \"endloop\"");
    expect_refusal("a.stl", without("facet normal 0 0 1\n"), ":2: expected facet or endsolid, got \"outer\"");
    expect_refusal("a.stl", without(" outer loop\n"), "expected outer, got \"vertex\"");
    expect_refusal("a.stl", without(" endloop\n"), "expected endloop, got \"endfacet\"");
    expect_refusal("a.stl", without("endfacet\n"), "expected endfacet, got \"endsolid\"");
    expect_refusal("a.stl", without("endsolid a\n"), "breaks off before facet or endsolid");
    expect_refusal("a.stl", kStlFacet, "breaks off before facet or endsolid");
    expect_refusal("a.stl", whole + kStlFacet, "breaks off before facet or endsolid");
    expect_refusal("a.stl", "solid b\n" + kStlFacet + whole, ":9: expected facet or endsolid, got \"solid\"");
    expect_read("a.stl", "Solid part, made by hand\n" + whole, triangle(), {});
    // Damaged keywords.
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{{"facet", "fcet"},
                                                                                   {"outer", "outter"},
                                                                                   {"vertex", "vertx"},
                                                                                   {"endloop", "end loop"},
                                                                                   {"endfacet", "end facet"},
                                                                                   {"endsolid", "end solid"},
                                                                                   {"0 1 0", "0 1"},
                                                                                   {"0 1 0", "0 1 0 0"},
                                                                                   {"1 0 0", "1 0 0\n0 0 0"}}) {
        std::string text = whole;
        text.replace(text.find(from), from.size(), to);
        EXPECT_NE(refusal<IoError>("a.stl", text), "") << text;
    }
    for (const char* text : {"hello\n", "\xEF\xBB\xBF", "vertex 0 0 0\n", "so"})
        EXPECT_NE(refusal<IoError>("a.stl", text), "") << text;
}

} // namespace
} // namespace forceshade
