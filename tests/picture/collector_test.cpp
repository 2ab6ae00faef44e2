#include "host/picture/values.h"

#include <cmath>
#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace forceshade::picture {
namespace {

// A force that tells its voxel: no two are equal, and floats hold it exactly.
std::array<double, 3> marked(std::uint64_t i, std::uint64_t j, std::uint64_t k) {
    return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k + 1)};
}

struct ChunkShape {
    std::size_t padding;      // samples that each row is stored longer than it is
    std::size_t rows, levels; // y and z per chunk, at most
};

template <typename real>
void add_chunk(SliceCollector& collector, std::size_t x_count, std::size_t padding, std::size_t y_first,
               std::size_t y_count, std::size_t z_first, std::size_t z_count) {
    const std::size_t pitch = x_count + padding;
    std::vector<real> force(3 * pitch * y_count * z_count, real(-1));
    for (std::size_t k = 0; k < z_count; ++k)
        for (std::size_t j = 0; j < y_count; ++j)
            for (std::size_t i = 0; i < x_count; ++i) {
                const auto value = marked(i, y_first + j, z_first + k);
                for (std::size_t axis = 0; axis < 3; ++axis)
                    force[3 * ((k * y_count + j) * pitch + i) + axis] = static_cast<real>(value[axis]);
            }
    collector.add(layout::FieldChunk<real>{x_count, pitch, y_first, y_count, z_first, z_count, force, {}, {}, {}, {}});
}

template <typename real> SliceCollector feed(const GridSpec& grid, ChunkShape shape, bool repeat_y = false) {
    SliceCollector collector(grid, repeat_y);
    const std::size_t ny = repeat_y ? 1 : grid.size[1], nz = grid.size[2];
    for (std::size_t z = 0; z < nz; z += shape.levels)
        for (std::size_t y = 0; y < ny; y += shape.rows)
            add_chunk<real>(collector, grid.size[0], shape.padding, y, std::min(shape.rows, ny - y), z,
                            std::min(shape.levels, nz - z));
    return collector;
}

std::uint64_t index_of(double coordinate, const GridSpec& grid, std::size_t axis) {
    return static_cast<std::uint64_t>(std::llround((coordinate - grid.origin[axis]) / grid.spacing[axis]));
}

// Every sample kept must be the one at the coordinates that the slice states.
void expect_right(const SliceCollector& collector, const GridSpec& grid, bool repeat_y) {
    const FieldSlice& xz = collector.slice();
    const std::uint64_t middle = (grid.size[1] - 1) / 2;
    ASSERT_EQ(index_of(xz.axes.at, grid, 1), middle);
    for (std::size_t v = 0; v < xz.axes.v.size(); ++v)
        for (std::size_t u = 0; u < xz.axes.u.size(); ++u)
            ASSERT_EQ(xz.force[v * xz.axes.u.size() + u],
                      marked(index_of(xz.axes.u[u], grid, 0), repeat_y ? 0 : middle, index_of(xz.axes.v[v], grid, 2)));
    for (const ValueSlice& tile : collector.tiles())
        for (std::size_t v = 0; v < tile.axes.v.size(); ++v)
            for (std::size_t u = 0; u < tile.axes.u.size(); ++u) {
                const auto force =
                    marked(index_of(tile.axes.u[u], grid, 0), repeat_y ? 0 : index_of(tile.axes.v[v], grid, 1),
                           index_of(tile.axes.at, grid, 2));
                ASSERT_EQ(tile.value[v * tile.axes.u.size() + u], std::hypot(force[0], force[1], force[2]));
            }
}

TEST(SliceCollector, PicksTheSamplesItStates) {
    ASSERT_TRUE(rc::check([] {
        const GridSpec grid{{*rc::gen::inRange<std::uint64_t>(1, 600), *rc::gen::inRange<std::uint64_t>(1, 12),
                             *rc::gen::inRange<std::uint64_t>(1, 40)},
                            {-0.025, 1, -0.01},
                            {2e-4, 3e-4, 1e-3}};
        const ChunkShape shape{*rc::gen::inRange<std::size_t>(0, 3), *rc::gen::inRange<std::size_t>(1, 8),
                               *rc::gen::inRange<std::size_t>(1, 9)};
        const bool repeat_y = *rc::gen::arbitrary<bool>();
        if (*rc::gen::arbitrary<bool>())
            expect_right(feed<float>(grid, shape, repeat_y), grid, repeat_y);
        else
            expect_right(feed<double>(grid, shape, repeat_y), grid, repeat_y);
        RC_ASSERT(!::testing::Test::HasFatalFailure());
    }));
}

TEST(SliceCollector, ShapesAreThoseOfTheGrid) {
    const GridSpec grid{{1000, 3, 128}, {0, 0, -0.01}, {1e-4, 2e-4, 3e-4}};
    const SliceCollector collector = feed<float>(grid, {1, 2, 13});
    EXPECT_EQ(collector.slice().axes.u.size(), kMaxSliceSamples);
    EXPECT_EQ(collector.slice().axes.v.size(), 128U);
    EXPECT_DOUBLE_EQ(collector.slice().axes.u.back(), 0.0999);
    EXPECT_DOUBLE_EQ(collector.slice().axes.at_spacing, 2e-4);
    ASSERT_EQ(collector.tiles().size(), kMaxTiles);
    EXPECT_EQ(collector.tiles()[0].axes.v.size(), 3U);
    EXPECT_DOUBLE_EQ(collector.tiles().front().axes.at, -0.01);
    EXPECT_DOUBLE_EQ(collector.tiles().back().axes.at, -0.01 + 127 * 3e-4);
}

TEST(SliceCollector, MemoryIsBoundedWhateverTheGrid) {
    const std::uint64_t huge = std::uint64_t{1} << 40U;
    const SliceCollector collector(GridSpec{{huge, huge, huge}, {0, 0, 0}, {1e-9, 1e-9, 1e-9}}, false);
    std::size_t bytes = collector.slice().force.size() * sizeof(collector.slice().force[0]);
    for (const ValueSlice& tile : collector.tiles())
        bytes += (tile.value.size() + tile.axes.u.size() + tile.axes.v.size()) * sizeof(double);
    EXPECT_LT(bytes, 24U << 20U);
}

TEST(EvenIndices, IncludeBothEndsAndAreEven) {
    ASSERT_TRUE(rc::check([] {
        const auto count = *rc::gen::inRange<std::uint64_t>(1, std::uint64_t{1} << 62U);
        const auto wanted = *rc::gen::inRange<std::size_t>(2, 300);
        const auto indices = even_indices(count, wanted);
        RC_ASSERT(indices.size() == std::min<std::uint64_t>(count, wanted));
        RC_ASSERT(indices.front() == 0 && indices.back() == count - 1);
        const std::uint64_t step = indices.size() > 1 ? (count - 1) / (indices.size() - 1) : 0;
        for (std::size_t i = 1; i < indices.size(); ++i)
            RC_ASSERT(indices[i] - indices[i - 1] == step || indices[i] - indices[i - 1] == step + 1);
    }));
    EXPECT_EQ(even_indices(5, 12), (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
    EXPECT_EQ(even_indices(128, 12).size(), 12U);
}

} // namespace
} // namespace forceshade::picture
