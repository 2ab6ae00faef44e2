// Run times: what paired rounds say for sure, loops by their rate, and forces waited for.
#include <algorithm>
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "host/clock.h"
#include "host/study/error_time/error_time.h"
#include "host/study/error_time/volumes.h"
#include "host/threads.h"
#include "tests/study/subjects.h"

namespace forceshade::study::error_time {
namespace {

// Rounds that a machine slows down and speeds up at random, all methods alike.
Times times_of(const std::vector<double>& seconds, std::size_t rounds = 31) {
    Random draw(3);
    std::vector<Round> all;
    for (std::size_t i = 0; i < rounds; ++i) {
        const double load = draw(1, 3);
        Round round;
        for (const double one : seconds)
            round.push_back(load * one * draw(0.97, 1.03));
        all.push_back(round);
    }
    return {all, 0};
}

TEST(PairedRounds, TellApartWhatTheMachinesLoadWouldHide) {
    const Times times = times_of({1, 1.2, 1.001, 1.05});
    const Interval ratio = times.ratio(1, 0);
    EXPECT_GT(ratio.low, 1.1);
    EXPECT_LT(ratio.low, 1.2);
    EXPECT_GT(ratio.high, 1.2 * 0.98);
    EXPECT_TRUE(times.is_cheaper(0, 1));
    EXPECT_FALSE(times.is_cheaper(1, 0));
    EXPECT_FALSE(times.is_cheaper(0, 2) || times.is_cheaper(2, 0)) << "a tie";
    EXPECT_GT(times.ratio(3, 0).low, 1);
    EXPECT_FALSE(times.is_cheaper(0, 3)) << "a rerun may have it the other way round";
    EXPECT_EQ(times.ratio(1, 1).high, 1);
}

TEST(PairedRounds, NameTiesOfTheCheapest) {
    const Cheapest cheapest = cheapest_of(times_of({1, 1.3, 1.0005, 2}), {0, 1, 2, 3});
    EXPECT_TRUE(cheapest.method == 0 || cheapest.method == 2);
    EXPECT_EQ(cheapest.ties, std::vector<std::size_t>{2 - cheapest.method});
    EXPECT_EQ(cheapest_of(times_of({1, 1.3}), {1}).ties.size(), 0u);
}

TEST(PairedRounds, SayHowSureAFrontIs) {
    const Times times = times_of({1, 2, 2.001, 4});
    const std::vector<double> shares = front_shares(times, {0, 1, 2, 3}, {{8}, {4, 5.5}, {5}, {1}});
    EXPECT_DOUBLE_EQ(shares[0], 1);
    EXPECT_DOUBLE_EQ(shares[3], 1);
    EXPECT_GT(shares[1], 0.3) << "tied in time, and closer in one of two draws";
    EXPECT_LT(shares[1], 0.9);
    EXPECT_GT(shares[2], 0.3);
    EXPECT_LT(shares[2], 0.9);
}

// A loop that is sampled and held has an error of first order in its period. On a plane every loop comes to rest where
// spring and press are in balance, whatever its rate.
TEST(LoopRuns, ErrByTheirPeriodAndNotWhereTheyRest) {
    const auto engine = cpu_engine(1);
    const std::vector<Subject> subjects = own_subjects({{1, 64}, {16}, {0.8e-3}, 100, 20, 1, 1, 1});
    const auto error = [&](const std::vector<LoopRun>& runs, double rate, Precision precision) {
        const auto found =
            std::ranges::find_if(runs, [&](const LoopRun& r) { return r.rate == rate && r.precision == precision; });
        return *found;
    };
    const auto runs = loop_runs("mesh", variant_named(subjects.back(), "16 cells, mean_value"), *engine, 1);
    for (const double rate : {1000.0, 2000.0, 4000.0}) {
        const double ratio =
            error(runs, rate, Precision::f64).position_error / error(runs, 2 * rate, Precision::f64).position_error;
        EXPECT_GT(ratio, 1.6) << rate;
        EXPECT_LT(ratio, 2.6) << rate;
        EXPECT_NEAR(error(runs, rate, Precision::f32).force_error / error(runs, rate, Precision::f64).force_error, 1,
                    0.01);
    }
    // Across a rim: first order at half of the instants; where one crosses earlier than the other both differ by the
    // whole turn, for a time of first order, of which the RMS is the root.
    const auto rims = loop_runs("bump", variant_named(subjects.front(), "64 facets, reference"), *engine, 1);
    for (const double rate : {1000.0, 2000.0, 4000.0}) {
        const LoopRun coarse = error(rims, rate, Precision::f64), fine = error(rims, 2 * rate, Precision::f64);
        EXPECT_NEAR(coarse.median_error / fine.median_error, 2, 0.2) << rate;
        EXPECT_NEAR(coarse.force_error / fine.force_error, std::sqrt(2.0), 0.25) << rate;
    }
    const auto flat = loop_runs("plane", variant_named(subjects.front(), "1 facets, none"), *engine, 1);
    for (const LoopRun& run : flat) {
        EXPECT_LT(run.force_error, 5e-3) << run.rate;
        EXPECT_GT(run.seconds, 0);
    }
}

// Of waits: ranks, each method its own, with the numbers in order; and what a loop sleeps through is no method's time.
TEST(AsMetTimes, AreOfSingleEvaluationsInTurns) {
    std::vector<Method> methods(2);
    std::vector<std::size_t> numbers;
    methods[0].once = [&](std::size_t number) {
        numbers.push_back(number);
        return number == 7 ? 9e-6 : 1e-6;
    };
    methods[1].once = [](std::size_t) { return 5e-6; };
    const Clock::time_point start = Clock::now();
    AsMetTimes times(methods, {0, 1});
    times.measure(15, 2);
    times.measure(5, 1);
    const std::vector<AsMet> met = times.result();
    EXPECT_GT(seconds_since(start), 3 * 20 / kLoopRate - 2e-3) << "three take turns, a tick each";
    ASSERT_EQ(met.size(), 3U);
    EXPECT_EQ(met[0].method, AsMet::kControl);
    EXPECT_NEAR(met[1].loop.median.median, 1e-6, 1e-12);
    EXPECT_NEAR(met[1].loop.median.high, 1e-6, 1e-12);
    EXPECT_NEAR(met[1].loop.worst, 9e-6, 1e-12);
    EXPECT_NEAR(met[1].cold.worst, 1e-6, 1e-12) << "number 7 is not among them";
    EXPECT_NEAR(met[2].loop.median.median, 5e-6, 1e-12);
    EXPECT_EQ(numbers.size(), 2U + 20 + 3) << "once more each time, to make volumes";
    EXPECT_EQ(numbers[23], 19U);
    EXPECT_EQ(numbers[24], 2U);
}

TEST(Crowding, IsSeenWhereOtherWorkWantsTheCores) {
    std::atomic<bool> done = false;
    std::vector<std::jthread> others;
    for (unsigned i = 0; i < 2 * most_threads(); ++i)
        others.emplace_back([&] {
            while (!done) {
            }
        });
    std::vector<double> crowding;
    for (int i = 0; i < 5; ++i)
        crowding.push_back(crowding_of_cores());
    done = true;
    EXPECT_GT(quantile(crowding, 0.5), 1.25);
    const Times times({}, 0);
    EXPECT_TRUE((Measured{{}, {}, times}.steady()));
    EXPECT_FALSE((Measured{{}, {}, times, {1, 1, 1}, bootstrap_median(crowding)}.steady()));
}

TEST(AsMetTimes, AreTakenInOrdersThatDiffer) {
    std::vector<std::size_t> first = shuffled(20, 1);
    EXPECT_EQ(first, shuffled(20, 1));
    EXPECT_NE(first, shuffled(20, 2));
    std::ranges::sort(first);
    for (std::size_t i = 0; i < first.size(); ++i)
        EXPECT_EQ(first[i], i);
}

TEST(AsMetTimes, SayNothingWhereTheControlWaits) {
    AsMet control{AsMet::kControl, {{0.1e-6, 0.1e-6, 0.1e-6}, 2e-6, 4e-6, 5e-6}, {}, 1000, 10};
    EXPECT_FALSE(was_busy({control}));
    control.loop.p99 = 2e-5;
    EXPECT_TRUE(was_busy({control}));
    control.loop = {{2e-6, 2e-6, 2e-6}, 3e-6, 4e-6, 4e-6};
    EXPECT_TRUE(was_busy({control}));
}

TEST(AsMetTimes, AreOfEachLawsFinestVolume) {
    const auto engine = cpu_engine(1);
    Extents extents = few();
    extents.cells = {16};
    const std::vector<Subject> subjects = own_subjects(extents);
    std::vector<Method> methods;
    for (const Subject& subject : subjects)
        for (const Variant& variant : subject.variants)
            add_methods(methods, subject, variant, 0, {*engine, *engine});
    std::size_t volumes = 0, proxies = 0;
    for (const std::size_t i : met_methods(methods)) {
        EXPECT_TRUE(!methods[i].spacing || *methods[i].spacing == 0.4e-3) << methods[i].name;
        EXPECT_TRUE(methods[i].variant->shading != "none" || !methods[i].spacing) << methods[i].name;
        volumes += methods[i].spacing.has_value();
        proxies += methods[i].family == "god-object";
        EXPECT_GT(methods[i].once(0), 0);
    }
    EXPECT_EQ(volumes, 6U + 6);
    EXPECT_EQ(proxies, 4U) << "shaded and unshaded";
}

} // namespace
} // namespace forceshade::study::error_time
