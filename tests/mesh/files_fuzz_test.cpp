// Small valid files of all formats, cut off and damaged at random: read or refused, never anything else.
#include "host/mesh/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

std::string damaged(std::string bytes, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    static const std::string kNasty[] = {"-", "9999999999",       "e", "nan", "\n", " ", "\\", "#",
                                         "0", "\xFF\xFF\xFF\xFF", "f", "/"};
    switch (below(4)) {
    case 0:
        return bytes.substr(0, below(bytes.size()));
    case 1:
        for (std::size_t flips = 1 + below(4); flips > 0; --flips)
            bytes[below(bytes.size())] = static_cast<char>(below(256));
        return bytes;
    case 2:
        return bytes.insert(below(bytes.size()), kNasty[below(std::size(kNasty))]);
    default:
        return bytes.erase(below(bytes.size()), 1 + below(8));
    }
}

void expect_sound(const PolygonSoup& soup) {
    ASSERT_EQ(soup.begins.front(), 0u);
    ASSERT_EQ(soup.begins.back(), soup.corners.size());
    for (std::size_t facet = 0; facet < soup.facets(); ++facet)
        ASSERT_GE(soup.begins[facet + 1], soup.begins[facet] + 3);
    for (const std::uint32_t corner : soup.corners)
        ASSERT_LT(corner, soup.vertices.size());
    for (const glm::dvec3& vertex : soup.vertices)
        ASSERT_TRUE(std::isfinite(vertex.x + vertex.y + vertex.z) || std::abs(vertex.x) > 1e300 ||
                    std::abs(vertex.y) > 1e300 || std::abs(vertex.z) > 1e300);
}

double largest_coordinate(const PolygonSoup& soup) {
    double largest = 0;
    for (const glm::dvec3& vertex : soup.vertices)
        largest = std::max({largest, std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
    return largest;
}

// What is read is also inspected and prepared.
TEST(MeshFuzz, DamagedFilesAreReadOrRefused) {
    std::mt19937 random(1);
    const int trials = std::getenv("FORCESHADE_LONG") ? 200000 : 3000; // of each format
    int read = 0, refused = 0;
    for (const auto& [extension, bytes] : testing::all_formats(testing::fine_tetrahedron()))
        for (int i = 0; i < trials; ++i) {
            try {
                const PolygonSoup soup = parse_polygons("a" + extension, damaged(bytes, random)).polygons;
                expect_sound(soup);
                inspect(soup);
                if (largest_coordinate(soup) < 1e100)
                    prepare_mesh(soup, {}, VertexNormals::angle);
                ++read;
            } catch (const Error& error) {
                ++refused;
                ASSERT_NE(std::string(error.what()).find("a" + extension), std::string::npos) << error.what();
            }
        }
    EXPECT_GT(read, trials / 2);
    EXPECT_GT(refused, 2 * trials);
}

// Every prefix of every file.
TEST(MeshFuzz, TruncatedFilesAreReadOrRefused) {
    for (const auto& [extension, bytes] : testing::all_formats(testing::fine_tetrahedron())) {
        std::size_t refused = 0;
        for (std::size_t size = 0; size < bytes.size(); ++size) {
            try {
                expect_sound(parse_polygons("a" + extension, bytes.substr(0, size)).polygons);
            } catch (const Error&) {
                ++refused;
            }
        }
        // Text that announces its length may lose its last line end; OBJ announces nothing.
        EXPECT_GE(refused, extension == ".obj" ? bytes.size() / 4 : bytes.size() - 8) << extension;
    }
}

} // namespace
} // namespace forceshade
