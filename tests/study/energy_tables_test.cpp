// Tables of the study of energy.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/study/energy_samples.h"

namespace forceshade::study {
namespace {

TEST(EnergyTables, TakeTheCoarsestThatKeepsToAnError) {
    const StudyData data = sample();
    const Table& equal = data.table("equal_error");
    const auto expect = [&](double level, const char* scheme, double facets, double error, double eta) {
        for (std::size_t i = 0; i < equal.rows.size(); ++i)
            if (equal.number(i, "error_deg") == level && equal.word(i, "scheme") == scheme) {
                EXPECT_EQ(equal.number(i, "facets"), facets);
                EXPECT_EQ(equal.number(i, "direction_rms_deg"), error);
                EXPECT_EQ(equal.number(i, "eta"), eta);
                return;
            }
        ADD_FAILURE() << level << " " << scheme;
    };
    expect(2, "facets", 8, 2, 0.05);
    expect(1, "facets", 32, 0.5, 0.07);
    expect(2, "triangles none", 32, 0.4, 0);
    expect(0.2, "shaded", 1, 0, 0.24);
    EXPECT_EQ(equal.rows.size(), 4u + 4 + 4 + 1) << "no row where none keeps to it";
}

TEST(EnergyTables, OfEqualErrorAreRowsOfLoopsWhereEnergyChangesSign) {
    // Between 4 and 8 cells energy is taken here and given there; no mesh has what lies between.
    const char* scheme = "quads two_pass, god-object";
    const Table loops =
        loops_table({row("mesh of quads", scheme, 8, 0.126, 0.004), row("mesh of quads", scheme, 4, 0.68, -0.0008)});
    const Table equal = equal_error_table(loops);
    ASSERT_EQ(equal.rows.size(), 4u);
    EXPECT_EQ(equal.number(0, "facets"), 4.0);
    EXPECT_EQ(equal.number(0, "eta"), -0.0008);
    EXPECT_EQ(equal.number(2, "facets"), 8.0);
    EXPECT_EQ(equal.number(2, "eta"), 0.004);
    EXPECT_EQ(equal.word(2, "group"), "mesh, god-object");
}

TEST(EnergyTables, TellASchemesHistoryApart) {
    const Table loops = loops_table({row("mesh of quads", "quads two_pass, god-object", 8, 1, 0.1),
                                     row("mesh of quads", "quads two_pass", 8, 1, 0.1),
                                     row("bump", "facets, normal depth", 8, 1, 0.1)});
    EXPECT_EQ(loops.word(0, "law"), "quads two_pass");
    EXPECT_EQ(loops.word(0, "history"), "god-object");
    EXPECT_EQ(loops.word(1, "law"), "quads two_pass");
    EXPECT_EQ(loops.word(1, "history"), "static field");
    EXPECT_EQ(loops.word(2, "law"), "facets, normal depth");
    const std::vector<Figure> figures = loop_figures();
    const auto bars = std::ranges::find(figures, std::string("eta_bars"), &Figure::name);
    ASSERT_NE(bars, figures.end());
    EXPECT_EQ(bars->x.column + "/" + bars->series, "law/history");
}

TEST(EnergyTables, TheFrontHoldsWhatNothingBeats) {
    const StudyData data = sample();
    const Table& front = data.table("front");
    ASSERT_EQ(front.rows.size(), 3u);
    EXPECT_EQ(front.word(0, "scheme"), "shaded");
    EXPECT_EQ(front.number(0, "facets"), 32.0);
    EXPECT_EQ(front.word(1, "scheme"), "triangles mean_value");
    EXPECT_EQ(front.word(2, "scheme"), "triangles none");
}

} // namespace
} // namespace forceshade::study
