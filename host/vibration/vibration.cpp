#include "host/vibration/vibration.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "host/error.h"

namespace forceshade {
namespace {

constexpr double kSame = 0.01;          // of a speed or a force: the filter is kept
constexpr double kLargestOutput = 1e6;  // m/s^2: beyond, a file's numbers are wrong
constexpr double kLargestRatio = 10000; // of rates

// Half the sum of the two polynomials of order p + 1 whose roots are e^(+-i w) on the unit circle: the symmetric one
// has the 1st, 3rd, ... frequency w, the antisymmetric one the others. Roots at 1 and -1 complete them. `polynomial`
// has p + 1 numbers, `product` p + 2 or more.
void set_polynomial(std::span<const double> frequencies, std::span<double> polynomial,
                    std::span<double> product) noexcept {
    const std::size_t order = frequencies.size();
    std::ranges::fill(polynomial, 0.0);
    for (const std::size_t first : {std::size_t(0), std::size_t(1)}) {
        std::ranges::fill(product, 0.0);
        product[0] = 1;
        std::size_t degree = 0;
        for (std::size_t i = first; i < order; i += 2) {
            const double middle = -2 * std::cos(frequencies[i]);
            degree += 2;
            for (std::size_t k = degree; k > 1; --k)
                product[k] += middle * product[k - 1] + product[k - 2];
            product[1] += middle;
        }
        const auto times_root = [&](double root) {
            for (std::size_t k = ++degree; k > 0; --k)
                product[k] -= root * product[k - 1];
        };
        if (first == 1)
            times_root(1);
        if (order % 2 == first) // of an odd order both roots are the antisymmetric one's
            times_root(-1);
        for (std::size_t k = 0; k <= order; ++k)
            polynomial[k] += 0.5 * product[k];
    }
}

struct Weights {
    std::array<std::size_t, 3> models;
    std::array<double, 3> weights{1, 0, 0};
};

// Barycentric, of the triangle about a place; rounding can leave a place outside of all, which then has the nearest
// one.
Weights weights_at(const VibrationModels& models, double speed, double force) noexcept {
    Weights best{models.triangles.front()};
    double depth = -std::numeric_limits<double>::infinity();
    for (const std::array<std::size_t, 3>& corners : models.triangles) {
        const VibrationModel &a = models.models[corners[0]], &b = models.models[corners[1]],
                             &c = models.models[corners[2]];
        const double area = (b.speed - a.speed) * (c.force - a.force) - (c.speed - a.speed) * (b.force - a.force);
        if (area == 0)
            continue;
        const double second =
            ((speed - a.speed) * (c.force - a.force) - (c.speed - a.speed) * (force - a.force)) / area;
        const double third = ((b.speed - a.speed) * (force - a.force) - (speed - a.speed) * (b.force - a.force)) / area;
        const double first = 1 - second - third;
        if (const double least = std::min({first, second, third}); least > depth) {
            depth = least;
            best = {corners, {first, second, third}};
            if (least >= 0)
                return best;
        }
    }
    double sum = 0;
    for (double& weight : best.weights)
        sum += weight = std::max(weight, 0.0);
    for (double& weight : best.weights)
        weight /= sum;
    return best;
}

} // namespace

std::vector<double> polynomial_of(std::span<const double> frequencies) {
    std::vector<double> polynomial(frequencies.size() + 1), product(frequencies.size() + 2);
    set_polynomial(frequencies, polynomial, product);
    return polynomial;
}

Vibration::Vibration(std::shared_ptr<const VibrationModels> models, double rate, std::uint64_t seed)
    : models_(std::move(models)), seed_(seed), noise_(seed) {
    assert(models_ && !models_->models.empty() && !models_->triangles.empty());
    const auto is_whole = [](double ratio) {
        return ratio > 0.5 && ratio <= kLargestRatio && std::abs(ratio - std::round(ratio)) <= 1e-9 * ratio;
    };
    if (const double steps = models_->rate / rate, repeats = rate / models_->rate; is_whole(steps))
        steps_ = static_cast<std::size_t>(std::round(steps));
    else if (is_whole(repeats))
        repeats_ = static_cast<std::size_t>(std::round(repeats));
    else
        throw UsageError("the loop's rate must be {:g} Hz, a whole multiple or a whole fraction of it for the "
                         "vibration of \"{}\", got {:g} Hz",
                         models_->rate, models_->material, rate);
    const std::size_t ar = models_->models.front().ar.size(), ma = models_->models.front().ma.size();
    ar_.resize(ar + 1);
    outputs_.resize(ar + 1);
    ma_.resize(ma + 1);
    excitations_.resize(ma + 1);
    frequencies_.resize(std::max(ar, ma));
    product_.resize(std::max(ar, ma) + 2);
    begin(0);
}

void Vibration::begin(std::uint64_t path) noexcept {
    noise_ = Random(scrambled(seed_ ^ scrambled(path + 1)));
    std::ranges::fill(outputs_, 0.0);
    std::ranges::fill(excitations_, 0.0);
    speed_ = force_ = -1;
    left_ = 0;
    last_ = 0;
}

void Vibration::set_filter(double speed, double force) noexcept {
    speed_ = speed;
    force_ = force;
    const Weights at = weights_at(*models_, speed, force);
    const auto mean = [&](auto value) {
        double sum = 0;
        for (std::size_t corner = 0; corner < 3; ++corner)
            sum += at.weights[corner] * value(models_->models[at.models[corner]]);
        return sum;
    };
    const auto set = [&](std::vector<double> VibrationModel::*own, std::vector<double>& polynomial) {
        const std::size_t order = polynomial.size() - 1;
        for (std::size_t i = 0; i < order; ++i)
            frequencies_[i] = mean([&](const VibrationModel& model) { return (model.*own)[i]; });
        set_polynomial(std::span(frequencies_).first(order), polynomial, product_);
    };
    set(&VibrationModel::ar, ar_);
    set(&VibrationModel::ma, ma_);
    deviation_ = std::sqrt(mean([](const VibrationModel& model) { return model.variance; }));
    gain_ = mean([](const VibrationModel& model) { return model.gain; });
}

double Vibration::step() noexcept {
    double normal = -6; // nearly Gaussian, and the same on every machine: 12 uniform numbers have variance 1
    for (int i = 0; i < 12; ++i)
        normal += noise_.uniform();
    std::shift_right(excitations_.begin(), excitations_.end(), 1);
    excitations_[0] = deviation_ * normal;
    double output = 0;
    for (std::size_t i = 0; i < ma_.size(); ++i)
        output += ma_[i] * excitations_[i];
    output *= gain_;
    for (std::size_t i = 1; i < ar_.size(); ++i)
        output -= ar_[i] * outputs_[i - 1];
    if (!(std::abs(output) <= kLargestOutput)) {
        std::ranges::fill(outputs_, 0.0);
        std::ranges::fill(excitations_, 0.0);
        output = 0;
    }
    std::shift_right(outputs_.begin(), outputs_.end(), 1);
    outputs_[0] = output;
    return output;
}

double Vibration::next(double speed, double force) noexcept {
    if (!(speed > 0 && force > 0 && std::isfinite(speed) && std::isfinite(force)))
        return 0;
    if (left_ > 0) {
        --left_;
        return last_;
    }
    speed = std::min(speed, models_->largest_speed);
    force = std::min(force, models_->largest_force);
    if (!(std::abs(speed - speed_) <= kSame * speed_ && std::abs(force - force_) <= kSame * force_))
        set_filter(speed, force);
    for (std::size_t i = 0; i < steps_; ++i)
        last_ = step();
    left_ = repeats_ - 1;
    return last_;
}

} // namespace forceshade
