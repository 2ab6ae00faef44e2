// Findings of error against time say what the data say, and turn with them.
#include <gtest/gtest.h>

#include "host/study/data/data_error.h"
#include "tests/study/made_error_time.h"

namespace forceshade::study {
namespace {

using namespace error_time;

TEST(ErrorTimeFindings, NameTheCheapest) {
    Made made;
    EXPECT_TRUE(
        says(made.text("cheapest_1deg_bump"), "the cheapest is \"1 facet, shaded: direct f64\" (0.6 times the unit"));
    made.times[made.number("bump, 64 facets, flat: direct f32")] = 0.3;
    EXPECT_TRUE(
        says(made.text("cheapest_1deg_bump"), "the cheapest is \"64 facets, flat: direct f32\" (0.3 times the unit"))
        << made.text("cheapest_1deg_bump");
    EXPECT_TRUE(says(made.text("cheapest_1deg_mesh"), "the cheapest is nothing that was tried"));
    // Out of contact at a tenth of the places: no candidate.
    made.measured.compared[made.number("bump, 64 facets, flat: direct f32")].smooth->contact_differs = 10;
    EXPECT_TRUE(says(made.text("cheapest_1deg_bump"), "the cheapest is \"1 facet, shaded"));
}

TEST(ErrorTimeFindings, CountFacets) {
    Made made;
    EXPECT_TRUE(says(made.text("facets_1deg"), "needs 1 shaded facet; of the numbers tried, flat ones need 64 (0.5°)"));
    made.measured.compared[made.number("bump, 4 facets, flat: direct f64")].smooth->direction->rms = 0.9;
    EXPECT_TRUE(says(made.text("facets_1deg"), "of the numbers tried, flat ones need 4 (0.9°)"));
}

TEST(ErrorTimeFindings, HoldShadingsAgainstFlatFacets) {
    Made made;
    made.add("bump, 4 facets, shaded", "direct", "f64", 0.88, 2, 4, "reference");
    made.measured.contenders[made.number("bump, 1 facet, shaded: direct f64")].facets = 2; // no flat one of as many
    EXPECT_TRUE(says(made.text("shading_bump_reference"),
                     "takes 1.1 times as long as flat facets, as many of them, and has "
                     "0.25 times their direction error"))
        << made.text("shading_bump_reference");
    made.times.back() = 0.4;
    made.measured.compared.back().smooth->direction->rms = 0;
    EXPECT_TRUE(says(made.text("shading_bump_reference"), "takes 0.5 times the time of flat facets"));
    EXPECT_TRUE(says(made.text("shading_bump_reference"), "none of their direction error"));
}

// Where no smooth shape is known, errors are against a law that is compared itself: nothing is close to a truth.
TEST(ErrorTimeFindings, WithoutASmoothShapeNothingIsTheCheapest) {
    Made made;
    made.add("mesh, 8 x 8 cells, mean_value", "direct", "f64", 12, 0, {}, "mean_value");
    EXPECT_TRUE(says(made.text("shading_mesh_mean_value"), "none of their direction error"));
    for (Contender& one : made.measured.contenders)
        if (one.subject == "mesh")
            one.against = "double of mean_value";
    EXPECT_EQ(made.text("cheapest_1deg_mesh"), "");
    EXPECT_EQ(made.text("shading_mesh_mean_value"), "");
    EXPECT_NE(made.text("cheapest_1deg_bump"), "");
    EXPECT_TRUE(says(made.text("god_object"), "up to 4.1° RMS off double of mean_value by the god-object, the static "
                                              "field's up to 4° off that by the static field."))
        << made.text("god_object");
    const auto figures = figures_of(tables_of(made.measured));
    const auto figure = std::ranges::find(figures, "error-time-mesh-direction", &Figure::name);
    ASSERT_NE(figure, figures.end());
    EXPECT_EQ(figure->y.label, "RMS direction error off double of mean_value / deg");
    EXPECT_TRUE(says(figure->caption, "closer to double of mean_value."));
    EXPECT_FALSE(says(figure->caption, "smooth shape"));
    for (Contender& one : made.measured.contenders)
        one.against = "double of none";
    EXPECT_EQ(made.text("facets_1deg"), "");
}

TEST(ErrorTimeFigures, OfPrecisionAreOfSurfacesWithSizes) {
    Made made;
    made.add("mesh, 8 x 8 cells, none", "direct", "f32", 10, 4, {}, "none");
    made.add("bump, 4 facets, flat", "direct", "f32", 1, 8, 4, "none");
    const auto named = [&](const char* name) {
        const auto figures = figures_of(tables_of(made.measured));
        return std::ranges::count(figures, name, &Figure::name);
    };
    made.measured.rounds = {{1, made.times}};
    EXPECT_EQ(named("precision-mesh"), 0); // no number of cells
    EXPECT_EQ(named("precision-bump"), 1);
}

TEST(ErrorTimeFindings, HoldWaysAgainstEachOther) {
    Made made;
    EXPECT_TRUE(says(made.text("god_object"), "takes 0.5 times the time of the static field"));
    EXPECT_TRUE(says(made.text("god_object"), "up to 4.1° RMS off the smooth shape's, the static field's up to 4°"));
    EXPECT_TRUE(says(made.text("kernel"), "takes 0.5 times the time of the CPU oracle"));
    EXPECT_TRUE(says(made.text("single_precision"), "takes 0.7 times the time of double"));
    EXPECT_TRUE(says(made.text("half_output"), "takes 1.5 times as long as double"));
    EXPECT_TRUE(says(made.text("closed_loop"), "takes 4 times as long as a direct evaluation"));
    EXPECT_TRUE(says(made.text("lookup_mesh"), "takes 0.05 times the time of evaluating it directly"));
    EXPECT_TRUE(says(made.text("lookup_mesh"), ": here a volume saves time."));
    made.times[made.number("mesh, 8 x 8 cells, none: god-object f64")] = 20;
    made.times[made.number("bump, 64 facets, flat: field, kernel f32")] = 0.8;
    made.times[made.number("mesh, 8 x 8 cells, none: look-up, trilinear f32")] = 12;
    EXPECT_TRUE(says(made.text("god_object"), "takes 2 times as long as the static field"));
    EXPECT_TRUE(says(made.text("kernel"), "takes 2 times as long as the CPU oracle"));
    EXPECT_TRUE(says(made.text("lookup_mesh"), "here a volume saves nothing"));
}

TEST(ErrorTimeFindings, TheCloserOfTwoThatTimesDoNotTellApartIsTheCheapest) {
    Made made;
    const auto flat = made.number("bump, 64 facets, flat: direct f32");
    made.times[flat] = 0.55;
    EXPECT_TRUE(says(made.text("cheapest_1deg_bump"), "the cheapest is \"64 facets, flat: direct f32\""));
    made.apart = true;       // once and twice the time: quartiles 1.25, 1.5, 1.75 of it
    made.times[flat] = 0.45; // 0.45 to 0.9, and 0.6 to 1.2 whose lower quartile of 0.75 is above the median of 0.675
    EXPECT_TRUE(says(made.text("cheapest_1deg_bump"), "the cheapest is \"64 facets, flat: direct f32\""));
    made.times[flat] = 0.55; // median 0.825
    EXPECT_TRUE(says(made.text("cheapest_1deg_bump"), "the cheapest is \"1 facet, shaded: direct f64\""));
}

TEST(ErrorTimeFindings, WhatIsNeverInContactHasNoDirectionAndNoPlaceAmongTheCheapest) {
    Made made;
    const auto shaded = made.number("bump, 1 facet, shaded: direct f64");
    made.measured.compared[shaded].smooth->direction.reset();
    const StudyData data = made.data();
    const Table& points = data.table("points");
    EXPECT_EQ(points.number(shaded, "direction_rms_deg"), std::nullopt);
    EXPECT_EQ(points.number(shaded, "shown_direction_deg"), std::nullopt);
    EXPECT_TRUE(says(made.text("cheapest_1deg_bump"), "the cheapest is \"64 facets, flat: direct f32"));
}

TEST(ErrorTimeFindings, TellOrders) {
    Made made;
    EXPECT_TRUE(says(made.text("orders"), "3 of 3 observed orders")) << made.text("orders");
    EXPECT_TRUE(says(made.text("order_at_depth"),
                     "order 2.00 of the cell size on the surface, but only with order 1.00 for a probe"));
    made.measured.series[0].errors = {2, 1};
    EXPECT_TRUE(says(made.text("orders"), "2 of 3 observed orders"));
    EXPECT_TRUE(says(made.text("orders"), "\"patch of triangles, mean_value\": 1.00 where 2 is expected"));
    EXPECT_TRUE(says(made.text("order_at_depth"), "and with order 1.00"));
}

TEST(ErrorTimeFindings, TellSpacingsAndTheTable) {
    Made made;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "at spacings up to 0.4 mm (1 %, "))
        << made.text("lookup_spacing_1");
    made.measured.lookups[1].error.rms = 0.02;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "at spacings up to 0.2 mm (0.5 %, "));
    made.measured.lookups[3].error.rms = 0.03;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "at 0.2 mm it is 3 % off "));
    EXPECT_TRUE(says(made.text("interpolation"), "all 3 printed values agree"));
    made.measured.patches[0].found[1] = 3.6;
    EXPECT_TRUE(says(made.text("interpolation"), "1 of 3 printed values"));
}

TEST(ErrorTimeFindings, MissingTablesAreTold) {
    StudyData data = Made().data();
    std::erase_if(data.tables, [](const Table& one) { return one.name == "cheapest"; });
    EXPECT_THROW(error_time_findings(data), DataError);
}

} // namespace
} // namespace forceshade::study
