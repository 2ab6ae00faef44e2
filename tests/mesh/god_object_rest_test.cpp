// L6: one update converges fully, at folded corners of many triangles too: from where the proxy rests a solver that
// walks on the surface itself goes no further, and the same probe given again moves nothing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"

namespace forceshade {
namespace {

using glm::dvec3;

template <typename T> brute::SurfaceWalker walker_of(const layout::MeshView<T>& mesh) {
    std::vector<dvec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t i = 0; i + 2 < mesh.vertices.size(); i += 3)
        vertices.emplace_back(mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]);
    const auto& corners = mesh.triangle_corners;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return {vertices, triangles, {mesh.triangle_facets.begin(), mesh.triangle_facets.end()}};
}

struct RestTally {
    std::uint64_t steps = 0, contacts = 0, crossed = 0;
    std::uint64_t again = 0;     /* moved on when the same probe was given again */
    std::uint64_t stuck = 0;     /* rested where the solver goes on */
    std::uint64_t elsewhere = 0; /* rests elsewhere than the solver that came the same way, and no worse by itself */
    std::uint64_t ties = 0;      /* the same where the solver might have gone either way */
};

template <typename T> class Path {
public:
    static constexpr double kSkin = walks::Run<T>::kSkin;
    static constexpr double kFlush = std::is_same_v<T, double> ? 1e-12 : kSkin / 8;
    static constexpr double kApart = std::is_same_v<T, double> ? 1e-9 : 16 * kSkin;

    Path(const walks::Terrain& terrain, std::uint64_t seed)
        : run_(terrain.polygons), beside_(walker_of(run_.mesh)), after_(beside_),
          wanderer_(run_.structure, seed, terrain.focus) {}

    void wander(std::uint64_t steps, RestTally& tally) {
        bool fresh = true;
        for (std::uint64_t i = 0; i < steps; ++i) {
            at_ = fresh || i % 500 == 0 ? wanderer_.begin() : wanderer_.step(at_);
            if (fresh || i % 500 == 0) {
                run_.state = {};
                beside_.begin(walks::wide(glm::vec<3, T>(at_)));
            }
            fresh = !step(tally);
        }
    }

private:
    /// False if the proxy and the solver are on different ways from here.
    bool step(RestTally& tally) {
        const glm::vec<3, T> probe(at_);
        const auto contact = run_.update(probe);
        const bool rests = beside_.update(walks::wide(probe));
        const bool apart = !rests || glm::length(walks::wide(contact.proxy) - beside_.proxy()) > kApart;
        ++tally.steps;
        tally.contacts += contact.touching;
        tally.crossed += run_.crossed;
        tally.again += run_.moves_again(probe, contact) > 2 * kSkin;
        // Two ways down from a corner about as steep as each other: the skin may send the proxy down the other.
        (beside_.margin() < 0.05L ? tally.ties : tally.elsewhere) += apart;
        tally.stuck += contact.touching && goes_on(contact, probe);
        return !apart;
    }

    bool goes_on(const reference::GodObjectContact<T>& contact, const glm::vec<3, T>& probe) {
        const std::uint32_t triangle = contact.triangles[0];
        const auto normal = reference::vector_at(run_.mesh.triangle_normals, triangle);
        after_.begin_on(triangle, walks::wide(contact.proxy), dot(normal, contact.normals[0]) > 0, kFlush);
        after_.update(walks::wide(probe));
        const double gain =
            glm::length(walks::wide(contact.proxy - probe)) - glm::length(after_.proxy() - walks::wide(probe));
        return gain > 4 * kSkin && glm::length(after_.proxy() - walks::wide(contact.proxy)) > kApart;
    }

    walks::Run<T> run_;
    brute::SurfaceWalker beside_, after_;
    walks::Wanderer wanderer_;
    dvec3 at_{0};
};

/// In double, folds are wide beside the skin: the proxy rests where the solver would, but for one way in tens of
/// thousands of contacts that neither stride nor walk finds. In float those of a corner of many triangles are not, for
/// as far as thousands of skins.
template <typename T> void expect_rest(const std::string& name, const RestTally& tally, bool narrow) {
    EXPECT_EQ(tally.crossed, 0u) << name;
    EXPECT_GT(tally.contacts, tally.steps / 20) << name;
    const bool exact = std::is_same_v<T, double>;
    EXPECT_LE(tally.again, exact ? 0 : tally.contacts / 2000) << name;
    EXPECT_LE(tally.stuck, exact ? tally.steps / 30000 : tally.contacts / (narrow ? 10 : 200)) << name;
    EXPECT_LE(tally.elsewhere + tally.ties, tally.contacts / (exact ? 100 : narrow ? 8 : 25)) << name;
}

/// Fans round a corner below or amid their rim, more and more folded.
template <typename T> void rest_on_stars() {
    for (const unsigned valence : {4U, 6U, 8U, 12U, 40U})
        for (const double relief : {0.2, 0.4, 0.8}) {
            RestTally tally;
            for (unsigned seed = 1; seed <= (walks::in_long_form() ? 50 : 5); ++seed)
                for (const double depth : {0.0, 0.3})
                    Path<T>({"star", walks::pit(valence, relief, seed, depth), valence, dvec3(0, 0, -depth)}, seed)
                        .wander(300, tally);
            expect_rest<T>(fmt::format("star {} {}", valence, relief), tally, false);
        }
}

template <typename T> void rest_in_pits() {
    for (const walks::Terrain& terrain : walks::pits()) {
        RestTally tally;
        Path<T>(terrain, 1).wander(walks::in_long_form() ? 30000 : 200000 / (100 + terrain.valence), tally);
        expect_rest<T>(terrain.name, tally, terrain.valence > 40);
    }
}

/// Patches whose nodes stand at random heights, up to `relief` cells off the plane: crumpled, or spikes.
walks::Terrain rough(unsigned cells, double relief, unsigned seed) {
    std::mt19937 random(seed);
    const auto height = [&](double, double) {
        return relief / cells * (2 * double(random()) / double(std::mt19937::max()) - 1);
    };
    return {fmt::format("rough {}", relief), shapes::patch(shapes::Cells::triangles, cells, height)};
}

/// At a corner a proxy finds a way into every sector that is free, but for a few rests in ten thousand between spikes.
template <typename T> void rest_on_rough_terrain() {
    for (const double relief : {1.0, 3.0, 8.0}) {
        RestTally tally;
        for (unsigned seed = 1; seed <= (walks::in_long_form() ? 100 : 6); ++seed)
            Path<T>(rough(16, relief, seed), seed).wander(3000, tally);
        EXPECT_EQ(tally.crossed, 0u) << relief;
        const bool exact = std::is_same_v<T, double>;
        EXPECT_LE(tally.stuck,
                  exact && relief < 8 && !walks::in_long_form() ? 0 : tally.contacts / (exact ? 3000 : 2000))
            << relief;
        EXPECT_LE(tally.again, tally.contacts / 5000) << relief;
    }
}

TEST(GodObjectRest, OnRoughTerrain) {
    rest_on_rough_terrain<double>();
    rest_on_rough_terrain<float>();
}
TEST(GodObjectRest, OnStars) {
    rest_on_stars<double>();
    rest_on_stars<float>();
}
TEST(GodObjectRest, InPits) {
    rest_in_pits<double>();
    rest_in_pits<float>();
}

// Folds and polyhedra touch themselves, which the solver does not know.
TEST(GodObjectRest, WhereTheSolverDoes) {
    RestTally all;
    for (const walks::Terrain& terrain : walks::terrains()) {
        if (terrain.name == "folds" || terrain.name == "polyhedra")
            continue;
        RestTally tally;
        Path<double>(terrain, 99).wander(walks::in_long_form() ? 200000 : 10000, tally);
        EXPECT_EQ(tally.elsewhere + tally.crossed, 0u) << terrain.name;
        all.contacts += tally.contacts;
        all.ties += tally.ties;
    }
    EXPECT_LE(all.ties, all.contacts / 10000);
}

} // namespace
} // namespace forceshade
