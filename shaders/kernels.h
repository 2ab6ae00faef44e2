// The embedded SPIR-V of every kernel.
#pragma once

#include <cstdint>
#include <span>

namespace forceshade::kernels {

// ..._exact: quotients and roots of floats through double precision, as rounded as on the CPU whatever the device's own
// are like; needs shaderFloat64.

/// shaders/field.comp in single precision, one 32-bit store a real.
std::span<const std::uint32_t> field_f32();
std::span<const std::uint32_t> field_f32_exact();
/// The same with two reals a 64-bit store; needs shaderInt64.
std::span<const std::uint32_t> field_f32_packed();
/// shaders/field.comp in double precision; needs shaderFloat64.
std::span<const std::uint32_t> field_f64();
/// shaders/mesh_field.comp in single precision.
std::span<const std::uint32_t> mesh_field_f32();
std::span<const std::uint32_t> mesh_field_f32_exact();
/// The same in double precision; needs shaderFloat64.
std::span<const std::uint32_t> mesh_field_f64();
/// shaders/path.comp in single precision.
std::span<const std::uint32_t> path_f32();
std::span<const std::uint32_t> path_f32_exact();
/// The same in double precision; needs shaderFloat64.
std::span<const std::uint32_t> path_f64();
/// shaders/mesh_path.comp in single precision.
std::span<const std::uint32_t> mesh_path_f32();
std::span<const std::uint32_t> mesh_path_f32_exact();
/// The same in double precision; needs shaderFloat64.
std::span<const std::uint32_t> mesh_path_f64();

} // namespace forceshade::kernels
