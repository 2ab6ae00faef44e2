// Validation layers (core, synchronization, best practices, accesses in kernels) over every kernel and way of running
// it; and that they are listened to.
#include <gtest/gtest.h>

#include "host/field/engine.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/random_scene.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

class Validation : public ::testing::Test {
protected:
    void SetUp() override {
        if (!test::has_validation_layer())
            GTEST_SKIP() << "the package vulkan-validationlayers is not installed";
    }
    void TearDown() override { test::choose_break(test::Break::none); }

    template <typename T> static void evaluate(compute::FieldKernel& kernel, const PreparedCase& prepared) {
        const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::everything);
        std::uint64_t dispatches = kernel.evaluate<T>(tables.input(), [](const layout::FieldChunk<T>&) {}).dispatches;
        EXPECT_GT(dispatches, 2u); // more than are in flight at once
    }
};

TEST_F(Validation, IsSilent) {
    compute::Device device = test::open_software_device(true);
    for (const bool packed : {false, true})
        for (const bool staged : {false, true}) {
            compute::KernelOptions options;
            options.chunk_bytes = options.software_chunk_bytes = 100000;
            options.packed_stores = packed;
            options.force_staging = staged;
            compute::FieldKernel kernel(device, options);
            for (std::uint64_t seed = 1; seed <= 12; ++seed) {
                evaluate<float>(kernel, test::random_scene(seed, test::Conditioning::moderate));
                evaluate<double>(kernel, test::random_scene(seed, test::Conditioning::moderate));
            }
        }
    for (const std::string& message : device.validation_messages())
        ADD_FAILURE() << message;
}

// Every access of every kernel within its buffers, as the layers see them.
TEST_F(Validation, OfAccessesIsSilent) {
    compute::DeviceOptions options;
    options.wanted = test::tested_gpu();
    options.validation = options.gpu_assisted = true;
    compute::Device device(options);
    test::Kernels kernels(device);
    std::vector<test::Row> rows = test::field_rows();
    for (auto more : {test::mesh_field_rows(), test::path_rows(), test::mesh_path_rows()})
        rows.insert(rows.end(), more.begin(), more.begin() + 1);
    rows.erase(rows.begin() + 1, rows.end() - 3);
    for (const test::Row& row : rows)
        for (const test::Held& held : kernels.hold<float>(row))
            EXPECT_TRUE(is_equal(held)) << row.name;
    for (const std::string& message : device.validation_messages())
        ADD_FAILURE() << message;
}

// A kernel that writes rows behind its last.
TEST_F(Validation, OfAccessesIsListenedTo) {
    test::choose_break(test::Break::beyond);
    compute::DeviceOptions options;
    options.wanted = test::tested_gpu();
    options.validation = options.gpu_assisted = true;
    compute::Device device(options);
    Scene scene;
    scene.grid.size = {16, 3, 5};
    compute::KernelOptions four_rows;
    four_rows.rows = 4;
    compute::FieldKernel kernel(device, four_rows);
    const FieldTables<float> tables = make_tables<float>(scene, {}, Extent::everything);
    kernel.evaluate<float>(tables.input(), [](const layout::FieldChunk<float>&) {});
    EXPECT_FALSE(device.validation_messages().empty());
}

// A kernel that asks for what the device was not asked to give.
TEST_F(Validation, IsListenedTo) {
    test::choose_break(test::Break::undeclared);
    EngineOptions options;
    options.gpu = test::tested_gpu();
    options.validation = true;
    const auto engine = make_engine(options);
    const FieldTables<float> tables = make_tables<float>(Scene{}, {}, Extent::what_varies);
    try {
        engine->evaluate(tables.input(), [](const layout::FieldChunk<float>&) {});
        FAIL() << "the layers say nothing";
    } catch (const compute::DeviceError& error) {
        EXPECT_NE(std::string(error.what()).find("the validation layers complain"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace forceshade
