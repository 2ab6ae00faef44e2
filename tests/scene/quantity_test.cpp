#include "host/scene/value.h"

#include "tests/scene/errors.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace forceshade {
namespace {

using test::usage_error;
using testing::says;

double metres(std::string_view text) {
    return parse_quantity(text, Dimension::length);
}

std::string length_error(std::string_view text) {
    return usage_error([&] { metres(text); });
}

TEST(Quantity, ReadsEveryDimension) {
    EXPECT_EQ(metres("600 mil"), 0.01524);
    EXPECT_EQ(metres("-25 mm"), -0.025);
    EXPECT_EQ(metres("1 in"), 0.0254);
    EXPECT_EQ(parse_quantity("1 kHz", Dimension::frequency), 1000.0);
    EXPECT_EQ(parse_quantity("0.5 N/mm", Dimension::stiffness), 500.0);
    EXPECT_EQ(parse_quantity("1e-9 N/m", Dimension::stiffness), 1e-9);
    EXPECT_EQ(parse_quantity("1 N s/m", Dimension::damping), 1.0);
    EXPECT_EQ(parse_quantity("20 kg/s", Dimension::damping), 20.0);
    EXPECT_EQ(parse_quantity("100 mm/s", Dimension::speed), 0.1);
    EXPECT_EQ(parse_quantity("75 g", Dimension::mass), 0.075);
    EXPECT_EQ(parse_quantity("0.1 ms", Dimension::time), 0.0001);
    EXPECT_EQ(parse_quantity("8.5 N", Dimension::force), 8.5);
    EXPECT_EQ(parse_quantity("2 J/cm", Dimension::force), 200.0);
    EXPECT_EQ(parse_quantity("90 deg", Dimension::angle), std::numbers::pi / 2);
    EXPECT_EQ(parse_quantity("1 rad", Dimension::angle), 1.0);
}

TEST(Quantity, ReadsEverySpelling) {
    EXPECT_EQ(metres("600mil"), metres("  600   mil "));
    EXPECT_EQ(metres("+1e3 m"), 1000.0);
    EXPECT_EQ(metres(".5 m"), 0.5);
    EXPECT_EQ(metres("5. m"), 5.0);
    EXPECT_EQ(metres("1 \u00b5m"), 1e-6);
    EXPECT_EQ(metres("1 \u03bcm"), 1e-6);
    EXPECT_EQ(metres("1 um"), 1e-6);
    EXPECT_EQ(metres("1 m^2/m"), 1.0);
    EXPECT_EQ(metres("1 m^3*m^-2"), 1.0);
    for (const char* unit : {"N s/m", "N*s/m", "N\u00b7s/m", "N \u22c5 s / m", "kg m^2/s/m^2"})
        EXPECT_EQ(parse_quantity(fmt::format("3 {}", unit), Dimension::damping), 3.0) << unit;
    EXPECT_EQ(parse_quantity("7 /s", Dimension::frequency), 7.0);
    EXPECT_EQ(parse_quantity("3 kg/s/s", Dimension::stiffness), 3.0);
}

TEST(Quantity, RoundsOnce) {
    EXPECT_EQ(metres("500 mil"), metres("1000 mil") / 2);
    EXPECT_EQ(metres("0.2 mm"), 0.0002);
    EXPECT_EQ(metres("0.1 um"), 1e-7);
    EXPECT_EQ(metres("1 mil"), 2.54e-5);
    EXPECT_EQ(metres("1e-3 mil"), 2.54e-8);
    EXPECT_EQ(metres("0.00000000000000000000000000000000000001e38 mil"), 2.54e-5);
    EXPECT_EQ(metres("4e-324 m"), std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(parse_quantity("1 N/mil", Dimension::stiffness), 1e7 / 254);
    EXPECT_FALSE(std::signbit(metres("-0 m")));
}

TEST(Quantity, EqualsTheDecimalLiteral) {
    // Moving the decimal point by a prefix must give the double nearest to the decimal number, not one rounded twice.
    EXPECT_TRUE(rc::check([](int mantissa, std::uint8_t digits) {
        const std::string number = fmt::format("{}e-{}", mantissa, digits % 12);
        double expected = 0;
        const std::string shifted = fmt::format("{}e-{}", mantissa, digits % 12 + 3);
        std::from_chars(shifted.data(), shifted.data() + shifted.size(), expected);
        RC_ASSERT(metres(number + " mm") == expected);
    }));
}

// Which unit was meant is told where that is not the nearest word.
TEST(Quantity, SaysWhichUnitIsMeant) {
    for (const auto& [text, words] :
         std::vector<std::pair<std::string, std::string>>{{"1 N", "is a force, not a length"},
                                                          {"600 mils", "did you mean \"mil\"?"},
                                                          {"600 min", "did you mean \"mil\""},
                                                          {"0.6 inch", "did you mean \"in\"?"},
                                                          {"1 ft", "1 ft is \"12 in\""},
                                                          {"1\u00a0mm", "no-break space"},
                                                          {"\u202f1 mm", "narrow no-break space"},
                                                          {"1 N/m s", "in two ways"},
                                                          {"1e400 m", "too large"},
                                                          {"1e99999999999999999999 m", "too large"},
                                                          {"1e-400 m", "too small"}})
        EXPECT_TRUE(says(length_error(text), words)) << text;
    EXPECT_TRUE(says(usage_error([] { parse_quantity("1 mm", Dimension::angle); }), "not an angle"));
    EXPECT_TRUE(says(usage_error([] { parse_quantity("1 Nmm", Dimension::stiffness); }), "\"N mm\""));
}

TEST(Quantity, RefusesWhatIsNoQuantity) {
    for (const char* text :
         {"",       "0.2",      "600 MM",        "1\u2009mm", "1,5 mm",   "1 min", " ",      "mm",
          "nan m",  "inf m",    "-inf mm",       "0x10 m",    "1 m/",     "1 /",   "1 m**2", "1 * m",
          "1 m^",   "1 m^2",    "1 m^99",        "1 m^1.5",   "1_000 m",  "--1 m", "1 2 m",  "1.2.3 m",
          "1 \xff", "1 \u2126", "1 mil^9/mil^8", "1 e3 m",    "1 m^9 m^9"})
        EXPECT_NE(length_error(text), "(no error)") << text;
    EXPECT_NE(length_error(std::string(1000, '1') + " m"), "(no error)");
    EXPECT_EQ(length_error("0 m"), "(no error)");
}

} // namespace
} // namespace forceshade
