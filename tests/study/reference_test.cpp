// The results that the README shows are whole, and the README says what they say; rows of each study's tables are
// computed again.
#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/output/files.h"
#include "host/study/energy/energy.h"
#include "host/study/error_time/error_time.h"
#include "host/study/omission/omission.h"
#include "host/study/stability/stability.h"
#include "host/study/study_data.h"
#include "host/touch/own_surfaces.h"
#include "tests/io/folder.h"
#include "tests/places.h"

namespace forceshade::study {
namespace {

const std::filesystem::path kSource = in_source("");
const std::filesystem::path kReference = kSource / "results/reference";
constexpr const char* kStudies[] = {"error-time"};

// What the account names is there as it was written, and nothing else is.
TEST(Reference, HoldsWhatItsAccountsName) {
    for (const char* study : kStudies) {
        const StudyData data = read_data(kReference / study);
        EXPECT_EQ(data.files.size(), data.tables.size() + data.figures.size()) << study;
        std::set<std::string> named{"study.json"};
        for (const std::vector<FileRecord>* files : {&data.files, &data.volumes})
            for (const FileRecord& file : *files) {
                EXPECT_TRUE(file_is_intact(kReference / study / file.name, file.sha256)) << study << ' ' << file.name;
                named.insert(file.name);
            }
        for (const auto& entry : std::filesystem::directory_iterator(kReference / study))
            EXPECT_TRUE(!entry.is_regular_file() || named.contains(entry.path().filename().string())) << entry.path();
    }
}

TEST(Reference, ReadmeShowsThreeFindingsWordForWord) {
    const std::string text = testing::read_text(kSource / "README.md");
    std::size_t shown = 0;
    for (const char* study : kStudies)
        for (const Finding& finding : read_data(kReference / study).findings)
            shown += text.find("- " + finding.text + "\n") != std::string::npos;
    EXPECT_GE(shown, 3u);
}

TEST(Reference, PicturesOfTheReadmeAreThere) {
    const std::string text = testing::read_text(kSource / "README.md");
    std::size_t pictures = 0;
    for (std::size_t at = text.find("](results/reference/"); at != std::string::npos;
         at = text.find("](results/reference/", at + 1)) {
        const std::string name = text.substr(at + 2, text.find(')', at) - at - 2);
        EXPECT_TRUE(std::filesystem::is_regular_file(kSource / name)) << name;
        ++pictures;
    }
    EXPECT_GE(pictures, 2u);
}

// A table's rows, by column.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& file) {
    const std::vector<std::string> lines = testing::lines_of(testing::read_text(kReference / file));
    std::vector<std::map<std::string, std::string>> rows;
    const std::vector<std::string> columns = testing::cells_of(lines.at(0));
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::vector<std::string> cells = testing::cells_of(lines[i]);
        auto& row = rows.emplace_back();
        for (std::size_t j = 0; j < columns.size(); ++j)
            row[columns[j]] = cells.at(j);
    }
    return rows;
}
// The row that has these words. \throws std::out_of_range without one
std::map<std::string, std::string> row_with(const std::string& file, const std::map<std::string, std::string>& words) {
    for (const auto& row : rows_of(file))
        if (std::ranges::all_of(words, [&](const auto& one) { return row.at(one.first) == one.second; }))
            return row;
    throw std::out_of_range(file + " has no such row");
}
void expect_equal(double found, const std::string& kept, const std::string& what) {
    EXPECT_NEAR(found, std::stod(kept), 1e-6 * std::abs(std::stod(kept)) + 1e-12) << what;
}

std::unique_ptr<Engine> oracle() {
    EngineOptions options;
    options.cpu = true;
    return make_engine(options);
}

TEST(Reference, HasTheErrorsOfEightFacets) {
    error_time::Extents extents = error_time::extents_of(false);
    extents.facets = {8};
    extents.cells = {4};
    const std::vector<error_time::Subject> subjects = error_time::own_subjects(extents);
    const auto engine = oracle();
    for (const error_time::Variant& law : subjects.front().variants) {
        std::vector<error_time::Method> methods;
        add_methods(methods, subjects.front(), law, 0, {*engine, *engine});
        std::erase_if(methods, [](const auto& one) { return one.family != "direct" || one.precision != "f64"; });
        ASSERT_EQ(methods.size(), 1u);
        error_time::KnownPlaces known;
        add_errors(methods, subjects.front(), law, extents, {*engine, *engine}, known);
        const auto kept = row_with("error-time/ways.csv", {{"way", methods[0].name}});
        const ForceErrors& found = methods[0].errors->shared;
        expect_equal(found.direction.rms, kept.at("direction_rms_deg"), methods[0].name);
        expect_equal(found.size.median, kept.at("size_median_1"), law.name);
        expect_equal(found.size.p95, kept.at("size_p95_1"), law.name);
        expect_equal(found.one_sided_share(), kept.at("one_sided"), law.name);
    }
}

TEST(Reference, HasTheLimitsOfTheShadedBump) {
    const std::vector<LoopSurface> surfaces = own_surfaces();
    const LoopSurface& bump = *std::ranges::find(surfaces, "shaded bump of 2 facets", &LoopSurface::name);
    const std::vector<LeastLimit> limits =
        least_limits(bump, searched_places(bump, 400, Searched::of_each_kind), {settings_of(bump, false).front()});
    const LeastLimit& worst = *worst_of(limits);
    const auto kept = row_with("stability/loop_worst.csv", {{"surface", bump.name}});
    expect_equal(*worst.limit, kept.at("limit_N_per_m"), "worst");
    expect_equal(1e3 * worst.place.at.x, kept.at("x_mm"), "place");
    std::size_t kinds = 0;
    for (const auto& row : rows_of("stability/loop_kinds.csv"))
        for (const PlaceKind kind : {PlaceKind::flat, PlaceKind::crest, PlaceKind::hollow, PlaceKind::slope})
            if (row.at("surface") == bump.name && row.at("kind") == name_of(kind)) {
                expect_equal(*worst_of(limits, bump.name, {}, kind)->limit, row.at("limit_N_per_m"), name_of(kind));
                ++kinds;
            }
    EXPECT_GE(kinds, 2u);
}

TEST(Reference, HasTheEnergyOfEightFacets) {
    const std::vector<Stroke> strokes = drawn_strokes({{-kOwnHalfWidth, -0.005}, {kOwnHalfWidth, 0.005}}, 250);
    for (const auto& [shading, scheme] : {std::pair(Shading::none, "unshaded"), {Shading::reference, "shaded"}}) {
        auto prepared = std::make_shared<PreparedCase>(own_case({.radius = kOwnRadius, .facets = 8}));
        prepared->one.scene.force.shading = shading;
        const EnergyLaw law{"bump", scheme, 8, shading == Shading::none, prepared};
        std::vector<LoopRow> rows;
        for (const Stroke& stroke : strokes)
            if (const auto places = places_of_loop(law, stroke, 256))
                if (const auto work = work_by_place(law, *places))
                    rows.push_back({&law, false, rows.size(), std::abs(work->work), work->effort});
        const LawRow found = summarise_by_law(rows).at(0);
        const auto kept = row_with("energy/energy.csv", {{"surface", "bump"}, {"elements", "8"}, {"scheme", scheme}});
        expect_equal(1e3 * found.gain.median, kept.at("gain_mJ"), scheme);
        expect_equal(1e3 * found.effort, kept.at("effort_mJ"), scheme);
        EXPECT_EQ(std::to_string(found.loops), kept.at("closed_strokes")) << scheme;
    }
}

// Times are free.
TEST(Reference, HasTheSamplesThatABumpLeavesOut) {
    const testing::Folder folder;
    const auto engine = oracle();
    const std::vector<BaseScene> scenes = own_scenes(false);
    for (const Comparison& one : comparisons_of(scenes.front(), false)) {
        const Measurement found = measure(*engine, one, {1, 1e-6, 60}, folder.path());
        const auto kept = row_with("omission/features.csv", {{"scene", one.scene}, {"feature", one.feature}});
        EXPECT_EQ(std::to_string(found.with.samples), kept.at("samples")) << one.feature;
        EXPECT_EQ(std::to_string(found.with.cost.evaluated), kept.at("evaluated_with")) << one.feature;
        EXPECT_EQ(std::to_string(found.without.cost.evaluated), kept.at("evaluated_without")) << one.feature;
        EXPECT_EQ(found.same_forces() ? "yes" : "no", kept.at("same_forces")) << one.feature;
        EXPECT_EQ(one.omitted, kept.at("omitted")) << one.feature;
    }
}

} // namespace
} // namespace forceshade::study
