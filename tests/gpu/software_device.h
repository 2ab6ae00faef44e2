// The software device that every GPU test is pinned to, and fields held against the oracle bit for bit.
#pragma once

#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "compute/device.h"
#include "compute/kernels.h"
#include "host/field/tables.h"
#include "host/reference/field.h"

namespace forceshade::test {

inline constexpr layout::uint kAllChannels = layout::kChannelForce | layout::kChannelDepth | layout::kChannelFacet |
                                             layout::kChannelProxy | layout::kChannelUnshaded;

inline compute::Device open_software_device(bool validation) {
    compute::DeviceOptions options;
    options.wanted = "llvmpipe";
    options.needs_f64 = true;
    options.validation = validation;
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
    void TearDown() override {
        for (const std::string& message : device().validation_messages())
            ADD_FAILURE() << message;
    }
};

/// What came of holding a field against reference<T>.
struct BitComparison {
    std::uint64_t voxels = 0;
    std::uint64_t differing = 0;   // voxels any of whose channels has other bits
    std::uint64_t not_finite = 0;  // NaN or infinite numbers in any channel, padding included
    std::uint64_t bad_padding = 0; // padding samples that are no copy of their row's last
    std::string first;             // where the first difference is
    bool in_order = true;          // chunks came in order and without gaps

    bool equal() const { return differing == 0 && not_finite == 0 && bad_padding == 0 && in_order; }
};

template <typename T> class BitComparer {
public:
    explicit BitComparer(const layout::FieldInput<T>& input) : input_(input) {}

    void add(const layout::FieldChunk<T>& chunk) {
        const std::uint64_t row = std::uint64_t(chunk.z_first) * input_.y.size() + chunk.y_first;
        result_.in_order = result_.in_order && row == rows_ && chunk.x_count == input_.x.size();
        rows_ += std::uint64_t(chunk.y_count) * chunk.z_count;
        layout::FieldInput<T> part = input_;
        part.y = input_.y.subspan(chunk.y_first, chunk.y_count);
        part.z = input_.z.subspan(chunk.z_first, chunk.z_count);
        reference::evaluate_field<T>(part, {}, [&](const layout::FieldChunk<T>& oracle) { compare(chunk, oracle); });
        for (const auto channel : {chunk.force, chunk.depth, chunk.proxy, chunk.unshaded})
            for (const T value : channel)
                result_.not_finite += !std::isfinite(value);
    }

    BitComparison result() const {
        BitComparison result = result_;
        result.in_order = result.in_order && rows_ == std::uint64_t(input_.y.size()) * input_.z.size();
        return result;
    }

private:
    void compare(const layout::FieldChunk<T>& chunk, const layout::FieldChunk<T>& oracle) {
        result_.voxels += std::uint64_t(oracle.x_count) * oracle.y_count * oracle.z_count;
        for (std::size_t z = 0; z < oracle.z_count; ++z)
            for (std::size_t y = 0; y < oracle.y_count; ++y) {
                const std::size_t ours = (oracle.z_first + z) * chunk.y_count + oracle.y_first + y;
                const std::size_t theirs = z * oracle.y_count + y;
                if (!same(chunk, ours * chunk.x_pitch, oracle, theirs * oracle.x_pitch, oracle.x_count))
                    count_row(chunk, ours, oracle, theirs);
                const std::size_t last = ours * chunk.x_pitch + chunk.x_count - 1;
                for (std::size_t pad = chunk.x_count; pad < chunk.x_pitch; ++pad)
                    result_.bad_padding += !same(chunk, last, chunk, ours * chunk.x_pitch + pad, 1);
            }
    }

    void count_row(const layout::FieldChunk<T>& chunk, std::size_t ours, const layout::FieldChunk<T>& oracle,
                   std::size_t theirs) {
        for (std::size_t x = 0; x < oracle.x_count; ++x) {
            const std::size_t a = ours * chunk.x_pitch + x, b = theirs * oracle.x_pitch + x;
            if (same(chunk, a, oracle, b, 1))
                continue;
            if (result_.differing++ == 0)
                result_.first = fmt::format("x {} y {} z {}: force ({}, {}, {}), the oracle's is ({}, {}, {})", x,
                                            chunk.y_first + ours % chunk.y_count, chunk.z_first + ours / chunk.y_count,
                                            chunk.force[3 * a], chunk.force[3 * a + 1], chunk.force[3 * a + 2],
                                            oracle.force[3 * b], oracle.force[3 * b + 1], oracle.force[3 * b + 2]);
        }
    }

    // `count` samples of a from `at` on have the bits of those of b from `from` on, in every channel.
    static bool same(const layout::FieldChunk<T>& a, std::size_t at, const layout::FieldChunk<T>& b, std::size_t from,
                     std::size_t count) {
        const auto alike = [&](auto ours, auto theirs, std::size_t width) {
            if (ours.empty() || theirs.empty())
                return ours.empty() && theirs.empty();
            return std::memcmp(&ours[width * at], &theirs[width * from], width * count * sizeof(ours[0])) == 0;
        };
        return alike(a.force, b.force, 3) && alike(a.depth, b.depth, 1) && alike(a.facet, b.facet, 1) &&
               alike(a.proxy, b.proxy, 3) && alike(a.unshaded, b.unshaded, 3);
    }

    const layout::FieldInput<T>& input_;
    std::uint64_t rows_ = 0;
    BitComparison result_;
};

/// Evaluates a field on the device and, chunk by chunk, on the oracle; any difference in a bit is a failure.
template <typename T>
BitComparison hold_against_oracle(compute::FieldKernel& kernel, const layout::FieldInput<T>& input) {
    BitComparer<T> comparer(input);
    kernel.evaluate<T>(input, [&](const layout::FieldChunk<T>& chunk) { comparer.add(chunk); });
    return comparer.result();
}

/// For gtest: says what differs.
inline ::testing::AssertionResult is_equal(const BitComparison& comparison) {
    if (comparison.equal())
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << fmt::format(
               "{} of {} voxels differ, {} numbers are not finite, {} of padding are wrong{}; {}", comparison.differing,
               comparison.voxels, comparison.not_finite, comparison.bad_padding,
               comparison.in_order ? "" : ", chunks out of order", comparison.first);
}

} // namespace forceshade::test
