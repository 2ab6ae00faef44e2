// L6: whatever the steps, the proxy crosses nothing, comes never further from the probe than it was, and rests only
// where the facets hold it.
#include <cstdlib>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

struct SafetyTally {
    std::uint64_t steps = 0, contacts = 0, pieces = 0, crossed = 0, further = 0, outside_cone = 0, unfinished = 0;
    std::uint64_t substeps = 0, most_substeps = 0;
    std::uint64_t behind = 0, again = 0;
    double worst_cone = 0, worst_further = 0, worst_shift = 0;
};

/// How far, in skins, a proxy stands from where the planes that hold it meet.
double skins_to(const std::array<glm::dvec3, 3>& normals, unsigned count) {
    if (count < 2)
        return 1;
    // The least v with n . v = 1 for each normal n.
    const glm::dvec3& a = normals[0];
    const glm::dvec3& b = normals[1];
    if (count == 2)
        return glm::length(a + b) / (1 + glm::dot(a, b));
    const glm::dvec3& c = normals[2];
    return glm::length(glm::cross(b, c) + glm::cross(c, a) + glm::cross(a, b)) /
           std::abs(glm::dot(a, glm::cross(b, c)));
}

template <typename T>
void wander(const walks::Terrain& terrain, std::uint64_t steps, std::uint64_t seed, SafetyTally& tally) {
    const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
    const MeshTables<T> tables = make_mesh_tables<T>(structure, 1.0);
    const layout::MeshView<T> mesh = tables.view();
    const brute::Triangles triangles = brute::Triangles::of(mesh.vertices, mesh.triangle_corners);
    const brute::TriangleGrid grid(triangles);
    walks::Wanderer wanderer(structure, seed, terrain.focus);
    auto around = std::make_unique<reference::Neighbourhood<T>>();
    reference::GodObject<T> state;
    glm::dvec3 at{0};
    const double skin = double(reference::Skin<T>::kWidth);
    for (std::uint64_t i = 0; i < steps; ++i) {
        if (i % 1000 == 0) {
            state = {};
            at = wanderer.begin();
        } else {
            at = wanderer.step(at);
        }
        const glm::vec<3, T> probe(at);
        const glm::dvec3 start = walks::wide(state.started ? state.proxy : probe);
        double depth = glm::length(start - walks::wide(probe));
        const bool fresh = !state.started;
        bool crossed = false;
        double further = 0;
        const auto trace = [&](const glm::vec<3, T>& from, const glm::vec<3, T>& to) {
            ++tally.pieces;
            crossed = crossed || grid.touches(walks::wide(from), walks::wide(to));
        };
        const auto contact = reference::update(mesh, state, *around, probe, trace);
        if (!fresh)
            further = glm::length(walks::wide(state.proxy) - walks::wide(probe)) - depth;
        ++tally.steps;
        tally.contacts += contact.touching;
        tally.substeps += contact.substeps;
        tally.most_substeps = std::max<std::uint64_t>(tally.most_substeps, contact.substeps);
        tally.unfinished += !contact.finished;
        std::array<glm::dvec3, 3> normals;
        for (unsigned k = 0; k < contact.count; ++k)
            normals[k] = walks::wide(contact.normals[k]);
        const glm::dvec3 pull = walks::wide(probe) - walks::wide(contact.proxy);
        const double floor = 64 * double(std::numeric_limits<T>::epsilon());
        const double off = brute::distance_from_cone(pull, std::span(normals.data(), contact.count));
        const double relative = std::max(0.0, off - floor) / std::max(glm::length(pull), 1e-300);
        // The reported proxy is the walked one without its skin, and nothing is between.
        const glm::dvec3 back = walks::wide(state.proxy) - walks::wide(contact.proxy);
        const double shift = contact.touching ? glm::length(back) / skin : 0;
        const double off_planes = shift / (1 + skins_to(normals, contact.count));
        // Touching is allowed within two skins; in an acute corner, where it is a hundredth of a skin wide.
        const double lift = (2 + 0.01 * skins_to(normals, contact.count)) / shift;
        const bool behind =
            lift < 1 && grid.touches(walks::wide(state.proxy), walks::wide(contact.proxy) + lift * back);
        reference::GodObject<T> same = state;
        const auto again = reference::update(mesh, same, *around, probe);
        const bool moved = glm::length(walks::wide(again.proxy) - walks::wide(contact.proxy)) > 2 * skin;
        tally.behind += behind;
        tally.again += moved;
        tally.worst_shift = std::max(tally.worst_shift, off_planes);
        tally.worst_cone = std::max(tally.worst_cone, relative);
        tally.worst_further = std::max(tally.worst_further, further / skin);
        const bool bad = crossed || relative > 1e-9 || further > 8 * skin || !contact.finished || behind || moved;
        tally.crossed += crossed;
        tally.outside_cone += relative > 1e-9;
        tally.further += further > 8 * skin;
        if (bad &&
            tally.crossed + tally.outside_cone + tally.further + tally.unfinished + tally.behind + tally.again < 6)
            fmt::print("{} seed {} step {}: crossed {} cone {} further {} skins finished {} shift {} skins behind {} "
                       "moved {}, substeps {}, count {} depth {}\n",
                       terrain.name, seed, i, crossed, relative, further / skin, contact.finished, shift, behind, moved,
                       contact.substeps, contact.count, glm::length(pull));
    }
}

void print(const walks::Terrain& terrain, const SafetyTally& tally) {
    fmt::print(
        "{:18} {:9} steps {:9} contacts {:9} pieces; crossed {} further {} ({:.2f}) cone {} ({:.1e}) behind {} shift "
        "{:.2f} again {} unfinished {} substeps {:.2f} most {}\n",
        terrain.name, tally.steps, tally.contacts, tally.pieces, tally.crossed, tally.further, tally.worst_further,
        tally.outside_cone, tally.worst_cone, tally.behind, tally.worst_shift, tally.again, tally.unfinished,
        double(tally.substeps) / double(tally.steps), tally.most_substeps);
}

/// `unfinished`: so many contacts may say that they are uncertain.
void expect_safe(const walks::Terrain& terrain, const SafetyTally& tally, std::uint64_t unfinished = 0) {
    EXPECT_EQ(tally.crossed, 0u) << terrain.name;
    EXPECT_EQ(tally.further, 0u) << terrain.name;
    EXPECT_EQ(tally.behind, 0u) << terrain.name;
    EXPECT_LE(tally.unfinished, unfinished) << terrain.name;
    EXPECT_GT(tally.contacts, tally.steps / 20) << terrain.name;
}

/// FORCESHADE_LONG: more than 10^8 steps in all, some minutes.
template <typename T> void wander_everywhere() {
    const std::uint64_t steps = std::getenv("FORCESHADE_LONG") ? 8000000 : 50000;
    for (const walks::Terrain& terrain : walks::terrains()) {
        SafetyTally tally;
        wander<T>(terrain, steps, 1, tally);
        print(terrain, tally);
        expect_safe(terrain, tally);
        // In float a skin is wide enough for a proxy to rest, once in a long while, on what rounds edges.
        const std::uint64_t seldom = std::is_same_v<T, double> ? 0 : tally.contacts / 20000;
        EXPECT_LE(tally.outside_cone, seldom) << terrain.name;
        EXPECT_LE(tally.again, seldom) << terrain.name;
        EXPECT_LE(tally.worst_shift, (std::is_same_v<T, double> ? 1.01 : 4.01)) << terrain.name;
    }
}

/// Of corners of many triangles. In float, folds as narrow as the skin may once in a long while let the next update go
/// on, or leave a contact that no planes tell.
template <typename T> void wander_in_pits() {
    const std::uint64_t steps = std::getenv("FORCESHADE_LONG") ? 8000000 : 400000;
    for (const walks::Terrain& terrain : walks::pits()) {
        SafetyTally tally;
        wander<T>(terrain, steps / terrain.valence, 1, tally);
        print(terrain, tally);
        expect_safe(terrain, tally, std::is_same_v<T, double> ? 0 : tally.contacts / 40);
        EXPECT_LE(tally.again, (std::is_same_v<T, double> ? 0 : tally.contacts / 500)) << terrain.name;
        EXPECT_LE(tally.most_substeps, 2000u) << terrain.name;
    }
}

TEST(GodObjectSafety, Double) {
    wander_everywhere<double>();
}
TEST(GodObjectSafety, Float) {
    wander_everywhere<float>();
}
TEST(GodObjectSafety, PitsDouble) {
    wander_in_pits<double>();
}
TEST(GodObjectSafety, PitsFloat) {
    wander_in_pits<float>();
}

} // namespace
} // namespace forceshade
