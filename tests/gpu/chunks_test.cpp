// However a grid is cut into dispatches, the field has the oracle's bits; and what no cut makes possible is refused.
#include <gtest/gtest.h>

#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::kAllChannels;

// Every channel, a texture, and a force that depends on y where asked: kernels order their rows accordingly.
Scene scene_of(std::array<std::uint64_t, 3> size, bool varies_in_y) {
    Scene scene;
    scene.surface.facets = 5;
    scene.force.shading = Shading::reference;
    scene.output.channels = kAllChannels;
    scene.texture.emplace();
    scene.texture->stiffness = 100;
    scene.texture->map.function = varies_in_y ? MapFunction::gaussian : MapFunction::sine;
    scene.grid.size = size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        scene.grid.spacing[axis] = 0.03 / static_cast<double>(size[axis]);
        scene.grid.origin[axis] = axis == 2 ? -0.02 : -0.0137;
    }
    return scene;
}

struct Cut {
    std::size_t chunk_bytes;
    std::uint32_t rows;
    bool packed, staged;
};

class Chunks : public test::SoftwareDeviceTest {
protected:
    static compute::FieldKernelOptions options(const Cut& cut) {
        compute::FieldKernelOptions options;
        options.chunk_bytes = options.software_chunk_bytes = cut.chunk_bytes;
        options.rows = cut.rows;
        options.packed_stores = cut.packed;
        options.force_staging = cut.staged;
        return options;
    }

    template <typename T> static void hold(compute::FieldKernel& kernel, const Scene& scene, const std::string& what) {
        const FieldTables<T> tables = make_tables<T>(scene, {}, Extent::everything);
        EXPECT_TRUE(is_equal(test::hold_against_oracle(kernel, tables.input()))) << what;
    }

    static void hold_everywhere(const Scene& scene, const Cut& cut) {
        compute::FieldKernel kernel(device(), options(cut));
        const std::string what = fmt::format("{} x {} x {} in chunks of {} bytes, {} rows{}{}", scene.grid.size[0],
                                             scene.grid.size[1], scene.grid.size[2], cut.chunk_bytes, cut.rows,
                                             cut.packed ? ", packed" : "", cut.staged ? ", staged" : "");
        hold<float>(kernel, scene, what + ", f32");
        hold<double>(kernel, scene, what + ", f64");
    }

    template <typename Call> static std::string device_error(compute::DeviceError::Kind kind, const Call& call) {
        try {
            call();
        } catch (const compute::DeviceError& error) {
            EXPECT_EQ(error.kind(), kind) << error.what();
            return error.what();
        }
        return "(no error)";
    }
};

TEST_F(Chunks, OddShapes) {
    for (const auto size : {std::array<std::uint64_t, 3>{1, 1, 1},
                            {7, 1, 1},
                            {1, 9, 1},
                            {1, 1, 33},
                            {9, 5, 3},
                            {37, 2, 129},
                            {64, 16, 17},
                            {65, 64, 3},
                            {301, 3, 5},
                            {1031, 1, 2},
                            {3, 300, 7}})
        for (const bool varies_in_y : {false, true})
            hold_everywhere(scene_of(size, varies_in_y), {std::size_t(1) << 20, 0, true, false});
}

// From one row a dispatch to all in one.
TEST_F(Chunks, EveryChunkSize) {
    for (const bool varies_in_y : {false, true})
        for (const std::size_t bytes : {1u, 5000u, 20000u, 77777u, 300000u, 32u << 20})
            hold_everywhere(scene_of({37, 9, 23}, varies_in_y), {bytes, 0, true, bytes == 20000u});
}

TEST_F(Chunks, EveryWayToStore) {
    for (const bool varies_in_y : {false, true})
        for (const bool packed : {false, true})
            for (const bool staged : {false, true})
                for (const std::uint32_t rows : {1u, 3u, 1000u})
                    hold_everywhere(scene_of({45, 11, 13}, varies_in_y), {60000, rows, packed, staged});
}

// Each set of channels binds other buffers.
TEST_F(Chunks, EverySetOfChannels) {
    for (const bool packed : {false, true}) {
        compute::FieldKernel kernel(device(), options({100000, 0, packed, packed}));
        for (layout::uint channels = 1; channels <= kAllChannels; channels += 2) {
            Scene scene = scene_of({21, 6, 9}, false);
            scene.output.channels = channels;
            hold<float>(kernel, scene, fmt::format("channels {}", channels));
        }
    }
}

// 384 MiB of results, three times what a storage buffer of this device may span.
TEST_F(Chunks, LargerThanABufferMayBe) {
    Scene scene = scene_of({512, 512, 64}, false);
    scene.texture.reset();
    scene.output.channels = layout::kChannelForce;
    const std::size_t unlimited = std::size_t(1) << 30;
    compute::FieldKernel kernel(device(), options({unlimited, 0, true, false}));
    const FieldTables<double> tables = make_tables<double>(scene, {}, Extent::everything);
    test::BitComparer<double> comparer(tables.input());
    std::size_t largest = 0;
    const auto times = kernel.evaluate<double>(tables.input(), [&](const layout::FieldChunk<double>& chunk) {
        largest = std::max(largest, chunk.force.size_bytes());
        comparer.add(chunk);
    });
    EXPECT_TRUE(is_equal(comparer.result()));
    EXPECT_EQ(comparer.result().voxels, 512u * 512 * 64);
    EXPECT_GE(times.dispatches, 3u);
    EXPECT_LE(largest, device().report().buffer_range);
}

TEST_F(Chunks, ARowThatNoBufferHoldsIsRefused) {
    const std::vector<double> wide(12000000, 0.0), one(1, -0.001);
    layout::FieldInput<double> input{};
    input.law.features.surface = layout::kSurfaceHeightMap;
    input.x = wide;
    input.y = input.z = one;
    compute::FieldKernel kernel(device());
    const auto never = [](const layout::FieldChunk<double>&) { FAIL(); };
    const std::string message =
        device_error(compute::DeviceError::Kind::out_of_memory, [&] { kernel.evaluate<double>(input, never); });
    EXPECT_NE(message.find("one row of 12000000 samples takes 288000000 bytes"), std::string::npos) << message;
    hold<double>(kernel, scene_of({16, 4, 4}, false), "after a refusal");
}

TEST_F(Chunks, ATableThatNoBufferHoldsIsRefused) {
    const std::vector<float> vertices(40000001, 0.0f), one(1, 0.0f);
    layout::FieldInput<float> input{};
    input.law.params.facets = 40000000;
    input.law.facet_vertices = vertices;
    input.x = input.y = input.z = one;
    compute::FieldKernel kernel(device());
    const auto never = [](const layout::FieldChunk<float>&) { FAIL(); };
    const std::string message =
        device_error(compute::DeviceError::Kind::out_of_memory, [&] { kernel.evaluate<float>(input, never); });
    EXPECT_NE(message.find("160000004 bytes"), std::string::npos) << message;
    EXPECT_NE(message.find("fewer facets"), std::string::npos) << message;
    hold<float>(kernel, scene_of({16, 4, 4}, false), "after a refusal");
}

// What the consumer throws comes through with chunks still in flight, and the kernel serves on.
TEST_F(Chunks, AConsumerMayThrow) {
    compute::FieldKernel kernel(device(), options({20000, 0, true, false}));
    const FieldTables<float> tables = make_tables<float>(scene_of({37, 9, 23}, true), {}, Extent::everything);
    int chunks = 0;
    const auto fails = [&](const layout::FieldChunk<float>&) {
        if (++chunks == 2)
            throw std::runtime_error("disk full");
    };
    EXPECT_THROW(kernel.evaluate<float>(tables.input(), fails), std::runtime_error);
    EXPECT_TRUE(is_equal(test::hold_against_oracle(kernel, tables.input())));
}

} // namespace
} // namespace forceshade
