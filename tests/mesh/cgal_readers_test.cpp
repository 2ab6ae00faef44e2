// The readers against CGAL's, which were written by others: the same doubles and facets from well-formed files.
#include <fstream>
#include <sstream>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/OBJ.h>
#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>

#include <gtest/gtest.h>

#include "host/mesh/mesh_file.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

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
    testing::Folder folder;
    std::ofstream(folder / ("a" + extension), std::ios::binary) << bytes;
    const PolygonSoup mine = read_polygons(folder / ("a" + extension)).polygons;
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

TEST(CgalReaders, ReadTheSameFromEveryFormat) {
    for (const PolygonSoup& soup : {testing::fine_tetrahedron(), shapes::icosphere(3)})
        for (const auto& [extension, bytes] : testing::all_formats(soup))
            compare(extension, bytes);
}

TEST(CgalReaders, ReadTheSamePolygonsOfManyCorners) {
    const PolygonSoup prism = shapes::many_gon_prism(100);
    compare(".obj", testing::as_obj(prism));
    compare(".off", testing::as_off(prism));
    compare(".ply", testing::as_ply_text(prism));
    compare(".ply", testing::as_ply_binary(prism, true));
}

TEST(CgalReaders, ReadTheSameSpot) {
    std::ifstream stream(FORCESHADE_TEST_DATA "/spot.obj", std::ios::binary);
    std::stringstream bytes;
    bytes << stream.rdbuf();
    compare(".obj", bytes.str());
}

} // namespace
} // namespace forceshade
