// L6: moves that aim at corners, edges and faces make no proxy cross anything, however small or large they are.
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

/// A move ends 7/8 of a skin from a triangle; what is far below that has lost its skin and meets nothing any more.
constexpr double kLeastGap = 0.86;

struct AimedTally {
    std::uint64_t walks = 0, steps = 0, contacts = 0, pieces = 0, crossed = 0, unfinished = 0;
    double least_gap = 1; /* between a proxy at rest and the mesh, in skins */
};

/// Every piece of every walk is checked in exact arithmetic.
template <typename T>
void walk(const std::string& name, const MeshStructure& structure, std::uint64_t walks, std::uint64_t seed,
          AimedTally& tally) {
    const MeshTables<T> tables = make_mesh_tables<T>(structure, 1.0);
    const layout::MeshView<T> mesh = tables.view();
    const brute::Triangles triangles = brute::Triangles::of(mesh.vertices, mesh.triangle_corners);
    const brute::TriangleGrid grid(triangles);
    walks::Aimer aimer(structure, seed);
    auto around = std::make_unique<reference::Neighbourhood<T>>();
    for (std::uint64_t i = 0; i < walks; ++i) {
        reference::GodObject<T> state;
        std::vector<glm::dvec3> way;
        bool crossed = false, unfinished = false;
        const auto trace = [&](const glm::vec<3, T>& from, const glm::vec<3, T>& to) {
            ++tally.pieces;
            crossed = crossed || grid.touches(walks::wide(from), walks::wide(to));
        };
        for (unsigned step = 0; step < walks::Aimer::kSteps && !crossed && !unfinished; ++step) {
            way.push_back(step == 0 ? aimer.begin() : aimer.step(way.back()));
            const auto contact = reference::update(mesh, state, *around, glm::vec<3, T>(way.back()), trace);
            ++tally.steps;
            tally.contacts += contact.touching;
            unfinished = unfinished || !contact.finished;
            const double gap =
                std::sqrt(double(reference::nearest(mesh, state.proxy).square)) / double(reference::Skin<T>::kWidth);
            crossed = crossed || gap < kLeastGap;
            tally.least_gap = std::min(tally.least_gap, gap);
        }
        ++tally.walks;
        tally.crossed += crossed;
        tally.unfinished += unfinished;
        if ((crossed || unfinished) && tally.crossed + tally.unfinished <= 3) {
            fmt::print("{} f{} seed {} walk {}: {} ({:.4f} skins)\n", name, 8 * sizeof(T), seed, i,
                       crossed ? "crosses, or loses its skin" : "does not come to rest", tally.least_gap);
            for (const glm::dvec3& at : way)
                fmt::print("  {{{}, {}, {}}},\n", at.x, at.y, at.z);
        }
    }
}

/// More meshes to walk on: files, separated by colons.
std::vector<std::string> files() {
    std::vector<std::string> result = {FORCESHADE_TEST_DATA "/spot.obj"};
    const char* more = std::getenv("FORCESHADE_MESHES");
    for (std::string rest = more ? more : ""; !rest.empty();) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        result.push_back(rest.substr(0, end));
        rest.erase(0, end + 1);
    }
    return result;
}

/// FORCESHADE_LONG: 10^9 steps in all.
template <typename T> void walk_on(const std::vector<walks::Terrain>& terrains, std::uint64_t walks) {
    const char* seed = std::getenv("FORCESHADE_SEED");
    if (const char* count = std::getenv("FORCESHADE_WALKS"))
        walks = std::strtoull(count, nullptr, 10);
    for (const walks::Terrain& terrain : terrains) {
        const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
        AimedTally tally;
        walk<T>(terrain.name, structure, walks, seed ? std::strtoull(seed, nullptr, 10) : 1, tally);
        fmt::print(
            "{:18} f{} {:9} walks {:9} steps {:9} contacts {:9} pieces: {} crossed, {} unfinished, {:.4f} skins\n",
            terrain.name, 8 * sizeof(T), tally.walks, tally.steps, tally.contacts, tally.pieces, tally.crossed,
            tally.unfinished, tally.least_gap);
        EXPECT_EQ(tally.crossed, 0u) << terrain.name;
        // In narrow corners a contact may say that it is uncertain.
        EXPECT_LE(tally.unfinished, tally.contacts / 150) << terrain.name;
        EXPECT_GT(tally.contacts, tally.steps / 20) << terrain.name;
    }
}

std::uint64_t walks_a_mesh() {
    return std::getenv("FORCESHADE_LONG") ? 2500000 : 10000;
}

TEST(GodObjectAimed, SolidsDouble) {
    walk_on<double>(walks::solids(), walks_a_mesh());
}
TEST(GodObjectAimed, SolidsFloat) {
    walk_on<float>(walks::solids(), walks_a_mesh());
}
TEST(GodObjectAimed, MeshesDouble) {
    walk_on<double>(walks::meshes(files()), walks_a_mesh());
}
/// Triangles that cut each other everywhere: a few walks on each of many soups.
template <typename T> void walk_on_soups() {
    const unsigned soups = std::getenv("FORCESHADE_LONG") ? 20000 : 1000;
    AimedTally tally;
    for (unsigned seed = 1; seed <= soups; ++seed)
        walk<T>(fmt::format("soup {}", seed), build_structure(shapes::mesh_of(walks::soup(seed))), 10, seed, tally);
    fmt::print("{} soups f{}: {} walks {} contacts: {} crossed, {} unfinished\n", soups, 8 * sizeof(T), tally.walks,
               tally.contacts, tally.crossed, tally.unfinished);
    EXPECT_EQ(tally.crossed, 0u);
    EXPECT_EQ(tally.unfinished, 0u);
}

TEST(GodObjectAimed, SoupsDouble) {
    walk_on_soups<double>();
}
TEST(GodObjectAimed, SoupsFloat) {
    walk_on_soups<float>();
}
TEST(GodObjectAimed, MeshesFloat) {
    walk_on<float>(walks::meshes(files()), walks_a_mesh());
}

/// Along an edge, past the corner where it begins: the move comes nearer to the edge by a skin over its whole length,
/// and a place a little past the corner may be taken for one at it.
TEST(GodObjectAimed, AlongAnEdgePastItsCorner) {
    const MeshStructure structure = build_structure(shapes::mesh_of(walks::solids()[0].polygons));
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 1.0);
    auto around = std::make_unique<reference::Neighbourhood<double>>();
    const auto gap = [&](const glm::dvec3& place) {
        return std::sqrt(reference::nearest(tables.view(), place).square) / reference::Skin<double>::kWidth;
    };
    reference::GodObject<double> state;
    for (const glm::dvec3& probe :
         {glm::dvec3(1.0000000000009546, 1.0000000000003315, 1.0000000000006557), glm::dvec3(1, -1, -1)}) {
        reference::update(tables.view(), state, *around, probe,
                          [&](const auto&, const auto& to) { EXPECT_GT(gap(to), kLeastGap); });
        EXPECT_GT(gap(state.proxy), kLeastGap);
    }
}

} // namespace
} // namespace forceshade
