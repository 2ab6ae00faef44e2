// What safety lets through.
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "device/loop/safety.h"

namespace forceshade::device {
namespace {

constexpr double kPeriod = 1e-3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

SafetyLimits quick() {
    SafetyLimits limits;
    limits.max_force = 3;
    limits.ramp = limits.contact_ramp = 0;
    limits.slew = kUnknown;
    return limits;
}

// One sample after the other, of a probe that stays in contact.
class Touch {
public:
    explicit Touch(const SafetyLimits& limits) : safety(limits, kPeriod) {}

    Situation fine() const {
        Situation now;
        now.answer = Answer::fresh;
        now.is_position = true;
        now.time = time;
        return now;
    }
    glm::dvec3 show(const Situation& now, const glm::dvec3& force, bool contact = true) {
        time += kPeriod;
        flags = 0;
        return safety.limit(now, force, contact, flags);
    }
    glm::dvec3 show(const glm::dvec3& force, bool contact = true) { return show(fine(), force, contact); }

    Safety safety;
    double time = 0;
    std::uint32_t flags = 0;
};

TEST(Safety, LetsAForceThroughThatIsNone) {
    Touch touch(quick());
    const glm::dvec3 force{0.1, -0.2, 2.0 / 3};
    EXPECT_EQ(touch.show(force), force);
    EXPECT_EQ(touch.flags, 0u);
}

TEST(Safety, ClampsAndKeepsTheDirection) {
    Touch touch(quick());
    const glm::dvec3 shown = touch.show({30, 0, 40});
    EXPECT_NEAR(shown.x, 1.8, 1e-12);
    EXPECT_NEAR(shown.z, 2.4, 1e-12);
    EXPECT_EQ(touch.flags, kClamped);
    EXPECT_LE(glm::length(touch.show({1e200, 1e200, -1e200})), 3 * (1 + 1e-15)) << "whose square is no number";
}

TEST(Safety, ForcesChangeNoFasterThanTheyMay) {
    SafetyLimits limits = quick();
    limits.slew = 1000; // N/s: a newton a sample
    Touch touch(limits);
    EXPECT_NEAR(touch.show({0, 0, 2.5}).z, 1, 1e-12);
    EXPECT_EQ(touch.flags, kSlewed);
    EXPECT_NEAR(touch.show({0, 0, 2.5}).z, 2, 1e-12);
    for (const double less : {0.25, 0.0}) {
        EXPECT_NEAR(touch.show({0, 0, 2.5}).z, 2.5, 1e-12);
        EXPECT_EQ(touch.flags, 0u);
        EXPECT_EQ(touch.show({0, 0, less}), glm::dvec3(0, 0, less)) << "it falls at once";
        EXPECT_EQ(touch.flags, 0u) << "not delayed";
        for (int i = 0; i < 5; ++i)
            touch.show({0, 0, 2.5});
    }
    EXPECT_NEAR(touch.show({0, 0, -2.5}).z, -1, 1e-12) << "what opposes goes at once";
}

// What is kept of a force whose direction turns is its share nearest to the wanted one.
TEST(Safety, AForceThatTurnsFallsAtOnceAndComesUpSlowly) {
    SafetyLimits limits = quick();
    limits.slew = 100; // N/s: 0.1 N a sample
    for (const double angle : {0.0, 0.1, 0.7, 1.5, 1.6, 2.5, 3.1}) {
        Touch touch(limits);
        for (int i = 0; i < 30; ++i)
            touch.show({0, 0, 2});
        const glm::dvec3 toward{std::sin(angle), 0, std::cos(angle)};
        const double kept = std::max(0.0, 2 * std::cos(angle));
        glm::dvec3 shown = touch.show(2.0 * toward);
        EXPECT_LE(glm::length(shown - glm::dvec3(0, 0, kept)), 0.1 * (1 + 1e-9)) << angle;
        for (int i = 0; i < 60; ++i)
            shown = touch.show(2.0 * toward);
        EXPECT_LE(glm::length(shown - 2.0 * toward), 1e-12) << angle;
    }
    const bool held_true = rc::check("never larger than wanted, never against it, never up too fast", [&] {
        Touch touch(limits);
        glm::dvec3 before(0);
        const auto some = rc::gen::element(0.0, 1e-3, -0.05, 0.3, -1.0, 1.7, -1e-160);
        for (int i = 0; i < 60; ++i) {
            const glm::dvec3 wanted{*some, *some, *some};
            const glm::dvec3 shown = touch.show(wanted);
            RC_ASSERT(glm::length(shown) <= glm::length(wanted) * (1 + 1e-12));
            RC_ASSERT(glm::dot(shown, wanted) >= 0);
            RC_ASSERT(glm::length(shown) <= glm::length(before) + 0.1 * (1 + 1e-9));
            before = shown;
        }
    });
    EXPECT_TRUE(held_true);
}

// The motors of a Touch: 3.3 N, but no more than 0.88 N for long.
TEST(Safety, AForceThatLastsComesDownToWhatTheMotorsBear) {
    SafetyLimits limits = quick();
    limits.max_force = 3.3;
    limits.continuous_force = 0.88;
    Touch touch(limits);
    EXPECT_EQ(touch.show({0, 0, 9}).z, 3.3) << "at first";
    EXPECT_EQ(touch.flags, kClamped);
    double square = 0, before = 3.3; /* N^2 s */
    for (int i = 0; i < 60'000; ++i) {
        const double shown = touch.show({0, 0, 9}).z;
        ASSERT_LE(shown, before + 1e-12);
        before = shown;
        square += shown * shown * kPeriod;
    }
    EXPECT_NEAR(before, 0.88, 0.01);
    EXPECT_EQ(touch.flags, kLasting);
    EXPECT_LT(square, 0.88 * 0.88 * (60 + 1.01 * kContinuousForceTime));
    EXPECT_EQ(touch.show({0, 0, 0.5}).z, 0.5) << "a force that may last stays";
    EXPECT_EQ(touch.flags, 0u);
    for (int i = 0; i < 60'000; ++i)
        touch.show({0, 0, 0}, false);
    EXPECT_EQ(touch.show({0, 0, 3.3}).z, 3.3) << "it has cooled down";
}

TEST(Safety, AForceLastsWhileTheLoopIsHeldUp) {
    SafetyLimits limits = quick();
    limits.max_force = 3.3;
    limits.continuous_force = 0.88;
    Touch touch(limits);
    double square = 0; /* N^2 s */
    for (int burst = 0; burst < 6000; ++burst)
        for (int i = 0; i < 10; ++i) {
            const double pause = i == 0 ? 9.991e-3 : 1e-6, shown = touch.show({0, 0, 9}).z;
            touch.time += pause - kPeriod;
            square += shown * shown * pause;
        }
    EXPECT_LT(square, 0.88 * 0.88 * (60 + 1.05 * kContinuousForceTime));
}

TEST(Safety, TwoSamplesAtOneTimeAreNoFault) {
    Touch touch(quick());
    touch.show({0, 0, 1});
    touch.time -= kPeriod;
    EXPECT_EQ(touch.show({0, 0, 2}).z, 2);
    EXPECT_EQ(touch.flags, 0u);
}

TEST(Safety, AForceComesUpAfterTheStartAndAfterAFault) {
    SafetyLimits limits = quick();
    limits.ramp = 0.1;
    Touch touch(limits), too_large(limits);
    for (int i = 1; i <= 100; ++i) {
        EXPECT_NEAR(touch.show({0, 0, 1}).z, i / 100.0, 1e-9);
        EXPECT_NEAR(too_large.show({0, 0, 200}).z, 3 * i / 100.0, 1e-9) << "no sooner";
        EXPECT_NE(too_large.flags & kClamped, 0u);
    }
    EXPECT_EQ(touch.show({0, 0, 1}).z, 1);
    EXPECT_EQ(touch.flags, 0u);
    Situation failed = touch.fine();
    failed.answer = Answer::failed;
    failed.is_position = false;
    EXPECT_EQ(touch.show(failed, {0, 0, 1}), glm::dvec3(0));
    EXPECT_EQ(touch.flags, kFailed);
    EXPECT_NEAR(touch.show({0, 0, 1}).z, 0.01, 1e-9);
    EXPECT_EQ(touch.flags, kRamping);
}

TEST(Safety, AForceComesUpWhenContactIsMadeAgain) {
    SafetyLimits limits = quick();
    limits.contact_ramp = 0.005;
    Touch touch(limits);
    EXPECT_EQ(touch.show({0, 0, 1}).z, 1) << "the first contact has the ramp of the start";
    for (int i = 0; i < 20; ++i)
        touch.show({0, 0, 0}, false);
    EXPECT_EQ(touch.show({0, 0, 1}).z, 1) << "a bounce is no new contact";
    for (int i = 0; i < 60; ++i)
        touch.show({0, 0, 0}, false);
    for (int i = 1; i <= 5; ++i)
        EXPECT_NEAR(touch.show({0, 0, 1}).z, 0.2 * i, 1e-9);
    EXPECT_EQ(touch.show({0, 0, 1}).z, 1);
}

TEST(Safety, NoForceWithoutASoundPosition) {
    const auto zero = [](const std::function<void(Situation&, glm::dvec3&)>& spoil, std::uint32_t expected) {
        SafetyLimits limits = quick();
        limits.low = glm::dvec3(-0.1);
        limits.high = glm::dvec3(0.1);
        Touch touch(limits);
        EXPECT_EQ(touch.show({0, 0, 1}).z, 1);
        Situation now = touch.fine();
        glm::dvec3 force{0, 0, 1};
        spoil(now, force);
        EXPECT_EQ(touch.show(now, force), glm::dvec3(0));
        EXPECT_EQ(touch.flags & kZeroForceFlags, expected);
    };
    zero([](Situation&, glm::dvec3& force) { force.x = kNan; }, kNoNumber);
    zero([](Situation&, glm::dvec3& force) { force.y = kUnknown; }, kNoNumber);
    zero([](Situation& now, glm::dvec3&) { now.is_position = false; }, kBadPosition);
    zero([](Situation& now, glm::dvec3&) { now.answer = Answer::failed; }, kFailed);
    zero([](Situation& now, glm::dvec3&) { now.answer = Answer::repeated, now.time = 0.03; }, kStale);
    zero([](Situation& now, glm::dvec3&) { now.withheld = true; }, kWithheld);
    zero([](Situation& now, glm::dvec3&) { now.late = 0.021; }, kTooLate);
    zero([](Situation& now, glm::dvec3&) { now.late = kUnknown; }, kTooLate);
    zero([](Situation& now, glm::dvec3&) { now.late = kNan; }, kTooLate);
    zero([](Situation& now, glm::dvec3&) { now.probe.z = 0.05; }, kTooFast); // 50 mm in a sample
    zero([](Situation& now, glm::dvec3&) { now.probe.z = -0.11; }, kOutside | kTooFast);
}

TEST(Safety, NoForceWhileTheProbeIsTooFast) {
    Touch touch(quick());
    auto step = [&, z = 0.0](double by) mutable {
        Situation now = touch.fine();
        now.probe.z = z += by;
        return touch.show(now, {0, 0, 1}).z;
    };
    for (int i = 0; i < 50; ++i)
        ASSERT_EQ(step(1.9e-3), 1) << "below 2 m/s";
    int forceless = 0;
    for (int i = 0; i < 50; ++i)
        forceless += step(2.1e-3) == 0;
    EXPECT_GT(forceless, 30);
    EXPECT_NEAR(touch.safety.speed(), 2.1, 1e-3);
    for (int i = 0; i < 5; ++i)
        step(0);
    EXPECT_EQ(step(0), 1);
}

TEST(Safety, AClockThatJittersIsNoSpeed) {
    Touch touch(quick());
    double z = 0;
    for (int i = 0; i < 200; ++i) {
        Situation now = touch.fine();
        now.probe.z = z += 5e-4;                               // 0.5 m/s on the whole
        now.time = i * kPeriod + (i % 2 ? 0 : 0.95 * kPeriod); // two positions within 50 us, then none for 2 ms
        EXPECT_EQ(touch.show(now, {0, 0, 1}).z, 1) << i;
    }
}

TEST(Safety, APathThatBeginsElsewhereIsNoSpeedAndNoWork) {
    Touch touch(quick());
    touch.show({0, 0, 1});
    Situation now = touch.fine();
    now.begins_path = true;
    now.probe = {0.5, 0, 0.5};
    EXPECT_EQ(touch.show(now, {0, 0, 1}).z, 1);
    EXPECT_EQ(touch.safety.energy(), 0);
    SafetyLimits limits = quick();
    limits.ramp = 0.1;
    Touch slowly(limits);
    for (int i = 0; i < 200; ++i)
        slowly.show({0, 0, 1});
    now.time = slowly.time;
    EXPECT_NEAR(slowly.show(now, {0, 0, 1}).z, 0.01, 1e-9) << "what was displayed belongs to another place";
}

TEST(Safety, WhateverComesTheForceIsWithinItsLimits) {
    const bool held_true = rc::check("largest force and slew hold", [] {
        SafetyLimits limits;
        limits.max_force = 3;
        limits.slew = 500;
        limits.passivity = *rc::gen::arbitrary<bool>() ? kPassiveDamping : 0;
        Touch touch(limits);
        glm::dvec3 before(0);
        const auto wild = rc::gen::element(0.0, 1e-3, -2e-3, 1.0, -5.0, 1e9, 1e300, -1e308, kNan, kUnknown);
        for (int i = 0; i < 60; ++i) {
            Situation now = touch.fine();
            now.answer =
                *rc::gen::element(Answer::fresh, Answer::fresh, Answer::fresh, Answer::repeated, Answer::failed);
            now.is_position = now.answer != Answer::failed && *rc::gen::inRange(0, 10) > 0;
            const double place = *rc::gen::element(0.0, 1e-4, -1e-4, 1e-3, 10.0, 1e150);
            now.probe = {place, 0, -place};
            now.late = *rc::gen::element(0.0, 0.0, 0.0, 0.001, 0.03, kNan);
            const glm::dvec3 shown = touch.show(now, {*wild, *wild, *wild}, *rc::gen::arbitrary<bool>());
            RC_ASSERT(glm::length(shown) <= 3 * (1 + 1e-12));
            RC_ASSERT((touch.flags & kZeroForceFlags) == 0 || shown == glm::dvec3(0));
            RC_ASSERT(glm::length(shown) <= glm::length(before) + 0.5 * (1 + 1e-9));
            before = shown;
        }
    });
    EXPECT_TRUE(held_true);
}

TEST(Safety, AWayCountsFromTheBeginningOfTheFirstPath) {
    Touch touch(quick());
    Situation now = touch.fine();
    now.begins_path = true;
    touch.show(now, {0, 0, 1});
    now = touch.fine();
    now.probe.z = 1e-3;
    touch.show(now, {0, 0, 1});
    EXPECT_EQ(touch.safety.energy(), 1e-3);
}

// A device that tells its position at every fourth sample, pushed by a force that gives it 1 mJ, and then left alone.
TEST(Safety, DampsEvenlyBetweenPositionsThatComeSeldom) {
    SafetyLimits limits = quick();
    limits.passivity = 1;
    Touch touch(limits);
    for (int i = 0; i < 9; ++i) {
        Situation now = touch.fine();
        now.answer = i % 4 == 0 ? Answer::fresh : Answer::repeated;
        now.probe.z = 1e-3 * (i / 4);
        const glm::dvec3 shown = touch.show(now, {0, 0, i < 4 ? i : 0});
        EXPECT_NEAR(shown.z, i < 4 ? i : -touch.safety.speed(), 1e-12) << "1 N s/m";
    }
    const double first = 0.25 * 4 / 9, second = first + (0.25 - first) * 4 / 9; // m/s: smoothed over 5 ms
    EXPECT_NEAR(touch.safety.speed(), second, 1e-12);
    EXPECT_NEAR(touch.safety.energy(), 1.5e-3 - 1e-3 * first, 1e-12) << "0 to 3 N over 1 mm, less what was taken out";
    EXPECT_NEAR(touch.safety.damped(), 1e-3 * (4 * first * first + second * second), 1e-12);
    for (int i = 0; i < 6; ++i) {
        Situation now = touch.fine();
        now.answer = Answer::repeated;
        now.probe.z = 2e-3;
        EXPECT_NEAR(touch.show(now, {0, 0, 0}).z, i < 3 ? -second : 0, 1e-12) << "nothing new came when it was due";
    }
}

TEST(EnergyObserver, CountsTheWorkOfForcesThatAreHeld) {
    EnergyObserver observer;
    observer.move_to({0, 0, 0});
    observer.display({0, 0, 2});
    observer.move_to({0.1, 0, 0.25});
    EXPECT_EQ(observer.energy(), 0.5);
    observer.display({1, 0, 0});
    observer.move_to({-0.4, 0, 7});
    EXPECT_EQ(observer.energy(), 0);
    observer.start_at({9, 9, 9});
    EXPECT_EQ(observer.energy(), 0);
}

// What a hand once put in pays for no instability later, beyond what a wall may give back.
TEST(EnergyObserver, KeepsAReserveAndNoMore) {
    EnergyObserver observer;
    observer.move_to({0, 0, 0});
    observer.display({0, 0, 5});
    observer.move_to({0, 0, -1});
    EXPECT_EQ(observer.energy(), -5);
    EXPECT_EQ(observer.surplus(), -kReserve);
    observer.move_to({0, 0, -0.9});
    EXPECT_NEAR(observer.energy(), -4.5, 1e-12);
    EXPECT_NEAR(observer.surplus(), 0.5 - kReserve, 1e-12);
}

} // namespace
} // namespace forceshade::device
