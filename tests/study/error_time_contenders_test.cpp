// What the contenders of the study of error against time give, on few places.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/scene/study.h"
#include "host/study/error_time/measured.h"

namespace forceshade::study::error_time {
namespace {

Extents few() {
    Extents extents;
    extents.facets = {1, 4, 64};
    extents.cells = {8, 16};
    extents.spacings = {1.6e-3, 0.8e-3};
    extents.probes = 512;
    extents.timed = 64;
    return extents;
}

std::unique_ptr<Engine> software() {
    return make_engine({});
}

const Contender& named(const Contenders& contenders, const std::string& name) {
    for (const Contender& one : contenders)
        if (one.name == name)
            return one;
    ADD_FAILURE() << name;
    return contenders.front();
}

ForceErrors against_smooth(const Subject& subject, const Contender& contender) {
    const Evaluated evaluated = contender.evaluate();
    std::vector<glm::dvec3> truth;
    for (const glm::dvec3& at : evaluated.at)
        truth.push_back(subject.smooth(at));
    return force_errors(evaluated.force, truth);
}

ForceErrors against_reference(const Contender& contender) {
    const Evaluated evaluated = contender.evaluate();
    return force_errors(evaluated.force, contender.exact(evaluated.at));
}

TEST(Bump, ErrorsAreThoseOfTheLaws) {
    const auto engine = software();
    const Subject subject = bump_subject(few());
    Contenders contenders;
    add_contenders(contenders, subject, few(), *engine);
    const auto error = [&](const std::string& name) { return against_smooth(subject, named(contenders, name)); };
    // The angle between z and N(x) over |x| <= 0.85 a, evenly: its largest is asin(0.85 a / R).
    EXPECT_NEAR(error("bump, 1 facet, flat: direct f64").direction->largest,
                std::asin(0.85 * 500.0 / 600) * 180 / std::numbers::pi, 0.5);
    // Four facets: at most half a facet's angle; 16 times as many, a sixteenth.
    EXPECT_NEAR(error("bump, 4 facets, flat: direct f64").direction->largest, 56.44 / 4, 0.2);
    EXPECT_NEAR(error("bump, 64 facets, flat: direct f64").direction->largest, 56.44 / 64, 0.02);
    EXPECT_LT(error("bump, 1 facet, shaded: direct f64").direction->largest, 1e-12);
    EXPECT_GT(error("bump, 1 facet, shaded: direct f64").magnitude->rms, 0.5);
    EXPECT_LT(error("bump, 64 facets, shaded: direct f64").vector->rms, 1e-3);
    const ForceErrors single = against_reference(named(contenders, "bump, 64 facets, shaded: direct f32"));
    EXPECT_GT(single.vector->largest, 1e-9);
    EXPECT_LT(single.vector->largest, 1e-5);
    const ForceErrors half = against_reference(named(contenders, "bump, 64 facets, shaded: direct f32, half output"));
    EXPECT_GT(half.vector->rms, 1e-5);
    EXPECT_LT(half.vector->largest, 1e-3);
    EXPECT_EQ(against_reference(named(contenders, "bump, 64 facets, shaded: direct f64")).vector->largest, 0);
}

TEST(Bump, KernelAndOracleAreEquallyFarOff) {
    const auto engine = software();
    const Subject subject = bump_subject(few());
    Contenders contenders;
    add_contenders(contenders, subject, few(), *engine);
    for (const char* precision : {"f32", "f64"}) {
        const std::string law = "bump, 64 facets, shaded: field, ";
        const Evaluated kernel = named(contenders, law + "kernel " + precision).evaluate();
        const Evaluated oracle = named(contenders, law + "CPU on one thread " + precision).evaluate();
        EXPECT_GT(kernel.at.size(), 10000u);
        EXPECT_TRUE(kernel.at == oracle.at);
        EXPECT_LT(against_reference(named(contenders, law + "kernel " + precision)).vector->largest, 1e-5);
        EXPECT_TRUE(kernel.force == oracle.force) << precision;
        const auto path = [&](const char* who) {
            return named(contenders, "bump, 64 facets, shaded: closed loop, " + std::string(who) + precision)
                .evaluate();
        };
        EXPECT_TRUE(path("kernel ").force == path("CPU on one thread ").force) << precision;
    }
}

// A device that says how long it took, a time an evaluation, and that it visited seven voxels.
class TimedEngine final : public Engine {
public:
    std::vector<EngineTimes> left; /* the last one first */
    EngineReport report() const override { return {"gpu", "a device", "", "", true, true}; }
    EngineTimes run(const EngineWork&) override {
        const EngineTimes times = left.back();
        left.pop_back();
        return times;
    }
    void take(const std::vector<double>& kernels, double plan) {
        for (const double kernel : kernels)
            left.insert(left.begin(), {.kernel = kernel, .plan = plan, .voxels_evaluated = 7});
    }
};

// A plan leaves most voxels of a mesh out, and finding them takes time: a grid's time is both, over all its voxels.
TEST(Grid, TimeIsThatOfKernelAndPlanOverAllVoxels) {
    for (const Subject& subject : {bump_subject(few()), mesh_subject(few())}) {
        const auto& size = subject.grid.size;
        const double voxels = static_cast<double>(size[0] * size[1] * size[2]);
        TimedEngine engine;
        Contenders contenders;
        add_grids(contenders, subject, subject.variants.front(), engine);
        for (const char* precision : {"f32", "f64"}) {
            const auto grid = std::ranges::find_if(contenders, [&](const Contender& one) {
                return one.family == "field, kernel" && one.precision == precision;
            });
            if (grid == contenders.end()) {
                EXPECT_STREQ(precision, "f64") << "not of every variant";
                continue;
            }
            engine.take({8e-3}, 3e-3);
            EXPECT_DOUBLE_EQ(grid->seconds(), 11e-3 / voxels) << subject.name << ", long enough at once";
            engine.take({1e-3, 3e-3, 2e-3}, 0.5e-3);
            EXPECT_DOUBLE_EQ(grid->seconds(), 2.5e-3 / voxels) << subject.name << ", the middle one of three";
            EXPECT_TRUE(engine.left.empty());
        }
    }
}

TEST(Mesh, GodObjectStaticFieldAndLookUpAreNearTheSmoothCylinder) {
    const auto engine = software();
    const Subject subject = mesh_subject(few());
    Contenders contenders;
    add_contenders(contenders, subject, few(), *engine);
    const auto error = [&](const std::string& name) { return against_smooth(subject, named(contenders, name)); };
    const double flat = error("mesh, 16 x 16 cells, none: direct f64").direction->rms;
    EXPECT_NEAR(flat, 56.44 / 16 / std::sqrt(3), 0.15 * flat); // evenly spread up to half a facet's angle
    EXPECT_NEAR(error("mesh, 16 x 16 cells, none: god-object f64").direction->rms, flat, 0.1 * flat);
    EXPECT_LT(error("mesh, 16 x 16 cells, mean_value: direct f64").direction->rms, 0.1 * flat);
    EXPECT_LT(error("mesh, 16 x 16 cells, mean_value: direct f64").magnitude->rms, 0.04);
    EXPECT_LT(error("mesh, 16 x 16 cells, mean_value: look-up, trilinear 1.6 mm").direction->rms, flat);
    EXPECT_EQ(against_reference(named(contenders, "mesh, 16 x 16 cells, none: god-object f64")).vector->largest, 0);
}

std::vector<std::string> looked_up(const Subject& subject) {
    std::vector<std::string> names;
    for (const Variant& variant : subject.variants)
        if (variant.lookups)
            names.push_back(variant.name);
    return names;
}

// Reading costs the same whatever a volume is of: a front without the finest would end at a coarser one's errors.
TEST(Lookups, AreOfTheFinestSurfaceToo) {
    Extents extents = few();
    extents.facets = {64, 512};
    extents.cells = {16, 32};
    EXPECT_EQ(looked_up(bump_subject(extents)), (std::vector<std::string>{"64 facets, shaded", "512 facets, shaded"}));
    EXPECT_EQ(looked_up(mesh_subject(extents)),
              (std::vector<std::string>{"16 x 16 cells, mean_value", "32 x 32 cells, mean_value"}));
}

PreparedCase scene(const std::string& text) {
    return CasePreparation().prepare(parse_scene(text, "scene.toml", FORCESHADE_TEST_DATA));
}

// Everything that a scene gives can be evaluated and timed, and its own law in double is the reference.
void expect_whole(const std::string& text) {
    const auto engine = software();
    const PreparedCase prepared = scene(text);
    Extents extents = few();
    extents.probes = 256;
    const Subject subject = scene_subject(prepared, extents);
    EXPECT_FALSE(subject.notes.empty());
    Contenders contenders;
    add_contenders(contenders, subject, extents, *engine);
    std::size_t own = 0;
    for (const Contender& one : contenders) {
        EXPECT_GT(one.seconds(), 0) << one.name;
        const ForceErrors errors = against_reference(one);
        EXPECT_GT(errors.compared, 0u) << one.name;
        if (one.name == one.reference) {
            ++own;
            EXPECT_EQ(errors.vector->largest, 0) << one.name;
        }
        EXPECT_NO_FATAL_FAILURE(named(contenders, one.reference));
    }
    EXPECT_EQ(own, subject.variants.size());
}

TEST(Scene, OfEveryKindIsTakenWhole) {
    expect_whole("[surface]\nradius = \"1000 mil\"\nfacets = 3\n[grid]\nsize = [33, 3, 17]\nspacing = \"1 mm\"\norigin "
                 "= [\"-16 mm\", \"-1 mm\", \"-8 mm\"]\n");
    expect_whole("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\n[force]\nshading = "
                 "\"height_map\"\n[grid]\nsize = [17, 17, 9]\n"
                 "spacing = \"1 mm\"\norigin = [\"-8 mm\", \"-8 mm\", \"-8 mm\"]\n");
    expect_whole("[surface]\nkind = \"cylinder_bump\"\n[grid]\nsize = [33, 3, 17]\nspacing = \"1 mm\"\norigin = [\"-16 "
                 "mm\", \"-1 mm\", \"-8 mm\"]\n");
    expect_whole("[surface]\nkind = \"mesh\"\nfile = \"bump.obj\"\nunit = \"mm\"\n[force]\nshading = "
                 "\"mean_value\"\n[grid]\nsamples = 12\n");
}

TEST(Scene, WithoutContactIsRefused) {
    const PreparedCase prepared =
        scene("[grid]\nsize = [4, 4, 4]\nspacing = \"1 mm\"\norigin = [\"0 m\", \"0 m\", \"50 mm\"]\n");
    EXPECT_THROW(scene_subject(prepared, few()), UsageError);
}

} // namespace
} // namespace forceshade::study::error_time
