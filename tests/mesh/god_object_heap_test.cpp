// An update of the god-object takes nothing from the heap.
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_walks.h"

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
        const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
        const MeshTables<double> tables = make_mesh_tables<double>(structure, 1.0);
        layout::Law<double> law{};
        law.features.surface = layout::kSurfaceMesh;
        law.features.shading = layout::kShadingMeanValue;
        law.mesh = tables.view();
        auto around = std::make_unique<reference::Neighbourhood<double>>();
        walks::Wanderer wanderer(structure, 5);
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

} // namespace
} // namespace forceshade
