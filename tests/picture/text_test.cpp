#include "host/picture/canvas.h"

#include <gtest/gtest.h>

namespace forceshade::picture {
namespace {

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

TEST(Text, MeasuresGrowWithTheText) {
    EXPECT_GT(measure("force magnitude", {}).width, measure("force", {}).width);
    TextStyle upwards;
    upwards.upwards = true;
    EXPECT_EQ(measure("force", upwards).height, measure("force", {}).width);
}

} // namespace
} // namespace forceshade::picture
