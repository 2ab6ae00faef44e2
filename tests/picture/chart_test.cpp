// Charts: everything that is written stands on the sheet and clear of the rest, and nothing is left out in silence.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "host/picture/canvas.h"
#include "host/picture/frame.h"
#include "tests/picture/cases.h"

namespace forceshade::picture {
namespace {

Chart sample() {
    Chart chart;
    chart.title =
        "A title that is so long that it needs more than one line of the sheet, however wide the sheet may be";
    chart.x = {"time of an evaluation / ns", true};
    chart.y = {"error / deg", true};
    for (int s = 0; s < 9; ++s) {
        ChartSeries series{"series number " + std::to_string(s), {}, true, s % 2 == 0, false};
        for (int i = 0; i < 6; ++i) {
            ChartPoint point{std::pow(10, i - 1) * (1 + s), std::pow(10, -i) * (1 + s), {}, {}, {}, {}, ""};
            point.x_low = 0.8 * point.x;
            point.x_high = 1.3 * point.x;
            if (i == 2)
                point.label = "the label of a mark";
            series.points.push_back(point);
        }
        chart.series.push_back(series);
    }
    chart.series.push_back(
        {"a curve", {{1, 1, {}, {}, {}, {}, ""}, {1000, 1e-3, {}, {}, {}, {}, ""}}, false, true, true});
    return chart;
}

Chart map_sample(bool words) {
    Chart chart;
    chart.title = "A map";
    chart.x.label = "x / mm";
    chart.y.label = "stiffness / (N/m)";
    chart.value_label = "largest force / N";
    for (int i = 0; i < 20; ++i)
        for (int k = 0; k < 15; ++k)
            chart.cells.push_back(
                {0.1 * i, 100.0 * k, words ? 0 : std::sin(i) * k, words ? (i > k ? "stable" : "unstable") : ""});
    return chart;
}

Chart bar_sample() {
    Chart chart;
    chart.title = "Bars";
    chart.x.label = "energy / mJ";
    chart.groups = {"a bump of many facets, not shaded", "another"};
    for (const char* name : {"shaded", "unshaded"})
        chart.series.push_back({name, {{0, 2, {}, {}, 1, 3, ""}, {1, -1, {}, {}, -2, 0, ""}}, true, false, false});
    return chart;
}

TEST(Chart, HasNoTextThatIsCutOrDrawnOver) {
    for (const Chart& chart : {sample(), map_sample(false), map_sample(true), bar_sample(), Chart{}}) {
        const Picture picture = draw_chart(chart);
        EXPECT_GT(picture.png.size(), 1000u);
        test::expect_clear_texts(picture);
    }
}

TEST(Chart, TellsOfPointsThatAnAxisCannotShow) {
    Chart chart = sample();
    const auto tells = [&] {
        for (const PlacedText& text : draw_chart(chart).texts)
            if (text.text.find("have no number") != std::string::npos)
                return text.text;
        return std::string();
    };
    EXPECT_EQ(tells(), "");
    chart.series[0].points[0].x = -1;
    chart.series[0].points[1].y = NAN;
    EXPECT_EQ(tells(), "2 points have no number that these axes can show.");
}

std::vector<std::string> texts_of(const Chart& chart) {
    std::vector<std::string> texts;
    for (const PlacedText& text : draw_chart(chart).texts)
        texts.push_back(text.text);
    return texts;
}

Chart named(const std::vector<std::string>& names) {
    Chart chart;
    for (const std::string& name : names)
        chart.series.push_back({name, {{1, 1, {}, {}, {}, {}, ""}}, true, false, false});
    return chart;
}

TEST(Chart, GivesASeriesItsColourByItsName) {
    const std::vector<std::string> all{"facet", "direct", "new", "edge"}, one{"edge"};
    const std::vector<std::size_t> numbers = series_numbers(all);
    EXPECT_EQ(numbers[3], series_numbers(one)[0]);
    std::set<std::tuple<int, int, int>> colours;
    for (const std::size_t number : numbers)
        colours.insert({series_colour(number).r, series_colour(number).g, series_colour(number).b});
    EXPECT_EQ(colours.size(), all.size()) << "also of a name that is not known";
    EXPECT_NE(known_series_json().find("\"edge\": " + std::to_string(numbers[3])), std::string::npos);
}

TEST(Chart, HasALegendOfWhatIsDrawnAlone) {
    Chart chart = named({"drawn", "not drawn"});
    chart.x.logarithmic = true;
    chart.series[1].points[0].x = -1;
    chart.series.push_back({"a curve of one point", {{1, 1, {}, {}, {}, {}, ""}}, false, true, false});
    const std::vector<std::string> texts = texts_of(chart);
    EXPECT_EQ(std::ranges::count(texts, "drawn"), 1);
    EXPECT_EQ(std::ranges::count(texts, "not drawn"), 0);
    EXPECT_EQ(std::ranges::count(texts, "a curve of one point"), 0);
    Chart map = map_sample(true);
    map.words = {"stable", "unstable", "never"};
    EXPECT_EQ(std::ranges::count(texts_of(map), "never"), 0);
}

TEST(Chart, HasRoundTicksBetweenManyCells) {
    Chart map = map_sample(false);
    map.cells.clear();
    for (int i = 0; i < 40; ++i)
        map.cells.push_back({130 * std::pow(1.26, i), 100, 1, ""});
    const std::vector<std::string> texts = texts_of(map);
    EXPECT_EQ(std::ranges::count(texts, "1000"), 1);
    EXPECT_EQ(std::ranges::count(texts, "130"), 0) << "the value of the first column";
}

TEST(Chart, HasRoundTicksBetweenFewCells) {
    for (const int rows : {3, 4, 8, 16}) {
        Chart map = map_sample(false);
        map.cells.clear();
        for (int i = 0; i < rows; ++i) // from 0.6 to 60 at equal ratios
            map.cells.push_back({double(i), 0.6 * std::pow(100, i / (rows - 1.0)), 1, ""});
        const std::vector<std::string> texts = texts_of(map);
        EXPECT_EQ(std::ranges::count(texts, "10"), rows > 10 ? 2 : 1) << rows << " rows";
        EXPECT_EQ(std::ranges::count(texts, "0.6") + std::ranges::count(texts, "60"), 0) << rows << " rows";
        EXPECT_GE(std::ranges::count(texts, "2"), 1) << rows << " counted columns";
    }
}

TEST(Chart, KeepsLabelsClearOfLines) {
    Chart chart = named({"way"});
    chart.series[0].points = {
        {0, 0, {}, {}, {}, {}, ""}, {5, 5, {}, {}, {}, {}, "label"}, {10, 10, {}, {}, {}, {}, ""}};
    EXPECT_EQ(std::ranges::count(texts_of(chart), "label"), 1);
    for (int i = 0; i <= 60; ++i) // a net of lines over the whole plot
        chart.series.push_back(
            {"", {{0, i / 6.0, {}, {}, {}, {}, ""}, {10, i / 6.0, {}, {}, {}, {}, ""}}, false, true, false});
    EXPECT_EQ(std::ranges::count(texts_of(chart), "label"), 0);
}

// As vectors, too, and always with the same bytes.
TEST(Chart, IsDrawnAsSvgAndPdf) {
    const Picture picture = draw_chart(sample()), again = draw_chart(sample());
    EXPECT_EQ(picture.svg().substr(0, 5), "<?xml");
    EXPECT_NE(picture.svg().find("viewBox=\"0 0 1000 "), std::string::npos);
    EXPECT_EQ(picture.pdf().substr(0, 5), "%PDF-");
    EXPECT_TRUE(picture.png == again.png);
    EXPECT_TRUE(picture.pdf() == again.pdf());
}

} // namespace
} // namespace forceshade::picture
