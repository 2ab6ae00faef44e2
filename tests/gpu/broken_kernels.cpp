#include "tests/gpu/broken_kernels.h"

#include "shaders/kernels.h"

namespace forceshade {
namespace {
namespace words {
#include "adrift_f32.spv.h"
#include "adrift_f32_packed.spv.h"
#include "adrift_f64.spv.h"
#include "adrift_mesh_f32.spv.h"
#include "adrift_mesh_f64.spv.h"
#include "adrift_path_f32.spv.h"
#include "adrift_path_f64.spv.h"
#include "behind_mesh_path_f32.spv.h"
#include "behind_mesh_path_f64.spv.h"
#include "channel_f32.spv.h"
#include "channel_f32_packed.spv.h"
#include "channel_f64.spv.h"
#include "channel_mesh_f32.spv.h"
#include "channel_mesh_f64.spv.h"
#include "channel_path_f32.spv.h"
#include "channel_path_f64.spv.h"
#include "component_f32.spv.h"
#include "component_f32_packed.spv.h"
#include "component_f64.spv.h"
#include "component_mesh_f32.spv.h"
#include "component_mesh_f64.spv.h"
#include "component_path_f32.spv.h"
#include "component_path_f64.spv.h"
#include "creep_mesh_path_f32.spv.h"
#include "creep_mesh_path_f64.spv.h"
#include "edge_f32.spv.h"
#include "edge_f32_packed.spv.h"
#include "edge_f64.spv.h"
#include "edge_mesh_f32.spv.h"
#include "edge_mesh_f64.spv.h"
#include "edge_path_f32.spv.h"
#include "edge_path_f64.spv.h"
#include "forgetful_f32.spv.h"
#include "forgetful_f32_packed.spv.h"
#include "forgetful_f64.spv.h"
#include "forgetful_mesh_f32.spv.h"
#include "forgetful_mesh_f64.spv.h"
#include "forgetful_path_f32.spv.h"
#include "forgetful_path_f64.spv.h"
#include "friction_f32.spv.h"
#include "friction_f32_packed.spv.h"
#include "friction_f64.spv.h"
#include "friction_mesh_f32.spv.h"
#include "friction_mesh_f64.spv.h"
#include "friction_path_f32.spv.h"
#include "friction_path_f64.spv.h"
#include "imprecise_f32.spv.h"
#include "imprecise_f32_packed.spv.h"
#include "imprecise_f64.spv.h"
#include "imprecise_mesh_f32.spv.h"
#include "imprecise_mesh_f64.spv.h"
#include "imprecise_mesh_path_f32.spv.h"
#include "imprecise_mesh_path_f64.spv.h"
#include "imprecise_path_f32.spv.h"
#include "imprecise_path_f64.spv.h"
#include "kahan_f32.spv.h"
#include "kahan_f32_packed.spv.h"
#include "kahan_f64.spv.h"
#include "kahan_mesh_f32.spv.h"
#include "kahan_mesh_f64.spv.h"
#include "kahan_path_f32.spv.h"
#include "kahan_path_f64.spv.h"
#include "lap_f32.spv.h"
#include "lap_f32_packed.spv.h"
#include "lap_f64.spv.h"
#include "lap_mesh_f32.spv.h"
#include "lap_mesh_f64.spv.h"
#include "lap_path_f32.spv.h"
#include "lap_path_f64.spv.h"
#include "late_f32.spv.h"
#include "late_f32_packed.spv.h"
#include "late_f64.spv.h"
#include "late_mesh_f32.spv.h"
#include "late_mesh_f64.spv.h"
#include "late_path_f32.spv.h"
#include "late_path_f64.spv.h"
#include "none_f32.spv.h"
#include "none_f32_packed.spv.h"
#include "none_f64.spv.h"
#include "none_mesh_f32.spv.h"
#include "none_mesh_f64.spv.h"
#include "none_mesh_path_f32.spv.h"
#include "none_mesh_path_f64.spv.h"
#include "none_path_f32.spv.h"
#include "none_path_f64.spv.h"
#include "outward_f32.spv.h"
#include "outward_f32_packed.spv.h"
#include "outward_f64.spv.h"
#include "outward_mesh_f32.spv.h"
#include "outward_mesh_f64.spv.h"
#include "outward_path_f32.spv.h"
#include "outward_path_f64.spv.h"
#include "sign_f32.spv.h"
#include "sign_f32_packed.spv.h"
#include "sign_f64.spv.h"
#include "sign_mesh_f32.spv.h"
#include "sign_mesh_f64.spv.h"
#include "sign_path_f32.spv.h"
#include "sign_path_f64.spv.h"
#include "slip_mesh_path_f32.spv.h"
#include "slip_mesh_path_f64.spv.h"
#include "tangent_f32.spv.h"
#include "tangent_f32_packed.spv.h"
#include "tangent_f64.spv.h"
#include "tangent_mesh_f32.spv.h"
#include "tangent_mesh_f64.spv.h"
#include "tangent_path_f32.spv.h"
#include "tangent_path_f64.spv.h"
#include "tie_f32.spv.h"
#include "tie_f32_packed.spv.h"
#include "tie_f64.spv.h"
#include "tie_mesh_f32.spv.h"
#include "tie_mesh_f64.spv.h"
#include "tie_path_f32.spv.h"
#include "tie_path_f64.spv.h"
#include "tunnel_mesh_path_f32.spv.h"
#include "tunnel_mesh_path_f64.spv.h"
#include "undeclared_f32.spv.h"
#include "undeclared_f32_packed.spv.h"
#include "undeclared_f64.spv.h"
#include "undeclared_mesh_f32.spv.h"
#include "undeclared_mesh_f64.spv.h"
#include "undeclared_path_f32.spv.h"
#include "undeclared_path_f64.spv.h"
} // namespace words

using Words = std::span<const std::uint32_t>;

struct Kernels {
    Words f32, f32_packed, f64, mesh_f32, mesh_f64, path_f32, path_f64;
};

struct MeshPathKernels {
    Words path_f32, path_f64;
};

#define FS_KERNELS(name)                                                                                               \
    {                                                                                                                  \
        words::name##_f32, words::name##_f32_packed, words::name##_f64, words::name##_mesh_f32,                        \
            words::name##_mesh_f64, words::name##_path_f32, words::name##_path_f64                                     \
    }

Kernels kernels_of(test::Break which) {
    switch (which) {
    case test::Break::none:
        return Kernels FS_KERNELS(none);
    case test::Break::sign:
        return Kernels FS_KERNELS(sign);
    case test::Break::component:
        return Kernels FS_KERNELS(component);
    case test::Break::edge:
        return Kernels FS_KERNELS(edge);
    case test::Break::channel:
        return Kernels FS_KERNELS(channel);
    case test::Break::undeclared:
        return Kernels FS_KERNELS(undeclared);
    case test::Break::friction:
        return Kernels FS_KERNELS(friction);
    case test::Break::kahan:
        return Kernels FS_KERNELS(kahan);
    case test::Break::late:
        return Kernels FS_KERNELS(late);
    case test::Break::adrift:
        return Kernels FS_KERNELS(adrift);
    case test::Break::lap:
        return Kernels FS_KERNELS(lap);
    case test::Break::forgetful:
        return Kernels FS_KERNELS(forgetful);
    case test::Break::imprecise:
        return Kernels FS_KERNELS(imprecise);
    case test::Break::tie:
        return Kernels FS_KERNELS(tie);
    case test::Break::outward:
        return Kernels FS_KERNELS(outward);
    case test::Break::tangent:
        return Kernels FS_KERNELS(tangent);
    default:
        return {};
    }
}

#define FS_MESH_PATH_KERNELS(name)                                                                                     \
    { words::name##_mesh_path_f32, words::name##_mesh_path_f64 }

MeshPathKernels mesh_path_kernels_of(test::Break which) {
    switch (which) {
    case test::Break::none:
        return MeshPathKernels FS_MESH_PATH_KERNELS(none);
    case test::Break::creep:
        return MeshPathKernels FS_MESH_PATH_KERNELS(creep);
    case test::Break::tunnel:
        return MeshPathKernels FS_MESH_PATH_KERNELS(tunnel);
    case test::Break::slip:
        return MeshPathKernels FS_MESH_PATH_KERNELS(slip);
    case test::Break::behind:
        return MeshPathKernels FS_MESH_PATH_KERNELS(behind);
    case test::Break::imprecise:
        return MeshPathKernels FS_MESH_PATH_KERNELS(imprecise);
    default:
        return {};
    }
}

test::Break chosen_break = test::Break::none;

} // namespace

namespace test {

void choose_break(Break chosen) {
    chosen_break = chosen;
}

} // namespace test

// The linker takes these for the program's own, which lie in a library.
namespace kernels {

Words field_f32() {
    return kernels_of(chosen_break).f32;
}

Words field_f32_packed() {
    return kernels_of(chosen_break).f32_packed;
}

Words field_f64() {
    return kernels_of(chosen_break).f64;
}

Words mesh_field_f32() {
    return kernels_of(chosen_break).mesh_f32;
}

Words mesh_field_f64() {
    return kernels_of(chosen_break).mesh_f64;
}

Words path_f32() {
    return kernels_of(chosen_break).path_f32;
}

Words path_f64() {
    return kernels_of(chosen_break).path_f64;
}

Words mesh_path_f32() {
    return mesh_path_kernels_of(chosen_break).path_f32;
}

Words mesh_path_f64() {
    return mesh_path_kernels_of(chosen_break).path_f64;
}

} // namespace kernels
} // namespace forceshade
