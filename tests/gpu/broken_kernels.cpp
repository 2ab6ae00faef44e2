#include "tests/gpu/broken_kernels.h"

#include "shaders/kernels.h"

namespace forceshade {
namespace {
namespace words {
#include "channel_f32.spv.h"
#include "channel_f32_packed.spv.h"
#include "channel_f64.spv.h"
#include "component_f32.spv.h"
#include "component_f32_packed.spv.h"
#include "component_f64.spv.h"
#include "edge_f32.spv.h"
#include "edge_f32_packed.spv.h"
#include "edge_f64.spv.h"
#include "imprecise_f32.spv.h"
#include "imprecise_f32_packed.spv.h"
#include "imprecise_f64.spv.h"
#include "none_f32.spv.h"
#include "none_f32_packed.spv.h"
#include "none_f64.spv.h"
#include "sign_f32.spv.h"
#include "sign_f32_packed.spv.h"
#include "sign_f64.spv.h"
#include "undeclared_f32.spv.h"
#include "undeclared_f32_packed.spv.h"
#include "undeclared_f64.spv.h"
} // namespace words

using Words = std::span<const std::uint32_t>;

struct Kernels {
    Words f32, f32_packed, f64;
};

Kernels kernels_of(test::Break which) {
    switch (which) {
    case test::Break::none:
        return {words::none_f32, words::none_f32_packed, words::none_f64};
    case test::Break::sign:
        return {words::sign_f32, words::sign_f32_packed, words::sign_f64};
    case test::Break::component:
        return {words::component_f32, words::component_f32_packed, words::component_f64};
    case test::Break::edge:
        return {words::edge_f32, words::edge_f32_packed, words::edge_f64};
    case test::Break::channel:
        return {words::channel_f32, words::channel_f32_packed, words::channel_f64};
    case test::Break::undeclared:
        return {words::undeclared_f32, words::undeclared_f32_packed, words::undeclared_f64};
    case test::Break::imprecise:
        return {words::imprecise_f32, words::imprecise_f32_packed, words::imprecise_f64};
    }
    return {};
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

} // namespace kernels
} // namespace forceshade
