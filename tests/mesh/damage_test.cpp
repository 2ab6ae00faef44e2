// Facets without area, needles of no width and facets given twice change nothing: inside is where the winding number of
// the sound mesh says, near and far, in both precisions.
#include <algorithm>
#include <cmath>
#include <random>

#include <glm/common.hpp>
#include <gtest/gtest.h>

#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"
#include "tests/mesh/damage.h"
#include "tests/mesh/mesh_law.h"

namespace forceshade {
namespace {

using shapes::anywhere;
using shapes::Damage;

PolygonSoup shape(unsigned kind, std::mt19937& random) {
    switch (kind % 6) {
    case 0:
        return shapes::cube(true);
    case 1:
        return shapes::moved(
            shapes::merged(shapes::icosphere(1), shapes::moved(shapes::cube(true), glm::dvec3(-0.3), {})), {1, 1, 0.5},
            {});
    case 2:
        return shapes::tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.1, 0.2, 0.7});
    default:
        return shapes::lumpy_sphere(kind % 6 == 3 ? 2 : 1, random);
    }
}

/// On the surface, an edge or a corner, or off by up to `off`.
glm::dvec3 near_surface(const PolygonSoup& polygons, double off, std::mt19937& random) {
    const std::size_t first = 3 * (random() % polygons.facets());
    const auto vertex = [&](std::size_t i) { return polygons.vertices[polygons.corners[first + i]]; };
    const double u = random() % 3 == 0 ? 0 : std::abs(shapes::uniform(random)),
                 v = (1 - u) * std::abs(shapes::uniform(random));
    return vertex(0) + u * (vertex(1) - vertex(0)) + v * (vertex(2) - vertex(0)) + anywhere(random, off);
}

struct Count {
    int asked = 0, wrong = 0, referee_wrong = 0;
};

/// Probes against the sound mesh's winding number; `surely` in units of the frame: nearer ones are not judged.
template <typename T>
Count count_wrong(const Mesh& sound, const Mesh& broken, int probes, double surely, std::mt19937& random) {
    const shapes::MeshLaw<T> law(broken);
    const MeshStructure& structure = law.structure;
    const layout::MeshView<T>& view = law.view;
    const brute::MeshReferee referee(sound, {}), of_broken(broken, {});
    Count count;
    for (int i = 0; i < probes; ++i) {
        const double off = std::pow(10.0, -4 + 4 * std::abs(shapes::uniform(random)));
        const glm::dvec3 world = i % 3 == 0 ? structure.centre + structure.scale * anywhere(random, i % 2 == 0 ? 1 : 30)
                                            : near_surface(sound.polygons, off * structure.scale, random);
        const reference::Vector<T> probe = law.local(world);
        const auto found = reference::nearest(view, probe);
        if (std::sqrt(double(found.square)) < surely * std::max(1.0, double(reference::largest_coordinate(probe))))
            continue;
        ++count.asked;
        const glm::dvec3 there = structure.centre + structure.scale * glm::dvec3(probe);
        const bool inside = referee.winding_number(there) > 0.5L;
        count.wrong += reference::inside_by_pseudonormal(view, found) != inside;
        // What the program is validated by must know these meshes too.
        count.referee_wrong += (of_broken.at(there).depth > 0) != inside;
        count.referee_wrong += (of_broken.winding_number(there) > 0.5L) != inside;
    }
    return count;
}

void expect_right(const Damage& most, const MeshPlacement& placement, unsigned meshes, const char* what) {
    std::mt19937 random(11);
    Count doubles, singles;
    for (unsigned i = 0; i < (std::getenv("FORCESHADE_LONG") ? meshes : meshes / 4); ++i) {
        const PolygonSoup polygons = shapes::rounded(shape(i, random));
        const auto some = [&](unsigned count) { return count > 0 ? 1 + unsigned(random()) % count : 0; };
        const Damage damage{some(most.caps), some(most.needles), some(most.repeats),
                            some(std::min(most.strays, unsigned(polygons.facets() / 10))), most.shuffled};
        const PolygonSoup broken = shapes::damaged(polygons, damage, random);
        const Mesh sound_mesh = prepare_mesh(polygons, placement, VertexNormals::plain);
        const Mesh mesh = prepare_mesh(broken, placement, VertexNormals::plain);
        const Count one = count_wrong<double>(sound_mesh, mesh, 100, 1e-8, random);
        const Count other = count_wrong<float>(sound_mesh, mesh, 100, 1e-4, random);
        doubles = {doubles.asked + one.asked, doubles.wrong + one.wrong, doubles.referee_wrong + one.referee_wrong};
        singles = {singles.asked + other.asked, singles.wrong + other.wrong,
                   singles.referee_wrong + other.referee_wrong};
    }
    EXPECT_EQ(doubles.wrong, 0) << what << ", of " << doubles.asked;
    EXPECT_EQ(singles.wrong, 0) << what << ", of " << singles.asked;
    EXPECT_EQ(doubles.referee_wrong + singles.referee_wrong, 0) << what;
}

constexpr MeshPlacement kTurned{.unit = 1e-3, .scale = 1.7, .rotate = {0.3, 1.1, -0.7}, .translate = {0.01, 0.02, 0.7}};
constexpr MeshPlacement kFar{.unit = 1, .scale = 1, .rotate = {0.3, 1.1, -0.7}, .translate = {1000, -300, 20}};

TEST(Damage, ChangesNothing) {
    struct Row {
        const char* what;
        Damage most;
        MeshPlacement placement;
        unsigned meshes = 120;
    };
    // Of a mesh that is given once as it is and once turned over, neither side could be told from the other.
    for (const Row& row : {Row{"sound", {}, {}, 60},
                           {"one cap", {.caps = 1}, {}},
                           {"caps", {.caps = 100}, {}},
                           {"one cap turned", {.caps = 1}, kTurned},
                           {"caps turned", {.caps = 100}, kTurned},
                           {"caps far", {.caps = 100}, kFar},
                           {"needles", {.needles = 30}, {}},
                           {"needles turned", {.needles = 30}, kTurned},
                           {"one repeat", {.repeats = 1}, {}},
                           {"repeats", {.repeats = 100}, kTurned},
                           {"at most one stray", {.strays = 1}, {}},
                           {"strays", {.strays = 10}, kTurned},
                           {"repeats and strays", {.repeats = 20, .strays = 10}, kFar},
                           {"all", {.caps = 60, .needles = 20, .repeats = 40}, {}, 200},
                           {"all with strays", {.caps = 60, .needles = 20, .repeats = 40, .strays = 3}, kTurned, 200}})
        expect_right(row.most, row.placement, row.meshes, row.what);
}

// In the file three corners of each are on a line, exactly; in another unit rounding gives some an area.
TEST(Damage, ThreadsOfNoAreaAreLeftOutInAnyUnit) {
    for (const double unit : {1.0, 1e-3, 0.0254}) {
        std::mt19937 random(3);
        PolygonSoup polygons = shapes::icosphere(1);
        std::vector<glm::dvec3> middles;
        for (int i = 0; i < 20; ++i) {
            const glm::dvec3 begin = 64.0 * anywhere(random, 2), way = 64.0 * anywhere(random, 1);
            for (const double share : {0.0, 2.0, 1.0}) // multiples of 1/64: the middle is exact
                polygons.vertices.push_back((glm::round(begin) + share * glm::round(way)) / 64.0);
            middles.push_back(polygons.vertices.back());
            const auto last = static_cast<std::uint32_t>(polygons.vertices.size() - 1);
            shapes::add_facet(polygons, {last - 2, last - 1, last});
        }
        const shapes::MeshLaw<> law(shapes::moved(polygons, glm::dvec3(unit), {}));
        EXPECT_EQ(inspect(law.mesh.polygons).degenerate_facets, 20u) << unit;
        const brute::MeshReferee referee(law.mesh, {});
        for (const glm::dvec3& middle : middles) {
            const auto found = reference::nearest(law.view, law.local(unit * middle));
            EXPECT_NEAR(law.structure.scale * std::sqrt(found.square), double(referee.nearest(unit * middle).distance),
                        1e-12 * unit);
        }
    }
}

} // namespace
} // namespace forceshade
