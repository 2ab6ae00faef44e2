#include "host/scene/quantity.h"

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

TEST(Quantity, SaysWhatWouldBeRight) {
    EXPECT_EQ(length_error("0.2"), "a length needs a unit, for example \"0.2 mm\"; got \"0.2\"");
    EXPECT_EQ(length_error("1 N"), "\"N\" is a force, not a length; write for example \"0.2 mm\"");
    EXPECT_EQ(length_error("600 mils"), "unknown unit \"mils\": did you mean \"mil\"?");
    EXPECT_EQ(length_error("600 min"), "unknown unit \"min\": did you mean \"mil\", a thousandth of an inch?");
    EXPECT_EQ(length_error("0.6 inch"), "unknown unit \"inch\": did you mean \"in\"?");
    EXPECT_EQ(length_error("1 ft"), "unknown unit \"ft\": 1 ft is \"12 in\"");
    EXPECT_EQ(length_error("1\u00a0mm"),
              "\"1\u00a0mm\" contains a no-break space (U+00A0); write an ordinary space: \"1 mm\"");
    EXPECT_EQ(length_error("1\u202fmm\u00a0"),
              "\"1\u202fmm\u00a0\" contains a no-break space (U+00A0); write an ordinary space: \"1 mm\"");
    EXPECT_EQ(length_error("\u202f1 mm"),
              "\"\u202f1 mm\" contains a narrow no-break space (U+202F); write an ordinary space: \"1 mm\"");
    EXPECT_EQ(length_error("1\u2009mm"),
              "\"1\u2009mm\" contains a thin space (U+2009); write an ordinary space: \"1 mm\"");
    EXPECT_EQ(usage_error([] { parse_quantity("1 N\u00a0s/m", Dimension::damping); }),
              "\"1 N\u00a0s/m\" contains a no-break space (U+00A0); write an ordinary space: \"1 N s/m\"");
    EXPECT_EQ(length_error("1 \u00b5m"), "(no error)");
    EXPECT_EQ(length_error("1 \u03bcm"), "(no error)");
    EXPECT_EQ(usage_error([] { parse_quantity("1 min", Dimension::time); }), "unknown unit \"min\": 1 min is \"60 s\"");
    EXPECT_EQ(usage_error([] { parse_quantity("1 Nmm", Dimension::stiffness); }),
              "unknown unit \"Nmm\": write \"N mm\" for a product, \"N/mm\" for a stiffness");
    EXPECT_EQ(usage_error([] { parse_quantity("1 N/mm", Dimension::force); }),
              "\"N/mm\" is a stiffness, not a force; write for example \"1 N\"");
    EXPECT_EQ(length_error("600 MM"), "unknown unit \"MM\": did you mean \"mm\"?");
    EXPECT_EQ(usage_error([] { parse_quantity("1 Ns/m", Dimension::damping); }),
              "unknown unit \"Ns\": write \"N s\" for a product");
    EXPECT_EQ(usage_error([] { parse_quantity("1 N/m s", Dimension::damping); }),
              "\"N/m s\" can be read in two ways: write products before the \"/\", and \"/\" before each divisor");
    EXPECT_EQ(usage_error([] { parse_quantity("1 mm", Dimension::angle); }),
              "\"mm\" is a length, not an angle; write for example \"90 deg\"");
    EXPECT_EQ(length_error("1,5 mm"), "\"1,5 mm\": write a decimal point, as in \"0.2 mm\"");
    EXPECT_EQ(length_error("1e400 m"), "\"1e400 m\" is too large for a double");
    EXPECT_EQ(length_error("1e-400 m"), "\"1e-400 m\" is too small for a double");
    EXPECT_EQ(length_error("1e99999999999999999999 m"), "\"1e99999999999999999999 m\" is too large for a double");
}

TEST(Quantity, RefusesWhatIsNoQuantity) {
    for (const char* text :
         {"",      " ",      "mm",      "nan m",  "inf m",    "-inf mm",       "0x10 m",  "1 m/",
          "1 /",   "1 m**2", "1 * m",   "1 m^",   "1 m^2",    "1 m^99",        "1 m^1.5", "1_000 m",
          "--1 m", "1 2 m",  "1.2.3 m", "1 \xff", "1 \u2126", "1 mil^9/mil^8", "1 e3 m",  "1 m^9 m^9"})
        EXPECT_NE(length_error(text), "(no error)") << text;
    EXPECT_NE(length_error(std::string(1000, '1') + " m"), "(no error)");
    EXPECT_EQ(length_error("0 m"), "(no error)");
}

} // namespace
} // namespace forceshade
