// What is too thin for a god-object in single precision is found, and nothing else.
#include "host/mesh/thin_parts.h"

#include <gtest/gtest.h>

#include "tests/mesh/god_object_walks.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

constexpr double kReach = 3e-3;

bool is_thin(const PolygonSoup& polygons) {
    return has_thin_parts(build_structure(shapes::mesh_of(polygons)), kReach);
}

TEST(ThinParts, WallsWedgesAndGaps) {
    EXPECT_TRUE(is_thin(shapes::plate(1e-3)));
    EXPECT_TRUE(is_thin(shapes::plate(1e-7)));
    EXPECT_TRUE(is_thin(walks::wedge(1e-4)));
    EXPECT_TRUE(is_thin(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), {1, 1, 1}, {2.001, 0, 0}))));
}

TEST(ThinParts, NotWhatIsThickNorSheets) {
    EXPECT_FALSE(is_thin(shapes::cube()));
    EXPECT_FALSE(is_thin(shapes::plate(1e-2)));
    EXPECT_FALSE(is_thin(shapes::icosphere(3)));
    EXPECT_FALSE(is_thin(walks::wedge(1.0)));
    EXPECT_FALSE(is_thin(shapes::single_triangle()));
    EXPECT_FALSE(is_thin(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), {1, 1, 1}, {2.1, 0, 0}))));
}

} // namespace
} // namespace forceshade
