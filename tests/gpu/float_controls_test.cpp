// Kernels that ask a device to keep denormals and special values, and for the nearest numbers.
#include <gtest/gtest.h>
#include <spirv/unified1/spirv.hpp>

#include "compute/float_controls.h"
#include "shaders/kernels.h"
#include "tests/gpu/spirv_module.h"

namespace forceshade::compute {
namespace {

constexpr FloatControls kAll{true, true, true}, kNone{};

using Modes = std::set<std::pair<std::uint32_t, std::uint32_t>>; // and the width

Modes modes_of(std::span<const std::uint32_t> kernel) {
    Modes modes;
    for (std::size_t at = 5; at < kernel.size(); at += kernel[at] >> 16)
        if ((kernel[at] & 0xFFFF) == spv::OpExecutionMode && kernel[at] >> 16 == 4)
            modes.emplace(kernel[at + 2], kernel[at + 3]);
    return modes;
}

TEST(FloatControls, AreAskedOfTheWidthsThatAKernelHas) {
    const Modes single{{spv::ExecutionModeDenormPreserve, 32},
                       {spv::ExecutionModeSignedZeroInfNanPreserve, 32},
                       {spv::ExecutionModeRoundingModeRTE, 32}};
    Modes both = single;
    for (const auto& [mode, width] : single)
        both.emplace(mode, 64);
    EXPECT_EQ(modes_of(with_float_controls(kernels::field_f32(), kAll, kAll)), single);
    EXPECT_EQ(modes_of(with_float_controls(kernels::path_f32_exact(), kAll, kAll)), both);
    EXPECT_EQ(modes_of(with_float_controls(kernels::mesh_path_f64(), kAll, kAll)), both);
    EXPECT_EQ(modes_of(with_float_controls(kernels::mesh_path_f64(), {.special = true}, {})),
              (Modes{{spv::ExecutionModeSignedZeroInfNanPreserve, 32}}));
}

TEST(FloatControls, ComeWithTheirCapabilitiesAndLeaveTheRest) {
    const std::span<const std::uint32_t> kernel = kernels::mesh_field_f64();
    const std::vector<std::uint32_t> asking = with_float_controls(kernel, kNone, {.denormals = true});
    std::set<std::uint32_t> capabilities = test::SpirvModule(kernel).capabilities();
    capabilities.insert(spv::CapabilityDenormPreserve);
    EXPECT_EQ(test::SpirvModule(asking).capabilities(), capabilities);
    EXPECT_EQ(asking.size(), kernel.size() + 2 + 7 + 4) << "a capability, the extension's name, a mode";
    EXPECT_TRUE(std::equal(kernel.end() - 1000, kernel.end(), asking.end() - 1000));
    EXPECT_TRUE(std::ranges::equal(with_float_controls(kernel, kNone, kNone), kernel));
}

} // namespace
} // namespace forceshade::compute
