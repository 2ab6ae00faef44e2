// The oracle in double precision against the closed forms, which are derived differently; and the gradients of height
// maps (G3 and L5).
#include <cmath>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/field/prepared_case.h"
#include "host/norm.h"
#include "host/output/height_image.h"
#include "host/referee/referee.h"
#include "tests/io/folder.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

using testing::says;

void expect_agreement(const Scene& scene, const SceneImages& images = {}) {
    const OwnedLaw<double> law(scene, images);
    const brute::Referee referee(scene, images);
    std::mt19937_64 random(5);
    const auto between = [&](double low, double high) {
        return std::lerp(low, high, static_cast<double>(random() >> 11) / 0x1p53);
    };
    for (int i = 0; i < 400; ++i) {
        const double x = between(-0.016, 0.016), y = between(-0.006, 0.006), z = between(-0.008, 0.004);
        const auto oracle = law(x, y, z);
        const brute::Answer answer = referee.at(referee.column(x, y), z);
        const double scale =
            1e-12 * (1 + norm(double(answer.force[0]), double(answer.force[1]), double(answer.force[2])));
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(oracle.force[k], double(answer.force[k]), scale);
            EXPECT_NEAR(oracle.unshaded[k], double(answer.unshaded[k]), scale);
            EXPECT_NEAR(oracle.proxy[k], double(answer.proxy[k]), 1e-14);
        }
        EXPECT_NEAR(oracle.depth, double(answer.depth), 1e-14);
        EXPECT_EQ(oracle.facet, answer.facet);
        if (scene.force.shading == Shading::reference && !scene.texture) { // it keeps the magnitude
            EXPECT_NEAR(norm(oracle.force), norm(oracle.unshaded), 1e-15 * norm(oracle.unshaded));
        }
    }
}

TEST(Referee, Bumps) {
    for (const double radius : {1.001 * kHalfWidth, kRadii[0], kRadii[2]})
        for (const std::uint32_t facets : {1u, 2u, 3u, 17u})
            for (const Shading shading : {Shading::none, Shading::reference})
                for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal})
                    for (const ReferenceDirection reference : {ReferenceDirection::normal, ReferenceDirection::radial})
                        for (const FacetSpacing spacing : {FacetSpacing::equal_arc, FacetSpacing::equal_x}) {
                            Scene scene = bump(radius, facets, shading);
                            scene.force.depth = depth;
                            scene.force.reference = reference;
                            scene.surface.facet_spacing = spacing;
                            expect_agreement(scene);
                        }
}

TEST(Referee, CylinderBumps) {
    for (const double radius : {kHalfWidth, kRadii[0], kRadii[1], 1e4 * kHalfWidth})
        expect_agreement(cylinder_bump(radius));
}

std::shared_ptr<HeightImage> noise(std::size_t columns, std::size_t rows) {
    auto image = std::make_shared<HeightImage>();
    image->columns = columns;
    image->rows = rows;
    std::mt19937_64 random(columns * 100 + rows);
    for (std::size_t i = 0; i < columns * rows; ++i)
        image->samples.push_back(static_cast<double>(random() >> 11) / 0x1p53);
    return image;
}

TEST(Referee, HeightMapsAndTextures) {
    for (const MapFunction function :
         {MapFunction::cylinder, MapFunction::dip, MapFunction::sine, MapFunction::gaussian, MapFunction::file}) {
        HeightMapSpec map;
        map.function = function;
        map.radius = function == MapFunction::gaussian ? 0.004 : kRadii[0];
        map.width = function == MapFunction::sine ? 0.0037 : 2 * kHalfWidth;
        map.size = {0.02, 0.008};
        map.height = 0.0005;
        SceneImages images;
        images.map = images.texture = noise(13, 8);
        expect_agreement(height_map(map), images);
        Scene textured = bump(kRadii[0], 3, Shading::reference);
        textured.texture = TextureSpec{250, map};
        expect_agreement(textured, images);
        textured.surface.kind = SurfaceKind::cylinder_bump;
        textured.force.shading = Shading::none;
        expect_agreement(textured, images);
    }
}

TEST(HeightMap, FlatBeyondTheCylinder) {
    HeightMapSpec map;
    map.function = MapFunction::cylinder;
    map.width = 2 * kHalfWidth;
    map.radius = kRadii[0];
    const OwnedLaw<double> law(height_map(map));
    EXPECT_EQ(law(kHalfWidth, 0, -0.001).force.x, 0);
    EXPECT_EQ(law(-0.02, 0, -0.001).force.z, 1);
}

HeightMapSpec sampled(double size_x, double size_y) {
    HeightMapSpec map;
    map.function = MapFunction::file;
    map.size = {size_x, size_y};
    map.height = 1;
    return map;
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
    return testing::message_of<UsageError>([&] { map_gradients<T>(samples, 3, 2, 2.0, 1.0, 1.0, "steps.exr"); });
}

TEST(HeightMap, SlopesWhoseSquareOverflowsAreRefusedWithTheirPixel) {
    EXPECT_EQ(refusal<float>({0, 0, 0, 0, 9e14, 9e14}), "");
    const std::string single = refusal<float>({0, 0, 0, 0, 0, 1e25}); // the largest y is row 0: these are in row 1
    EXPECT_TRUE(says(single, "steps.exr", "row 1, column 1", "f32 allows 1e+15", "precision f64"));
    EXPECT_EQ(refusal<double>({0, 0, 0, 0, 0, 1e25}), "");
    const std::string twice = refusal<double>({0, 1e200, 0, 0, 0, 0});
    EXPECT_TRUE(says(twice, "row 1, column 1")) << "its y slope comes first: " << twice;
    EXPECT_TRUE(says(twice, "f64 allows 1e+150"));
    EXPECT_FALSE(says(twice, "precision f64")) << "there is nothing beyond: " << twice;
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

} // namespace
} // namespace forceshade::test
