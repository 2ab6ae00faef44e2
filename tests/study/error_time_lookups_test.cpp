// Findings of look-ups say at which spacings volumes pay off, and tricubic reading.
#include <tuple>

#include <gtest/gtest.h>

#include "tests/study/made_error_time.h"

namespace forceshade::study {
namespace {

using namespace error_time;

TEST(ErrorTimeLookups, HoldTricubicAgainstTrilinearForDirectionAndForce) {
    Made made;
    const auto errors = [&](const char* family, double direction, double vector) {
        ForceErrors& of =
            *made.measured.compared[made.number("mesh, 8 x 8 cells, none: " + std::string(family))].reference;
        of.direction = Summary{direction, direction, direction};
        of.vector = Summary{vector, vector, vector};
    };
    errors("look-up, trilinear f32", 0.4, 0.02);
    errors("look-up, tricubic f32", 0.01, 0.018);
    EXPECT_EQ(
        made.text("tricubic_mesh"),
        "Reading \"mesh, 8 x 8 cells, none\" tricubic takes 3 times as long as trilinear of the same spacing "
        "(median of 1 volume); its direction error against direct evaluation is 40 times smaller, the error of the "
        "whole force 1.11 times smaller: where the error should fall by more than the time rises, it pays off for "
        "the direction at every spacing, for the whole force at no spacing.");
    errors("look-up, tricubic f32", 0.5, 0.03);
    EXPECT_TRUE(says(made.text("tricubic_mesh"), "is 1.25 times as large, the error of the whole force 1.5 times as "
                                                 "large: "));
    EXPECT_TRUE(says(made.text("tricubic_mesh"), "it pays off at no spacing."));
    errors("look-up, tricubic f32", 0.1, 0.001);
    EXPECT_TRUE(says(made.text("tricubic_mesh"), "it pays off at every spacing."));
    for (const auto& [family, time, error] :
         {std::tuple("look-up, trilinear", 0.5, 0.1), {"look-up, tricubic", 1.5, 0.2}}) {
        made.add("mesh, 8 x 8 cells, none", family, "f32", time, 4.2, {}, "none");
        made.measured.contenders.back().spacing = 0.4e-3;
        made.measured.compared.back().reference->direction = Summary{error, error, error};
    }
    EXPECT_TRUE(says(made.text("tricubic_mesh"), "(median of 2 volumes); its direction error against direct evaluation "
                                                 "is 0.25 to 2 times as large"))
        << made.text("tricubic_mesh");
    EXPECT_TRUE(says(made.text("tricubic_mesh"), "it pays off at 0.2 mm."));
    EXPECT_EQ(made.text("tricubic_bump"), "");
}

TEST(ErrorTimeLookups, HoldVolumesOfEverySpacingAgainstDirect) {
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

} // namespace
} // namespace forceshade::study
