#include "tests/gpu/broken_kernels.h"

// The program's own kernels, in a namespace of another name.
#define kernels own_kernels
#include "shaders/kernels.cpp"
#undef kernels

namespace forceshade {
namespace {

using Words = std::span<const std::uint32_t>;

struct Kernel {
    test::Break broken;
    std::string_view variant;
    Words words;
};

namespace words {
#include "broken_includes.h" // generated: CMakeLists.txt lists the breaks
} // namespace words

const Kernel kKernels[] = {
#include "broken_table.h"
};

test::Break chosen_break = test::Break::none;

} // namespace

namespace test {

void choose_break(Break broken) {
    chosen_break = broken;
}

Words broken_words(Break broken, std::string_view variant) {
    for (const Kernel& kernel : kKernels)
        if (kernel.broken == broken && kernel.variant == variant)
            return kernel.words;
    return {};
}

} // namespace test

// The linker takes these for those of the library.
namespace kernels {
#define FS_CHOSEN(name, variant)                                                                                       \
    Words name() {                                                                                                     \
        return chosen_break == test::Break::none ? own_kernels::name() : test::broken_words(chosen_break, variant);    \
    }
FS_CHOSEN(field_f32, "f32")
FS_CHOSEN(field_f32_packed, "f32_packed")
FS_CHOSEN(field_f32_exact, "f32_exact")
FS_CHOSEN(field_f64, "f64")
FS_CHOSEN(mesh_field_f32, "mesh_f32")
FS_CHOSEN(mesh_field_f32_exact, "mesh_f32_exact")
FS_CHOSEN(mesh_field_f64, "mesh_f64")
FS_CHOSEN(path_f32, "path_f32")
FS_CHOSEN(path_f32_exact, "path_f32_exact")
FS_CHOSEN(path_f64, "path_f64")
FS_CHOSEN(mesh_path_f32, "mesh_path_f32")
FS_CHOSEN(mesh_path_f32_exact, "mesh_path_f32_exact")
FS_CHOSEN(mesh_path_f64, "mesh_path_f64")
} // namespace kernels

} // namespace forceshade
