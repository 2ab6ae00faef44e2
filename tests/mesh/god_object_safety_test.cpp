// L6: whatever the steps, the proxy crosses nothing, comes never further from the probe than it was, and rests only
// where the facets hold it; also where moves aim at corners, edges and faces, however small or large they are.
#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"
#include "tests/places.h"

namespace forceshade {
namespace {

struct SafetyTally {
    std::uint64_t steps = 0, contacts = 0, crossed = 0, further = 0, outside_cone = 0, unfinished = 0;
    std::uint64_t most_substeps = 0, behind = 0, again = 0;
    double worst_shift = 0;
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

template <typename T> SafetyTally wander(const walks::Terrain& terrain, std::uint64_t steps) {
    walks::Run<T> run(terrain.polygons);
    walks::Wanderer wanderer(run.structure, 1, terrain.focus);
    SafetyTally tally;
    glm::dvec3 at{0};
    const double skin = run.kSkin;
    for (std::uint64_t i = 0; i < steps; ++i) {
        at = i % 1000 == 0 ? wanderer.begin() : wanderer.step(at);
        if (i % 1000 == 0)
            run.state = {};
        const glm::vec<3, T> probe(at);
        const bool fresh = !run.state.started;
        const double depth = glm::length(walks::wide(run.state.proxy) - walks::wide(probe));
        const auto contact = run.update(probe);
        const double further = glm::length(walks::wide(run.state.proxy) - walks::wide(probe)) - depth;
        std::array<glm::dvec3, 3> normals;
        for (unsigned k = 0; k < contact.count; ++k)
            normals[k] = walks::wide(contact.normals[k]);
        const glm::dvec3 pull = walks::wide(probe) - walks::wide(contact.proxy);
        const double floor = 64 * double(std::numeric_limits<T>::epsilon());
        const double off = brute::distance_from_cone(pull, std::span(normals.data(), contact.count));
        // The reported proxy is the walked one without its skin, and nothing is between.
        const glm::dvec3 back = walks::wide(run.state.proxy) - walks::wide(contact.proxy);
        const double shift = contact.touching ? glm::length(back) / skin : 0;
        // Touching is allowed within two skins; in an acute corner, where it is a hundredth of a skin wide.
        const double skins = skins_to(normals, contact.count), lift = (2 + 0.01 * skins) / shift;
        ++tally.steps;
        tally.contacts += contact.touching;
        tally.most_substeps = std::max<std::uint64_t>(tally.most_substeps, contact.substeps);
        tally.unfinished += !contact.finished;
        tally.crossed += run.crossed;
        tally.further += !fresh && further > 8 * skin;
        tally.outside_cone += std::max(0.0, off - floor) / std::max(glm::length(pull), 1e-300) > 1e-9;
        tally.behind +=
            lift < 1 && run.grid.touches(walks::wide(run.state.proxy), walks::wide(contact.proxy) + lift * back);
        tally.again += run.moves_again(probe, contact) > 2 * skin;
        tally.worst_shift = std::max(tally.worst_shift, shift / (1 + skins));
    }
    return tally;
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
    for (const walks::Terrain& terrain : walks::terrains()) {
        const SafetyTally tally = wander<T>(terrain, walks::in_long_form() ? 8000000 : 50000);
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
    for (const walks::Terrain& terrain : walks::pits()) {
        const SafetyTally tally = wander<T>(terrain, (walks::in_long_form() ? 8000000 : 400000) / terrain.valence);
        expect_safe(terrain, tally, std::is_same_v<T, double> ? 0 : tally.contacts / 40);
        EXPECT_LE(tally.again, (std::is_same_v<T, double> ? 0 : tally.contacts / 500)) << terrain.name;
        EXPECT_LE(tally.most_substeps, 2000u) << terrain.name;
    }
}

TEST(GodObjectSafety, Everywhere) {
    wander_everywhere<double>();
    wander_everywhere<float>();
}
TEST(GodObjectSafety, InPits) {
    wander_in_pits<double>();
    wander_in_pits<float>();
}

struct AimedTally {
    std::uint64_t steps = 0, contacts = 0, crossed = 0, unfinished = 0;
};

template <typename T> void aim(PolygonSoup polygons, std::uint64_t walks, std::uint64_t seed, AimedTally& tally) {
    walks::Run<T> run(std::move(polygons));
    walks::Aimer aimer(run.structure, seed);
    for (std::uint64_t i = 0; i < walks; ++i) {
        run.state = {};
        glm::dvec3 at{0};
        bool crossed = false, unfinished = false;
        for (unsigned step = 0; step < walks::Aimer::kSteps && !crossed && !unfinished; ++step) {
            at = step == 0 ? aimer.begin() : aimer.step(at);
            const auto contact = run.update(glm::vec<3, T>(at));
            const double gap = std::sqrt(double(reference::nearest(run.mesh, run.state.proxy).square)) / run.kSkin;
            ++tally.steps;
            tally.contacts += contact.touching;
            unfinished = !contact.finished;
            crossed = run.crossed || gap < walks::kLeastGap;
        }
        tally.crossed += crossed;
        tally.unfinished += unfinished;
    }
}

/// FORCESHADE_LONG: 10^9 steps in all.
template <typename T> void aim_on(const std::vector<walks::Terrain>& terrains) {
    for (const walks::Terrain& terrain : terrains) {
        AimedTally tally;
        aim<T>(terrain.polygons, walks::in_long_form() ? 2500000 : 5000, 1, tally);
        EXPECT_EQ(tally.crossed, 0u) << terrain.name;
        // In narrow corners a contact may say that it is uncertain.
        EXPECT_LE(tally.unfinished, tally.contacts / 150) << terrain.name;
        EXPECT_GT(tally.contacts, tally.steps / 20) << terrain.name;
    }
}

TEST(GodObjectAimed, Solids) {
    aim_on<double>(walks::solids());
    aim_on<float>(walks::solids());
}
TEST(GodObjectAimed, Meshes) {
    aim_on<double>(walks::meshes({in_source("tests/data/spot.obj")}));
    aim_on<float>(walks::meshes({in_source("tests/data/spot.obj")}));
}

/// Triangles that cut each other everywhere: a few walks on each of many soups.
TEST(GodObjectAimed, Soups) {
    AimedTally tally;
    for (unsigned seed = 1; seed <= (walks::in_long_form() ? 20000 : 500); ++seed) {
        aim<double>(walks::soup(seed), 10, seed, tally);
        aim<float>(walks::soup(seed), 10, seed, tally);
    }
    EXPECT_EQ(tally.crossed, 0u);
    EXPECT_EQ(tally.unfinished, 0u);
}

/// Along an edge, past the corner where it begins: the move comes nearer to the edge by a skin over its whole length,
/// and a place a little past the corner may be taken for one at it.
TEST(GodObjectAimed, AlongAnEdgePastItsCorner) {
    walks::Run<double> run(walks::solids()[0].polygons);
    const auto gap = [&](const glm::dvec3& place) {
        return std::sqrt(reference::nearest(run.mesh, place).square) / run.kSkin;
    };
    for (const glm::dvec3& probe :
         {glm::dvec3(1.0000000000009546, 1.0000000000003315, 1.0000000000006557), glm::dvec3(1, -1, -1)}) {
        reference::update(run.mesh, run.state, *run.around, probe,
                          [&](const auto&, const auto& to) { EXPECT_GT(gap(to), walks::kLeastGap); });
        EXPECT_GT(gap(run.state.proxy), walks::kLeastGap);
    }
}

} // namespace
} // namespace forceshade
