// What is left out changes nothing else, and is what the manifest says.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/study/omission/omission.h"
#include "tests/io/folder.h"

namespace forceshade::study {
namespace {

using testing::says;

std::vector<Comparison> all_comparisons(const std::vector<BaseScene>& scenes, bool gpu) {
    std::vector<Comparison> all;
    for (const BaseScene& base : scenes)
        for (Comparison& one : comparisons_of(base, gpu))
            all.push_back(std::move(one));
    return all;
}

TEST(Omission, IsWhatTheManifestsSay) {
    const std::vector<Comparison> comparisons = all_comparisons(own_scenes(true), true);
    for (const Comparison& one : comparisons)
        EXPECT_TRUE(agrees_with_manifest(one)) << one.scene << ": " << one.feature;
    Comparison wrong = comparisons.front();
    wrong.omitted = "texture"; // left out on both sides
    EXPECT_FALSE(agrees_with_manifest(wrong));
}

TEST(Omission, SwitchesEachFeatureOnceInAScene) {
    for (const BaseScene& base : own_scenes(true)) {
        std::set<std::string> features;
        for (const Comparison& one : comparisons_of(base, true))
            EXPECT_TRUE(features.insert(one.feature).second) << one.feature;
    }
}

TEST(Omission, EvaluatesTheSameSamplesOnBothSidesUnlessTheyAreTheFeature) {
    for (const BaseScene& base : own_scenes(true))
        for (const Comparison& one : comparisons_of(base, true)) {
            const auto y_samples = [](const study::Setup& setup) {
                return make_tables<float>(setup.prepared.one.scene, setup.prepared.images, setup.extent).y.size();
            };
            EXPECT_EQ(y_samples(one.with) == y_samples(one.without), one.feature != "every y") << one.feature;
        }
}

// The oracle as the engine: what is held is the comparison, whatever kernels do.
class OnTheOracle : public ::testing::Test {
protected:
    OnTheOracle() {
        EngineOptions options;
        options.cpu = true;
        engine_ = make_engine(options);
    }

    static Comparison comparison(const std::string& scene, const std::string& feature) {
        for (const BaseScene& base : own_scenes(true))
            if (base.name == scene)
                for (Comparison& one : comparisons_of(base, false))
                    if (one.feature == feature)
                        return std::move(one);
        throw std::runtime_error("no comparison of " + feature);
    }

    Agreement held(const Comparison& one) {
        return compare(one, capture<float>(*engine_, one.with, one.paths, one.channels),
                       capture<float>(*engine_, one.without, one.paths, one.channels));
    }

    std::unique_ptr<Engine> engine_;
};

TEST_F(OnTheOracle, EveryForceIsTheSameWithoutIt) {
    for (const BaseScene& base : own_scenes(true))
        for (const Comparison& one : comparisons_of(base, false)) {
            const Agreement agreement = held(one);
            EXPECT_EQ(agreement.differing, 0u) << base.name << ": " << one.feature;
            EXPECT_GT(agreement.compared, 100u) << base.name << ": " << one.feature;
            if (one.same != Same::metrics) {
                EXPECT_GT(agreement.in_contact, 1000u) << base.name << ": " << one.feature;
                EXPECT_TRUE(one.paths || agreement.in_contact < agreement.compared) << base.name << ": " << one.feature;
            }
        }
}

TEST_F(OnTheOracle, WhatDiffersIsCounted) {
    Comparison stiffer = comparison("bump", "depth channel");
    stiffer.with.prepared.one.scene.force.stiffness *= 1 + 1e-6;
    EXPECT_GT(held(stiffer).differing, 1000u);

    Comparison shading = comparison("bump", "facet channel");
    shading.without.prepared.one.scene.force.shading = Shading::none;
    const Agreement turned = held(shading);
    EXPECT_GT(turned.differing, 1000u);
    EXPECT_LT(turned.differing, turned.compared);
    EXPECT_FALSE((Measurement{shading, {}, {}, turned}.same_forces()));

    Comparison smaller = comparison("bump", "depth channel");
    smaller.with.prepared.one.scene.grid.size[2] /= 2;
    const Agreement half = held(smaller);
    EXPECT_EQ(half.differing, half.compared) << "the samples that are not there";
}

constexpr const char* kPaths = "[paths]\ndepth = \"1 mm\"\ncount = 2\nsteps = 100\n";

// A bump's grid, from `bottom` upwards.
Case given_scene(const std::string& bottom, const std::string& more = "") {
    const std::string grid = "[grid]\nsize = [16, 2, 8]\norigin = [\"-14 mm\", \"-1 mm\", \"" + bottom +
                             "\"]\nspacing = [\"1.8 mm\", \"1 mm\", \"0.5 mm\"]\n";
    return parse_scene("[surface]\nfacets = 3\n" + more + grid, "test");
}
BaseScene based_on(const Case& scene) {
    return user_scene(CasePreparation().prepare(scene), true);
}

TEST_F(OnTheOracle, WhatTouchesIsCounted) {
    const Touched grid = touched(*engine_, based_on(given_scene("-4 mm")));
    EXPECT_GT(grid.field, 100u);
    EXPECT_LT(grid.field, 16u * 2 * 8 + 1);
    EXPECT_EQ(grid.paths, 0u) << "it has none";
    EXPECT_EQ(touched(*engine_, based_on(given_scene("30 mm"))).field, 0u);
    for (const char* precision : {"f32", "f64"}) {
        BaseScene both = based_on(given_scene("30 mm", kPaths));
        both.prepared.one.scene.precision = precision == std::string("f32") ? Precision::f32 : Precision::f64;
        const Touched samples = touched(*engine_, both);
        EXPECT_EQ(samples.field, 0u);
        EXPECT_GT(samples.paths, 10u);
        EXPECT_LE(samples.paths, 200u);
    }
}

// The studies of energy and stability go to places on the surface of their own; this one takes the scene's.
class OmissionRun : public ::testing::Test {
protected:
    StudyData run(const Case& scene) {
        StudyOptions options;
        options.folder = folder_ / "omission";
        options.quick = true;
        options.engine.cpu = true;
        options.scene = scene;
        StudyRun study("omission", options);
        return study_omission(study);
    }
    static std::size_t free_notes(const StudyData& data) {
        return static_cast<std::size_t>(std::ranges::count_if(data.notes, [](const std::string& note) {
            return bool(says(note, "is in contact: its results are those of free space"));
        }));
    }

    testing::Folder folder_;
};

TEST_F(OmissionRun, OfASceneThatTouchesNothingIsRefused) {
    EXPECT_TRUE(says(testing::message_of<UsageError>([&] { run(given_scene("30 mm")); }),
                     "no sample of the scene's [grid] is in contact"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "omission/study.json"));
    EXPECT_EQ(free_notes(run(given_scene("-4 mm"))), 0u);
}

TEST_F(OmissionRun, OfAGridInTheAirAboveTouchingPathsSaysSo) {
    const StudyData data = run(given_scene("30 mm", kPaths));
    EXPECT_EQ(free_notes(data), 1u);
    EXPECT_GT(data.table("features").rows.size(), 5u);
}

TEST_F(OnTheOracle, AMeasurementHasARoundOfEachSideAndLeavesNoFile) {
    const testing::Folder folder;
    const Comparison one = comparison("bump", "every y");
    const Measurement result = measure(*engine_, one, {6, 0.001, 60}, folder.path());
    EXPECT_TRUE(folder.names().empty());
    EXPECT_EQ(result.with.kernel.size(), 6u);
    EXPECT_EQ(result.without.whole.size(), 6u);
    EXPECT_EQ(result.with.cost.evaluated, 8 * result.without.cost.evaluated);
    EXPECT_EQ(result.with.cost.received, 8 * result.without.cost.received);
    EXPECT_EQ(result.with.file, result.without.file) << "the file holds every y either way";
    EXPECT_EQ(result.agreement.differing, 0u);
    const Agreement in_place = held(one);
    EXPECT_EQ(result.agreement.compared, 4 * in_place.compared) << "in place, and where three rounds moved the grid";
    EXPECT_NE(result.agreement.in_contact, 4 * in_place.in_contact);
}

// A patch has no inside: its winding number is another law.
TEST(OmissionScene, OnAnOpenMeshComparesNoLawWithAnother) {
    PreparedCase given = own_scenes(true)[2].prepared;
    const auto has_winding = [](const PreparedCase& prepared) {
        const auto all = comparisons_of(user_scene(prepared, true), true);
        return std::ranges::find(all, "winding number", &Comparison::feature) != all.end();
    };
    EXPECT_TRUE(has_winding(given));
    auto mesh = std::make_shared<SceneMesh>(*given.images.mesh);
    mesh->findings.closed = false;
    given.images.mesh = mesh;
    EXPECT_FALSE(has_winding(given));
}

Measurement timed(const std::string& feature, double ratio, bool always = false, std::uint64_t differing = 0) {
    Measurement row;
    row.comparison.feature = feature;
    row.comparison.scene = "bump";
    row.comparison.always = always;
    for (const double jitter : {0.99, 1.0, 1.01, 1.0, 1.005, 0.995}) {
        row.with.kernel.push_back(ratio * jitter);
        row.without.kernel.push_back(1);
    }
    row.with.whole = row.with.kernel;
    row.without.whole = row.without.kernel;
    row.with.samples = row.without.samples = 10;
    row.agreement = {10, 5, differing};
    return row;
}

TEST(OmissionFindings, TellProgramAndSceneApartAndNothingFromTheSpread) {
    StudyData data;
    add_omissions(data, {},
                  {timed(kControl, 1), timed("every y", 3, true), timed("depth channel", 1.2),
                   timed("other law", 9, false, 1), timed("facet channel", 1.002)});
    ASSERT_EQ(data.findings.size(), 2u);
    EXPECT_EQ(data.findings[0].name, "program");
    EXPECT_TRUE(says(data.findings[0].text, "3 [3, 3] times as long with every y (bump)."));
    EXPECT_TRUE(says(data.findings[1].text, "20 [19, 21] % longer with depth channel (bump)"));
    EXPECT_FALSE(says(data.findings[1].text, "other law")) << "its forces are others";
    EXPECT_EQ(data.table("features").word(3, "same"), "no: 1 of 10 differ");
    EXPECT_TRUE(data.notes.empty());
}

TEST(OmissionFindings, AreNoneWhereEqualSidesTakeUnequalTimes) {
    StudyData data;
    add_omissions(data, {}, {timed(kControl, 1.3), timed("every y", 3, true), timed("depth channel", 1.4)});
    EXPECT_TRUE(data.findings.empty());
    ASSERT_EQ(data.notes.size(), 1u);
    EXPECT_TRUE(says(data.notes[0], "one took 1.3 to 1.3 times as long as the other"));
}

TEST(OmissionScene, OfTheUserIsThinnedOut) {
    PreparedCase given = CasePreparation().prepare(parse_scene("[grid]\nsize = [1024, 512, 256]\n", "test"));
    const BaseScene base = user_scene(given, true);
    const GridSpec &thin = base.prepared.one.scene.grid, &whole = given.one.scene.grid;
    EXPECT_LE(thin.size[0] * thin.size[1] * thin.size[2], 32768u);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(thin.spacing[i] * double(thin.size[i] - 1), whole.spacing[i] * double(whole.size[i] - 1), 1e-12);
    given.one.scene.field = false;
    given.one.scene.paths.emplace().kind = PathKind::recorded;
    EXPECT_THROW(user_scene(given, true), UsageError);
}

} // namespace
} // namespace forceshade::study
