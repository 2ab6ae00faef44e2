// Frames of pictures: axes and their ticks, texts, and the pieces of lines that can be seen.
#include <charconv>
#include <clocale>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "host/picture/canvas.h"
#include "host/picture/frame.h"
#include "host/spelling.h"

namespace forceshade::picture {
namespace {

constexpr Box kPlot{100, 100, 200, 100};

TEST(VisiblePieces, KeepsWhatIsInside) {
    const std::vector<Point> line{{120, 120}, {150, 180}, {290, 110}};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    ASSERT_EQ(pieces[0].size(), 3U);
    EXPECT_EQ(pieces[0][1].x, 150);
}

TEST(VisiblePieces, CutsFarAwayEndsAndDropsWhatIsOutside) {
    const auto pieces = visible_pieces(std::vector<Point>{{-1e18, 150}, {1e18, 150}}, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_NEAR(pieces[0].front().x, 92, 200 /* pixels: 1e18 leaves few digits */);
    EXPECT_NEAR(pieces[0].back().x, 308, 200);
    EXPECT_TRUE(visible_pieces(std::vector<Point>{{0, 0}, {400, 0}}, kPlot).empty());
}

TEST(VisiblePieces, LeavesAndComesBackAsTwoPieces) {
    const std::vector<Point> line{{150, 150}, {150, 400}, {250, 400}, {250, 150}};
    EXPECT_EQ(visible_pieces(line, kPlot).size(), 2U);
}

TEST(VisiblePieces, BreaksAtWhatIsNoNumber) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Point> line{{110, 150}, {150, 150}, {nan, 150}, {200, 150}, {250, 150}};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 2U);
    EXPECT_EQ(pieces[0].back().x, 150);
    EXPECT_EQ(pieces[1].front().x, 200);
}

TEST(VisiblePieces, ThinsOutAMillionPoints) {
    std::vector<Point> line(1'000'001);
    for (std::size_t i = 0; i < line.size(); ++i)
        line[i] = {100 + 200.0 * static_cast<double>(i) / 1e6, 150};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_LT(pieces[0].size(), 700U);
    EXPECT_EQ(pieces[0].back().x, 300);
}

TEST(SeenAsLine, MakesABarOfWhatStaysInOnePlace) {
    const std::vector<Point> bar = seen_as_line({{50, 20}, {50, 20}, {50.5, 20}});
    ASSERT_EQ(bar.size(), 2u);
    EXPECT_GT(bar[1].x - bar[0].x, 5);
    EXPECT_EQ(bar[0].y, 20);
    EXPECT_EQ(seen_as_line({{50, 20}, {60, 20}}).size(), 2u);
    EXPECT_EQ(seen_as_line({{50, 20}, {60, 20}})[0].x, 50) << "long enough by itself";
    EXPECT_TRUE(seen_as_line({}).empty());
}

SliceAxes line_of(double first, double spacing, std::size_t count) {
    SliceAxes axes{{}, {}, spacing, spacing, spacing, 0};
    for (std::size_t i = 0; i < count; ++i)
        axes.u.push_back(first + spacing * static_cast<double>(i));
    axes.v = axes.u;
    return axes;
}

TEST(PlaneAxes, KeepTheTrueAspectOrSaySo) {
    SliceAxes samples = line_of(0, 1e-3, 70);
    samples.v.resize(10);
    const PlaneAxes plain = plan_axes(samples);
    EXPECT_NEAR(plain.aspect, 1.0 / 7, 1e-9);
    EXPECT_TRUE(plain.stretch_note.empty());
    samples.v.resize(1);
    const PlaneAxes stretched = plan_axes(samples);
    EXPECT_NEAR(stretched.aspect, 1.0 / 8, 1e-9);
    EXPECT_EQ(stretched.stretch_note, "not to scale: z is stretched 8.75 times");
}

std::string joined(const std::vector<std::string>& lines) {
    std::string all;
    for (const std::string& line : lines)
        all += line;
    return all;
}

TEST(Text, WrapFitsAndLosesNothing) {
    const TextStyle style{kTitleSize, true};
    for (const std::string& text : {std::string("bump_radius-600mil_facets-2_shading-reference"), std::string(150, 'W'),
                                    std::string("ä é ü 力 _ x"), std::string()}) {
        const auto lines = wrap(text, style, 160);
        EXPECT_EQ(joined(lines), text);
        for (const std::string& line : lines)
            EXPECT_LE(measure(line, style).width, 160);
    }
}

TEST(Text, WrapBreaksAtSeparators) {
    const auto lines =
        wrap("radius-600mil_shading-reference", {kTextSize}, measure("radius-600mil_shad", {kTextSize}).width);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[0], "radius-600mil_");
}

TEST(Text, PrintableMendsWhatCannotBeDrawn) {
    EXPECT_EQ(printable("a\nb\tc"), "a b c");
    EXPECT_EQ(printable("µ力🙂"), "µ力🙂");
    EXPECT_EQ(printable("\xff"), "\uFFFD");
    EXPECT_EQ(printable("x\xc3"), "x\uFFFD");
    EXPECT_EQ(printable("\xc0\xaf"), "\uFFFD\uFFFD");           // overlong
    EXPECT_EQ(printable("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD"); // surrogate
    EXPECT_EQ(printable(std::string("a\0b", 3)), "a b");
}

double parse(std::string text) {
    const bool negative = text.starts_with("−");
    if (negative)
        text.erase(0, std::string("−").size());
    double value = NAN;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    return end.ptr == text.data() + text.size() && end.ec == std::errc() ? (negative ? -value : value) : NAN;
}

double random_real(int low, int high) { // in thousandths
    return *rc::gen::inRange(low * 1000, high * 1000) / 1000.0;
}

TEST(Ticks, AreRoundWithinTheRangeAndNotTooMany) {
    ASSERT_TRUE(rc::check([] {
        const double scale = std::pow(10.0, *rc::gen::inRange(-9, 9));
        const double low = random_real(-100, 100) * scale;
        const double high = low + (0.5 + std::fabs(random_real(0, 200))) * scale;
        const auto most = *rc::gen::inRange<std::size_t>(2, 12);
        const RoundTicks ticks = round_ticks(low, high, most);
        RC_ASSERT(!ticks.values.empty() && ticks.values.size() <= most);
        const int exponent = decade(ticks.step * 1.000001);
        const double mantissa = std::round(divide_by_power_of_ten(ticks.step, exponent));
        RC_ASSERT(mantissa == 1 || mantissa == 2 || mantissa == 5);
        for (std::size_t i = 0; i < ticks.values.size(); ++i) {
            const double value = ticks.values[i];
            RC_ASSERT(value >= low - 1e-6 * ticks.step && value <= high + 1e-6 * ticks.step);
            RC_ASSERT(std::fabs(value / ticks.step - std::round(value / ticks.step)) < 1e-6);
            RC_ASSERT(std::fabs(parse(decimal(value, ticks.decimals)) - value) <= 1e-9 * std::fabs(value));
            if (i > 0)
                RC_ASSERT(std::fabs(value - ticks.values[i - 1] - ticks.step) < 1e-6 * ticks.step);
        }
    }));
}

// m: 1000 of "(x − 1000 m) / mm", 0 of "x / mm".
double offset_of(const std::string& title) {
    if (!title.starts_with("(x "))
        return 0;
    const std::size_t sign = std::string("(x ").size(), number = title.find(' ', sign) + 1;
    const double size = parse(title.substr(number, title.find(" m)") - number));
    return title[sign] == '+' ? -size : size;
}

// Every label, put back through offset and unit, must name the coordinate at its fraction of the axis.
TEST(Axis, LabelsReadBackAsCoordinates) {
    ASSERT_TRUE(rc::check([] {
        const double spacing = std::pow(10.0, *rc::gen::inRange(-9, 4)) * (1 + std::fabs(random_real(0, 8)));
        const double away = random_real(-50, 50) * std::pow(10.0, *rc::gen::inRange(0, 6));
        std::vector<double> samples(*rc::gen::inRange<std::size_t>(1, 300));
        for (std::size_t i = 0; i < samples.size(); ++i)
            samples[i] = away * spacing + spacing * static_cast<double>(i);
        const double extent = axis_extent(samples, spacing);
        const Unit unit = choose_unit(extent, "m");
        const Axis axis = make_axis("x", samples, spacing, unit, *rc::gen::inRange<std::size_t>(2, 12));
        RC_ASSERT(!axis.ticks.empty());
        for (const AxisTick& tick : axis.ticks) {
            RC_ASSERT(tick.label.size() < 12);
            const double label = divide_by_power_of_ten(parse(tick.label), -unit.exponent);
            const double drawn = samples.front() - spacing / 2 - offset_of(axis.title) + tick.fraction * extent;
            RC_ASSERT(std::fabs(label - drawn) <= 1e-6 * extent + spacing * 1e-2 * (samples.size() == 1));
        }
    }));
}

TEST(Axis, TitlesNameUnitAndOffset) {
    const auto title = [](double first, double spacing, std::size_t count) {
        std::vector<double> samples(count);
        for (std::size_t i = 0; i < count; ++i)
            samples[i] = first + spacing * static_cast<double>(i);
        return make_axis("x", samples, spacing, choose_unit(axis_extent(samples, spacing), "m"), 8).title;
    };
    EXPECT_EQ(title(-0.025, 2e-4, 256), "x / mm");
    EXPECT_EQ(title(0, 1e-9, 100), "x / nm");
    EXPECT_EQ(title(0, 50, 100), "x / km");
    EXPECT_EQ(title(999.9755, 4e-4, 128), "(x − 1000 m) / mm");
    EXPECT_EQ(title(-1000.00000003, 1e-9, 64), "(x + 1000 m) / nm");
    EXPECT_EQ(title(0, 1e30, 100), "x / (10³⁰ m)");
}

TEST(Axis, ForceScaleNamesItsUnit) {
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 16.8, 9).title, "force magnitude / N");
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 1.7e-11, 9).title, "force magnitude / pN");
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 2e10, 9).title, "force magnitude / GN");
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 3e-30, 9).title, "force magnitude / (10⁻³⁰ N)");
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 5e-324, 9).ticks.front().label, "0");
    EXPECT_EQ(quantity_axis("force magnitude", "N", 0, 1.7e308, 9).ticks.front().label, "0");
}

std::vector<std::string> log_labels(double low, double high, std::size_t most) {
    std::vector<std::string> labels;
    for (const AxisTick& tick : number_axis("", {low, high, true}, most).ticks)
        labels.push_back(tick.label);
    return labels;
}

TEST(Axis, LogarithmicOnesHaveAsManyTicksAsThereIsRoomFor) {
    using Labels = std::vector<std::string>;
    EXPECT_EQ(log_labels(1, 100, 12), (Labels{"1", "2", "5", "10", "20", "50", "100"}));
    EXPECT_EQ(log_labels(1, 100, 6), (Labels{"1", "3", "10", "30", "100"}));
    EXPECT_EQ(log_labels(1, 100, 4), (Labels{"1", "10", "100"}));
    EXPECT_EQ(log_labels(1e-4, 1e8, 8), (Labels{"10⁻⁴", "0.01", "1", "100", "10000", "10⁶", "10⁸"}));
    EXPECT_EQ(log_labels(2.3, 4.2, 5), (Labels{"2.5", "3.0", "3.5", "4.0"})) << "less than a decade";
    const Axis axis = number_axis("", {1, 1e4, true}, 12);
    EXPECT_NEAR(axis.ticks[2].fraction, 0.25, 1e-12);
    EXPECT_EQ((Range{1, 10, true}.fraction(-3)), 0);
}

TEST(PositionLabels, TellPositionsApart) {
    const Unit mm = choose_unit(0.05, "m");
    EXPECT_EQ(position_labels("z", {-0.01, -0.0076, -0.0054}, 2e-4, mm),
              (std::vector<std::string>{"z = −10.0 mm", "z = −7.6 mm", "z = −5.4 mm"}));
    EXPECT_EQ(position_labels("y", {0.0002}, 2e-4, mm).front(), "y = 0.2 mm");
    EXPECT_EQ(position_labels("y", {0}, 2e-4, mm).front(), "y = 0 mm");
    EXPECT_EQ(position_labels("z", {999.99, 1000.01}, 2e-4, mm).front(), "z − 1000 m = −10 mm");
    EXPECT_EQ(position_labels("z", {4.2e-9}, 1e-9, mm).front(), "z = 4.2 nm");
    ASSERT_TRUE(rc::check([mm] {
        const double first = random_real(-1000, 1000), gap = std::pow(10.0, *rc::gen::inRange(-9, 3));
        std::vector<double> at(12);
        for (std::size_t i = 0; i < at.size(); ++i)
            at[i] = first + gap * static_cast<double>(i);
        const auto labels = position_labels("z", at, gap, mm);
        RC_ASSERT(std::set<std::string>(labels.begin(), labels.end()).size() == at.size());
        for (const std::string& label : labels)
            RC_ASSERT(label.size() < 40);
    }));
}

TEST(Quantity, NumbersDoNotDependOnTheLocale) {
    const char* locale = std::setlocale(LC_ALL, "de_DE.UTF-8");
    EXPECT_EQ(decimal(-1234.5, 2), "−1234.50");
    EXPECT_EQ(decimal(-0.001, 2), "0.00");
    EXPECT_EQ(trimmed(2.50, 3), "2.5");
    EXPECT_EQ(three_digits(31.25), "31.2");
    EXPECT_EQ(three_digits(3.75e6), "3.75 × 10⁶");
    std::setlocale(LC_ALL, "C");
    if (!locale)
        GTEST_SKIP() << "no de_DE.UTF-8 on this machine: checked in the C locale only";
}

TEST(Quantity, UnitsAndRoundValues) {
    EXPECT_EQ(choose_unit(999.9, "N").name, "N");
    EXPECT_EQ(choose_unit(1000, "N").name, "kN");
    EXPECT_EQ(choose_unit(0.001, "N").name, "mN");
    EXPECT_EQ(choose_unit(0.00099999, "N").name, "µN");
    EXPECT_EQ(choose_unit(5e5, "m").name, "km");
    EXPECT_EQ(choose_unit(5e6, "m").name, "km");
    EXPECT_EQ(round_below(9.99), 5);
    EXPECT_EQ(round_below(2), 2);
    EXPECT_EQ(round_below(0.1), 0.1);
    EXPECT_EQ(decade(9999.9999), 3);
    EXPECT_EQ(decade(5e-324), -324);
}

} // namespace
} // namespace forceshade::picture
