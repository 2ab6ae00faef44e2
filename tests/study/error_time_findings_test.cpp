// Findings of error against time say what the data say, and turn with them.
#include <functional>

#include <gtest/gtest.h>

#include "host/study/data/data_error.h"
#include "host/study/error_time/measured.h"
#include "host/study/findings/findings.h"

namespace forceshade::study {
namespace {

using namespace error_time;

// A study as it might have come out; a contender has a time in the unit and a direction error, deg.
class Made {
public:
    Measured measured;

    Made() {
        add("bump, 4 facets, flat", "direct", "f64", 0.8, 8, 4, "none");
        add("bump, 64 facets, flat", "direct", "f64", 1, 0.5, 64, "none");
        add("bump, 64 facets, flat", "direct", "f32", 0.7, 0.5, 64, "none");
        add("bump, 64 facets, flat", "direct", "f32, half output", 1.5, 0.51, 64, "none");
        add("bump, 1 facet, shaded", "direct", "f64", 0.6, 0, 1, "reference");
        add("bump, 64 facets, flat", "field, kernel", "f32", 0.2, 0.5, 64, "none");
        add("bump, 64 facets, flat", "field, CPU on one thread", "f32", 0.4, 0.5, 64, "none");
        add("bump, 64 facets, flat", "closed loop, CPU on one thread", "f64", 4, 0.5, 64, "none");
        add("bump, 64 facets, flat", "closed loop, CPU on one thread", "f32", 3, 0.5, 64, "none");
        add("mesh, 8 x 8 cells, none", "direct", "f64", 10, 4, {}, "none");
        add("mesh, 8 x 8 cells, none", "god-object", "f64", 5, 4.1, {}, "none");
        add("mesh, 8 x 8 cells, none", "look-up, trilinear", "f32", 0.5, 4.2, {}, "none");
        add("mesh, 8 x 8 cells, none", "look-up, tricubic", "f32", 1.5, 4.15, {}, "none");
        of("look-up, trilinear", "f32").spacing = of("look-up, tricubic", "f32").spacing = 0.2e-3;
        measured.series = {{"patch of triangles, mean_value", "e", "1 / cells", {0.1, 0.05}, {4, 1}, 2, "L7"},
                           {"mesh, mean_value, static", "e", "1 / cells", {0.1, 0.05}, {4, 2}, 1, "depth"}};
        for (const double spacing : {0.4e-3, 0.2e-3})
            for (const char* place : {"smooth", "edge"})
                measured.lookups.push_back({"a bump",
                                            spacing,
                                            {"trilinear", place, 500, place[0] == 'e' ? spacing / 0.04 : 1e-4, 1, 1},
                                            place[0] == 'e' ? std::optional(1.0) : std::nullopt});
        measured.patches = {{"cylinder", "triangles", "none", 8, {2.12, 3.77, 7.42}, {2.12, 3.77, 7.42}}};
        measured.unit = 1;
    }

    void add(const std::string& law, const std::string& family, const std::string& precision, double time, double angle,
             std::optional<double> facets, const std::string& shading) {
        Contender one;
        one.name = law + ": " + family + " " + precision;
        one.subject = law.substr(0, law.find(','));
        one.family = family;
        one.precision = precision;
        one.shading = shading;
        one.facets = facets;
        one.reference = law + ": direct f64";
        measured.contenders.push_back(one);
        ForceErrors errors;
        errors.direction = Summary{angle, 2 * angle, 3 * angle};
        errors.vector = Summary{angle / 57, angle / 30, angle / 20};
        errors.compared = 100;
        ForceErrors exact;
        exact.direction = Summary{0, 0, 0};
        exact.vector = Summary{precision == "f64" ? 0 : 1e-7, 1e-6, precision == "f64" ? 0 : 1e-5};
        measured.compared.push_back({errors, exact});
        times.push_back(time);
    }

    Contender& of(const std::string& family, const std::string& precision) {
        for (Contender& one : measured.contenders)
            if (one.family == family && one.precision == precision)
                return one;
        throw std::out_of_range(family);
    }

    std::size_t number(const std::string& name) const {
        for (std::size_t i = 0; i < measured.contenders.size(); ++i)
            if (measured.contenders[i].name == name)
                return i;
        throw std::out_of_range(name);
    }

    StudyData data() {
        measured.rounds = {{1, times}, {2, times}};
        measured.rounds[1].unit = apart ? 1 : 2;
        for (double& seconds : measured.rounds[1].seconds)
            seconds *= 2;
        StudyData data;
        data.study = "error-time";
        data.device = "a device";
        data.cores = 2;
        data.tables = tables_of(measured);
        return data;
    }

    std::string text(const std::string& name) {
        for (const Finding& one : findings_of(data()))
            if (one.name == name)
                return one.text;
        return "";
    }

    std::vector<double> times;
    bool apart = false; // the second round's ratios are twice the first's
};

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

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
    EXPECT_TRUE(says(made.text("tricubic"), "takes 3 times as long as trilinear"));
    made.times[made.number("mesh, 8 x 8 cells, none: god-object f64")] = 20;
    made.times[made.number("bump, 64 facets, flat: field, kernel f32")] = 0.8;
    made.times[made.number("mesh, 8 x 8 cells, none: look-up, trilinear f32")] = 12;
    EXPECT_TRUE(says(made.text("god_object"), "takes 2 times as long as the static field"));
    EXPECT_TRUE(says(made.text("kernel"), "takes 2 times as long as the CPU oracle"));
    EXPECT_TRUE(says(made.text("lookup_mesh"), "here a volume saves nothing"));
}

TEST(ErrorTimeFindings, HoldVolumesOfEverySpacingAgainstDirect) {
    Made made;
    made.of("look-up, trilinear", "f32").spacing = 0.1e-3;
    const auto trilinear = made.number("mesh, 8 x 8 cells, none: look-up, trilinear f32");
    made.times[trilinear] = 17;
    made.measured.compared[trilinear].reference->direction->rms = 0.001;
    const auto add = [&](double spacing, double time, double error) {
        made.add("mesh, 8 x 8 cells, none", "look-up, trilinear", "f32", time, 4.2, {}, "none");
        made.measured.contenders.back().spacing = spacing;
        made.measured.compared.back().reference->direction->rms = error;
    };
    add(0.2e-3, 9, 0.003);
    add(0.8312581986e-3, 6.7, 0.05);
    add(0.4e-3, 7.1, 0.012);
    const std::string text = made.text("lookup_mesh");
    EXPECT_TRUE(says(text,
                     "volume of 0.831 mm (nan MB) takes 0.67 times the time of evaluating it directly in f64, and "
                     "is 0.05° RMS off that; a volume of 0.1 mm"))
        << text;
    EXPECT_TRUE(says(text,
                     "takes 1.7 times as long as evaluating it directly in f64, and is 0.001° RMS off that: of "
                     "those tried, 0.831, 0.4 and 0.2 mm save time, the closest of these with 0.9 times the time and "
                     "0.003°."))
        << text;
    made.times[made.times.size() - 3] = 11;
    made.times[made.times.size() - 1] = 12;
    EXPECT_TRUE(says(made.text("lookup_mesh"), ": of those tried, 0.831 mm saves time."));
    made.times[made.times.size() - 2] = 9.9;
    EXPECT_TRUE(says(made.text("lookup_mesh"), ": here no volume that was tried saves anything."));
    for (std::size_t i = 0; i < 3; ++i)
        made.times[made.times.size() - 1 - i] = 5;
    made.times[trilinear] = 5;
    EXPECT_TRUE(says(made.text("lookup_mesh"), ": every volume that was tried saves time."));
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
                     "order 2.00 in the cell size, for probes pressed in with order 1.00: the proxy"));
    made.measured.series[0].errors = {2, 1};
    EXPECT_TRUE(says(made.text("orders"), "2 of 3 observed orders"));
    EXPECT_TRUE(says(made.text("orders"), "\"patch of triangles, mean_value\": 1.00 where 2 is expected"));
    EXPECT_TRUE(says(made.text("order_at_depth"), "depth does not matter"));
}

TEST(ErrorTimeFindings, TellSpacingsAndTheTable) {
    Made made;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "up to a spacing of 0.4 mm (1 %)"))
        << made.text("lookup_spacing_1");
    made.measured.lookups[1].error.rms = 0.02;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "up to a spacing of 0.2 mm (0.5 %)"));
    made.measured.lookups[3].error.rms = 0.03;
    EXPECT_TRUE(says(made.text("lookup_spacing_1"), "at 0.2 mm it is still 3 % off"));
    EXPECT_TRUE(says(made.text("interpolation"), "all 3 printed values agree"));
    made.measured.patches[0].found[1] = 3.6;
    EXPECT_TRUE(says(made.text("interpolation"), "1 of 3 printed values"));
}

TEST(ErrorTimeFindings, MissingTablesAreTold) {
    StudyData data = Made().data();
    std::erase_if(data.tables, [](const Table& one) { return one.name == "cheapest"; });
    EXPECT_THROW(findings_of(data), DataError);
}

} // namespace
} // namespace forceshade::study
