// Kernels write their own rows and nothing else. Buffers are kept from field to field, and on the software device a
// chunk is the buffer itself: what a large field left behind the rows of a small one must still be there.
#include <gtest/gtest.h>

#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

// A force everywhere, so that no sentinel is 0.
Scene pressed(std::array<std::uint64_t, 3> size) {
    Scene scene;
    scene.surface.facets = 3;
    scene.force.shading = Shading::reference;
    scene.output.channels = test::kAllChannels;
    scene.grid.size = size;
    scene.grid.spacing = {1e-4, 1e-4, 1e-5};
    return scene;
}

class Sentinel : public test::SoftwareDeviceTest {
protected:
    template <typename T> struct Channel {
        const T* data = nullptr;
        std::size_t size = 0;
        Channel() = default;
        explicit Channel(std::span<const T> from) : data(from.data()), size(from.size()) {}
    };

    // Where the channels of a field of one chunk lie.
    template <typename T> struct Place {
        Channel<T> force, depth, proxy, unshaded;
        Channel<layout::uint> facet;
    };

    template <typename T> static Place<T> evaluate(compute::FieldKernel& kernel, const Scene& scene) {
        Place<T> place;
        int chunks = 0;
        const FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
        kernel.evaluate<T>(tables.input(), [&](const layout::FieldChunk<T>& chunk) {
            ++chunks;
            place = {Channel<T>(chunk.force), Channel<T>(chunk.depth), Channel<T>(chunk.proxy),
                     Channel<T>(chunk.unshaded), Channel<layout::uint>(chunk.facet)};
        });
        EXPECT_EQ(chunks, 1);
        return place;
    }

    template <typename T>
    static void expect_untouched(const Channel<T>& large, const Channel<T>& small, const std::vector<T>& before) {
        ASSERT_EQ(large.data, small.data) << "buffers are not kept: this test sees nothing";
        ASSERT_LT(small.size, large.size);
        EXPECT_EQ(
            std::memcmp(large.data + small.size, before.data() + small.size, (large.size - small.size) * sizeof(T)), 0);
    }

    template <typename T> static void hold(bool packed, std::array<std::uint64_t, 3> size) {
        compute::FieldKernelOptions options;
        options.packed_stores = packed;
        options.software_chunk_bytes = options.chunk_bytes;
        compute::FieldKernel kernel(device(), options);
        const Place<T> large = evaluate<T>(kernel, pressed({320, 9, 40}));
        const auto copy = [](const auto& channel) { return std::vector(channel.data, channel.data + channel.size); };
        const auto force = copy(large.force), depth = copy(large.depth), proxy = copy(large.proxy),
                   unshaded = copy(large.unshaded);
        const auto facet = copy(large.facet);
        const Place<T> small = evaluate<T>(kernel, pressed(size));
        expect_untouched(large.force, small.force, force);
        expect_untouched(large.depth, small.depth, depth);
        expect_untouched(large.proxy, small.proxy, proxy);
        expect_untouched(large.unshaded, small.unshaded, unshaded);
        expect_untouched(large.facet, small.facet, facet);
    }
};

TEST_F(Sentinel, NothingIsWrittenBehindTheRows) {
    for (const auto size : {std::array<std::uint64_t, 3>{1, 1, 1},
                            {3, 1, 1},
                            {9, 5, 3},
                            {63, 7, 17},
                            {300, 9, 39},
                            {64, 1, 16},
                            {257, 2, 1}}) {
        hold<float>(true, size);
        hold<float>(false, size);
        hold<double>(true, size);
    }
}

} // namespace
} // namespace forceshade
