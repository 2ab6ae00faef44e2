// What a device cannot do is noticed or refused, and the kernel serves on. Mesa's software driver ends loops after 65
// 535 iterations of an invocation and says nothing; buffers span so much and no more.
#include <gtest/gtest.h>

#include "host/field/engine.h"
#include "tests/gpu/software_device.h"
#include "tests/mesh/shapes.h"
#include "tests/unit/laws.h"

namespace forceshade {
namespace {

using compute::DeviceError;
using test::device_error;

// A driver that no longer ends loops needs another shape of these tests.
class LoopLimit : public test::SoftwareDeviceTest {
protected:
    void SetUp() override {
        if (!on_llvmpipe())
            GTEST_SKIP() << "only llvmpipe ends loops early";
    }

    static constexpr std::uint32_t kRows = 100000;

    static FieldTables<float> small() { return make_tables<float>(Scene{}, {}, Extent::what_varies); }

    // A column of samples, all of which one invocation takes where `rows` says so.
    template <typename T> static FieldTables<T> column(bool varies_in_y) {
        Scene scene;
        scene.grid.size = {1, 1, kRows};
        scene.grid.spacing = {1e-3, 1e-3, 2e-7};
        if (varies_in_y) {
            scene.surface.kind = SurfaceKind::height_map;
            scene.force.shading = Shading::height_map;
            scene.surface.map.function = MapFunction::gaussian;
        }
        return make_tables<T>(scene, {}, Extent::everything);
    }

    template <typename T> static void expect_noticed(bool varies_in_y) {
        const FieldTables<T> tables = column<T>(varies_in_y);
        const test::Way all_rows{.chunk_bytes = std::size_t(64) << 20, .rows = kRows};
        device_error(DeviceError::Kind::unfinished, [&] { kernels().field<T>(all_rows, tables); });
        const test::Way own_choice{.chunk_bytes = std::size_t(64) << 20};
        EXPECT_TRUE(is_equal(kernels().field<T>(own_choice, tables)));
        EXPECT_TRUE(is_equal(kernels().field<float>(all_rows, small()))); // the same kernel object serves on
    }

    template <typename T> static void expect_noticed(layout::uint loop, double bound) {
        test::PathShape shape;
        shape.features.loop = loop;
        shape.features.channels = bound == 0 ? layout::kChannelDepth : 0;
        shape.paths = 3;
        shape.steps = kRows;
        shape.bound = bound;
        shape.depth = bound == 0 ? 0.01 : 1e-3;
        const FieldTables<T> tables =
            test::tables_of<T>(test::analytic(test::bump(test::kRadii[0], 3, Shading::reference)));
        test::PathCase<T> one(tables, nullptr, shape);
        const auto length = [&](std::size_t path) { return one.length(path); };
        device_error(DeviceError::Kind::unfinished, [&] { kernels().paths<T>({.rows = kRows}, one.input(), length); });
        EXPECT_TRUE(is_equal(kernels().paths<T>({}, one.input(), length)));
        compute::PathKernel own_choice(device());
        const auto times = own_choice.explore<T>(
            one.input(), [](const layout::PathChunk<T>&) {},
            [](std::size_t, std::span<const layout::PathMetrics<T>>) {});
        EXPECT_GT(times.dispatches, 4u);
    }
};

TEST_F(LoopLimit, IsNoticedInFields) {
    for (const bool varies_in_y : {false, true}) {
        expect_noticed<float>(varies_in_y);
        expect_noticed<double>(varies_in_y);
    }
}

// The loop of probes that have left their bound is one of its own.
TEST_F(LoopLimit, IsNoticedInPaths) {
    expect_noticed<float>(layout::kLoopOpen, 0.5);
    expect_noticed<double>(layout::kLoopClosed, 0.5);
    expect_noticed<float>(layout::kLoopClosed, 0);
}

// A list of candidates beyond it; what the planner makes never is so long.
TEST_F(LoopLimit, IsNoticedInMeshFields) {
    const FieldTables<float> tables =
        test::tables_of<float>(test::mesh_of(shapes::icosphere(2)), {{2, 2, 2}, glm::dvec3(-0.1), glm::dvec3(0.1)});
    layout::FieldInput<float> input = tables.input();
    std::vector<layout::uint> candidates;
    for (layout::uint i = 0; i < 100000; ++i)
        candidates.push_back(i % 320);
    const std::vector<layout::MeshBlock> blocks{{0, 0, 0, 0, static_cast<layout::uint>(candidates.size())}};
    input.plan = {blocks, candidates, {}};
    compute::MeshKernel kernel(device());
    device_error(DeviceError::Kind::unfinished,
                 [&] { kernel.evaluate<float>(input, [](const layout::FieldChunk<float>&) {}); });
    candidates.resize(320);
    const std::vector<layout::MeshBlock> shorter{{0, 0, 0, 0, 320}};
    input.plan = {shorter, candidates, {}};
    EXPECT_TRUE(is_equal(test::hold_field(kernel, input)));
}

// Steps of a walk, where nothing makes an invocation pause.
TEST_F(LoopLimit, IsNoticedInMeshPaths) {
    const test::Ground ground = test::mesh_of(shapes::icosphere(2));
    const FieldTables<float> tables = test::tables_of<float>(ground);
    test::PathShape shape;
    shape.features.channels = layout::kChannelDepth;
    shape.paths = 3;
    shape.steps = kRows;
    test::PathCase<float> one(tables, ground.mesh(), shape);
    const auto length = [&](std::size_t path) { return one.length(path); };
    device_error(DeviceError::Kind::unfinished, [&] {
        kernels().paths<float>({.rows = kRows, .pause = 1U << 30, .limit = 1U << 30}, one.input(), length);
    });
    EXPECT_TRUE(is_equal(kernels().paths<float>({}, one.input(), length)));
}

class Limits : public test::SoftwareDeviceTest {
protected:
    // Every channel and a texture.
    template <typename T> static FieldTables<T> textured(std::array<std::uint64_t, 3> size, bool texture = true) {
        Scene scene;
        scene.surface.facets = 5;
        scene.force.shading = Shading::reference;
        scene.output.channels = texture ? test::kAllChannels : layout::kChannelForce;
        if (texture)
            scene.texture = TextureSpec{100, {}};
        scene.grid.size = size;
        scene.grid.spacing = {0.03 / double(size[0]), 0.03 / double(size[1]), 0.03 / double(size[2])};
        scene.grid.origin = {-0.0137, -0.0137, -0.02};
        return make_tables<T>(scene, {}, Extent::everything);
    }

    template <typename T> static void expect_refused(const layout::FieldInput<T>& input, const std::string& reason) {
        compute::FieldKernel kernel(device());
        const auto never = [](const layout::FieldChunk<T>&) { FAIL(); };
        const std::string message =
            device_error(DeviceError::Kind::out_of_memory, [&] { kernel.evaluate<T>(input, never); });
        EXPECT_NE(message.find(reason), std::string::npos) << message;
        const FieldTables<T> tables = textured<T>({16, 4, 4});
        EXPECT_TRUE(is_equal(test::hold_field(kernel, tables.input()))) << "after a refusal";
    }
};

// 384 MiB of results, three times what a storage buffer of this device may span.
TEST_F(Limits, AFieldMayBeLargerThanABuffer) {
    if (!on_llvmpipe())
        GTEST_SKIP() << "this device's buffers span more";
    const FieldTables<double> tables = textured<double>({512, 512, 64}, false);
    const layout::FieldInput<double> input = tables.input();
    compute::KernelOptions options;
    options.chunk_bytes = options.software_chunk_bytes = std::size_t(1) << 30;
    compute::FieldKernel kernel(device(), options);
    test::HeldField<double> held(input);
    std::size_t largest = 0;
    const auto times = kernel.evaluate<double>(input, [&](const layout::FieldChunk<double>& chunk) {
        largest = std::max(largest, chunk.force.size_bytes());
        held.add(chunk);
    });
    EXPECT_TRUE(is_equal(held.result()));
    EXPECT_EQ(held.result().samples, 512u * 512 * 64);
    EXPECT_GE(times.dispatches, 3u);
    EXPECT_LE(largest, device().report().buffer_range);
}

TEST_F(Limits, ARowThatNoBufferHoldsIsRefused) {
    if (!on_llvmpipe())
        GTEST_SKIP() << "this device's buffers span more";
    const std::vector<double> wide(12000000, 0.0), one(1, -0.001);
    layout::FieldInput<double> input{};
    input.law.features.surface = layout::kSurfaceHeightMap;
    input.x = wide;
    input.y = input.z = one;
    expect_refused(input, "one row of 12000000 samples takes 288000000 bytes");
}

TEST_F(Limits, ATableThatNoBufferHoldsIsRefused) {
    if (!on_llvmpipe())
        GTEST_SKIP() << "this device's buffers span more";
    const std::vector<float> vertices(40000001, 0.0f), one(1, 0.0f);
    layout::FieldInput<float> input{};
    input.law.params.facets = 40000000;
    input.law.facet_vertices = vertices;
    input.x = input.y = input.z = one;
    expect_refused(input, "160000004 bytes");
}

TEST_F(Limits, FacetsWithTooManyCornersAreRefused) {
    const FieldTables<float> tables = test::tables_of<float>(test::mesh_of(shapes::cube(false), Shading::mean_value));
    layout::FieldInput<float> input = tables.input();
    const std::vector<layout::uint> begins{0, 4, 200004};
    input.law.mesh.facet_begins = begins;
    compute::MeshKernel kernel(device());
    const std::string message = device_error(DeviceError::Kind::unsupported, [&] {
        kernel.evaluate<float>(input, [](const layout::FieldChunk<float>&) {});
    });
    EXPECT_NE(message.find("200000"), std::string::npos) << message;
}

// What the consumer throws comes through with chunks still in flight, and the kernel serves on.
TEST_F(Limits, AConsumerMayThrow) {
    compute::KernelOptions options;
    options.chunk_bytes = options.software_chunk_bytes = 20000;
    compute::FieldKernel kernel(device(), options);
    const FieldTables<float> tables = textured<float>({37, 9, 23});
    const layout::FieldInput<float> input = tables.input();
    int chunks = 0;
    const auto fails = [&](const layout::FieldChunk<float>&) {
        if (++chunks == 2)
            throw std::runtime_error("disk full");
    };
    EXPECT_THROW(kernel.evaluate<float>(input, fails), std::runtime_error);
    EXPECT_TRUE(is_equal(test::hold_field(kernel, input)));
}

// What the command line calls: empty chunks without channels, and the same metrics.
TEST_F(Limits, AnEngineTakesPathsWithoutChannels) {
    EngineOptions options;
    options.gpu = test::tested_gpu();
    options.needs_f64 = true;
    const std::unique_ptr<Engine> engine = make_engine(options);
    test::PathShape shape;
    shape.features.loop = layout::kLoopClosed;
    shape.paths = 3;
    shape.steps = 500;
    const FieldTables<double> tables =
        test::tables_of<double>(test::analytic(test::bump(test::kRadii[0], 3, Shading::reference)));
    test::PathCase<double> one(tables, nullptr, shape);
    const layout::PathInput<double> input = one.input();
    test::Sentinels sentinels;
    test::HeldPaths<double> held(input, sentinels);
    engine->explore(
        input,
        [](const layout::PathChunk<double>& chunk) {
            EXPECT_TRUE(chunk.force.empty() && chunk.position.empty() && chunk.proxy.empty());
        },
        [&](std::size_t first, std::span<const layout::PathMetrics<double>> some) { held.add(first, some); });
    EXPECT_TRUE(is_equal(held.result()));
}

} // namespace
} // namespace forceshade
