// Measures of forces that are known in closed form.
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/score/measures.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::score {
namespace {

constexpr double kPeriod = 1e-3; // s

std::vector<glm::dvec3> sine(double frequency, double amplitude, std::size_t samples = 2048) {
    std::vector<glm::dvec3> signal;
    for (std::size_t i = 0; i < samples; ++i)
        signal.emplace_back(0, 0, amplitude * std::sin(2 * std::numbers::pi * frequency * kPeriod * double(i)));
    return signal;
}

TEST(Spectrum, OfASineIsItsRootMeanSquareAboveAndNothingBelow) {
    EXPECT_NEAR(rms_above(sine(200, 0.3), kPeriod, 100), 0.3 / std::sqrt(2), 1e-3);
    EXPECT_NEAR(rms_above(sine(200, 0.3), kPeriod, 30), 0.3 / std::sqrt(2), 1e-3);
    EXPECT_NEAR(rms_above(sine(60, 0.3), kPeriod, 30), 0.3 / std::sqrt(2), 1e-3);
    EXPECT_LT(rms_above(sine(60, 0.3), kPeriod, 100), 1e-3);
    EXPECT_NEAR(rms_above(sine(500, 0.3, 2049), kPeriod, 100), 0, 1e-9) << "sampled at its zeros";
    std::vector<glm::dvec3> ripple;
    for (int i = 0; i < 1024; ++i)
        ripple.emplace_back(0.2 * (i % 2 == 0 ? 1 : -1), 0, 0.001 * i); // at half the rate, on a line
    EXPECT_NEAR(rms_above(ripple, kPeriod, 100), 0.2, 1e-3);
    EXPECT_TRUE(std::isnan(rms_above(sine(200, 1, 255), kPeriod, 100)));
    EXPECT_TRUE(std::isnan(rms_above(sine(200, 1), 1e-2, 60))) << "beyond half the rate";
}

TEST(Shift, IsThatOfASignalThatComesLate) {
    const std::vector<glm::dvec3> early = sine(3, 1);
    EXPECT_EQ(shift_between(early, early), 0);
    for (const double late : {1.0, 7.0, -4.0}) {
        std::vector<glm::dvec3> shifted;
        for (std::size_t i = 0; i < early.size(); ++i)
            shifted.emplace_back(0, 0, std::sin(2 * std::numbers::pi * 3 * kPeriod * (double(i) - late)));
        EXPECT_NEAR(shift_between(early, shifted), late, 1e-6) << late;
    }
    EXPECT_TRUE(std::isnan(shift_between(std::vector<glm::dvec3>(500), early)));
    EXPECT_TRUE(std::isnan(shift_between(early, std::vector<glm::dvec3>(early.size()))));
}

// Down 2 mm into the plane far from the bump and out again, at 1000 N/m, in steps of 10 um.
class OnAPlane : public ::testing::Test {
protected:
    OnAPlane() : yardstick_(own_case({.facets = 4})) {
        for (int i = 0; i <= 600; ++i) {
            stroke_.time.push_back(kPeriod * i);
            stroke_.probe.emplace_back(0.1, 0, 1e-5 * (std::abs(i - 300) - 200) - 0.5e-5);
        }
        truth_ = yardstick_.along(stroke_);
    }
    StrokeScore score(const std::vector<glm::dvec3>& forces) const {
        return score_stroke(yardstick_, stroke_, truth_, forces, {}, kPeriod);
    }
    std::vector<glm::dvec3> changed(double factor, double tilt = 0) const {
        std::vector<glm::dvec3> all;
        for (const glm::dvec3& force : truth_.force)
            all.emplace_back(factor * glm::length(force) * std::sin(tilt), 0,
                             factor * glm::length(force) * std::cos(tilt));
        return all;
    }

    Yardstick yardstick_;
    Stroke stroke_;
    Truth truth_;
};

TEST_F(OnAPlane, TheOracleHasNoError) {
    const StrokeScore own = score(truth_.force);
    for (const double nothing : {own.error_rms, own.error_p95, own.error_share, own.magnitude_rms, own.direction_rms,
                                 own.phantom_share, own.drop_outs, own.pop_throughs, own.added_30, own.added_100,
                                 own.excess_work, own.delay, own.not_finite, own.jumps})
        EXPECT_EQ(nothing, 0);
    EXPECT_NEAR(own.loop_work, 0, 1e-9) << "down and up again, along a spring";
}

TEST_F(OnAPlane, AStifferOrTurnedForceIsOffByThatMuch) {
    const StrokeScore stiffer = score(changed(1.1));
    EXPECT_NEAR(stiffer.error_share, 0.1, 1e-9);
    EXPECT_NEAR(stiffer.direction_rms, 0, 1e-6);
    const StrokeScore turned = score(changed(1, 0.2));
    EXPECT_NEAR(turned.error_share, 2 * std::sin(0.1), 1e-9);
    EXPECT_NEAR(turned.magnitude_rms, 0, 1e-9);
    EXPECT_NEAR(turned.direction_p95, 0.2 * 180 / std::numbers::pi, 1e-6);
}

TEST_F(OnAPlane, LostAndReversedForcesAreFaults) {
    std::vector<glm::dvec3> lost = truth_.force, through = truth_.force, turned = truth_.force;
    for (std::size_t i = 250; i < 270; ++i)
        lost[i] = {};
    for (std::size_t i = 320; i < 601; ++i)
        through[i] = {};
    for (std::size_t i = 300; i < 310; ++i)
        turned[i] = -turned[i];
    const StrokeScore out = score(lost);
    EXPECT_EQ(out.drop_outs, 1);
    EXPECT_EQ(out.pop_throughs, 0);
    ASSERT_EQ(out.faults.size(), 1U);
    EXPECT_EQ(out.faults[0].sample, 250U);
    EXPECT_NEAR(out.faults[0].seconds, 0.019, 1e-9);
    EXPECT_NEAR(out.jumps, 2 / (1e3 * 2 * 200.5e-5), 0.01) << "gone, and back";
    EXPECT_EQ(score(through).pop_throughs, 1);
    EXPECT_EQ(score(turned).pop_throughs, 1);
    EXPECT_EQ(score(turned).drop_outs, 0);
}

TEST_F(OnAPlane, AContactThatIsShallowForAWhileIsLostOnce) {
    for (std::size_t i = 255; i < 260; ++i) {
        truth_.force[i] *= 0.01;
        truth_.certain[i + 5] = false;
    }
    std::vector<glm::dvec3> lost = truth_.force;
    for (std::size_t i = 250; i < 270; ++i)
        lost[i] = {};
    EXPECT_EQ(score(lost).drop_outs, 1);
    EXPECT_NEAR(score(lost).faults.at(0).seconds, 0.019, 1e-9);
    std::vector<glm::dvec3> doubtful = truth_.force;
    for (std::size_t i = 260; i < 265; ++i)
        doubtful[i] = {};
    EXPECT_EQ(score(doubtful).drop_outs, 0) << "no certificate there";
}

TEST_F(OnAPlane, AForceWithoutContactIsAPhantomAndOneThatLeavesGivesWork) {
    std::vector<glm::dvec3> forces = truth_.force;
    for (std::size_t i = 0; i < 20; ++i)
        forces[i] = {0, 0, 0.5};
    const StrokeScore phantom = score(forces);
    EXPECT_EQ(phantom.phantom_largest, 0.5);
    EXPECT_NEAR(phantom.phantom_share, 20.0 / double(std::ranges::count(truth_.touching, false)), 1e-12);
    // Twice as stiff on the way out: as much energy more as a spring of that stiffness holds, 1/2 K d^2 = 2 mJ.
    std::vector<glm::dvec3> active = truth_.force;
    for (std::size_t i = 301; i < active.size(); ++i)
        active[i] *= 2;
    EXPECT_NEAR(score(active).excess_work, 0.5 * 1000 * 2.005e-3 * 2.005e-3, 2e-5);
}

TEST_F(OnAPlane, ForcesThatAreNotFiniteAreCountedAndLeftOut) {
    std::vector<glm::dvec3> forces = truth_.force;
    forces[200].x = NAN;
    forces[301].z = 1e200; // whose square is no number
    const StrokeScore some = score(forces);
    EXPECT_EQ(some.not_finite, 2);
    EXPECT_EQ(some.error_rms, 0);
    EXPECT_EQ(some.drop_outs, 2);
    for (const double whole : {some.added_100, some.buzz_30, some.work, some.loop_work, some.delay})
        EXPECT_TRUE(std::isnan(whole)) << "of every sample";
    const StrokeScore none = score(std::vector<glm::dvec3>(forces.size(), glm::dvec3(NAN)));
    EXPECT_EQ(none.not_finite, double(forces.size()));
    EXPECT_TRUE(std::isnan(none.error_rms));
}

} // namespace
} // namespace forceshade::score
