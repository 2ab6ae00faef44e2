// Polygon files of every format and flavour, and those that are refused.
#include <limits>
#include <locale>
#include <sstream>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/mesh_file.h"
#include "host/output/files.h"
#include "tests/io/folder.h"
#include "tests/io/locales.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/places.h"

namespace forceshade {
namespace {

using testing::message_of;
using testing::says;

class MeshFiles : public ::testing::Test {
protected:
    PolygonSoup read(const std::string& name, const std::string& bytes) {
        return read_polygons(folder_.write(name, bytes)).polygons;
    }
    template <typename E> std::string refusal(const std::string& name, const std::string& bytes) {
        const auto path = folder_.write(name, bytes);
        return message_of<E>([&] { read_polygons(path); });
    }
    /// Refused with an error that says all of `words`.
    template <typename E>
    void expect_refused(const std::string& name, const std::string& bytes, const std::string& words) {
        EXPECT_TRUE(says(refusal<E>(name, bytes), words)) << bytes;
    }
    testing::Folder folder_;
};

void expect_same(const PolygonSoup& found, const PolygonSoup& expected) {
    EXPECT_EQ(found.vertices, expected.vertices);
    EXPECT_EQ(found.begins, expected.begins);
    EXPECT_EQ(found.corners, expected.corners);
}

// Of an STL file, whose vertices come in the order of their first use.
void expect_same_corners(const PolygonSoup& found, const PolygonSoup& expected) {
    ASSERT_EQ(found.corners.size(), expected.corners.size());
    EXPECT_EQ(found.begins, expected.begins);
    for (std::size_t i = 0; i < found.corners.size(); ++i)
        EXPECT_EQ(found.vertices[found.corners[i]], expected.vertices[expected.corners[i]]);
}

TEST_F(MeshFiles, FormatAndHashAreTold) {
    const PolygonFile file =
        read_polygons(folder_.write("a.ply", testing::as_ply_binary(testing::fine_tetrahedron(), true)));
    EXPECT_EQ(file.format, "PLY (binary, big endian)");
    EXPECT_EQ(file.sha256.size(), 64u);
    EXPECT_EQ(read_polygons(folder_.write("a.stl", testing::as_stl_binary(testing::fine_tetrahedron()))).format,
              "STL (binary)");
}

// Large texts are read in blocks. A line that is skipped, or a corner counted backwards, has the whole read in order.
TEST_F(MeshFiles, LargeTextsAreTheSameInBlocks) {
    const PolygonSoup sphere = shapes::icosphere(7);
    const std::string obj = testing::as_obj(sphere), ply = testing::as_ply_text(sphere);
    const std::string stl = testing::as_stl_text(shapes::icosphere(6));
    ASSERT_GT(std::min({obj.size(), ply.size(), stl.size()}), std::size_t(4) << 20);
    expect_same(read("a.obj", obj), sphere);
    expect_same(read("b.obj", "solitary words\n" + obj), sphere);
    expect_same(read("c.ply", ply), sphere);
    expect_same(read("d.stl", stl), read("e.stl", "words\n" + stl));
    expect_same(read("f.stl", stl + stl), read("g.stl", "words\n" + stl + stl));
    PolygonSoup more = sphere;
    more.corners.insert(more.corners.end(), {0, 1, static_cast<std::uint32_t>(sphere.vertices.size() - 1)});
    more.end_facet();
    expect_same(read("g.obj", obj + "f 1 2 -1\n"), more);
    more.groups.assign(sphere.facets(), 0);
    more.groups.push_back(3);
    EXPECT_EQ(read("h.obj", obj + "s 3\nf 1 2 -1\n").groups, more.groups);
}

TEST_F(MeshFiles, FaultsOfLargeTextsHaveTheirLine) {
    const PolygonSoup sphere = shapes::icosphere(7);
    const std::string obj = testing::as_obj(sphere), ply = testing::as_ply_text(sphere);
    const std::string stl = testing::as_stl_text(shapes::icosphere(6));
    const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
    expect_refused<IoError>("a.obj", obj + "f 1 2 nothing\n", fmt::format(":{}: \"nothing\"", lines(obj) + 1));
    expect_refused<IoError>("b.obj", obj + "f 1 2 1000000\n",
                            fmt::format(":{}: this facet has vertex 1000000", lines(obj) + 1));
    expect_refused<IoError>("c.ply", ply + "3 0 1 2\n", "goes on behind the elements");
    expect_refused<IoError>("d.ply", ply.substr(0, ply.rfind('\n', ply.size() - 2) + 1), "breaks off");
    const std::string cut = stl.substr(0, stl.rfind("endfacet"));
    expect_refused<IoError>("e.stl", cut, fmt::format(":{}: the file breaks off before endfacet", lines(cut) + 1));
}

TEST_F(MeshFiles, ObjCornersOfEveryForm) {
    const std::string vertices = "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv +1 1 0\nv 0 1e0 0\nvt 0 0\nvn 0 0 1\n";
    const std::vector<std::uint32_t> expected{0, 1, 2, 3};
    for (const char* facet :
         {"f 1 2 3 4", "f 1/1 2/1 3/1 4/1", "f 1//1 2//1 3//1 4//1", "f 1/1/1 2/1/1 3/1/1 4/1/1", "f -4 -3 -2 -1",
          "f\t1\t2\t3\t4  ", "f 1 2 \\\n 3 4", "f 1 2 3 4 # a comment", "l 1 2\ng a b\nf 1 2 3 4\r\nusemtl x\n"})
        EXPECT_EQ(read("a.obj", vertices + facet).corners, expected) << facet;
    EXPECT_EQ(read("a.obj", "o x\nf 1 2 3 4\n" + vertices).corners, expected) << "vertices behind their facets";
}

TEST_F(MeshFiles, ObjRefusals) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    for (const auto& [line, words] :
         std::vector<std::pair<std::string, std::string>>{{"f 1 2 4\n", "vertex 4"},
                                                          {"f 1 2 -4\n", ":4: no vertex -4"},
                                                          {"f 0 1 2\n", "no vertex 0"},
                                                          {"f 1 2", "three corners"},
                                                          {"f 1 2 3x\n", "\"3x\""},
                                                          {"f 1 2 99999999999999999999\n", "99999"},
                                                          {"v 1 2\n", "three coordinates"},
                                                          {"v 1 2,5 3\n", "\"2,5\""},
                                                          {"v 1 2 3y\n", "\"3y\""},
                                                          {"vertex 1 2 3\n", "unknown OBJ keyword"},
                                                          {"f 1 2 \\", "continued"}})
        expect_refused<IoError>("a.obj", vertices + line, words);
}

TEST_F(MeshFiles, OffFlavours) {
    const PolygonSoup expected = read("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    expect_same(read("b.off", "# first\nCOFF 3 1 0 # c\n\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n0 1 0 0 0 0 0\n3 0 1\n 2"),
                expected);
    expect_same(read("c.off", "OFF\r\n3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2 0.5 0.5 0.5"), expected);
    expect_refused<UsageError>("d.off", "OFF BINARY\nxxxx", "binary OFF");
}

TEST_F(MeshFiles, PlyPropertiesInAnyOrderAndOfAnyType) {
    const PolygonSoup soup =
        read("a.ply", "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement face 1\r\nproperty uchar red\r\n"
                      "property list int32 uint32 vertex_index\r\nproperty list uchar float uv\r\nelement vertex 3\r\n"
                      "property short z\r\nproperty float32 nx\r\nproperty int x\r\nproperty double y\r\n"
                      "element other 2\r\nproperty list uchar int a\r\nend_header\r\n7 3 0 1 2 2 .5 .5\r\n"
                      "1 0 2 3\r\n4 0 5 6\r\n\r\n7 0 8 9e0\r\n1 1\r\n0\r\n");
    EXPECT_EQ(soup.vertices, (std::vector<glm::dvec3>{{2, 3, 1}, {5, 6, 4}, {8, 9, 7}}));
    EXPECT_EQ(soup.corners, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST_F(MeshFiles, PlyRefusals) {
    const std::string begin = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n";
    const std::string end = "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 1 0\n";
    EXPECT_EQ(read("a.ply", begin + end + "3 0 1 2").facets(), 1u);
    for (const auto& [file, words] : std::vector<std::pair<std::string, std::string>>{
             {begin + end + "3 0 1 3\n", "vertex 3"},
             {begin + end + "3 0 1 -1\n", "vertex -1"},
             {begin + end + "3 0 1\n", "integer"},
             {begin + end + "3 0 1 2 5\n", "behind the last"},
             {begin + end + "3 0 1 2\n3 0 1 2\n", "goes on"},
             {begin + end, "breaks off"},
             {begin + end + "999999999 0\n", "cannot hold"},
             {begin + "property quad z\n", "is not a PLY type"},
             {begin + "element face 1\nproperty list float int vertex_indices\n", "integer"},
             {begin + "end_header\n0 0\n0 0\n0 0\n", "x, y and z"},
             {"ply\nformat ascii 1.0\n", "within its header"},
             {"ply\nelement vertex 1\nend_header\n", "format"},
             {"ply\nformat middle_endian 1.0\n", "middle"}})
        expect_refused<IoError>("a.ply", file, words);
}

TEST_F(MeshFiles, VerticesAtOnePlaceAreOne) {
    const double next = std::nextafter(1.0, 2.0);
    const PolygonSoup soup = shapes::soup_of(
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}, {next, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {3, 4, 5}});
    EXPECT_EQ(read("a.stl", testing::as_stl_text(soup)).vertices.size(),
              4u); // 0 and -0 are one, 1 and its successor two
    EXPECT_EQ(read("b.stl", testing::as_stl_binary(soup)).vertices.size(), 3u); // but not as floats
    EXPECT_EQ(read("a.obj", testing::as_obj(soup)).vertices.size(), 4u);
}

TEST_F(MeshFiles, StlOfSeveralSolidsAndOfAnyCase) {
    const std::string one = testing::as_stl_text(testing::fine_tetrahedron());
    std::string other = one;
    for (char& c : other)
        c = static_cast<char>(std::toupper(c, std::locale::classic()));
    EXPECT_EQ(read("a.stl", one + other).facets(), 8u);
    EXPECT_EQ(read("b.stl", "solid empty\nendsolid\n").facets(), 0u);
}

// Of a binary PLY file, between two facets too.
TEST_F(MeshFiles, ATruncatedListIsNoticed) {
    const std::string bytes = testing::as_ply_binary(testing::fine_tetrahedron(), false);
    for (const std::size_t missing : {std::size_t{1}, std::size_t{13}, std::size_t{14}})
        EXPECT_NE(refusal<IoError>("a.ply", bytes.substr(0, bytes.size() - missing)), "");
    expect_refused<IoError>("a.ply", bytes.substr(0, bytes.size() - 13), "breaks off");
    expect_refused<IoError>("a.ply", bytes + "more", "goes on");
}

TEST_F(MeshFiles, AnnouncedCountsBeyondTheFileAreRefusedAtOnce) {
    const std::string trillion = "1000000000000";
    expect_refused<IoError>("a.off", "OFF\n" + trillion + " 1 0\n0 0 0\n", trillion);
    expect_refused<IoError>("b.off", "OFF\n1 " + trillion + " 0\n0 0 0\n", trillion);
    expect_refused<IoError>("c.off", "OFF\n1 1 0\n0 0 0\n" + trillion + " 0 0 0\n", trillion);
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
        for (const char* element : {"vertex", "face", "other"})
            expect_refused<IoError>("a.ply",
                                    fmt::format("ply\nformat {} 1.0\nelement {} {}\nproperty float x\n"
                                                "property float y\nproperty float z\nproperty list uint "
                                                "int vertex_indices\nend_header\n1234567890123456",
                                                format, element, trillion),
                                    trillion);
    // Six times this wraps round to 2.
    expect_refused<IoError>("d.off", "OFF\n3074457345618258603 0 0\n0 0 0\n", "3074457345618258603");
    // A list of 2^32 - 1 values.
    expect_refused<IoError>("b.ply",
                            "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint int "
                            "vertex_indices\nend_header\n\xFF\xFF\xFF\xFF"
                            "1234",
                            "4294967295");
    expect_refused<IoError>("a.stl", std::string(80, 'x') + "\xFF\xFF\xFF\xFF" + std::string(50, '\0'), "4294967295");
}

TEST_F(MeshFiles, VerticesThatAreNotFiniteAreNamed) {
    for (const char* bad : {"nan", "inf", "-inf", "1e999"}) {
        expect_refused<UsageError>("a.obj", fmt::format("v 0 0 0\nv 1 {} 0\nv 0 1 0\nf 1 2 3\n", bad), "vertex 2 of 3");
        expect_refused<UsageError>("a.off", fmt::format("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 {}\n3 0 1 2\n", bad),
                                   "vertex 3 of 3");
    }
    PolygonSoup soup = testing::fine_tetrahedron();
    soup.vertices[2].y = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [extension, bytes] : testing::all_formats(soup))
        expect_refused<UsageError>("b" + extension, bytes, "finite");
    EXPECT_EQ(read("tiny.obj", "v 1e-400 0 0\nv 4e-320 0 0\nv 0 1 0\nf 1 2 3\n").vertices[0].x, 0);
}

TEST_F(MeshFiles, ExtensionAndContentsMustAgree) {
    const PolygonSoup soup = testing::fine_tetrahedron();
    EXPECT_TRUE(says(refusal<UsageError>("a.obj", testing::as_ply_text(soup)),
                     "the extension says OBJ, but its contents look like PLY; rename it to .ply"));
    expect_refused<UsageError>("a.ply", testing::as_stl_binary(soup), "look like STL");
    expect_refused<UsageError>("a.stl", testing::as_off(soup), "look like OFF");
    expect_refused<UsageError>("a.off", testing::as_obj(soup), "look like OBJ");
    EXPECT_TRUE(says(refusal<UsageError>("a.fbx", testing::as_obj(soup)), ".obj, .off, .ply, .stl", "look like OBJ"));
    expect_refused<UsageError>("noextension", "\1\2\3", "none of them");
}

TEST_F(MeshFiles, FilesThatCannotBeRead) {
    EXPECT_TRUE(says(message_of<IoError>([&] { read_polygons(folder_ / "missing.obj"); }), "missing.obj"));
    for (const char* name : {"a.obj", "a.off", "a.ply", "a.stl"})
        expect_refused<IoError>(name, "", "empty");
    std::filesystem::create_directory(folder_ / "folder.obj");
    EXPECT_TRUE(says(message_of<IoError>([&] { read_polygons(folder_ / "folder.obj"); }), "regular file"));
    for (const char* name : {"b.obj", "b.off", "b.ply", "b.stl"})
        EXPECT_NE(refusal<IoError>(name, std::string(300, '\xA7')), "") << name;
}

TEST_F(MeshFiles, ALocaleWithCommasChangesNothing) {
    const PolygonSoup expected = testing::fine_tetrahedron(true);
    testing::in_locales_with_commas([&] {
        for (const auto& [extension, bytes] : testing::all_formats(expected))
            expect_same_corners(read("a" + extension, bytes), expected);
        EXPECT_EQ(read("tiny.obj", "v 1.5e-400 0 0\nv 1.5 0 0\nv 0 1 0\nf 1 2 3\n").vertices[1].x, 1.5);
    });
}

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;

struct CgalSoup {
    std::vector<Point> points;
    std::vector<std::vector<std::size_t>> polygons;
};

CgalSoup read_by_cgal(const std::string& extension, const std::string& bytes) {
    std::istringstream stream(bytes);
    CgalSoup soup;
    bool good = false;
    if (extension == ".obj")
        good = CGAL::IO::read_OBJ(stream, soup.points, soup.polygons);
    else if (extension == ".off")
        good = CGAL::IO::read_OFF(stream, soup.points, soup.polygons);
    else if (extension == ".ply")
        good = CGAL::IO::read_PLY(stream, soup.points, soup.polygons);
    else
        good = CGAL::IO::read_STL(stream, soup.points, soup.polygons);
    EXPECT_TRUE(good) << extension;
    return soup;
}

void compare(const std::string& extension, const std::string& bytes) {
    const PolygonSoup mine = parse_polygons("a" + extension, bytes).polygons;
    const CgalSoup other = read_by_cgal(extension, bytes);
    ASSERT_EQ(mine.vertices.size(), other.points.size()) << extension;
    for (std::size_t i = 0; i < other.points.size(); ++i)
        EXPECT_EQ(mine.vertices[i], glm::dvec3(other.points[i].x(), other.points[i].y(), other.points[i].z()));
    ASSERT_EQ(mine.facets(), other.polygons.size()) << extension;
    for (std::size_t facet = 0; facet < mine.facets(); ++facet)
        EXPECT_TRUE(std::equal(other.polygons[facet].begin(), other.polygons[facet].end(),
                               mine.corners.begin() + mine.begins[facet],
                               mine.corners.begin() + mine.begins[facet + 1]))
            << extension << " facet " << facet;
}

TEST(CgalReaders, ReadTheSame) {
    for (const PolygonSoup& soup : {testing::fine_tetrahedron(), testing::fine_tetrahedron(true), shapes::icosphere(3)})
        for (const auto& [extension, bytes] : testing::all_formats(soup))
            compare(extension, bytes);
    compare(".ply", testing::as_ply_binary(testing::fine_tetrahedron(true), false, true, true));
    const PolygonSoup prism = shapes::many_gon_prism(100);
    compare(".obj", testing::as_obj(prism));
    compare(".off", testing::as_off(prism));
    compare(".ply", testing::as_ply_text(prism));
    compare(".ply", testing::as_ply_binary(prism, true));
    compare(".obj", read_file(in_source("tests/data/spot.obj")));
}

} // namespace
} // namespace forceshade
