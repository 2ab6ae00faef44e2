#include "shaders/kernels.h"

namespace forceshade::kernels {
namespace words {
#include "field_f32.spv.h"
#include "field_f32_exact.spv.h"
#include "field_f32_packed.spv.h"
#include "field_f64.spv.h"
#include "mesh_field_f32.spv.h"
#include "mesh_field_f32_exact.spv.h"
#include "mesh_field_f64.spv.h"
#include "mesh_path_f32.spv.h"
#include "mesh_path_f32_exact.spv.h"
#include "mesh_path_f64.spv.h"
#include "path_f32.spv.h"
#include "path_f32_exact.spv.h"
#include "path_f64.spv.h"
} // namespace words

#define FS_KERNEL(name)                                                                                                \
    std::span<const std::uint32_t> name() {                                                                            \
        return words::name;                                                                                            \
    }
FS_KERNEL(field_f32)
FS_KERNEL(field_f32_packed)
FS_KERNEL(field_f32_exact)
FS_KERNEL(field_f64)
FS_KERNEL(mesh_field_f32)
FS_KERNEL(mesh_field_f32_exact)
FS_KERNEL(mesh_field_f64)
FS_KERNEL(path_f32)
FS_KERNEL(path_f32_exact)
FS_KERNEL(path_f64)
FS_KERNEL(mesh_path_f32)
FS_KERNEL(mesh_path_f32_exact)
FS_KERNEL(mesh_path_f64)

} // namespace forceshade::kernels
