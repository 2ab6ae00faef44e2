// Vibration models: LSFs with known polynomials, signals with known spectra, files that are refused.
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/vibration/vibration.h"
#include "tests/io/folder.h"

namespace forceshade {
namespace {

using std::numbers::pi;
using testing::says;

// A polynomial in z^-1 at e^(iw).
std::complex<double> at(std::span<const double> polynomial, double w) {
    std::complex<double> sum = 0;
    for (std::size_t k = 0; k < polynomial.size(); ++k)
        sum += polynomial[k] * std::polar(1.0, -w * double(k));
    return sum;
}

// With roots at these places of the upper half plane and their mirror images, and with these real roots.
std::vector<double> polynomial_with(const std::vector<std::complex<double>>& pairs, const std::vector<double>& roots) {
    std::vector<double> all{1};
    const auto times = [&](const std::vector<double>& factor) {
        std::vector<double> product(all.size() + factor.size() - 1);
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t k = 0; k < factor.size(); ++k)
                product[i + k] += all[i] * factor[k];
        all = product;
    };
    for (const std::complex<double>& root : pairs)
        times({1, -2 * root.real(), std::norm(root)});
    for (const double root : roots)
        times({1, -root});
    return all;
}

// Where e^(iw(p + 1)/2) A(e^(iw)) is real or imaginary, by bisection: the sum polynomial's and the difference's roots.
std::vector<double> frequencies_of(const std::vector<double>& polynomial) {
    std::vector<double> all;
    const double half = 0.5 * double(polynomial.size());
    for (const bool sum : {true, false}) {
        const auto value = [&](double w) {
            const std::complex<double> turned = std::polar(1.0, w * half) * at(polynomial, w);
            return sum ? turned.real() : turned.imag();
        };
        constexpr int kSteps = 20000;
        for (int i = 1; i + 1 < kSteps; ++i) {
            double low = pi * (i + 0.3) / kSteps, high = pi * (i + 1.3) / kSteps;
            if (i + 2 == kSteps || (value(low) < 0) == (value(high) < 0))
                continue;
            for (int halving = 0; halving < 60; ++halving) {
                const double middle = 0.5 * (low + high);
                ((value(middle) < 0) == (value(low) < 0) ? low : high) = middle;
            }
            all.push_back(low);
        }
    }
    std::ranges::sort(all);
    return all;
}

std::vector<double> even_frequencies(std::size_t order) {
    std::vector<double> all;
    for (std::size_t i = 1; i <= order; ++i)
        all.push_back(pi * double(i) / double(order + 1));
    return all;
}

// Models at the corners of 0.1 m/s by 2 N, in two triangles.
std::shared_ptr<VibrationModels> four_models(const std::function<VibrationModel(std::size_t)>& model) {
    auto all = std::make_shared<VibrationModels>();
    all->material = "plum";
    all->rate = 1000;
    all->largest_speed = 0.1;
    all->largest_force = 2;
    for (std::size_t i = 0; i < 4; ++i) {
        all->models.push_back(model(i));
        all->models.back().speed = i % 2 == 0 ? 0 : 0.1;
        all->models.back().force = i < 2 ? 0 : 2;
    }
    all->triangles = {{0, 1, 2}, {1, 3, 2}};
    return all;
}

VibrationModel arma(const std::vector<double>& ar, const std::vector<double>& ma, double variance, double gain) {
    VibrationModel model;
    model.ar = frequencies_of(ar);
    model.ma = frequencies_of(ma);
    model.variance = variance;
    model.gain = gain;
    return model;
}

std::shared_ptr<VibrationModels> same_models(const VibrationModel& model) {
    return four_models([&](std::size_t) { return model; });
}

std::shared_ptr<VibrationModels> different_models() {
    return four_models([](std::size_t i) {
        const double angle = 0.4 + 0.3 * double(i);
        return arma(polynomial_with({std::polar(0.8, angle)}, {0.5}), polynomial_with({}, {-0.2 * double(i)}),
                    0.5 + double(i), 2 - 0.4 * double(i));
    });
}

std::vector<double> samples(Vibration vibration, double speed, double force, std::size_t count,
                            std::uint64_t path = 0) {
    std::vector<double> all(count);
    vibration.begin(path);
    for (double& one : all)
        one = vibration.next(speed, force);
    return all;
}

TEST(Frequencies, GiveThePolynomial) {
    for (std::size_t order = 1; order < 25; ++order) { // evenly spaced ones are those of 1
        const std::vector<double> one = polynomial_of(even_frequencies(order));
        ASSERT_EQ(one.size(), order + 1);
        EXPECT_EQ(one[0], 1);
        for (std::size_t k = 1; k <= order; ++k)
            EXPECT_NEAR(one[k], 0, 1e-11) << order << ' ' << k; // of products up to 1e4
    }
    for (const double a : {-0.7, 0.2}) // 1 + a z^-1: 1 + 2 a z^-1 + z^-2 is the sum
        EXPECT_NEAR(polynomial_of(std::vector{std::acos(-a)})[1], a, 1e-15);
    const double a1 = -1.2, a2 = 0.7; // by hand
    const std::vector<double> second =
        polynomial_of(std::vector{std::acos((1 - a1 - a2) / 2), std::acos(-(a1 - a2 + 1) / 2)});
    EXPECT_NEAR(second[1], a1, 1e-15);
    EXPECT_NEAR(second[2], a2, 1e-15);
    EXPECT_EQ(polynomial_of({}), std::vector<double>{1});
    const std::vector<std::complex<double>> pairs{std::polar(0.9, 0.3), std::polar(0.7, 1.1), std::polar(0.95, 1.9),
                                                  std::polar(0.5, 2.7)};
    for (const std::vector<double>& roots : {std::vector<double>{}, {0.6}, {0.6, -0.8}, {0.6, -0.8, -0.3}}) {
        const std::vector<double> known = polynomial_with(pairs, roots), frequencies = frequencies_of(known);
        ASSERT_EQ(frequencies.size(), known.size() - 1);
        const std::vector<double> found = polynomial_of(frequencies);
        for (std::size_t k = 0; k < known.size(); ++k)
            EXPECT_NEAR(found[k], known[k], 1e-12);
    }
}

TEST(Vibration, HasTheVarianceAndSpectrumOfItsModel) {
    const double a1 = -2 * 0.9 * std::cos(0.6), a2 = 0.81, variance = 0.3;
    constexpr std::size_t kSegment = 1000, kSegments = 400;
    const auto check = [&](const std::vector<double>& ma, double gain) {
        const std::vector<double> ar{1, a1, a2};
        const std::vector<double> all =
            samples(Vibration(same_models(arma(ar, ma, variance, gain)), 1000, 5), 0.03, 0.7, kSegment * kSegments);
        double square = 0, sum = 0, theory = 0;
        for (const double one : all) {
            square += one * one / double(all.size());
            sum += one / double(all.size());
        }
        for (int i = 0; i < 5000; ++i) // by Parseval's theorem
            theory += std::norm(at(ma, pi * (i + 0.5) / 5000) / at(ar, pi * (i + 0.5) / 5000)) / 5000;
        theory *= gain * gain * variance;
        EXPECT_NEAR(square / theory, 1, 0.02);
        EXPECT_NEAR(sum / std::sqrt(theory), 0, 0.02);
        if (ma.size() == 1) { // Yule and Walker's
            const double known = variance * (1 + a2) / ((1 - a2) * ((1 + a2) * (1 + a2) - a1 * a1));
            EXPECT_NEAR(theory / (gain * gain) / known, 1, 1e-6);
        }
        for (const int bin : {20, 60, 95, 96, 150, 250, 400, 480}) { // of 500 Hz
            const double w = 2 * pi * bin / double(kSegment);
            double power = 0, window = 0; // Hann's, or the resonance leaks into other bins
            std::vector<double> part(kSegment);
            for (std::size_t segment = 0; segment < kSegments; ++segment) {
                for (std::size_t i = 0; i < kSegment; ++i) {
                    const double weight = 1 - std::cos(2 * pi * double(i) / double(kSegment));
                    part[i] = weight * all[segment * kSegment + i];
                    window += weight * weight;
                }
                power += std::norm(at(part, w));
            }
            power /= window;
            const double known = gain * gain * variance * std::norm(at(ma, w) / at(ar, w));
            EXPECT_NEAR(power / known, 1, 0.2) << bin; // 4 standard deviations of the mean of 400
        }
    };
    check({1}, 1);
    check({1, 0.5}, 1);
    check({1, -0.3, 0.4}, 2.5);
}

TEST(Vibration, InterpolatesFrequenciesVarianceAndGain) {
    const auto models = different_models();
    struct Place {
        double speed, force;
        std::vector<double> weights;
    };
    for (const auto& [speed, force, weights] : std::vector<Place>{{0.1, 2, {0, 0, 0, 1}},
                                                                  {0.1, 1e-9, {0, 1, 0, 0}},
                                                                  {0.05, 1, {0, 0.5, 0.5, 0}},
                                                                  {0.025, 0.5, {0.5, 0.25, 0.25, 0}},
                                                                  {0.09, 1.6, {0, 0.2, 0.1, 0.7}},
                                                                  {7, 1, {0, 0.5, 0, 0.5}}, // cut to the range
                                                                  {0.05, 300, {0, 0, 0.5, 0.5}}}) {
        VibrationModel mean;
        mean.ar.resize(3);
        mean.ma.resize(1);
        mean.variance = mean.gain = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            const VibrationModel& one = models->models[i];
            for (std::size_t k = 0; k < 3; ++k)
                mean.ar[k] += weights[i] * one.ar[k];
            mean.ma[0] += weights[i] * one.ma[0];
            mean.variance += weights[i] * one.variance;
            mean.gain += weights[i] * one.gain;
        }
        const std::vector<double> own = samples(Vibration(models, 1000, 1), speed, force, 200);
        const std::vector<double> known = samples(Vibration(same_models(mean), 1000, 1), 0.05, 1, 200);
        for (std::size_t i = 0; i < own.size(); ++i)
            ASSERT_NEAR(own[i], known[i], 1e-7) << speed << ' ' << force << ' ' << i;
    }
}

TEST(Vibration, TakesNoHarmFromFlatTrianglesAndHoles) {
    const auto models = different_models();
    models->triangles = {{0, 1, 1}, {2, 2, 2}, {0, 1, 2}};
    const std::vector<double> own = samples(Vibration(models, 1000, 1), 0.05, 1, 50);
    EXPECT_EQ(own, samples(Vibration(different_models(), 1000, 1), 0.05, 1, 50));
    EXPECT_NE(own, samples(Vibration(models, 1000, 1), 0.1, 1.5, 50)); // outside of the triangle
    models->triangles = {{0, 1, 1}};
    for (const double one : samples(Vibration(models, 1000, 1), 0.05, 1, 50))
        EXPECT_TRUE(std::isfinite(one));
}

TEST(Vibration, DependsOnSeedAndPathAlone) {
    const auto models = different_models();
    const std::vector<double> own = samples(Vibration(models, 1000, 1), 0.05, 1, 100, 3);
    EXPECT_EQ(own, samples(Vibration(models, 1000, 1), 0.05, 1, 100, 3));
    EXPECT_NE(own, samples(Vibration(models, 1000, 2), 0.05, 1, 100, 3));
    EXPECT_NE(own, samples(Vibration(models, 1000, 1), 0.05, 1, 100, 4));
    Vibration used(models, 1000, 1);
    for (int i = 0; i < 50; ++i)
        used.next(0.02, 0.3);
    EXPECT_EQ(own, samples(used, 0.05, 1, 100, 3)); // begin() forgets it
}

TEST(Vibration, KeepsItsStateWhileNothingMoves) {
    Vibration rests(different_models(), 1000, 1);
    const std::vector<double> all = samples(rests, 0.05, 1, 60);
    rests.begin(0);
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (const auto& [speed, force] : {std::pair{0.0, 1.0}, {0.05, 0.0}, {0.0, 0.0}, {NAN, 1.0}, {0.05, HUGE_VAL}})
            EXPECT_EQ(rests.next(speed, force), 0);
        Vibration copy = rests;
        const double nearly = i % 2 == 0 ? 0.05 : 0.0503; // the filter stays
        ASSERT_EQ(rests.next(nearly, 1), all[i]);
        ASSERT_EQ(copy.next(0.05, 1), all[i]);
    }
}

TEST(Vibration, TakesRatesThatAreMultiples) {
    const auto models = different_models();
    const std::vector<double> own = samples(Vibration(models, 1000, 1), 0.05, 1, 60);
    const std::vector<double> slow = samples(Vibration(models, 1000.0 / 3, 1), 0.05, 1, 20);
    const std::vector<double> fast = samples(Vibration(models, 1 / 0.00025, 1), 0.05, 1, 240);
    for (std::size_t i = 0; i < 20; ++i)
        EXPECT_EQ(slow[i], own[3 * i + 2]);
    for (std::size_t i = 0; i < 240; ++i)
        EXPECT_EQ(fast[i], own[i / 4]);
    for (const double rate : {1500.0, 999.0, 400.0, 0.0, -1000.0, double(NAN), double(HUGE_VAL), 1e-9})
        EXPECT_TRUE(
            says(testing::message_of<UsageError>([&] { Vibration(models, rate, 1); }), "1000 Hz", "plum", "got"))
            << rate;
}

TEST(Vibration, StartsAfreshWhereAFilesNumbersAreWrong) {
    VibrationModel wrong = arma({1, -0.5}, {1, 0.2}, 1, 1e6);
    const std::vector<double> large = samples(Vibration(same_models(wrong), 1000, 1), 0.05, 1, 1000);
    for (const double one : large)
        EXPECT_LE(std::abs(one), 1e6);
    EXPECT_TRUE(std::ranges::count(large, 0.0) > 10);
    wrong.variance = NAN;
    for (const double one : samples(Vibration(same_models(wrong), 1000, 1), 0.05, 1, 10))
        EXPECT_EQ(one, 0);
}

class VibrationFile : public ::testing::Test {
protected:
    static std::string list(const char* name, const std::string& values) {
        return fmt::format("   <{0} type=\"array\">\n{1}   </{0}>\n", name, values);
    }
    static std::string values(const std::vector<double>& all) {
        std::string text;
        for (const double one : all)
            text += fmt::format("      <value>{:.6f}</value>\n", one);
        return text;
    }
    static std::string model(int number, const std::string& ma) {
        return fmt::format("   <model>\n      <modNum>{0}</modNum>\n      <ARcoeff>\n         <value>1.0</value>\n"
                           "      </ARcoeff>\n<ARlsf>\n{1}</ARlsf>\n{2}      <var>0.{0}</var>\n"
                           "      <gain>1{0}.5</gain>\n   </model>\n",
                           number, values({0.5, 1.0 + 0.1 * number, 2.25}), ma);
    }
    static std::string file(const std::string& ma = "<MAlsf>\n<value>1.5</value>\n</MAlsf>\n") {
        return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<modelSet texture=\"7\">\n"
               "   <material>Plum &amp; pear</material>\n   <AccelUnits>m/s^2</AccelUnits>\n"
               "   <SpeedUnits>mm/s</SpeedUnits>\n   <ForceUnits>N</ForceUnits>\n   <SampleRate>10000</SampleRate>\n"
               "   <mu>0.625</mu>\n   <numMod>3</numMod>\n   <numTri>1</numTri>\n   <maxSpeed>250</maxSpeed>\n"
               "   <maxForce> 2.5 </maxForce>\n" +
               list("speedList", values({0, 250, 0})) + list("forceList", values({0, 0, 2.5})) +
               list("tri", values({1, 2, 3})) + "   <numARCoeff>3</numARCoeff>\n" + model(1, ma) + model(2, ma) +
               model(3, ma) + "</modelSet>\n";
    }
    // The file with `from` replaced at its first place.
    static std::string changed(const std::string& from, const std::string& to) {
        std::string text = file();
        const std::size_t place = text.find(from);
        EXPECT_NE(place, text.npos) << from;
        return text.replace(place, from.size(), to);
    }
    VibrationModels read(const std::string& text) const { return read_vibration(folder_.write("plum.xml", text)); }
    // The message behind the file's path.
    std::string refusal(const std::string& text) const {
        const std::string message = testing::message_of<UsageError>([&] { read(text); });
        const std::string path = (folder_ / "plum.xml").string() + ":";
        EXPECT_TRUE(message.starts_with(path)) << message;
        return message.substr(std::min(message.size(), path.size()));
    }

    testing::Folder folder_;
};

TEST_F(VibrationFile, IsReadInSiUnits) {
    const VibrationModels models = read(file());
    EXPECT_EQ(models.material, "Plum & pear");
    EXPECT_EQ(models.rate, 10000);
    EXPECT_EQ(models.friction, 0.625);
    EXPECT_EQ(models.largest_speed, 0.25);
    EXPECT_EQ(models.largest_force, 2.5);
    ASSERT_EQ(models.models.size(), 3U);
    EXPECT_EQ(models.models[1].speed, 0.25);
    EXPECT_EQ(models.models[1].force, 0);
    EXPECT_EQ(models.models[2].speed, 0);
    EXPECT_EQ(models.models[2].force, 2.5);
    EXPECT_EQ(models.models[2].ar, (std::vector{0.5, 1.3, 2.25}));
    EXPECT_EQ(models.models[2].ma, std::vector{1.5});
    EXPECT_EQ(models.models[2].variance, 0.3);
    EXPECT_EQ(models.models[2].gain, 13.5);
    EXPECT_EQ(models.triangles, (std::vector<std::array<std::size_t, 3>>{{0, 1, 2}}));
    EXPECT_TRUE(std::isnan(read(changed("<mu>0.625</mu>", "")).friction));
}

TEST_F(VibrationFile, MayHaveNoMovingAverage) {
    for (const char* none : {"", "<MAlsf></MAlsf>", "<MAcoeff>\n<value>1.0</value>\n</MAcoeff>\n<MAlsf/>"}) {
        const VibrationModels models = read(file(none));
        EXPECT_TRUE(models.models[0].ma.empty());
        EXPECT_EQ(models.models[0].gain, 1); // is of the moving average
        Vibration vibration(std::make_shared<VibrationModels>(models), 1000, 0);
        EXPECT_NE(vibration.next(0.1, 1), 0);
    }
}

TEST_F(VibrationFile, IsRefusedWithItsLine) {
    const struct {
        const char *from, *to;
        std::vector<std::string> words;
    } cases[]{
        {"modelSet>\n", "", {"damaged XML"}},
        {"   </tri>", "", {"damaged XML"}},
        {"<modelSet texture=\"7\">", "<modelSet>", {}},
        {"m/s^2", "g", {"4: <AccelUnits> must be \"m/s^2\", got \"g\""}},
        {"mm/s", "in/s", {"5: <SpeedUnits> must be \"mm/s\", got \"in/s\""}},
        {"<ForceUnits>N<", "<ForceUnits>lbf<", {"6: <ForceUnits> must be \"N\", got \"lbf\""}},
        {"<ForceUnits>N</ForceUnits>", "", {"2: <modelSet> has no <ForceUnits>"}},
        {"10000", "0", {"7: <SampleRate> must be positive, got 0"}},
        {"10000", "1e300", {"7: the sample rate exceeds 1000000 Hz"}},
        {"0.625", "nan", {"8: <mu> must be a finite number, got \"nan\""}},
        {"0.625", "-1", {"8: <mu> must not be negative, got -1"}},
        {"<numMod>3", "<numMod>4", {"9: <numMod> is 4, but the file has 3"}},
        {"<numTri>1", "<numTri>2", {"10: <numTri> is 2, but the file has 1"}},
        {"<numARCoeff>3", "<numARCoeff>19", {"<numARCoeff> is 19, but the file has 3"}},
        {"<maxSpeed>250", "<maxSpeed>1e999", {"11: <maxSpeed> must be a finite number"}},
        {"<maxSpeed>250", "<maxSpeed>0,25", {"11: <maxSpeed> must be a finite number, got \"0,25\""}},
        {"2.5 <", "2.5 N<", {"12: <maxForce> must be a finite number, got \"2.5 N\""}},
        {"speedList type", "speeds type", {"damaged XML"}},
        {"<value>250.000000</value>", "", {"61: model 3 has no place"}},
        {"<value>250.000000</value>", "<value></value>", {"15: <value> must be a finite number, got \"\""}},
        {"<value>250.000000</value>", "<value>-3</value>", {"15: <value> must not be negative, got -3"}},
        {"<value>1.000000</value>", "<value>0</value>", {"24: <tri> must name models 1 to 3, got 0"}},
        {"<value>1.000000</value>", "<value>4</value>", {"24: <tri> must name models 1 to 3, got 4"}},
        {"<value>1.000000</value>", "<value>1.5</value>", {"24: <tri> must name models 1 to 3, got 1.5"}},
        {"<value>1.000000</value>", "", {"23: <tri> must have 3 values, got 2"}},
        {"<value>1.000000</value>", "<value>1</value><value>1</value>", {"26: <tri> has more than 3 values"}},
        {"<modNum>1", "<modNum>2", {"<modNum> must be 1, got 2"}},
        {"<value>0.500000</value>", "<value>0</value>", {"<ARlsf> must ascend between 0 and pi, got 0 after 0"}},
        {"<value>0.500000</value>", "<value>1.1</value>", {"got 1.1 after 1.1"}},
        {"<value>2.250000</value>", "<value>3.2</value>", {"got 3.2 after 1.1"}},
        {"<value>2.250000</value>", "", {"has 3 and 1 line spectral frequencies, the first 2 and 1"}},
        {"<value>0.500000</value>", "<value>inf</value>", {"<value> must be a finite number, got \"inf\""}},
        {"<var>0.1</var>", "", {"<model> has no <var>"}},
        {"<var>0.1</var>", "<var>-0.1</var>", {"<var> must not be negative"}},
        {"<gain>11.5</gain>", "", {"<model> has no <gain>"}},
        {"<gain>11.5</gain>", "<gain>NaN</gain>", {"<gain> must be a finite number, got \"NaN\""}},
    };
    for (const auto& [from, to, words] : cases) {
        if (words.empty())
            EXPECT_NO_THROW(read(changed(from, to)));
        else
            EXPECT_TRUE(says(refusal(changed(from, to)), words)) << from;
    }
    EXPECT_TRUE(says(refusal("<html><body/></html>\n"), "1: no <modelSet>"));
    EXPECT_TRUE(says(refusal(""), "1: damaged XML"));
    EXPECT_TRUE(says(refusal(std::string("\x89PNG\r\n\0\0", 8)), "damaged XML"));
    for (const char* name : {"speedList", "forceList", "tri", "model", "ARlsf"}) { // every one of these
        std::string text = file();
        const std::string begin = fmt::format("<{}", name), end = fmt::format("</{}>", name);
        for (std::size_t from = 0; (from = text.find(begin + (name == std::string("model") ? ">" : ""))) != text.npos;)
            text.erase(from, text.find(end, from) + end.size() - from);
        EXPECT_TRUE(says(refusal(text), name)) << name;
    }
    for (std::size_t size = 0; size + 10 < file().size(); size += 37) // cut off anywhere
        EXPECT_FALSE(refusal(file().substr(0, size)).empty()) << size;
    EXPECT_TRUE(says(testing::message_of<IoError>([&] { read_vibration(folder_ / "none.xml"); }), "none.xml"));
    EXPECT_TRUE(says(testing::message_of<IoError>([&] { read_vibration(folder_.path()); }), folder_.path().string()));
}

} // namespace
} // namespace forceshade
