// Exploration paths over meshes, open and closed loop: samples and metrics have the oracle's bits.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gtest/gtest.h>

#include "host/mesh/mesh_file.h"
#include "tests/gpu/mesh_path_case.h"
#include "tests/gpu/software_device.h"

namespace forceshade {
namespace {

using test::MeshPathCase;
using test::PathShape;

PathShape shape_of(layout::uint motion, layout::uint loop, std::size_t paths = 64, std::size_t steps = 200) {
    PathShape shape;
    shape.features.motion = motion;
    shape.features.loop = loop;
    shape.features.harmonics = motion == layout::kMotionRandomWalk ? 6 : 1;
    shape.features.channels = test::kAllPathChannels;
    shape.paths = paths;
    shape.steps = steps;
    return shape;
}

// A sphere of 25 mm whose top is the origin.
MeshStructure ball(unsigned levels) {
    return build_structure(
        shapes::mesh_of(shapes::moved(shapes::icosphere(levels), glm::dvec3(0.025), glm::dvec3(0, 0, -0.025))));
}

class MeshPath : public test::SoftwareDeviceTest {
protected:
    static compute::MeshPathKernel& kernel() {
        static compute::MeshPathKernel one(device());
        return one;
    }

    template <typename T> static test::PathComparison held(test::MeshPathRunner& runner, MeshPathCase<T>& one) {
        return test::hold_input(runner, one.input(), [&](std::size_t path) { return one.length(path); });
    }

    template <typename T>
    static test::PathComparison hold(MeshPathCase<T>& one, const std::string& name,
                                     compute::MeshPathKernel& on = kernel()) {
        test::MeshPathRunner runner{on};
        const test::PathComparison comparison = held(runner, one);
        EXPECT_TRUE(is_equal(comparison)) << name << ", f" << 8 * sizeof(T);
        return comparison;
    }

    // Paths that wander over a terrain.
    template <typename T>
    static compute::MeshPathTimes wander(const walks::Terrain& terrain, compute::MeshPathKernel& on = kernel(),
                                         std::size_t steps = 60) {
        const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
        MeshPathCase<T> one(structure, shape_of(layout::kMotionRecorded, layout::kLoopOpen, 24, steps),
                            test::Probes::wandering, terrain.focus);
        test::MeshPathRunner runner{on};
        EXPECT_TRUE(is_equal(held(runner, one))) << terrain.name << ", f" << 8 * sizeof(T);
        return runner.times;
    }
};

TEST_F(MeshPath, EveryMotionOpenAndClosed) {
    const MeshStructure structure = ball(4);
    std::uint64_t touching = 0;
    for (layout::uint motion = layout::kMotionStrokes; motion <= layout::kMotionRecorded; ++motion)
        for (const layout::uint loop : {layout::kLoopOpen, layout::kLoopClosed}) {
            PathShape shape = shape_of(motion, loop, 40, 150);
            shape.seed = motion + 1;
            shape.reach = 0.004;
            shape.delay = motion % 2;
            shape.own_hands = motion % 3 == 0;
            shape.coulomb = motion % 2 ? 0.01 : 0;
            shape.quantum = motion % 4 ? 0 : 1e-5;
            MeshPathCase<float> one(structure, shape);
            touching += hold(one, fmt::format("motion {} loop {}", motion, loop)).touching;
        }
    EXPECT_GT(touching, 10000u);
    MeshPathCase<double> one(structure, shape_of(layout::kMotionCircle, layout::kLoopClosed));
    EXPECT_GT(hold(one, "circle").touching, 100u);
}

TEST_F(MeshPath, WanderingOverEveryTerrain) {
    std::array<std::uint64_t, 2> host{};
    for (const auto& terrains : {walks::terrains(), walks::pits()})
        for (const walks::Terrain& terrain : terrains)
            for (const bool f64 : {false, true})
                host[f64] += (f64 ? wander<double>(terrain) : wander<float>(terrain)).host_updates;
    EXPECT_GT(host[0], 400u);
    EXPECT_GT(host[1], 150u);
}

// Moves that aim at corners and edges: the oracle's bits, and no piece of the oracle's walks crosses anything.
TEST_F(MeshPath, AimedAtCornersAndEdges) {
    const std::size_t paths = std::getenv("FORCESHADE_LONG") ? 1000000 : 10000;
    const auto hold_and_watch = [&]<typename T>(const walks::Terrain& terrain, T) {
        const MeshStructure structure = build_structure(shapes::mesh_of(terrain.polygons));
        constexpr std::size_t kSlice = 5000; // paths held in memory at once
        for (std::size_t first = 0; first < paths; first += kSlice) {
            PathShape shape = shape_of(layout::kMotionRecorded, layout::kLoopOpen, kSlice, walks::Aimer::kSteps);
            shape.seed = 1 + first / kSlice;
            MeshPathCase<T> one(structure, shape, test::Probes::aimed);
            EXPECT_GT(hold(one, terrain.name).touching, kSlice / 4);
            EXPECT_EQ(test::crossings(one, kSlice, walks::Aimer::kSteps), 0u) << terrain.name;
        }
    };
    for (const auto& terrains : {walks::solids(), walks::meshes({FORCESHADE_DATA "/spot.obj"})})
        for (const walks::Terrain& terrain : terrains) {
            hold_and_watch(terrain, float());
            hold_and_watch(terrain, double());
        }
}

// Strokes through a model of edges that fold either way: the host finishes many updates, and the kernel goes on from
// them.
TEST_F(MeshPath, TheHostFinishesRestsAtEdges) {
    const MeshStructure structure =
        build_structure(shapes::mesh_of(read_polygons(FORCESHADE_DATA "/spot.obj").polygons));
    PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopOpen, 400, 150);
    shape.reach = 0.4;
    shape.depth = 0.3;
    shape.seed = 3;
    const auto finished = [&](auto one) {
        test::MeshPathRunner runner{kernel()};
        EXPECT_TRUE(is_equal(held(runner, one)));
        EXPECT_LT(runner.times.host_updates, shape.paths * shape.steps / 2) << "the kernel ends the others";
        return runner.times.host_updates;
    };
    EXPECT_GT(finished(MeshPathCase<float>(structure, shape)), 400u);
    EXPECT_GT(finished(MeshPathCase<double>(structure, shape)), 400u);
}

// Where walks come to edges, some run out of loops on the way.
TEST_F(MeshPath, WalksToEdgesWithFewLoops) {
    compute::MeshPathOptions options;
    options.limit = 300;
    compute::MeshPathKernel few(device(), options);
    std::vector<walks::Terrain> terrains{{"spot", read_polygons(FORCESHADE_DATA "/spot.obj").polygons},
                                         {"narrow folds", walks::pit(24, 0.3), 24, glm::dvec3(0, 0, -0.3)}};
    for (const walks::Terrain& terrain : terrains)
        for (const compute::MeshPathTimes& times :
             {wander<float>(terrain, few, 200), wander<double>(terrain, few, 200)}) {
            EXPECT_GT(times.host_updates, 10u) << terrain.name;
        }
}

TEST_F(MeshPath, ShadingsTiltsAndTextures) {
    const MeshStructure structure =
        build_structure(shapes::mesh_of(read_polygons(FORCESHADE_DATA "/spot.obj").polygons));
    for (const layout::uint shading : {layout::kShadingNone, layout::kShadingMorgenbesser, layout::kShadingBarycentric,
                                       layout::kShadingMeanValue, layout::kShadingTwoPass})
        for (const bool maps : {false, true}) {
            MeshPathCase<float> one(structure, shape_of(layout::kMotionRecorded, layout::kLoopOpen, 48, 80),
                                    test::Probes::wandering);
            one.law.features.shading = shading;
            if (maps) {
                one.law.features.map = layout::kMapSine;
                one.law.features.texture = layout::kMapGaussian;
                one.law.params.map.slope = 0.3F;
                one.law.params.map.inverse_length = 7;
                one.law.params.texture.slope = 0.2F;
                one.law.params.texture.inverse_length = 2;
                one.law.params.texture_stiffness = 100;
            }
            EXPECT_GT(hold(one, fmt::format("shading {}", shading)).touching, 400u);
        }
}

// Places are measured from the scene's origin, height maps are read in the world.
TEST_F(MeshPath, FarFromTheWorldsOrigin) {
    const MeshStructure structure = build_structure(shapes::mesh_of(
        shapes::moved(shapes::icosphere(3), glm::dvec3(0.025), glm::dvec3(566321.26, -5933204.5, 12.25))));
    const auto felt = [&]<typename T>(T) {
        MeshPathCase<T> one(structure, shape_of(layout::kMotionRecorded, layout::kLoopOpen, 48, 80),
                            test::Probes::wandering);
        EXPECT_LT(std::abs(one.law.mesh.params.centre_x), T(structure.scale));
        EXPECT_EQ(one.law.mesh.params.map_x, T(structure.centre.x));
        one.law.mesh.params.map_x = T(0.0123);
        one.law.features.map = layout::kMapGaussian;
        one.law.features.texture = layout::kMapSine;
        one.law.params.map.slope = T(0.3);
        one.law.params.map.inverse_length = T(0.1);
        one.law.params.texture.slope = T(0.2);
        one.law.params.texture.inverse_length = T(70);
        one.law.params.texture_stiffness = T(100);
        return hold(one, "far").touching;
    };
    EXPECT_GT(felt(float()), 400u);
    EXPECT_GT(felt(double()), 400u);
}

// What the law does not read stays with the host.
TEST_F(MeshPath, UploadsWhatIsReadAlone) {
    const MeshStructure structure = ball(1);
    constexpr std::size_t kPaths = 8, kSteps = 5;
    const auto uploaded = [&](layout::uint shading, std::size_t paths) {
        MeshPathCase<float> one(structure, shape_of(layout::kMotionRecorded, layout::kLoopOpen, paths, kSteps),
                                test::Probes::wandering);
        one.law.features.shading = shading;
        test::MeshPathRunner runner{kernel()};
        EXPECT_TRUE(is_equal(held(runner, one)));
        return runner.times.uploaded;
    };
    MeshPathCase<float> some(structure, shape_of(layout::kMotionStrokes, layout::kLoopOpen));
    const layout::MeshView<float> mesh = some.law.mesh;
    constexpr std::size_t kVector = 4 * sizeof(float);
    const std::size_t vertices = mesh.vertices.size() / 3, facets = mesh.facet_normals.size() / 3;
    const std::size_t corners = sizeof(layout::uint) * (mesh.facet_begins.size() + mesh.facet_corners.size());
    const std::uint64_t least = uploaded(layout::kShadingNone, kPaths);
    EXPECT_EQ(uploaded(layout::kShadingMeanValue, kPaths) - least, (2 * vertices + facets) * kVector + corners);
    EXPECT_EQ(uploaded(layout::kShadingNone, 2 * kPaths) - least, kPaths * kSteps * 3 * sizeof(float))
        << "recorded paths have places and no motions";

    // Pseudonormals are for the host alone. Three sheets meet at an edge; the path stays far off.
    PolygonSoup sheets;
    sheets.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    sheets.corners = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    sheets.begins = {0, 3, 6, 9};
    const MeshStructure folded = build_structure(shapes::mesh_of(sheets));
    const auto uploaded_far_off = [&](bool pseudonormals) {
        PathShape shape = shape_of(layout::kMotionRecorded, layout::kLoopOpen, 1, 2);
        shape.own_lengths = false;
        MeshPathCase<float> one(folded, shape);
        for (std::size_t step = 0; step < 2; ++step)
            one.place(step, 0, {30, 0, 0});
        EXPECT_FALSE(one.law.mesh.edge_pseudonormals.empty());
        if (!pseudonormals)
            one.law.mesh.edge_pseudonormals = {};
        test::MeshPathRunner runner{kernel()};
        EXPECT_TRUE(is_equal(held(runner, one)));
        return runner.times.uploaded;
    };
    EXPECT_EQ(uploaded_far_off(true), uploaded_far_off(false));
}

TEST_F(MeshPath, InPiecesAsOnceThrough) {
    const MeshStructure structure = ball(3);
    compute::MeshPathOptions options;
    options.batch_paths = 17;
    options.chunk_bytes = 17 * 60 * 7;
    options.pause = 20;
    compute::MeshPathKernel pieces(device(), options);
    for (const layout::uint motion : {layout::kMotionRecorded, layout::kMotionStrokes}) {
        MeshPathCase<float> one(structure, shape_of(motion, layout::kLoopOpen, 40, 50),
                                motion == layout::kMotionRecorded ? test::Probes::wandering : test::Probes::of_case);
        hold(one, "pieces", pieces);
    }
}

// What takes more loops than an invocation may run goes to the host, and is the same.
TEST_F(MeshPath, FewLoops) {
    const MeshStructure structure = ball(4);
    compute::MeshPathOptions options;
    options.limit = 6;
    compute::MeshPathKernel few(device(), options);
    MeshPathCase<float> one(structure, shape_of(layout::kMotionRecorded, layout::kLoopOpen, 24, 60),
                            test::Probes::wandering);
    test::MeshPathRunner plain{kernel()}, runner{few};
    EXPECT_TRUE(is_equal(held(plain, one)));
    EXPECT_TRUE(is_equal(held(runner, one)));
    EXPECT_GT(runner.times.host_updates, plain.times.host_updates + 100);
}

// The software device ends loops after 65 535 iterations without a word.
TEST_F(MeshPath, FacetOfMoreCornersThanALoopMayTake) {
    constexpr std::uint32_t kCorners = 70000;
    PolygonSoup disc;
    disc.begins = {0, kCorners};
    for (std::uint32_t i = 0; i < kCorners; ++i) {
        const double angle = 2 * std::numbers::pi * i / kCorners;
        disc.vertices.push_back(0.01 * glm::dvec3(std::cos(angle), std::sin(angle), 0.02 * std::cos(2 * angle)));
        disc.corners.push_back(i);
    }
    const MeshStructure structure = build_structure(shapes::mesh_of(disc));
    for (const layout::uint shading : {layout::kShadingMeanValue, layout::kShadingTwoPass}) {
        PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopOpen, 8, 20);
        shape.reach = 0.004;
        MeshPathCase<float> one(structure, shape);
        one.law.features.shading = shading;
        EXPECT_GT(hold(one, fmt::format("shading {}", shading)).touching, 100u);
    }
}

TEST_F(MeshPath, MetricsAlone) {
    PathShape shape = shape_of(layout::kMotionStrokes, layout::kLoopClosed);
    shape.features.channels = 0;
    MeshPathCase<float> one(ball(3), shape);
    hold(one, "no channels");
}

} // namespace
} // namespace forceshade
