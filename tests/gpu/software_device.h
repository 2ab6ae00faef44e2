// The device that the GPU tests run on: the software one, or what FORCESHADE_TEST_GPU names (as --gpu does).
#pragma once

#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/device.h"
#include "tests/gpu/rows.h"

namespace forceshade::test {

inline const char* tested_gpu() {
    const char* const named = std::getenv("FORCESHADE_TEST_GPU");
    return named ? named : "llvmpipe";
}

inline compute::Device open_software_device(bool validation, bool through_double = false) {
    compute::DeviceOptions options;
    options.wanted = tested_gpu();
    options.validation = validation;
    options.through_double = through_double;
    return compute::Device(options);
}

/// True where the validation layer is installed; tried once.
inline bool has_validation_layer() {
    static const bool found = [] {
        try {
            open_software_device(true);
            return true;
        } catch (const compute::DeviceError& error) {
            fmt::print("without validation layers: {}\n", error.what());
            return false;
        }
    }();
    return found;
}

/// Runs on the software device with validation layers where they are installed; any message of theirs is a failure.
class SoftwareDeviceTest : public ::testing::Test {
protected:
    /// Opened once for all tests of the program.
    static compute::Device& device() {
        static compute::Device opened = open_software_device(has_validation_layer());
        return opened;
    }
    static Kernels& kernels() {
        static Kernels made(device());
        return made;
    }
    /// Whether the device is the one that tests are written for: some are of what it alone does.
    static bool on_llvmpipe() { return device().report().name.starts_with("llvmpipe"); }
    void TearDown() override {
        for (const std::string& message : device().validation_messages())
            ADD_FAILURE() << message;
    }
};

/// What `call` throws, which must be of this kind.
template <typename Call> std::string device_error(compute::DeviceError::Kind kind, const Call& call) {
    try {
        call();
    } catch (const compute::DeviceError& error) {
        EXPECT_EQ(error.kind(), kind) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return {};
}

} // namespace forceshade::test
