// L6: sampled steps of the god-object against a solver that walks on the surface itself, without skin or planes.
#include <cstdlib>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

brute::SurfaceWalker walker_of(const MeshStructure& structure) {
    std::vector<glm::dvec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    const std::vector<double>& reals = structure.reals->vertices;
    for (std::size_t i = 0; i + 2 < reals.size(); i += 3)
        vertices.emplace_back(reals[i], reals[i + 1], reals[i + 2]);
    const auto& corners = structure.parts->triangle_corners;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return {vertices, triangles, structure.parts->triangle_facets};
}

struct Agreement {
    std::uint64_t steps = 0, touching = 0, apart = 0, near_ties = 0;
};

Agreement compare(const walks::Terrain& terrain, std::uint64_t steps) {
    const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 1.0);
    const layout::MeshView<double> mesh = tables.view();
    brute::SurfaceWalker walker = walker_of(structure);
    walks::Wanderer wanderer(structure, 99);
    auto around = std::make_unique<reference::Neighbourhood<double>>();
    reference::GodObject<double> state;
    glm::dvec3 probe{0};
    Agreement agreement;
    for (std::uint64_t i = 0; i < steps; ++i) {
        const bool fresh = i % 500 == 0 || !state.started;
        probe = fresh ? wanderer.begin() : wanderer.step(probe);
        if (fresh) {
            state = {};
            walker.begin(probe);
        }
        const glm::dvec3 before = walker.proxy();
        const auto contact = reference::update(mesh, state, *around, probe);
        const bool rests = walker.update(probe);
        ++agreement.steps;
        agreement.touching += contact.touching && walker.touching();
        const double off = glm::length(contact.proxy - walker.proxy());
        if (rests && off < 1e-9)
            continue;
        // Two ways down from a corner about as steep as each other: the skin may send the proxy down the other.
        const bool tie = walker.margin() < 0.05L;
        agreement.near_ties += tie;
        agreement.apart += !tie;
        if (!tie && agreement.apart <= 3)
            fmt::print("{} step {}: apart {} rests {} touching {} {} count {} depth {} against {}, margin {}, before "
                       "{} {} {}\n",
                       terrain.name, i, off, rests, contact.touching, walker.touching(), contact.count,
                       glm::length(contact.proxy - probe), glm::length(walker.proxy() - probe), double(walker.margin()),
                       before.x, before.y, before.z);
        state.started = false;
    }
    return agreement;
}

// 10^5 steps a terrain at length; folds and polyhedra touch themselves, which the solver does not know.
TEST(GodObjectSolver, SameProxy) {
    const std::uint64_t steps = std::getenv("FORCESHADE_LONG") ? 200000 : 10000;
    std::uint64_t touching = 0, near_ties = 0;
    for (const walks::Terrain& terrain : walks::terrains()) {
        if (terrain.name == "folds" || terrain.name == "polyhedra")
            continue;
        const Agreement agreement = compare(terrain, steps);
        fmt::print("{:18} {} steps, {} touching, {} near ties, {} apart\n", terrain.name, agreement.steps,
                   agreement.touching, agreement.near_ties, agreement.apart);
        EXPECT_EQ(agreement.apart, 0u) << terrain.name;
        touching += agreement.touching;
        near_ties += agreement.near_ties;
    }
    EXPECT_LE(near_ties, touching / 10000);
}

} // namespace
} // namespace forceshade
