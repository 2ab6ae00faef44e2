// The study of error against time: its orders and fronts, errors, volumes, rounds, and what its contenders give.
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/study/error_time/half_forces.h"
#include "host/study/error_time/law_at.h"
#include "host/study/error_time/measured.h"
#include "host/study/error_time/patch_rows.h"
#include "host/study/run/quartiles.h"

namespace forceshade::study::error_time {
namespace {

TEST(Order, OfAPowerLawIsItsExponent) {
    const std::vector<double> sizes{1, 0.5, 0.25, 0.125}, errors{3, 0.75, 0.1875, 0.046875};
    const OrderFit fit = fit_order(sizes, errors);
    EXPECT_NEAR(fit.order, 2, 1e-12);
    EXPECT_NEAR(fit.deviation, 0, 1e-12);
    EXPECT_EQ(fit.points, 4u);
}

TEST(Order, LeavesOutWhatIsZeroAndTellsItsDeviation) {
    const std::vector<double> sizes{1, 0.5, 0.25, 0.125}, errors{1, 0, 0.3, 0.11};
    const OrderFit fit = fit_order(sizes, errors);
    EXPECT_EQ(fit.points, 3u);
    EXPECT_GT(fit.deviation, 0);
    EXPECT_EQ(fit_order(std::vector<double>{1.0}, std::vector<double>{1.0}).points, 1u);
}

TEST(Front, HoldsWhatNothingBeats) {
    const std::vector<double> costs{3, 1, 2, 4, 5, 1.5, NAN}, errors{0.5, 2, 1, 0.499, 0.1, 3, 0};
    EXPECT_EQ(pareto_front(costs, errors), (std::vector<std::size_t>{1, 2, 0, 4})); // 0.499 is not a hundredth closer
    EXPECT_EQ(pareto_front(costs, errors, 0), (std::vector<std::size_t>{1, 2, 0, 3, 4}));
    EXPECT_TRUE(pareto_front({}, {}).empty());
}

TEST(Quartiles, AreInterpolated) {
    const Quartiles found = quartiles({4, 1, 3, 2});
    EXPECT_DOUBLE_EQ(found.low, 1.75);
    EXPECT_DOUBLE_EQ(found.median, 2.5);
    EXPECT_DOUBLE_EQ(found.high, 3.25);
}

TEST(Errors, TellDirectionMagnitudeAndContactApart) {
    const std::vector<glm::dvec3> truth{{0, 0, 2}, {0, 0, 1}, {1, 0, 0}, {0, 0, 0}};
    const std::vector<glm::dvec3> forces{{2, 0, 0}, {0, 0, 1.5}, {0, 0, 0}, {0, 0, 1}};
    const ForceErrors errors = force_errors(forces, truth);
    EXPECT_EQ(errors.compared, 3u);
    EXPECT_EQ(errors.contact_differs, 2u);
    EXPECT_NEAR(errors.direction->largest, 90, 1e-12);
    EXPECT_NEAR(errors.direction->rms, 90 / std::sqrt(2), 1e-12);
    EXPECT_NEAR(errors.magnitude->largest, 1, 1e-12);
    EXPECT_NEAR(errors.vector->largest, std::sqrt(2), 1e-12);
    const ForceErrors again = errors_from(nlohmann::ordered_json::parse(to_json(errors).dump()));
    EXPECT_EQ(again.vector->rms, errors.vector->rms);
    EXPECT_EQ(again.compared, errors.compared);
}

TEST(Errors, WithoutAPlaceInContactThereIsNoDirection) {
    const std::vector<glm::dvec3> truth{{0, 0, 2}, {0, 0, 1}}, none{{0, 0, 0}, {0, 0, 0}};
    const ForceErrors missed = errors_from(nlohmann::ordered_json::parse(to_json(force_errors(none, truth)).dump()));
    EXPECT_FALSE(missed.direction);
    ASSERT_TRUE(missed.vector);
    EXPECT_EQ(missed.vector->rms, 1);
    EXPECT_EQ(missed.contact_differs, 2u);
    const ForceErrors nothing = force_errors(truth, none); // in contact where nothing should be
    EXPECT_FALSE(nothing.direction || nothing.magnitude || nothing.vector);
    EXPECT_EQ(nothing.compared, 0u);
    EXPECT_EQ(nothing.contact_differs, 2u);
}

TEST(Errors, SummaryLeavesOutAThousandthOfTheLargest) {
    std::vector<double> values(2000, 1.0);
    values[7] = values[8] = 50;
    EXPECT_EQ(summary_of(values)->p999, 1);
    values[9] = 40;
    EXPECT_EQ(summary_of(values)->p999, 40);
    EXPECT_EQ(summary_of(values)->largest, 50);
}

TEST(Halves, AreThoseOfTheFiles) {
    std::vector<float> numbers;
    for (const float x : {0.0F, -0.0F, 1.0F, -2.5F, 65504.0F, 6e-8F, -3.1e-5F, 0.1F, 1234.5F})
        numbers.push_back(x);
    std::vector<Half> halves;
    to_halves(numbers, halves);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const float back = to_float(halves[i]);
        EXPECT_NEAR(back, numbers[i], std::max(0x1p-11F * std::abs(numbers[i]), 0x1p-25F));
        EXPECT_EQ(std::signbit(back), std::signbit(numbers[i]));
    }
}

// A volume of a function of the place, and a place within.
template <typename Function> glm::dvec3 read(const Function& function, bool cubic, const glm::dvec3& at) {
    const VolumeGrid grid = volume_grid({0, 0, 0}, {1, 1, 1}, 0.25);
    std::vector<double> forces;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        for (std::size_t j = 0; j < grid.size[1]; ++j)
            for (std::size_t i = 0; i < grid.size[0]; ++i) {
                const glm::dvec3 force = function(grid.origin + grid.spacing * glm::dvec3(i, j, k));
                forces.insert(forces.end(), {force.x, force.y, force.z});
            }
    const ForceVolume<double, double> volume(grid, std::move(forces));
    return cubic ? volume.tricubic(at) : volume.trilinear(at);
}

void expect_near(const glm::dvec3& one, const glm::dvec3& other) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(one[i], other[i], 1e-13);
}

TEST(Volume, TrilinearIsExactForProductsTricubicForSquares) {
    const auto product = [](const glm::dvec3& p) { return glm::dvec3(p.x * p.y * p.z, 1 - p.x, p.y + 2 * p.z); };
    const auto square = [](const glm::dvec3& p) { return glm::dvec3(p.x * p.x, p.y * p.y - p.z, p.z * p.z * p.x); };
    for (const glm::dvec3& at : {glm::dvec3(0.1, 0.2, 0.33), {0.99, 0.01, 0.5}, {0.25, 0.75, 1}}) {
        expect_near(read(product, false, at), product(at));
        expect_near(read(product, true, at), product(at));
        expect_near(read(square, true, at), square(at));
        EXPECT_GT(std::abs(read(square, false, {0.1, 0.2, 0.33}).x - 0.01), 1e-3);
    }
}

double order_between(const LookupCase& one, std::size_t which) {
    const auto coarse = lookup_errors(one, 0.4e-3, 1500), fine = lookup_errors(one, 0.2e-3, 1500);
    EXPECT_GT(fine.at(which).places, 100u);
    return std::log2(coarse.at(which).rms / fine.at(which).rms);
}

TEST(Lookup, OrdersAreTwoAndThreeInSmoothPartsAndOneAcrossEdges) {
    const LookupCase shaded = lookup_cases().at(0), flat = lookup_cases().at(1), mesh = lookup_cases().at(2);
    EXPECT_NEAR(order_between(shaded, 0), 2, 0.05); // trilinear, smooth
    EXPECT_NEAR(order_between(shaded, 1), 1, 0.15); // edge
    EXPECT_NEAR(order_between(shaded, 2), 1, 0.15); // boundary
    EXPECT_NEAR(order_between(shaded, 3), 3, 0.1);  // tricubic, smooth
    EXPECT_NEAR(order_between(flat, 1), 0, 0.2);    // a jump stays
    EXPECT_NEAR(order_between(mesh, 0), 2, 0.1);
    EXPECT_LT(lookup_errors(flat, 0.4e-3, 300).at(0).largest, 1e-13);
    EXPECT_EQ(expected_order(shaded, "tricubic", "smooth"), 3);
    EXPECT_EQ(expected_order(flat, "trilinear", "edge"), 0);
    EXPECT_EQ(expected_order(flat, "trilinear", "smooth"), std::nullopt);
}

TEST(Interpolation, TheStudysTableAgreesWithThePrintedOne) {
    Measured measured;
    for (std::size_t mesh = 0; mesh < patch_meshes(); ++mesh)
        for (const PatchRow& row : patch_rows_from(to_json(patch_rows(mesh))))
            measured.patches.push_back(row);
    const std::vector<Table> tables = tables_of(measured);
    const Table& table = *std::ranges::find_if(tables, [](const Table& one) { return one.name == "interpolation"; });
    std::size_t printed = 0;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        EXPECT_NE(table.word(row, "agrees"), "no") << row;
        printed += table.word(row, "agrees") == "yes" ? 1 : 0;
    }
    EXPECT_EQ(printed, 50u);
    measured.patches[0].found[0] *= 1.02;
    const std::vector<Table> altered = tables_of(measured);
    const Table& worse = *std::ranges::find_if(altered, [](const Table& one) { return one.name == "interpolation"; });
    EXPECT_EQ(worse.word(0, "agrees"), "no");
}

void add_law(Measured& measured, const std::string& shading, std::optional<double> facets, std::optional<double> cells,
             double error) {
    Contender one;
    one.name = one.reference = fmt::format("a surface, law {}: direct f64", measured.contenders.size());
    one.family = "direct";
    one.precision = "f64";
    one.shading = shading;
    one.facets = facets;
    one.cells = cells;
    ForceErrors errors;
    errors.direction = Summary{error, error, error};
    errors.magnitude = Summary{10 * error, 10 * error, 10 * error};
    measured.contenders.push_back(one);
    measured.compared.push_back({errors, {}});
}

TEST(Series, FollowFromTheErrorsOfTheLaws) {
    Measured measured;
    for (const double n : {4.0, 8.0, 16.0}) {
        add_law(measured, "none", n, {}, 8 / n);
        add_law(measured, "reference", n, {}, 64 / (n * n));
        add_law(measured, "mean_value", {}, n, 3 / n);
    }
    measured.contenders.push_back(measured.contenders.front());
    measured.contenders.back().precision = "f32"; // belongs to none
    measured.compared.push_back(measured.compared.front());
    add_series(measured);
    ASSERT_EQ(measured.series.size(), 3u);
    EXPECT_EQ(measured.series[0].name, "bump, flat");
    EXPECT_EQ(measured.series[0].sizes, (std::vector<double>{1.0 / 8, 1.0 / 16})); // four facets are too few
    EXPECT_EQ(measured.series[0].errors, (std::vector<double>{1, 0.5}));           // of direction
    EXPECT_EQ(measured.series[1].name, "bump, shaded");
    EXPECT_EQ(measured.series[1].errors, (std::vector<double>{10, 2.5})); // of magnitude
    EXPECT_EQ(measured.series[1].expected, 2);
    EXPECT_EQ(measured.series[2].name, "mesh, mean_value, static");
    EXPECT_EQ(measured.series[2].expected, 1);
    measured.rounds = {{1, std::vector<double>(measured.contenders.size(), 1.0)}};
    std::set<std::string> shown; // degrees and shares are apart
    for (const Figure& figure : figures_of(tables_of(measured)))
        if (figure.name.starts_with("convergence"))
            shown.insert(figure.name + ": " + figure.y.label);
    EXPECT_EQ(shown, (std::set<std::string>{"convergence-facets-direction: RMS direction error / deg",
                                            "convergence-facets-magnitude: RMS relative error of the magnitude",
                                            "convergence-meshes: RMS direction error / deg"}));
}

TEST(Rounds, MeasureEachOnceInAnOrderOfTheirOwn) {
    std::vector<std::size_t> order;
    Contenders contenders(20);
    for (std::size_t i = 0; i < contenders.size(); ++i)
        contenders[i].seconds = [&order, i] {
            order.push_back(i);
            return static_cast<double>(i + 1);
        };
    const Round round = measure_round(contenders, 3, 0);
    const std::vector<std::size_t> first = order;
    EXPECT_EQ(round.unit, 4);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        EXPECT_EQ(round.seconds[i], static_cast<double>(i + 1));
        EXPECT_EQ(std::ranges::count(first, i), i == 3 ? 7 : 1);
    }
    order.clear();
    measure_round(contenders, 3, 0);
    EXPECT_EQ(order, first);
    order.clear();
    measure_round(contenders, 3, 1);
    EXPECT_NE(order, first);
    EXPECT_EQ(round_from(to_json(round)).seconds, round.seconds);
}

} // namespace
} // namespace forceshade::study::error_time
