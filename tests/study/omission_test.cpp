// What is left out changes nothing else, is what the manifest says, and is told by the data.
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "host/engine/engine.h"
#include "host/study/data/data_error.h"
#include "host/study/findings/omission_findings.h"
#include "host/study/omission/measurement.h"
#include "host/study/omission/quartiles.h"
#include "host/study/omission/tables.h"
#include "host/study/omission/unchanged.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

TEST(OmissionQuartiles, AreThoseOfSortedValues) {
    const Quartiles odd = quartiles({5, 1, 3, 2, 4});
    EXPECT_EQ(odd.low, 2);
    EXPECT_EQ(odd.middle, 3);
    EXPECT_EQ(odd.high, 4);
    EXPECT_EQ(quartiles({1, 2}).middle, 1.5);
    EXPECT_EQ(quartiles({}).middle, 0);
    EXPECT_EQ(ratios({2, 4, 9}, {1, 2, 3}).middle, 2);
}

std::vector<Comparison> all_comparisons(const std::vector<BaseScene>& scenes, bool gpu) {
    std::vector<Comparison> all;
    for (const BaseScene& base : scenes)
        for (Comparison& one : comparisons_of(base, gpu))
            all.push_back(std::move(one));
    return all;
}

TEST(Omission, IsWhatTheManifestsSay) {
    const std::vector<BaseScene> scenes = own_scenes(true);
    const std::vector<Comparison> comparisons = all_comparisons(scenes, true);
    for (const Comparison& one : comparisons)
        EXPECT_TRUE(agrees_with_manifest(one)) << one.scene << ": " << one.feature;
    const Table omitted = omitted_table(scenes, comparisons);
    EXPECT_GT(omitted.rows.size(), 15u);
    for (std::size_t row = 0; row < omitted.rows.size(); ++row)
        EXPECT_NE(omitted.word(row, "feature"), "not measured") << omitted.word(row, "omitted");
    Comparison wrong = comparisons.front();
    wrong.omitted = "texture"; // left out on both sides
    EXPECT_FALSE(agrees_with_manifest(wrong));
}

// Paths have neither a winding number nor blocks nor unshaded forces: nothing of that is left out.
TEST(Omission, OfPathsIsMeasuredInEitherLoop) {
    for (const char* drive : {"depth = \"1 mm\"", "press = \"1 N\""}) {
        const std::string text = std::string("[paths]\n") + drive + "\n";
        const PreparedCase given = CasePreparation().prepare(parse_scene(text, "test"));
        const BaseScene base = user_scene(given, true);
        const Table omitted = omitted_table({base}, comparisons_of(base, false));
        EXPECT_GT(omitted.rows.size(), 4u);
        for (std::size_t row = 0; row < omitted.rows.size(); ++row)
            EXPECT_NE(omitted.word(row, "feature"), "not measured") << omitted.word(row, "omitted");
    }
    Scene mesh;
    mesh.surface.kind = SurfaceKind::mesh;
    const std::size_t of_fields = omissions(mesh).size();
    mesh.field = false;
    EXPECT_EQ(omissions(mesh).size(), of_fields - 3);
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

    Unchanged held(const Comparison& one) {
        const std::uint32_t channels =
            one.channels | (one.unshaded_is_force ? std::uint32_t(layout::kChannelUnshaded) : 0);
        const auto with = make_side<float>(one.with, one.paths)->capture(*engine_, channels);
        const auto without = make_side<float>(one.without, one.paths)->capture(*engine_, channels);
        return compare(one, with, without);
    }

    std::unique_ptr<Engine> engine_;
};

TEST_F(OnTheOracle, NoFeatureChangesWhatItDoesNotConcern) {
    for (const BaseScene& base : own_scenes(true))
        for (const Comparison& one : comparisons_of(base, false)) {
            const Unchanged unchanged = held(one);
            EXPECT_EQ(unchanged.differing, 0u) << base.name << ": " << one.feature;
            EXPECT_GT(unchanged.compared, 100u) << base.name << ": " << one.feature;
            if (one.force != Agreement::none) {
                EXPECT_GT(unchanged.in_contact, 1000u) << base.name << ": " << one.feature;
                EXPECT_TRUE(one.paths || unchanged.in_contact < unchanged.compared) << base.name << ": " << one.feature;
            }
        }
}

TEST_F(OnTheOracle, WhatDiffersIsCounted) {
    Comparison shading = comparison("bump", "shading");
    shading.force = Agreement::bits; // shading turns the force
    const Unchanged turned = held(shading);
    EXPECT_GT(turned.differing, 1000u);
    EXPECT_LT(turned.differing, turned.compared);

    Comparison texture = comparison("bump", "texture");
    texture.force = Agreement::magnitude; // a texture adds to it
    const Unchanged stronger = held(texture);
    EXPECT_GT(stronger.differing, 100u);
    EXPECT_GT(stronger.largest, 1e-4);

    Comparison other = comparison("bump", "depth channel");
    other.with.prepared.one.scene.force.stiffness *= 1 + 1e-6;
    EXPECT_GT(held(other).differing, 1000u);

    Comparison smaller = comparison("bump", "depth channel");
    smaller.with.prepared.one.scene.grid.size[2] /= 2;
    const Unchanged half = held(smaller);
    EXPECT_EQ(half.differing, half.compared) << "the samples that are not there";
}

TEST_F(OnTheOracle, AMeasurementHasARoundOfEachSideAndLeavesNoFile) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "forceshade-omission-test";
    std::filesystem::create_directories(folder);
    const Json result = measure(*engine_, nullptr, comparison("bump", "every y"), {6, 0.001, 60, 1}, folder);
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    std::filesystem::remove_all(folder);
    EXPECT_EQ(result["with"]["kernel_s"].size(), 6u);
    EXPECT_EQ(result["without"]["whole_s"].size(), 6u);
    EXPECT_EQ(result["with"]["evaluated"].get<double>(), 8 * result["without"]["evaluated"].get<double>());
    EXPECT_EQ(result["with"]["received"].get<double>(), 8 * result["without"]["received"].get<double>());
    EXPECT_EQ(result["with"]["file"], result["without"]["file"]) << "the file holds every y either way";
    EXPECT_EQ(result["differing"], 0);
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

// Two scenes' worth of made-up results.
StudyData sample() {
    const std::vector<BaseScene> scenes = own_scenes(true);
    std::vector<Comparison> comparisons;
    for (Comparison& one : comparisons_of(scenes.front(), false))
        if (std::set<std::string>{kControl, "shading", "flat texture", "facet channel", "every y"}.contains(
                one.feature))
            comparisons.push_back(std::move(one));
    std::vector<Json> results;
    for (const Comparison& one : comparisons) {
        const double ratio = one.feature == "every y" ? 16 : one.feature == "facet channel" ? 1.5 : 1;
        Json side{{"kernel_s", {1e-3, 1e-3, 1e-3}},
                  {"whole_s", {2e-3, 2e-3, 2e-3}},
                  {"uploaded", 1000},
                  {"received", 9000},
                  {"evaluated", 100},
                  {"samples", 1000},
                  {"file", 500}};
        Json with = side;
        for (Json& value : with["kernel_s"])
            value = ratio * value.get<double>();
        with["received"] = ratio * 9000;
        results.push_back({{"with", with},
                           {"without", side},
                           {"compared", 1000},
                           {"in_contact", 500},
                           {"differing", 0},
                           {"largest", 0.0}});
    }
    StudyData data;
    data.study = "omission";
    data.tables = {features_table(comparisons, results), omitted_table(scenes, comparisons)};
    return data;
}

std::string finding(const StudyData& data, const std::string& name) {
    for (const Finding& one : omission_findings(data))
        if (one.name == name)
            return one.text;
    return "";
}

void set(StudyData& data, const std::string& feature, const char* column, Cell value) {
    Table& table = data.tables.front();
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (table.word(row, "feature") == feature)
            table.rows[row][table.index(column)] = value;
}

bool has(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

TEST(OmissionFindings, FollowTheTimes) {
    StudyData data = sample();
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "Leaving out every y (bump) saves the most kernel time"));
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "16 times as long (quartiles 16 to 16)"));
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "facet channel (bump) with 1.50 times"));
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "saves 94 % of the time"));
    EXPECT_TRUE(has(finding(data, "saves_nothing"), "shading (bump 0.0 %), flat texture (bump 0.0 %)"));
    EXPECT_FALSE(has(finding(data, "saves_nothing"), "nothing (bump)")) << "the control is no feature";
    EXPECT_EQ(finding(data, "costs"), "No omission makes a kernel slower.");
    EXPECT_TRUE(has(finding(data, "most_time"), "No omission saves time by the clock"));
    set(data, "facet channel", "kernel_ratio", 40.0);
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "Leaving out facet channel (bump)"));
    set(data, "facet channel", "kernel_verdict", std::string("costs"));
    set(data, "facet channel", "kernel_ratio", 0.5);
    EXPECT_TRUE(has(finding(data, "costs"), "facet channel (bump), 2.00 times as long without it"));
    set(data, "every y", "kernel_verdict", std::string("within the spread"));
    EXPECT_TRUE(has(finding(data, "most_kernel_time"), "No omission saves kernel time"));
}

TEST(OmissionFindings, FollowTheBytes) {
    StudyData data = sample();
    EXPECT_TRUE(has(finding(data, "most_bytes"), "every y (bump) saves the most bytes"));
    EXPECT_TRUE(has(finding(data, "most_bytes"), "no omission makes a file smaller"));
    set(data, "facet channel", "bytes_ratio", 100.0);
    set(data, "facet channel", "file_ratio", 1.25);
    EXPECT_TRUE(has(finding(data, "most_bytes"), "facet channel (bump) saves the most bytes"));
    EXPECT_TRUE(has(finding(data, "most_bytes"), "1.25 times as large"));
}

TEST(OmissionFindings, SayWhatChanged) {
    StudyData data = sample();
    EXPECT_TRUE(has(finding(data, "unchanged"), "0 of 5000 samples (2500 in contact) differ in 5 comparisons"));
    set(data, "shading", "differing", 7.0);
    EXPECT_TRUE(has(finding(data, "unchanged"), "changes what it does not concern: shading (bump) in 7 of 1000"));
    EXPECT_TRUE(has(finding(data, "manifest"), "tell of every omission that was measured; they tell of"));
    set(data, "shading", "manifest_agrees", std::string("no"));
    EXPECT_TRUE(has(finding(data, "manifest"), "do not agree with what was left out of shading (bump)"));
    EXPECT_TRUE(has(finding(data, "specialised"), "nothing that can be told"));
    set(data, "flat texture", "kernel_verdict", std::string("saves"));
    set(data, "flat texture", "kernel_ratio", 1.2);
    EXPECT_TRUE(has(finding(data, "specialised"), "costs 1.20 times the kernel time, for the same forces"));
    EXPECT_TRUE(has(finding(data, "control"), "between 1.000 and 1.000"));
    data.tables.pop_back();
    EXPECT_THROW(omission_findings(data), DataError);
}

// A noisy control makes an effect of its size none.
TEST(OmissionTables, TellEffectsFromTheSpread) {
    const std::vector<BaseScene> scenes = own_scenes(true);
    std::vector<Comparison> comparisons;
    for (Comparison& one : comparisons_of(scenes.front(), false))
        if (one.feature == kControl || one.feature == "shading")
            comparisons.push_back(std::move(one));
    ASSERT_EQ(comparisons.size(), 2u);
    const auto result = [](std::vector<double> with) {
        Json without{{"kernel_s", {1.0, 1.0, 1.0}},
                     {"whole_s", {1.0, 1.0, 1.0}},
                     {"uploaded", 1},
                     {"received", 1},
                     {"evaluated", 1},
                     {"samples", 1}};
        Json side = without;
        side["kernel_s"] = with;
        return Json{{"with", side},    {"without", without}, {"compared", 1},
                    {"in_contact", 1}, {"differing", 0},     {"largest", 0.0}};
    };
    const auto verdict = [&](std::vector<double> control, std::vector<double> with) {
        return features_table(comparisons, {result(control), result(with)}).word(1, "kernel_verdict");
    };
    EXPECT_EQ(verdict({1, 1, 1}, {1.1, 1.1, 1.1}), "saves");
    EXPECT_EQ(verdict({1, 1, 1}, {0.9, 0.9, 0.9}), "costs");
    EXPECT_EQ(verdict({1, 1, 1}, {1.01, 1.01, 1.01}), "within the spread");
    EXPECT_EQ(verdict({1, 1, 1}, {0.5, 1.1, 1.1}), "within the spread") << "a quartile below 1";
    EXPECT_EQ(verdict({0.8, 1.2, 1.5}, {1.1, 1.1, 1.1}), "within the spread") << "the control is as far from 1";
}

} // namespace
} // namespace forceshade::study
