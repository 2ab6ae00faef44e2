// An update of the god-object takes nothing from the heap, nor does a call of the library that a loop makes.
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>

#include <gtest/gtest.h>

#include "host/library/forceshade.h"
#include "host/reference/god_object.h"
#include "tests/mesh/god_object_walks.h"
#include "tests/mesh/mesh_law.h"

namespace {
std::atomic<std::uint64_t> taken{0};
}

#if !defined(__SANITIZE_ADDRESS__)
extern "C" void* __libc_malloc(std::size_t);
// Everything comes through here: operator new, vectors, the C library.
extern "C" void* malloc(std::size_t size) {
    taken.fetch_add(1, std::memory_order_relaxed);
    return __libc_malloc(size);
}
#endif

namespace forceshade {
namespace {

TEST(GodObjectHeap, NothingIsTaken) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer has the heap";
#endif
    for (const walks::Terrain& terrain : walks::terrains()) {
        shapes::MeshLaw<> meshed(terrain.polygons);
        layout::Law<double>& law = meshed.law;
        law.features.shading = layout::kShadingMeanValue;
        auto around = std::make_unique<reference::Neighbourhood<double>>();
        walks::Wanderer wanderer(meshed.structure, 5);
        std::vector<glm::dvec3> probes{wanderer.begin()};
        while (probes.size() < 5000)
            probes.push_back(wanderer.step(probes.back()));
        reference::GodObject<double> state;
        double sum = 0;
        const std::uint64_t before = taken.load();
        for (const glm::dvec3& probe : probes)
            sum += reference::mesh_contact(law, reference::update(law.mesh, state, *around, probe), probe).depth;
        EXPECT_EQ(taken.load(), before) << terrain.name;
        EXPECT_GT(sum, 0);
    }
    const std::uint64_t before = taken.load();
    void* volatile place = std::malloc(1);
    std::free(place);
    EXPECT_GT(taken.load(), before) << "the count must bite";
}

TEST(LibraryHeap, NothingIsTaken) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "the sanitizer has the heap";
#endif
    const double vertices[] = {0, 0, 0, 0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.02}, level[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int corners[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    for (const fs_precision precision : {FS_F32, FS_F64}) {
        fs_law law = fs_default_law();
        law.precision = precision;
        fs_scene* const scene = fs_scene_from_mesh(vertices, 4, corners, nullptr, 4, &law);
        ASSERT_NE(scene, nullptr) << fs_last_error();
        fs_probe* const probe = fs_probe_new(scene);
        ASSERT_NE(probe, nullptr) << fs_last_error();
        double depths = 0;
        fs_touch touches[2];
        const std::uint64_t begun = taken.load();
        for (int i = 0; i < 1000; ++i) {
            const double way = 0.009 - 0.003 * std::sin(0.01 * i), lift[] = {0, 0, 1e-6 * i};
            const double places[] = {way, way, way, 1e300, way, way};
            fs_scene_pose(scene, level, lift);
            depths += fs_probe_step(probe, places).depth + fs_scene_at(scene, places).depth;
            fs_scene_at_many(scene, places, 2, touches, 1);
            const fs_probe_state state = fs_probe_get_state(probe);
            fs_probe_set_state(probe, &state);
            if (i % 100 == 0)
                fs_probe_reset(probe);
            fs_scene_pose(scene, vertices, lift); // refused: no rotation
        }
        EXPECT_EQ(taken.load(), begun);
        EXPECT_GT(depths, 0);
        fs_probe_free(probe);
        fs_scene_free(scene);
    }
}

} // namespace
} // namespace forceshade
