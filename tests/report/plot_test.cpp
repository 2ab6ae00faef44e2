// Figures as SVG: well-formed, nothing clipped or drawn over, what cannot be shown is told.
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/plot/label_places.h"
#include "host/plot/plot.h"
#include "host/plot/svg.h"
#include "host/plot/text_size.h"
#include "host/plot/xml_text.h"
#include "host/study/data/data_error.h"
#include "tests/report/samples.h"
#include "tests/report/xml.h"

namespace forceshade::plot {
namespace {

using study::cell;
using testing::Element;
using testing::elements_of;

double number(const Element& element, const char* name) {
    return std::stod(element.attributes.at(name));
}

// About where a text stands; turned ones by their bounding box.
Box box_of(const Element& text) {
    const double size = number(text, "font-size"), width = text_width(text.text, size) * 0.97;
    const double x = number(text, "x"), y = number(text, "y");
    const auto anchor = text.attributes.find("text-anchor");
    const double before = anchor == text.attributes.end() ? 0 : anchor->second == "end" ? width : width / 2;
    if (!text.attributes.count("transform"))
        return {x - before, y - 0.75 * size, width, size};
    if (text.attributes.at("transform").starts_with("rotate(-90"))
        return {x - 0.75 * size, y - (width - before), size, width};
    return {x - 0.77 * before, y - 0.7 * size, 0.77 * width, 0.65 * width};
}

void expect_tidy(const std::string& svg) {
    const std::vector<Element> elements = elements_of(svg);
    const double width = number(elements.at(0), "width"), height = number(elements.at(0), "height");
    std::vector<std::pair<Box, std::string>> upright;
    std::set<std::string> ids;
    for (const Element& element : elements) {
        const auto id = element.attributes.find("id");
        EXPECT_TRUE(id == element.attributes.end() || ids.insert(id->second).second) << id->second;
        if (element.name != "text")
            continue;
        const Box box = box_of(element);
        EXPECT_TRUE(box.x >= 0 && box.y >= 0 && box.right() <= width && box.bottom() <= height)
            << element.text << " is clipped";
        if (!element.attributes.count("transform"))
            upright.emplace_back(box, element.text);
    }
    for (std::size_t i = 0; i < upright.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_FALSE(overlap(upright[i].first, upright[k].first))
                << upright[i].second << " stands on " << upright[k].second;
}

TEST(Figures, AreWellFormedAndNothingIsClippedOrDrawnOver) {
    const study::StudyData data = testing::sample_study();
    for (const study::Figure& figure : data.figures) {
        SCOPED_TRACE(figure.name);
        const std::string svg = svg_of(figure, data);
        expect_tidy(svg);
        EXPECT_EQ(svg_of(figure, data), svg);
    }
}

study::StudyData one_point(double x, double y) {
    study::StudyData data;
    data.study = "energy";
    data.tables = {{"t", "T", {{"x", "1", ""}, {"y", "1", ""}, {"w", "", ""}}, {{cell(x), cell(y), std::string("w")}}}};
    study::Figure figure;
    figure.name = "f";
    figure.title = "F";
    figure.table = "t";
    figure.x = {"x", "x / m", false};
    figure.y = {"y", "y / N", false};
    data.figures = {figure};
    return data;
}

TEST(Figures, OfExtremeNumbersAreTidy) {
    for (const double value : {0.0, 1e-300, -1e300, 1e9 + 1e-7, 123456.789})
        for (const study::FigureKind kind :
             {study::FigureKind::scatter, study::FigureKind::map, study::FigureKind::bars})
            for (const bool logarithmic : {false, true}) {
                study::StudyData data = one_point(value, value);
                study::Figure& figure = data.figures[0];
                figure.kind = kind;
                figure.x.logarithmic = figure.y.logarithmic = figure.value_logarithmic = logarithmic;
                figure.value = figure.y.column;
                figure.value_label = "y / N";
                SCOPED_TRACE(fmt::format("{} {} {}", value, static_cast<int>(kind), logarithmic));
                const std::string svg = svg_of(figure, data);
                expect_tidy(svg);
                EXPECT_EQ(svg.find("nan"), std::string::npos);
                EXPECT_EQ(svg.find("\"inf"), std::string::npos);
            }
}

TEST(Figures, TellWhatTheyDoNotShow) {
    study::StudyData data = one_point(1, 0);
    data.figures[0].y.logarithmic = true;
    EXPECT_NE(svg_of(data.figures[0], data).find("1 of 1 rows has no positive number here and is not shown."),
              std::string::npos);
    data.figures[0].y.logarithmic = false;
    EXPECT_EQ(svg_of(data.figures[0], data).find("not shown"), std::string::npos);
    data.tables[0].rows.clear();
    expect_tidy(svg_of(data.figures[0], data));
}

TEST(Figures, OfManyLongWordsAreTidy) {
    study::StudyData data = one_point(1, 1);
    data.figures[0].kind = study::FigureKind::bars;
    data.figures[0].x = {"w", "words", false};
    for (int i = 0; i < 25; ++i)
        data.tables[0].rows.push_back({cell(i), cell(i), fmt::format("a rather long name of number {}", i)});
    expect_tidy(svg_of(data.figures[0], data));
    data.figures[0].kind = study::FigureKind::map;
    data.figures[0].y = {"w", "words", false};
    data.figures[0].x = {"x", "x", false};
    data.figures[0].value = "w";
    expect_tidy(svg_of(data.figures[0], data));
}

TEST(Figures, TellWhatTheyLack) {
    study::StudyData data = one_point(1, 1);
    data.figures[0].y.column = "z";
    EXPECT_THROW(svg_of(data.figures[0], data), study::DataError);
    data.figures[0].y.column = "";
    EXPECT_THROW(svg_of(data.figures[0], data), study::DataError);
    data.figures[0].table = "u";
    EXPECT_THROW(svg_of(data.figures[0], data), study::DataError);
}

TEST(Figures, ShowMarkupAsText) {
    const std::string evil = "</text><script>alert(\"1\")</script>&'";
    study::StudyData data = one_point(1, 1);
    data.tables[0].rows[0][2] = evil;
    study::Figure& figure = data.figures[0];
    figure.title = figure.caption = figure.x.label = figure.y.label = evil;
    figure.series = figure.label = "w";
    figure.name = "\"><script>";
    for (const Element& element : elements_of(svg_of(figure, data)))
        EXPECT_NE(element.name, "script");
}

TEST(Text, IsAlwaysXml) {
    EXPECT_EQ(escaped("<a b=\"c\">&'"), "&lt;a b=&quot;c&quot;&gt;&amp;&#39;");
    EXPECT_EQ(escaped("η ≤ 1 µm"), "η ≤ 1 µm");
    EXPECT_EQ(escaped("a\x01"
                      "b\xff\xc3"),
              "a\xEF\xBF\xBD"
              "b\xEF\xBF\xBD\xEF\xBF\xBD");
    EXPECT_EQ(escaped("\xED\xA0\x80").find('\xED'), std::string::npos); // a lone surrogate
}

TEST(Labels, KeepOffEachOtherPointsAndEdges) {
    std::vector<LabelledPoint> points;
    for (int i = 0; i < 40; ++i)
        points.push_back({100 + 37.0 * (i % 8), 100 + 23.0 * (i / 8), fmt::format("label {}", i)});
    const Box plot{50, 50, 400, 200};
    const auto places = place_labels(points, plot, 11);
    std::size_t placed = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!places[i])
            continue;
        ++placed;
        EXPECT_TRUE(places[i]->x > plot.x && places[i]->right() < plot.right());
        for (std::size_t k = 0; k < i; ++k)
            EXPECT_FALSE(places[k] && overlap(*places[i], *places[k]));
        for (const LabelledPoint& point : points)
            EXPECT_FALSE(overlap(*places[i], {point.x - 4, point.y - 4, 8, 8}));
    }
    EXPECT_GE(placed, 10u);
}

TEST(Labels, KeepOffLinesWhereThereIsRoomElsewhere) {
    const Box plot{0, 0, 600, 300};
    const std::vector<LabelledPoint> points{{300, 150, "the winner"}};
    const std::optional<Box> free = place_labels(points, plot, 11)[0];
    ASSERT_TRUE(free);
    const double level = free->y + free->height / 2;
    const Piece through{300, level, 600, level};
    EXPECT_TRUE(crosses(through, *free));
    const std::optional<Box> moved = place_labels(points, plot, 11, {through})[0];
    ASSERT_TRUE(moved);
    EXPECT_FALSE(crosses(through, *moved));
    std::vector<Piece> everywhere;
    for (double y = 0; y < 300; y += 5)
        everywhere.push_back({0, y, 600, y});
    EXPECT_FALSE(place_labels(points, plot, 11, everywhere)[0]);
}

TEST(Labels, PiecesCrossBoxesThatTheyPassThrough) {
    const Box box{10, 10, 20, 10};
    EXPECT_TRUE(crosses({0, 0, 40, 30}, box));
    EXPECT_TRUE(crosses({15, 12, 16, 13}, box)); // within
    EXPECT_TRUE(crosses({20, 0, 20, 40}, box));
    EXPECT_FALSE(crosses({0, 0, 9, 9}, box));    // ends before
    EXPECT_FALSE(crosses({0, 12, 12, 40}, box)); // passes its corner
    EXPECT_FALSE(crosses({31, 0, 31, 40}, box));
    EXPECT_FALSE(crosses({0, 21, 40, 21}, box));
}

} // namespace
} // namespace forceshade::plot
