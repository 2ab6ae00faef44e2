#include "shaders/kernels.h"

namespace forceshade::kernels {
namespace words {
#include "field_f32.spv.h"
#include "field_f32_packed.spv.h"
#include "field_f64.spv.h"
#include "mesh_field_f32.spv.h"
#include "mesh_field_f64.spv.h"
#include "mesh_path_f32.spv.h"
#include "mesh_path_f64.spv.h"
#include "mesh_rest_f32.spv.h"
#include "mesh_rest_f64.spv.h"
#include "path_f32.spv.h"
#include "path_f64.spv.h"
} // namespace words

std::span<const std::uint32_t> field_f32() {
    return words::field_f32;
}

std::span<const std::uint32_t> field_f32_packed() {
    return words::field_f32_packed;
}

std::span<const std::uint32_t> field_f64() {
    return words::field_f64;
}

std::span<const std::uint32_t> mesh_field_f32() {
    return words::mesh_field_f32;
}

std::span<const std::uint32_t> mesh_field_f64() {
    return words::mesh_field_f64;
}

std::span<const std::uint32_t> path_f32() {
    return words::path_f32;
}

std::span<const std::uint32_t> path_f64() {
    return words::path_f64;
}

std::span<const std::uint32_t> mesh_path_f32() {
    return words::mesh_path_f32;
}

std::span<const std::uint32_t> mesh_path_f64() {
    return words::mesh_path_f64;
}

std::span<const std::uint32_t> mesh_rest_f32() {
    return words::mesh_rest_f32;
}

std::span<const std::uint32_t> mesh_rest_f64() {
    return words::mesh_rest_f64;
}

} // namespace forceshade::kernels
