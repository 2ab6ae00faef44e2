// Every row of the table: the kernel's bits are the oracle's however dispatches are cut, every sample is written and
// nothing behind them, and where there is a closed form it holds. And kernels broken on purpose: the row that should
// see a break does, or it holds nothing.
#include <gtest/gtest.h>

#include "compute/device_limits.h"
#include "host/field/engine.h"
#include "host/referee/validate.h"
#include "tests/gpu/broken_kernels.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::Break;
using test::Held;
using test::Row;

Comparison against_closed_form(const Row& row, Precision precision) {
    EngineOptions options;
    options.gpu = test::tested_gpu();
    options.validation = test::has_validation_layer();
    return compare_case(*make_engine(options), row.ground().prepared, precision);
}

class Table : public test::SoftwareDeviceTest, public ::testing::WithParamInterface<Row> {
protected:
    template <typename T> static void hold(const Row& row) {
        SCOPED_TRACE(fmt::format("{} f{}", row.name, 8 * sizeof(T)));
        std::uint64_t samples = 0;
        for (const Held& held : kernels().hold<T>(row)) {
            EXPECT_TRUE(is_equal(held));
            EXPECT_GE(held.touching, row.least.touching);
            EXPECT_GE(held.rounds, row.least.rounds);
            EXPECT_GE(held.unstable, row.least.unstable);
            EXPECT_GE(held.host_updates, row.least.host_updates);
            EXPECT_LE(held.host_updates, row.least.most_host_updates) << "the kernel ends the others";
            samples += held.samples;
        }
        EXPECT_GT(samples, 0u);
        if (row.referee) {
            const Comparison closed =
                against_closed_form(row, sizeof(T) == sizeof(float) ? Precision::f32 : Precision::f64);
            EXPECT_TRUE(closed.passed) << closed.first_difference;
        }
    }
};

TEST_P(Table, HasTheOraclesBits) {
    if (GetParam().f32)
        hold<float>(GetParam());
    if (GetParam().f64 && device().report().f64)
        hold<double>(GetParam());
}

// The kernels for devices whose own quotients and roots of floats may be off have the same bits.
class ThroughDouble : public ::testing::TestWithParam<Row> {};

TEST_P(ThroughDouble, HasTheOraclesBits) {
    static compute::Device device = test::open_software_device(test::has_validation_layer(), true);
    static test::Kernels kernels(device);
    for (const Held& held : kernels.hold<float>(GetParam()))
        EXPECT_TRUE(is_equal(held));
    for (const std::string& message : device.validation_messages())
        ADD_FAILURE() << message;
}

// Every fourth row: every law is among them.
std::vector<Row> some(std::vector<Row> rows) {
    std::vector<Row> few;
    for (std::size_t i = 0; i < rows.size(); i += 4)
        if (rows[i].f32)
            few.push_back(std::move(rows[i]));
    return few;
}

std::string name_of(const ::testing::TestParamInfo<Row>& info) {
    return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Fields, Table, ::testing::ValuesIn(test::field_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(MeshFields, Table, ::testing::ValuesIn(test::mesh_field_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(Paths, Table, ::testing::ValuesIn(test::path_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(MeshPaths, Table, ::testing::ValuesIn(test::mesh_path_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(LongPaths, Table, ::testing::ValuesIn(test::long_path_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(LongMeshPaths, Table, ::testing::ValuesIn(test::long_mesh_path_rows()), name_of);
INSTANTIATE_TEST_SUITE_P(Fields, ThroughDouble, ::testing::ValuesIn(some(test::field_rows())), name_of);
INSTANTIATE_TEST_SUITE_P(MeshFields, ThroughDouble, ::testing::ValuesIn(some(test::mesh_field_rows())), name_of);
INSTANTIATE_TEST_SUITE_P(Paths, ThroughDouble, ::testing::ValuesIn(some(test::path_rows())), name_of);
INSTANTIATE_TEST_SUITE_P(MeshPaths, ThroughDouble, ::testing::ValuesIn(some(test::mesh_path_rows())), name_of);

// Broken kernels.

/// Where a break shows.
enum class Shows { in_bits, beyond_bound, in_metrics };

struct Broken {
    const char* name;
    Break which;
    std::vector<Row> (*rows)();
    const char* seen_by; // one of the rows whose names begin so
    Shows shows = Shows::in_bits;
    bool f64 = true; /* or it shows in single precision; the text is the same */
    friend std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.name; }
};

const Broken kBroken[] = {
    {"sign", Break::sign, test::field_rows, "facets_on_samples", Shows::beyond_bound},
    {"component", Break::component, test::field_rows, "cylinder_on_samples", Shows::beyond_bound},
    {"edge", Break::edge, test::field_rows, "facets_on_samples"},
    {"channel", Break::channel, test::field_rows, "facets_on_samples", Shows::beyond_bound},
    {"imprecise", Break::imprecise, test::field_rows, "gaussian_on_samples"},
    {"beyond", Break::beyond, test::field_rows, "grid_"},
    {"tie", Break::tie, test::mesh_field_rows, "ties"},
    {"outward", Break::outward, test::mesh_field_rows, "ties"},
    {"tangent", Break::tangent, test::mesh_field_rows, "ties"},
    {"imprecise_mesh", Break::imprecise, test::mesh_field_rows, "ties"},
    {"sign_on_paths", Break::sign, test::path_rows, "friction_open"},
    {"friction", Break::friction, test::path_rows, "friction_closed"},
    {"kahan", Break::kahan, test::path_rows, "friction_open", Shows::in_metrics},
    {"late", Break::late, test::path_rows, "friction_closed"},
    {"lap", Break::lap, test::path_rows, "friction_open", Shows::in_metrics},
    {"adrift", Break::adrift, test::path_rows, "friction_open", Shows::in_metrics},
    {"imprecise_paths", Break::imprecise, test::path_rows, "friction_open", Shows::in_metrics},
    {"forgetful", Break::forgetful, test::path_rows, "vertices"},
    {"tunnel", Break::tunnel, test::mesh_path_rows, "wandering_", Shows::in_bits, false},
    {"slip", Break::slip, test::mesh_path_rows, "wandering_", Shows::in_bits, false},
    {"imprecise_mesh_paths", Break::imprecise, test::mesh_path_rows, "wandering_", Shows::in_bits, false},
    {"behind", Break::behind, test::mesh_path_rows, "from_behind"},
};

class BrokenKernel : public ::testing::TestWithParam<Broken> {
protected:
    void TearDown() override {
        test::choose_break(Break::none);
        unsetenv(compute::kLimitsVariable);
    }

    template <typename T> static bool is_seen(const Broken& broken, const Row& row, test::Kernels& kernels) {
        bool seen = true;
        for (const Held& held : kernels.hold<T>(row)) {
            EXPECT_TRUE(broken.shows != Shows::in_metrics || (held.differing == 0 && held.differing_metrics > 0));
            seen = seen && !held.equal();
        }
        if (seen && row.referee) {
            const Comparison closed =
                against_closed_form(row, sizeof(T) == sizeof(float) ? Precision::f32 : Precision::f64);
            EXPECT_FALSE(closed.passed);
            EXPECT_FALSE(closed.first_difference.empty());
            EXPECT_EQ(closed.oracle.unexplained + closed.closed_form.unexplained > 0,
                      broken.shows == Shows::beyond_bound);
        }
        return seen;
    }
};

TEST_P(BrokenKernel, IsSeen) {
    const Broken& broken = GetParam();
    test::choose_break(broken.which);
    if (broken.which == Break::imprecise) // Mesa reassociates nothing where infinities are to be kept
        setenv(compute::kLimitsVariable, "no-float-controls", 1);
    compute::Device device = test::open_software_device(false);
    test::Kernels kernels(device);
    bool single = false, twofold = false;
    for (const Row& row : broken.rows()) {
        if (!row.name.starts_with(broken.seen_by))
            continue;
        single = single || !row.f32 || is_seen<float>(broken, row, kernels);
        twofold = twofold || !device.report().f64 || !broken.f64 || !row.f64 || is_seen<double>(broken, row, kernels);
        if (single && twofold)
            return;
    }
    FAIL() << "f32 " << single << ", f64 " << twofold;
}

INSTANTIATE_TEST_SUITE_P(Breaks, BrokenKernel, ::testing::ValuesIn(kBroken),
                         [](const auto& broken) { return std::string(broken.param.name); });

} // namespace
} // namespace forceshade
