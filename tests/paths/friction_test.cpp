// L10: the bristle against closed forms, what it must keep to, and along paths.
#include "host/reference/friction.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/field/case_law.h"
#include "tests/io/folder.h"
#include "tests/paths/explored.h"
#include "tests/vibration/made_up_models.h"

namespace forceshade {
namespace {

using reference::bend;
using reference::BentBristle;
using reference::Contact;
using reference::FrictionParams;
using reference::SurfaceForces;
using Place = reference::Vector<double>;

constexpr double kFrictionPeriod = 1e-3; // s
const Place kUp{0, 0, 1};

// A bristle dragged along x, as far in each of `steps` samples: the last force.
Place dragged(const FrictionParams<double>& friction, double load, double slip, int steps) {
    BentBristle<double> bristle{Place(0), Place(0)};
    for (int i = 0; i < steps; ++i)
        bristle = bend(friction, bristle.bent, kUp, load, Place(slip, 0, 0), kFrictionPeriod);
    return bristle.force;
}

// After k steps of s the bristle of Dahl is bent by g (1 - (1 + s / g)^-k), which for small steps is g (1 - e^(-x /
// g)).
TEST(Friction, OfDahlIsGeometricAtConstantSpeed) {
    const FrictionParams<double> friction{.coefficient = 0.4, .stiffness = 700};
    constexpr double kLoad = 1.5, kMost = 0.4 * kLoad; // N
    for (const double slip : {1e-6, 1e-4, 3e-3})
        for (const int steps : {1, 2, 7, 500}) {
            const double expected = kMost * (1 - std::pow(1 + slip * 700 / kMost, -steps));
            EXPECT_NEAR(dragged(friction, kLoad, slip, steps).x, -expected, 1e-12) << slip << ' ' << steps;
        }
    EXPECT_NEAR(dragged(friction, kLoad, 1e-7, 10000).x, -kMost * (1 - std::exp(-1e-3 * 700 / kMost)), 1e-4);
}

TEST(Friction, FallsFromTheStaticCoefficientWithSpeed) {
    const FrictionParams<double> friction{.coefficient = 0.3, .excess = 0.2, .stribeck_speed = 0.01, .stiffness = 1000};
    EXPECT_NEAR(dragged(friction, 2, 1e-8, 2000000).x, -0.5 * 2, 1e-5) << "it breaks away at the static coefficient";
    EXPECT_NEAR(dragged(friction, 2, 1e-5, 100000).x, -0.4 * 2, 1e-9) << "half way down at the Stribeck speed";
    EXPECT_NEAR(dragged(friction, 2, 1e-3, 10000).x, -0.3 * 2, 1e-4);
}

TEST(Friction, IsNoMoreThanTheStaticCoefficientAndAlongTheSurface) {
    std::mt19937 random(10);
    std::normal_distribution<double> normal;
    const FrictionParams<double> friction{.coefficient = 0.3, .excess = 0.4, .stribeck_speed = 0.05, .stiffness = 2000};
    BentBristle<double> bristle{Place(0), Place(0)};
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const Place up = reference::normalised(Place(normal(random), normal(random), 3 + normal(random)));
        const double load = std::abs(normal(random)); // suddenly less, too
        const Place moved = std::exp(3 * normal(random)) * 1e-4 * Place(normal(random), normal(random), normal(random));
        bristle = bend(friction, bristle.bent, up, load, reference::across(moved, up), kFrictionPeriod);
        const double size = reference::length(bristle.force);
        ASSERT_LE(size, 0.7 * load * (1 + 1e-12));
        ASSERT_NEAR(reference::dot(bristle.force, up), 0, 1e-12 * (1 + load));
        largest = std::max(largest, size / load);
    }
    EXPECT_GT(largest, 0.6);
}

// What the force at the end of each step does on the way there, under a constant load.
TEST(Friction, GivesNoLoopEnergy) {
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    for (int loop = 0; loop < 2000; ++loop) {
        const FrictionParams<double> friction{.coefficient = 0.1 + std::abs(normal(random)),
                                              .stiffness = std::exp(7 + normal(random)),
                                              .damping = loop % 2 ? 0 : std::abs(normal(random)),
                                              .viscous = loop % 3 ? 0 : std::abs(normal(random))};
        const double load = std::exp(normal(random)), size = std::exp(2 * normal(random) - 8);
        BentBristle<double> bristle{Place(0), Place(0)};
        Place place(0);
        double work = 0;
        const int corners = 2 + loop % 30;
        for (int corner = 0; corner <= corners; ++corner) {
            const Place next = corner == corners ? Place(0) : size * Place(normal(random), normal(random), 0);
            const Place slip = next - place;
            bristle = bend(friction, bristle.bent, kUp, load, slip, kFrictionPeriod);
            work += reference::dot(bristle.force, slip);
            place = next;
        }
        ASSERT_LE(work, 0) << loop;
    }
}

Contact<double> pressed(double load) {
    return {1e-3, Place(0, 0, load), Place(0), Place(0), load > 0 ? 0u : layout::kNoFacet};
}

TEST(Friction, BeginsWithEachContact) {
    SurfaceForces<double> surface(FrictionParams<double>{.coefficient = 0.5, .stiffness = 500}, std::nullopt, 0,
                                  kFrictionPeriod);
    const auto force_at = [&](double x, double load) {
        Contact<double> contact = pressed(load);
        surface.add_to(contact, Place(x, 0, 0));
        return contact.force;
    };
    EXPECT_EQ(force_at(0, 1), Place(0, 0, 1)) << "it counts from the first sample";
    EXPECT_LT(force_at(0.01, 1).x, -0.4);
    EXPECT_EQ(force_at(0.02, 0), Place(0, 0, 0)) << "out of contact";
    EXPECT_EQ(force_at(0.03, 1), Place(0, 0, 1)) << "the bristle is another";
    EXPECT_LT(force_at(0.04, 1).x, -0.4);
    surface.begin_path(1);
    EXPECT_EQ(force_at(0.05, 1), Place(0, 0, 1));
    Contact<double> broken = pressed(NAN);
    broken.facet = 0;
    surface.add_to(broken, Place(0.06, 0, 0));
    EXPECT_EQ(force_at(0.07, 1), Place(0, 0, 1)) << "after a force that is no number";
}

constexpr const char* kRubbed = "[surface]\nfacets = 1\n[friction]\ncoefficient = 0.4\nstiffness = \"2 N/mm\"\n";

// Strokes below a plane: once a bristle is bent, the force is mu N against the motion.
template <typename T> void expect_strokes() {
    const auto result = explored<T>(std::string(kRubbed) + "[paths]\ncount = 3\nsteps = 1000\ndepth = \"1 mm\"\n"
                                                           "speed = { min = \"50 mm/s\", max = \"150 mm/s\" }\n");
    for (std::size_t path = 0; path < 3; ++path) {
        double sliding = 0;
        for (std::size_t step = 1; step < result.steps; ++step) {
            const auto& force = result.force[step * 3 + path];
            ASSERT_NEAR(double(force.z), 1, 1e-6);
            ASSERT_LE(std::hypot(force.x, force.y), 0.4 * (1 + 1e-5));
            const double moved = double(result.place(step, path).x - result.place(step - 1, path).x);
            sliding += std::abs(double(force.x) + std::copysign(0.4, moved)) < 0.004;
        }
        EXPECT_GT(sliding, 900);
        const double distance = double(result.metrics[path].effort) / 0.4; // m
        EXPECT_NEAR(double(result.metrics[path].work), -0.4 * distance, 0.04 * distance);
        EXPECT_GT(distance, 0.04);
    }
}

TEST(FrictionPaths, SlideWithTheCoefficient) {
    expect_strokes<float>();
    expect_strokes<double>();
}

TEST(FrictionPaths, OfAPressingHandLoseEnergy) {
    const std::string paths = "[paths]\ncount = 4\nsteps = 2000\npress = \"1 N\"\nspeed = \"100 mm/s\"\n"
                              "length = \"60 mm\"\ncentre = [\"0 m\", \"0 m\"]\n";
    const auto free = explored<double>("[surface]\nfacets = 1\n" + paths);
    const auto rubbed = explored<double>(kRubbed + paths);
    for (std::size_t path = 0; path < 4; ++path) {
        EXPECT_LT(std::abs(free.metrics[path].work), 1e-3);
        EXPECT_NEAR(rubbed.metrics[path].work, -0.4 * 0.1 * 2, 0.01) << "mu N along 0.2 m";
        const auto& last = rubbed.force[1999 * 4 + path];
        EXPECT_NEAR(std::hypot(last.x, last.y) / last.z, 0.4, 0.004);
        EXPECT_EQ(rubbed.metrics[path].unstable_step, layout::kNever);
    }
}

TEST(FrictionPaths, ThroughACouplingKeepTheCoefficient) {
    const auto result = explored<double>(
        std::string(kRubbed) + "[force]\nstiffness = \"20 N/mm\"\n[paths]\ncount = 1\nsteps = 500\n"
                               "press = \"1 N\"\nlength = \"0.1 m\"\n[hand]\ncoupling.stiffness = \"1 N/mm\"\n");
    const auto& last = result.force.back();
    EXPECT_NEAR(last.z, 1, 0.02);
    EXPECT_NEAR(std::hypot(last.x, last.y) / last.z, 0.4, 0.004);
}

// A bristle that sticks is a spring along the surface: of this hand, 0.1 kg and 3 N s/m at 1 kHz, up to 6.03 N/mm.
TEST(FrictionPaths, StickUpToTheLimitOfAWall) {
    const auto growth = [](const char* stiffness) {
        const auto result = explored<double>(fmt::format("[surface]\nfacets = 1\n[friction]\ncoefficient = 100\n"
                                                         "stiffness = \"{}\"\n[paths]\ncount = 1\nsteps = 4000\n"
                                                         "press = \"1 N\"\nspeed = \"1 mm/s\"\n",
                                                         stiffness));
        return result.metrics[0].late_speed / result.metrics[0].early_speed;
    };
    EXPECT_LT(growth("5.8 N/mm"), 0.8);
    EXPECT_GT(growth("6.2 N/mm"), 1.5);
}

TEST(FrictionPaths, AreTheSameInAnyPartsAndOnAnyThreads) {
    const std::string scene = "[surface]\nkind = \"bump\"\nfacets = 8\n[force]\nshading = \"reference\"\n[friction]\n"
                              "static_coefficient = 0.5\ndamping = \"0.1 N s/m\"\n[paths]\ncount = 37\nsteps = 300\n"
                              "tremor.amplitude = \"0.2 mm\"\nspeed = { mean = \"100 mm/s\", sd = \"20 mm/s\" }\n";
    for (const char* loop : {"depth = \"2 mm\"\n", "press = \"1 N\"\n"}) {
        const auto whole = explored<double>(scene + loop, {.threads = 1});
        const reference::PathOptions all[] = {{.threads = 3, .chunk_bytes = 4096},
                                              {.threads = 2, .chunk_bytes = 100000, .batch_paths = 5},
                                              {.threads = 1, .chunk_bytes = 1, .batch_paths = 1}};
        for (const reference::PathOptions& options : all) {
            const auto parts = explored<double>(scene + loop, options);
            EXPECT_EQ(parts.force, whole.force) << options.batch_paths;
            EXPECT_EQ(parts.position, whole.position) << options.batch_paths;
        }
    }
}

// A law at a probe, sample after sample, as the live loop has it.
template <typename T> void expect_probe_law(const std::string& text, const std::filesystem::path& folder = {}) {
    const PreparedCase prepared = prepared_scene(text, folder);
    ScenePaths<T> paths(prepared);
    const auto result = explored<T>(paths);
    const auto law = make_probe_law(prepared);
    double sideways = 0;
    for (std::size_t path = 0; path < result.paths; ++path) {
        law->begin_path();
        for (std::size_t step = 0; step < result.steps; ++step) {
            const glm::dvec3 force = law->at(glm::dvec3(result.place(step, path))).force;
            ASSERT_EQ(force, glm::dvec3(result.force[step * result.paths + path])) << path << ' ' << step;
            sideways = std::max(sideways, std::hypot(force.x, force.y));
        }
    }
    EXPECT_GT(sideways, 0.1);
}

TEST(FrictionPaths, EqualTheLawOfTheLiveLoop) {
    const std::string scene = "[surface]\nfacets = 5\n[friction]\nstatic_coefficient = 0.6\nviscous = \"1 N s/m\"\n"
                              "[paths]\ncount = 3\nsteps = 400\nkind = \"circle\"\nlength = \"20 mm\"\n"
                              "depth = { min = \"1 mm\", max = \"3 mm\" }\nrate = \"2 kHz\"\n[run]\nprecision = ";
    expect_probe_law<float>(scene + "\"f32\"\n");
    expect_probe_law<double>(scene + "\"f64\"\n");
}

TEST(VibrationPaths, ActAlongTheMotionAndDependOnTheirNumberAlone) {
    const testing::Folder folder;
    folder.write("m.xml", testing::made_up_models());
    const std::string scene = "[surface]\nfacets = 1\n[run]\nprecision = \"f64\"\n[paths]\ncount = 5\nsteps = 400\n"
                              "[texture]\nvibration = \"m.xml\"\nvibration_mass = \"20 g\"\n";
    const auto run = [&](const std::string& more, const reference::PathOptions& options = {}) {
        const PreparedCase prepared = prepared_scene(scene + more, folder.path());
        ScenePaths<double> paths(prepared);
        return explored(paths, options);
    };
    const auto result = run("");
    double square = 0;
    for (std::size_t step = 0; step < 400; ++step) {
        const Place& force = result.force[step * 5];
        ASSERT_EQ(force.y, 0);
        ASSERT_EQ(force.z, 1) << "the law's own";
        square += force.x * force.x / 400;
    }
    EXPECT_GT(std::sqrt(square), 0.02 * 2) << "the filter amplifies";
    EXPECT_LT(std::sqrt(square), 0.02 * 2 * 10);
    EXPECT_NE(result.force[5 * 100], result.force[5 * 100 + 1]) << "the paths are the same but for their noise";
    EXPECT_EQ(run("", {.threads = 3, .chunk_bytes = 1, .batch_paths = 2}).force, result.force);
    EXPECT_NE(run("vibration_seed = 2\n").force, result.force);
    expect_probe_law<double>(scene + "[friction]\nstatic_coefficient = 0.5\n", folder.path());

    const PreparedCase rubbed = prepared_scene(scene + "[friction]\n", folder.path());
    EXPECT_EQ(friction_coefficient(rubbed), 0.45) << "the file's";
    EXPECT_NE(rubbed.scene.find("vibration_sha256 = "), std::string::npos);
    EXPECT_EQ(friction_coefficient(prepared_scene(scene + "[friction]\ncoefficient = 0.2\n", folder.path())), 0.2);
    EXPECT_TRUE(testing::says(testing::message_of<UsageError>([&] {
                                  prepared_scene(scene + "[friction]\nstatic_coefficient = 0.4\n", folder.path());
                              }),
                              "friction.static_coefficient 0.4 is less than the coefficient 0.45 that m.xml leads to"));
    EXPECT_TRUE(testing::says(testing::message_of<UsageError>([&] {
                                  prepared_scene(scene + "vibration_sha256 = \"" + std::string(64, 'a') + "\"\n",
                                                 folder.path());
                              }),
                              "m.xml is not the file that the scene means"));
}

} // namespace
} // namespace forceshade
