// What hardware has and software has not, by limits that the software device is given (compute/device_limits.h): the
// same bits, or an error that says what is the matter. More rows of the table run so in gpu_as_hardware.
#include <cstdlib>

#include <gtest/gtest.h>

#include "compute/device_limits.h"
#include "tests/gpu/software_device.h"
#include "tests/mesh/shapes.h"
#include "tests/unit/laws.h"

namespace forceshade {
namespace {

using compute::DeviceError;
using compute::read_device_limits;
using test::device_error;
using test::Held;
using test::Row;

class DeviceLimits : public ::testing::Test {
protected:
    void SetUp() override {
        if (std::getenv(compute::kLimitsVariable))
            GTEST_SKIP() << "the device is limited already";
    }
    void TearDown() override { unsetenv(compute::kLimitsVariable); }

    static compute::Device limited(const std::string& limits) {
        setenv(compute::kLimitsVariable, limits.c_str(), 1);
        return test::open_software_device(test::has_validation_layer());
    }

    // One of each kernel, in few dispatches.
    static std::vector<Row> a_row_of_each() {
        const test::MakeGround bump = [] {
            Scene scene = test::bump(test::kRadii[0], 5, Shading::reference);
            scene.output.channels = test::kAllChannels;
            scene.grid.size = {33, 10, 50};
            scene.grid.origin = {-0.015, -0.002, -0.004};
            scene.grid.spacing = {0.001, 0.0001, 0.0001};
            return test::analytic(scene);
        };
        const test::MakeGround ball = [] { return test::mesh_of(shapes::icosphere(2), Shading::mean_value); };
        test::PathShape shape;
        shape.features.loop = layout::kLoopClosed;
        shape.features.channels = layout::kChannelForce | layout::kChannelDepth;
        shape.paths = 20;
        shape.steps = 300;
        return {{.name = "field", .ground = bump},
                {.name = "mesh_field", .ground = ball, .grid = {{17, 18, 19}}},
                {.name = "paths", .ground = bump, .shape = shape},
                {.name = "mesh_paths", .ground = ball, .shape = shape}};
    }

    static void expect_bits(const std::string& limits) {
        compute::Device device = limited(limits);
        test::Kernels kernels(device);
        for (const Row& row : a_row_of_each()) {
            for (const Held& held : kernels.hold<float>(row))
                EXPECT_TRUE(is_equal(held)) << row.name << " with " << limits;
            if (!device.report().f64)
                continue;
            for (const Held& held : kernels.hold<double>(row))
                EXPECT_TRUE(is_equal(held)) << row.name << " in f64 with " << limits;
        }
        for (const std::string& message : device.validation_messages())
            ADD_FAILURE() << message;
    }
};

TEST_F(DeviceLimits, AreRead) {
    const auto limits = read_device_limits("no-f64,flush,memory=268435456,lost-at=3,longest=0.5,group=128,buffer=1024");
    EXPECT_TRUE(limits.no_f64 && limits.flush);
    EXPECT_FALSE(limits.no_int64 || limits.incoherent);
    EXPECT_EQ(limits.memory, 268435456u);
    EXPECT_EQ(limits.lost_at, 3u);
    EXPECT_EQ(limits.longest, 0.5);
    EXPECT_EQ(limits.group_invocations, 128u);
    EXPECT_EQ(limits.buffer_range, 1024u);
    for (const char* wrong :
         {"no-f32", "memory", "memory=", "memory=-1", "memory=0", "memory=1k", "longest=nan", ",no-f64"})
        device_error(DeviceError::Kind::unsupported, [&] { read_device_limits(wrong); });
}

TEST_F(DeviceLimits, LeaveTheBits) {
    for (const char* limits : {"no-int64", "no-f64,no-int64", "incoherent", "memory=16777216", "buffer=65536",
                               "group=1", "longest=60", "no-int64,incoherent,memory=16777216,group=32,longest=60"})
        expect_bits(limits);
}

TEST_F(DeviceLimits, ADeviceWithoutDoublePrecisionIsRefusedWhereItIsAskedFor) {
    setenv(compute::kLimitsVariable, "no-f64", 1);
    compute::DeviceOptions options;
    options.wanted = test::tested_gpu();
    EXPECT_NE(compute::Device(options).report().driver.find("no-f64"), std::string::npos)
        << "reports say that the device is limited";
    options.needs_f64 = true;
    const std::string said = device_error(DeviceError::Kind::no_such_device, [&] { compute::Device{options}; });
    EXPECT_NE(said.find("no double precision"), std::string::npos) << said;
}

// Wherever it goes, the kernel says so; another device serves on.
TEST_F(DeviceLimits, ALostDeviceIsSaidToBe) {
    for (const int at : {1, 2, 3, 5, 9})
        for (const Row& row : a_row_of_each()) {
            Row in_parts = row;
            in_parts.ways = {{.chunk_bytes = 20000}};
            compute::Device device = limited(fmt::format("lost-at={}", at));
            test::Kernels kernels(device);
            const std::string said =
                device_error(DeviceError::Kind::device_lost, [&] { kernels.hold<float>(in_parts); });
            EXPECT_NE(said.find("the device was lost"), std::string::npos) << said;
        }
}

TEST_F(DeviceLimits, MemoryThatHoldsNothingIsSaidToBe) {
    for (const Row& row : a_row_of_each()) {
        compute::Device device = limited("memory=1000");
        test::Kernels kernels(device);
        const std::string said = device_error(DeviceError::Kind::out_of_memory, [&] { kernels.hold<float>(row); });
        EXPECT_NE(said.find("out of device memory"), std::string::npos) << said;
    }
}

// Whichever buffer finds no memory: an error, or smaller dispatches and the same bits.
TEST_F(DeviceLimits, SmallerDispatchesServeWhereMemoryIsShort) {
    const std::map<std::string, int> tables{{"field", 4}, {"mesh_field", 6}, {"paths", 5}, {"mesh_paths", 6}};
    for (const Row& row : a_row_of_each()) {
        int served = 0, ended = 0;
        for (int at = 1; at < 40; at += 3) {
            compute::Device device = limited(fmt::format("memory=1073741824,short-at={}", at));
            test::Kernels kernels(device);
            try {
                for (const Held& held : kernels.hold<float>(row))
                    EXPECT_TRUE(is_equal(held)) << row.name << " at buffer " << at;
                ++served;
            } catch (const DeviceError& error) {
                EXPECT_EQ(error.kind(), DeviceError::Kind::out_of_memory) << error.what();
                EXPECT_NE(std::string(error.what()).find("while allocating a buffer of"), std::string::npos);
                for (const Held& held : kernels.hold<float>(row))
                    EXPECT_TRUE(is_equal(held)) << row.name << ": the kernel serves on, after buffer " << at;
                ++ended;
            }
        }
        fmt::print("{}: {} served, {} ended with an error\n", row.name, served, ended);
        EXPECT_LE(ended, tables.at(row.name)) << "tables alone have no smaller form";
    }
}

// What found no memory is smaller when it is tried again.
TEST_F(DeviceLimits, ADispatchThatFindsNoMemoryIsHalved) {
    const FieldTables<float> tables = test::tables_of<float>(a_row_of_each().front().ground());
    const auto dispatches = [&](const std::string& limits) {
        compute::Device device = limited(limits);
        compute::KernelOptions options;
        options.chunk_bytes = options.software_chunk_bytes = 400'000;
        compute::FieldKernel kernel(device, options);
        return kernel.evaluate<float>(tables.input(), [](const layout::FieldChunk<float>&) {}).dispatches;
    };
    const std::uint64_t whole = dispatches("memory=1073741824");
    std::uint64_t most = 0;
    for (int at = 1; at < 24; ++at)
        try {
            most = std::max(most, dispatches(fmt::format("memory=1073741824,short-at={}", at)));
        } catch (const DeviceError&) { // a table's
        }
    EXPECT_GT(most, whole);
}

// A dispatch of the whole takes longer than the device lets it; those that are paced do not.
TEST_F(DeviceLimits, DispatchesEndBeforeADriverEndsThem) {
    const FieldTables<float> tables =
        test::tables_of<float>(test::mesh_of(shapes::many_gon_prism(3000), Shading::mean_value),
                               {{40, 40, 32}, glm::dvec3(-0.7), glm::dvec3(0.7)});
    const layout::FieldInput<float> input = tables.input();
    const BlockPlanner<float> planner(input.law.mesh, input.x, input.y, input.z, input.law.features.inside, 0,
                                      FreeSpace::visited);
    const BlockPlan plan = planner.plan(0, input.z.size());
    const auto run = [&](compute::Device& device) {
        compute::KernelOptions options;
        options.chunk_bytes = options.software_chunk_bytes = std::size_t(1) << 30;
        compute::MeshKernel kernel(device, options);
        const auto ignored = [](const layout::FieldChunk<float>&) {};
        layout::FieldInput<float> planned = input;
        planned.plan = plan.view();
        return kernel.evaluate<float>(planned, ignored);
    };
    compute::Device free = test::open_software_device(false);
    const compute::FieldTimes whole = run(free);
    const double mean = whole.kernel / static_cast<double>(whole.dispatches);
    fmt::print("{} dispatches of {:.3f} s\n", whole.dispatches, mean);
    setenv(compute::kLimitsVariable, fmt::format("longest={}", 0.7 * mean).c_str(), 1);
    compute::Device limited = test::open_software_device(false);
    const compute::FieldTimes paced = run(limited);
    fmt::print("{} paced ones of {:.3f} s\n", paced.dispatches, paced.kernel / static_cast<double>(paced.dispatches));
    EXPECT_GT(paced.dispatches, whole.dispatches);
}

} // namespace
} // namespace forceshade
