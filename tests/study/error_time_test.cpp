// Error against time: places that a hand touches, errors there, and whole runs.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "host/study/error_time/error_time.h"
#include "host/study/error_time/volumes.h"
#include "host/touch/force_at.h"
#include "host/touch/force_errors.h"
#include "tests/io/folder.h"
#include "tests/study/subjects.h"

namespace forceshade::study::error_time {
namespace {

using testing::says;

TEST(ForceErrors, CountWhatIsMissedAndWhatShouldNotBe) {
    const std::vector<glm::dvec3> truth{{0, 0, 2}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}};
    const std::vector<glm::dvec3> found{{0, 0, 1}, {0, 0, 0}, {0, 0.5, 0}, {1, 0, 1}};
    const ForceErrors errors = force_errors(found, truth, 0.5);
    EXPECT_EQ(errors.places, 4u);
    EXPECT_EQ(errors.missed, 1u);
    EXPECT_EQ(errors.phantom, 1u);
    EXPECT_EQ(errors.one_sided_share(), 0.5);
    EXPECT_NEAR(errors.direction.largest, 45, 1e-12);
    EXPECT_EQ(errors.size.largest, 0.5) << "of the size alone, and only where both have a force";
    EXPECT_NEAR(errors.size.median, std::sqrt(2) - 1, 1e-12);
    EXPECT_EQ(errors.local.largest, 1) << "over the force there";
    EXPECT_EQ(errors.local.median, 1);
    EXPECT_EQ(errors.typical.largest, 2) << "over the typical force";
    EXPECT_TRUE(std::isnan(force_errors({}, {}, 1).direction.rms));
}

TEST(ForceErrors, SummaryIsOfRanks) {
    std::vector<double> values(100);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = double(99 - i);
    const Summary summary = summary_of(values);
    EXPECT_EQ(summary.median, 49);
    EXPECT_EQ(summary.p95, 94);
    EXPECT_EQ(summary.largest, 99);
    EXPECT_NEAR(summary.rms, std::sqrt(99 * 199 / 6.0), 1e-12);
}

// Depths as a hand's: as many between 0.02 and 0.2 mm as between 0.2 and 2 mm, everywhere on the surface.
TEST(TouchedPlaces, AreLogUniformInDepthAndUniformOverTheSurface) {
    for (const Subject& subject : own_subjects(few())) {
        std::size_t shallow = 0, left = 0;
        for (const TouchPlace& place : subject.places) {
            EXPECT_GE(place.depth, 0.02e-3);
            EXPECT_LE(place.depth, 2e-3);
            shallow += place.depth < 0.2e-3;
            left += place.at.x < 0;
            EXPECT_NE(subject.force(place), glm::dvec3(0));
            TouchPlace above = place;
            above.at += (place.depth + 1e-6) * place.normal;
            EXPECT_EQ(subject.force(above), glm::dvec3(0)) << "depth is from the surface";
        }
        const auto count = double(subject.places.size());
        EXPECT_EQ(subject.places.size(), 400u);
        EXPECT_NEAR(double(shallow), count / 2, 3 * std::sqrt(count / 4));
        EXPECT_NEAR(double(left), count / 2, 3 * std::sqrt(count / 4));
    }
}

TEST(TouchedPlaces, HaveTheKindOfWhatIsMetThere) {
    const Subject bump = own_subjects(few()).front();
    const Variant &coarse = variant_named(bump, "4 facets, none"), &fine = variant_named(bump, "64 facets, none");
    KindOf of_coarse(bump, coarse), of_fine(bump, fine);
    const auto at = [](double x, double z, double depth) { return TouchPlace{{x, 0, z - depth}, {0, 0, 1}, depth}; };
    EXPECT_EQ(of_coarse(at(13.5e-3, 0, 1e-3)), Kind::flat);
    EXPECT_EQ(of_coarse(at(13.5e-3, 0, 0.03e-3)), Kind::boundary);
    EXPECT_EQ(of_coarse(at(12.7e-3, 0, 1e-3)), Kind::rim);
    const double top = 15.24e-3 - std::sqrt(15.24e-3 * 15.24e-3 - 12.7e-3 * 12.7e-3);
    EXPECT_EQ(of_coarse(at(0, top, 1e-3)), Kind::edge) << "of four facets two meet at the top";
    EXPECT_EQ(of_coarse(at(1e-3, top, 1e-3)), Kind::facet);
    EXPECT_EQ(of_fine(at(0, top, 1e-3)), Kind::edge);
    SharedPlaces shared = shared_places(bump, few(), 0);
    const KindPlaces all = places_of(bump, coarse, shared, few(), 0);
    for (const Kind kind : kKinds)
        EXPECT_GE(std::ranges::count(all.kinds, kind), 30) << name_of(kind);
    for (std::size_t i = 0; i < all.at.size(); ++i)
        if (all.at[i].depth < 0) {
            EXPECT_EQ(all.kinds[i], Kind::boundary);
            EXPECT_EQ(bump.force(all.at[i]), glm::dvec3(0));
        }
}

// A look-up that is good at two millimetres is not where contact begins.
TEST(TouchedPlaces, ShowWhatALookUpDoesWhereContactBegins) {
    const Subject bump = own_subjects(few()).front();
    const Variant& shaded = variant_named(bump, "64 facets, reference");
    const TurnedGrid grid(bump.low, bump.high, 0.4e-3, glm::dvec3(0));
    const Volume<float, float, 3> volume(grid.grid, sampled(*shaded.prepared, grid));
    SharedPlaces shared = shared_places(bump, few(), 0);
    const KindPlaces all = places_of(bump, shaded, shared, few(), 0);
    std::vector<glm::dvec3> found[2], truth[2];
    for (std::size_t i = 0; i < all.at.size(); ++i) {
        const bool shallow = all.kinds[i] == Kind::boundary;
        if (!shallow && (all.kinds[i] != Kind::facet || all.at[i].depth < 1e-3))
            continue;
        found[shallow].emplace_back(volume.trilinear(reference::Vector<float>(all.at[i].at)));
        truth[shallow].push_back(bump.force(all.at[i]));
    }
    EXPECT_LT(force_errors(found[0], truth[0], 1).local.p95, 0.02);
    EXPECT_GT(force_errors(found[1], truth[1], 1).local.p95, 0.5);
}

TEST(TouchedPlaces, OfAGodObjectAreReachedFromAbove) {
    const Subject mesh = own_subjects(few()).back();
    const Variant& flat = variant_named(mesh, "8 cells, none");
    const std::vector<glm::dvec3> found = forces_by(ProxyForce<double>(*flat.prepared, mesh.scale), mesh.places),
                                  direct = forces_by(StaticForce<double>(*flat.prepared), mesh.places);
    std::vector<glm::dvec3> truth;
    for (const TouchPlace& place : mesh.places)
        truth.push_back(mesh.force(place));
    const ForceErrors of_proxy = force_errors(found, truth, 1), of_direct = force_errors(direct, truth, 1);
    EXPECT_NEAR(of_proxy.direction.rms, of_direct.direction.rms, 0.2 * of_direct.direction.rms);
    EXPECT_EQ(of_proxy.missed, of_direct.missed) << "facets of 8 cells lie up to 0.1 mm below the cylinder";
}

// Where facets are few the field has errors that shading over many does not have; a stroke has what is true beside it.
TEST(Sections, ShowWhereAWayErrsAndWhatAStrokeFeels) {
    const std::vector<Subject> subjects = own_subjects(few());
    const auto method_of = [&](const std::string& name) {
        Method method;
        method.name = name;
        method.subject = &subjects.front();
        method.variant = &variant_named(subjects.front(), name);
        method.forces = [&, variant = method.variant](std::span<const TouchPlace> at) {
            return forces_by(StaticForce<double>(*variant->prepared), at);
        };
        return method;
    };
    const Method coarse = method_of("4 facets, none"), fine = method_of("64 facets, reference");
    const Method* const methods[] = {&coarse, &fine};
    const std::vector<Table> tables = section_tables(methods);
    std::map<std::string, double> largest, deep;
    for (std::size_t row = 0; row < tables[0].rows.size(); ++row) {
        const std::string method = tables[0].word(row, "way");
        const double error = tables[0].needed(row, "local_max_1");
        EXPECT_GE(error, 1e-4);
        largest[method] = std::max(largest[method], error);
        if (tables[0].needed(row, "height_mm") == -2)
            deep[method] = std::max(deep[method], error);
    }
    EXPECT_GT(deep[coarse.name], 0.2) << "the direction is wrong however deep";
    EXPECT_LT(deep[fine.name], 0.01);
    EXPECT_GT(largest[fine.name], 0.05) << "a chord lies 1.8 um below its arc, 0.02 mm over the probe";
    std::size_t planes = 0;
    for (std::size_t row = 0; row < tables[1].rows.size(); ++row)
        if (tables[1].word(row, "way") == kSmoothShape && std::abs(tables[1].needed(row, "x_mm")) > 13) {
            EXPECT_NEAR(tables[1].needed(row, "force_N"), tables[1].word(row, "component") == "along x" ? 0 : 0.5,
                        1e-3);
            ++planes;
        }
    EXPECT_GT(planes, 20u) << "0.5 mm below the plane beside the bump, 1 N/mm";
}

// A whole run on a scene whose smooth shape is not known.
class SceneErrorTime : public ::testing::Test {
protected:
    StudyData run(const std::string& scene) {
        StudyOptions options;
        options.folder = folder_ / "error-time";
        options.quick = true;
        options.engine.cpu = true;
        options.scene = parse_scene(scene, "test", folder_.path());
        StudyRun run("error-time", options);
        return study_error_time(run);
    }

    testing::Folder folder_;
};

TEST_F(SceneErrorTime, NamesNothingTheCheapestWithoutATruth) {
    const StudyData data =
        run("[surface]\nkind = \"height_map\"\nfunction = \"gaussian\"\nheight = \"2 mm\"\nradius = \"3 mm\"\n"
            "[force]\nshading = \"height_map\"\n[grid]\nsize = [24, 16, 16]\n"
            "origin = [\"-12 mm\", \"-8 mm\", \"-3 mm\"]\nspacing = [\"1 mm\", \"1 mm\", \"0.4 mm\"]\n");
    EXPECT_TRUE(says(data.notes.front(), "threads ran or waited on the machine")) << "times depend on its load";
    EXPECT_TRUE(data.table("cheapest").rows.empty());
    ASSERT_FALSE(data.findings.empty());
    EXPECT_LE(data.findings.size(), 6u);
    for (const Finding& finding : data.findings) {
        EXPECT_FALSE(says(finding.place, "bump")) << finding.text;
        EXPECT_FALSE(says(finding.text + finding.interval, "nan"));
        EXPECT_FALSE(says(finding.text + finding.interval, "inf"));
    }
    for (const auto& row : data.table("ways").rows)
        EXPECT_EQ(std::get<std::string>(row[data.table("ways").index("against")]),
                  "height_map shading in double precision");
}

TEST_F(SceneErrorTime, NeedsASurfaceInItsGrid) {
    EXPECT_THROW(run("[grid]\nsize = [8, 8, 8]\norigin = [\"0 mm\", \"0 mm\", \"50 mm\"]\nspacing = \"1 mm\"\n"),
                 UsageError);
}

} // namespace
} // namespace forceshade::study::error_time
