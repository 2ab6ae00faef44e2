// How a device's floats round, and kernels that ask for it. Without Vulkan types.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace forceshade::compute {

/// What kernels may ask of the device for floats of one width (SPV_KHR_float_controls); a device keeps to it then.
struct FloatControls {
    bool denormals = false;    /* are kept, not taken for 0 */
    bool special = false;      /* signed zeros, infinities and NaN are kept */
    bool nearest_even = false; /* sums and products are the nearest number, ties even */

    bool any() const { return denormals || special || nearest_even; }
    bool operator==(const FloatControls&) const = default;
};

/// "denormals, infinities and NaN, nearest"; empty: none.
std::string text_of(const FloatControls& controls);

/// A compute kernel, SPIR-V 1.3, that asks for all that is offered for the widths that it computes in.
std::vector<std::uint32_t> with_float_controls(std::span<const std::uint32_t> kernel, const FloatControls& single,
                                               const FloatControls& twice);

} // namespace forceshade::compute
