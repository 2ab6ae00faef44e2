// Fields to draw: a two-facet bump by the laws, and the odd cases that a picture must survive.
#pragma once

#include "host/picture/picture.h"
#include "host/picture/values.h"
#include "host/scene/scene.h"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace forceshade::picture::test {

/// Every text stands on the sheet and clear of the others.
inline void expect_clear_texts(const Picture& picture) {
    for (std::size_t i = 0; i < picture.texts.size(); ++i) {
        const auto& [text, a] = picture.texts[i];
        EXPECT_TRUE(a.x >= 0 && a.y >= 0 && a.x + a.width <= picture.width && a.y + a.height <= picture.height) << text;
        for (std::size_t k = 0; k < i; ++k) {
            const Box& b = picture.texts[k].ink;
            EXPECT_FALSE(a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height)
                << text << " over " << picture.texts[k].text;
        }
    }
}

/// Force (N) of a position (m).
using Law = std::function<std::array<double, 3>(double x, double y, double z)>;

/// L3 (shaded = false) or L4 (true): two facets over W = 1000 mil, R = 600 mil, vertical depth.
Law two_facet_bump(double stiffness /* N/m */, bool shaded);
/// The outlines of that bump: facets, and the cylinder.
SurfaceLines two_facet_lines();

/// The slices of a law over a grid as the collector would hand them over, fed plane by plane.
struct Slices {
    FieldSlice xz;
    std::vector<ValueSlice> tiles;
};
Slices collect(const GridSpec& grid, const Law& law, bool repeat_y = false, const SliceChoice& choice = {});

struct Case {
    std::string file; // name for a file
    std::string name; // the title
    GridSpec grid;
    Law law;
    SurfaceLines lines;
};
/// Ordinary and odd ones, drawn within seconds.
std::vector<Case> cases();

} // namespace forceshade::picture::test
