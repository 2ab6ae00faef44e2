// G3 and L5: gradients of analytic and sampled height maps.
#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/field/tables.h"
#include "host/output/height_image.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

HeightMapSpec analytic(MapFunction function) {
    HeightMapSpec map;
    map.function = function;
    map.width = function == MapFunction::sine ? 0.003 : 2 * kHalfWidth;
    map.radius = function == MapFunction::gaussian ? 0.005 : kRadii[0];
    map.height = 0.0008;
    return map;
}

double height(const HeightMapSpec& map, double x, double y) {
    switch (map.function) {
    case MapFunction::cylinder:
    case MapFunction::dip: {
        const double sign = map.function == MapFunction::dip ? -1 : 1, a = map.width / 2;
        return std::abs(x) < a
                   ? sign * (std::sqrt(map.radius * map.radius - x * x) - std::sqrt(map.radius * map.radius - a * a))
                   : 0;
    }
    case MapFunction::sine:
        return map.height * std::sin(2 * std::numbers::pi * x / map.width);
    default:
        return map.height * std::exp(-(x * x + y * y) / (map.radius * map.radius));
    }
}

TEST(HeightMap, ForceIsNormalToTheMap) {
    for (const MapFunction function :
         {MapFunction::cylinder, MapFunction::dip, MapFunction::sine, MapFunction::gaussian}) {
        const HeightMapSpec map = analytic(function);
        const OwnedLaw<double> law(height_map(map));
        for (const double x : {-0.009, -0.0021, 0.0, 0.0034, 0.0101})
            for (const double y : {-0.004, 0.0, 0.002}) {
                const auto force = law(x, y, -0.0015).force;
                const double step = 3e-7;
                EXPECT_NEAR(-force.x / force.z, (height(map, x + step, y) - height(map, x - step, y)) / (2 * step),
                            1e-6);
                EXPECT_NEAR(-force.y / force.z, (height(map, x, y + step) - height(map, x, y - step)) / (2 * step),
                            1e-6);
                EXPECT_NEAR(std::hypot(std::hypot(force.x, force.y), force.z), 1.5, 1e-14)
                    << "the plane sets the magnitude";
            }
    }
}

TEST(HeightMap, FlatBeyondCylinderAndImage) {
    const OwnedLaw<double> law(height_map(analytic(MapFunction::cylinder)));
    EXPECT_EQ(law(kHalfWidth, 0, -0.001).force.x, 0);
    EXPECT_EQ(law(-0.02, 0, -0.001).force.z, 1);
}

// A 5 x 4 image of a plane that rises by 0.3 per metre along x and falls by 0.7 along y.
std::shared_ptr<HeightImage> tilted_image() {
    auto image = std::make_shared<HeightImage>();
    image->columns = 5;
    image->rows = 4;
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 5; ++column)
            image->samples.push_back(0.3 * 0.01 * static_cast<double>(column) / 4 +
                                     0.7 * 0.006 * static_cast<double>(row) / 3); // row 0 is the largest y
    return image;
}

HeightMapSpec sampled(double size_x, double size_y) {
    HeightMapSpec map;
    map.function = MapFunction::file;
    map.size = {size_x, size_y};
    map.height = 1;
    return map;
}

TEST(HeightMap, SamplesOfAPlaneGiveItsSlopeEverywhere) {
    SceneImages images;
    images.map = tilted_image();
    const OwnedLaw<double> law(height_map(sampled(0.01, 0.006)), images);
    for (const double x : {-0.005, -0.0031, 0.0, 0.0024, 0.005})
        for (const double y : {-0.003, -0.001, 0.0, 0.0029, 0.003}) {
            const auto force = law(x, y, -0.001).force;
            EXPECT_NEAR(-force.x / force.z, 0.3, 1e-12) << x << ' ' << y;
            EXPECT_NEAR(-force.y / force.z, -0.7, 1e-12) << x << ' ' << y;
        }
    EXPECT_EQ(law(0.0051, 0, -0.001).force.x, 0) << "flat outside";
}

TEST(HeightMap, CentralDifferencesWithinAndOneSidedAtTheBorder) {
    const std::vector<double> samples{0, 1, 4, 9}; // one row, spaced 1 m
    const std::vector<double> gradients = map_gradients<double>(samples, 4, 1, 3.0, 1.0, 2.0, "");
    const double expected[] = {2, 4, 8, 10};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_DOUBLE_EQ(gradients[2 * i], expected[i]);
        EXPECT_EQ(gradients[2 * i + 1], 0);
    }
}

TEST(HeightMap, ImageRowZeroIsTheLargestY) {
    const std::vector<double> samples{5, 1}; // two rows of one column: 5 on top
    const std::vector<double> gradients = map_gradients<double>(samples, 1, 2, 1.0, 1.0, 1.0, "");
    EXPECT_DOUBLE_EQ(gradients[1], 4);
    EXPECT_DOUBLE_EQ(gradients[3], 4);
}

TEST(HeightMap, OnePixelIsFlat) {
    SceneImages images;
    auto image = std::make_shared<HeightImage>();
    image->columns = image->rows = 1;
    image->samples = {0.5};
    images.map = image;
    const OwnedLaw<float> law(height_map(sampled(0.01, 0.01)), images);
    EXPECT_EQ(law(0.001f, 0.002f, -0.001f).force.x, 0);
    EXPECT_EQ(law(0.001f, 0.002f, -0.001f).force.z, 1000 * 0.001f);
}

// What the refusal of these samples, 3 x 2 of them 1 m apart, says in precision T; empty if there is none.
template <typename T> std::string refusal(const std::vector<double>& samples) {
    try {
        map_gradients<T>(samples, 3, 2, 2.0, 1.0, 1.0, "steps.exr");
    } catch (const UsageError& error) {
        return error.what();
    }
    return "";
}

TEST(HeightMap, SlopesWhoseSquareOverflowsAreRefusedWithTheirPixel) {
    EXPECT_EQ(refusal<float>({0, 0, 0, 0, 9e14, 9e14}), "");
    const std::string single = refusal<float>({0, 0, 0, 0, 0, 1e25}); // the largest y is row 0: these are in row 1
    EXPECT_NE(single.find("steps.exr"), std::string::npos) << single;
    EXPECT_NE(single.find("row 1, column 1"), std::string::npos) << single;
    EXPECT_NE(single.find("f32 allows 1e+15"), std::string::npos) << single;
    EXPECT_NE(single.find("precision f64"), std::string::npos) << single;
    EXPECT_EQ(refusal<double>({0, 0, 0, 0, 0, 1e25}), "");
    const std::string twice = refusal<double>({0, 1e200, 0, 0, 0, 0});
    EXPECT_NE(twice.find("row 1, column 1"), std::string::npos) << "its y slope comes first: " << twice;
    EXPECT_NE(twice.find("f64 allows 1e+150"), std::string::npos) << twice;
    EXPECT_EQ(twice.find("precision f64"), std::string::npos) << "there is nothing beyond: " << twice;
    EXPECT_NE(refusal<double>({1e308, 0, -1e308, 0, 0, 0}), "") << "an infinite difference";
    EXPECT_NE(refusal<float>({1e308, 0, -1e308, 0, 0, 0}), "");
}

TEST(HeightMap, SteepestSamplesStillTurnTheForceNotItsLength) {
    SceneImages images;
    const auto image = std::make_shared<HeightImage>();
    image->columns = 2;
    image->rows = 1;
    image->samples = {0, 9e14 * 0.01};
    images.map = image;
    const Scene scene = height_map(sampled(0.01, 0.01));
    const auto single = OwnedLaw<float>(scene, images)(0.001f, 0, -0.001f).force;
    EXPECT_NEAR(single.x, -1, 1e-6);
    EXPECT_NEAR(OwnedLaw<double>(scene, images)(0.001, 0, -0.001).force.x, -1, 1e-12);
}

TEST(HeightMap, NormalsAreContinuousAcrossNodes) {
    auto image = std::make_shared<HeightImage>();
    image->columns = image->rows = 9;
    for (int i = 0; i < 81; ++i)
        image->samples.push_back(1e-4 * ((i * 37) % 11));
    SceneImages images;
    images.map = image;
    const OwnedLaw<double> law(height_map(sampled(0.008, 0.008)), images);
    for (int node = -3; node < 4; ++node)
        for (const double other : {-0.0033, 0.0, 0.00171}) {
            const double at = 0.001 * node, step = 1e-12;
            const auto left = law(at - step, other, -0.001).force, right = law(at + step, other, -0.001).force;
            const auto below = law(other, at - step, -0.001).force, above = law(other, at + step, -0.001).force;
            for (int i = 0; i < 3; ++i) {
                EXPECT_NEAR(left[i], right[i], 1e-8);
                EXPECT_NEAR(below[i], above[i], 1e-8);
            }
        }
}

} // namespace
} // namespace forceshade::test
