// The oracle in double precision against the closed forms, which are derived differently.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/norm.h"
#include "host/output/height_image.h"
#include "host/referee/referee.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

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

} // namespace
} // namespace forceshade::test
