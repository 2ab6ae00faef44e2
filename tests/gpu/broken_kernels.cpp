#include "tests/gpu/broken_kernels.h"

#include <string_view>

#include "shaders/kernels.h"

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

Words chosen(std::string_view variant) {
    for (const Kernel& kernel : kKernels)
        if (kernel.broken == chosen_break && kernel.variant == variant)
            return kernel.words;
    return {};
}

} // namespace

namespace test {

void choose_break(Break broken) {
    chosen_break = broken;
}

} // namespace test

// The linker takes these for the program's own, which lie in a library.
namespace kernels {

Words field_f32() {
    return chosen("f32");
}
Words field_f32_packed() {
    return chosen("f32_packed");
}
Words field_f64() {
    return chosen("f64");
}
Words mesh_field_f32() {
    return chosen("mesh_f32");
}
Words mesh_field_f64() {
    return chosen("mesh_f64");
}
Words path_f32() {
    return chosen("path_f32");
}
Words path_f64() {
    return chosen("path_f64");
}
Words mesh_path_f32() {
    return chosen("mesh_path_f32");
}
Words mesh_path_f64() {
    return chosen("mesh_path_f64");
}

} // namespace kernels
} // namespace forceshade
