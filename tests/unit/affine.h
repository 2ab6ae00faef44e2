// Numbers that know what rounding may have made of them, to run a law's own code with: affine arithmetic (de Figueiredo
// & Stolfi 2004), which is interval arithmetic that remembers what its errors have in common. A number is its exact
// value and a sum of errors noise[i] e_i, each e_i anywhere within [-1, 1]; what is not linear in them is one more.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <random>
#include <vector>

#include "host/reference/elementary.h"

namespace forceshade::test {

// How far an operation may be off, in roundings of half an ULP, which are at most u of the result each; and what is
// handed to a law: as it is `given` (a radius, a stiffness) or `made` in double before it is rounded (a vertex, a
// slope, a normal).

/// Single precision on any device: the table of precisions in Vulkan's appendix "SPIR-V". + - * round to nearest, / is
/// good to 2.5 ULP, and sqrt is one divided by an inverse root that is good to 2.
struct VulkanRounding {
    static constexpr double sum = 1, quotient = 5, root = 9, given = 1, made = 1;
};

/// Double precision: IEEE 754.
struct IeeeRounding {
    static constexpr double sum = 1, quotient = 1, root = 1, given = 0, made = 6;
};

/// What of an evaluation is watched or left out; the same for all numbers of a thread.
struct AffineRun {
    static constexpr double kUnit = 0x1p-24;     // counted in it, factors hold in double precision too
    std::vector<std::vector<double>> noises{{}}; // of all numbers so far: numbers are places in it, as GLM wants them
    std::size_t errors = 0;
    bool rounds = true;     // else only what was handed in is off
    bool undecided = false; // rounding can turn a comparison
    bool by_chance = false; // such a comparison is drawn, as a device may decide it either way
    std::mt19937_64 random{5};

    /// Forgets all numbers.
    void begin() {
        noises.resize(1);
        errors = 0;
        undecided = false;
    }
};
inline thread_local AffineRun affine_run;

/// Volatile, because g++ 12 at -O2 turns two of these side by side into vectors and drops the rounding.
inline double single_precision(double value) {
    const volatile float result = static_cast<float>(value);
    return result;
}

template <typename Rounding> class Affine {
public:
    static constexpr double kMade = Rounding::made;

    Affine() = default;
    /// A constant of the law: one that single precision cannot hold is rounded.
    template <typename Number>
    requires std::is_arithmetic_v<Number>
    explicit Affine(Number value) : value_(static_cast<double>(value)), place_(0) {
        if (single_precision(value_) != value_)
            add_error(AffineRun::kUnit * std::abs(value_));
    }
    template <std::integral Integer> explicit operator Integer() const { return static_cast<Integer>(value_); }

    /// A value that is off by no more than this.
    static Affine off_by(double value, double error) {
        Affine result(0);
        result.value_ = value;
        result.add_error(error);
        return result;
    }
    static Affine given(double value) { return off_by(value, Rounding::given * AffineRun::kUnit * std::abs(value)); }
    static Affine made(double value) { return off_by(value, Rounding::made * AffineRun::kUnit * std::abs(value)); }

    double value() const { return value_; }
    double noise(std::size_t error) const { return error < errors() ? noise()[error] : 0; }
    std::size_t errors() const { return noise().size(); }
    double radius() const {
        double sum = 0;
        for (const double error : noise())
            sum += std::abs(error);
        return sum;
    }

    friend Affine operator-(const Affine& a) { return sum_of(-1, a, 0, a); }
    friend Affine operator+(const Affine& a, const Affine& b) {
        return a.is(0) ? b : b.is(0) ? a : sum_of(1, a, 1, b).rounded(Rounding::sum);
    }
    friend Affine operator-(const Affine& a, const Affine& b) {
        return a.is(0) ? -b : b.is(0) ? a : sum_of(1, a, -1, b).rounded(Rounding::sum);
    }
    friend Affine operator*(const Affine& a, const Affine& b) {
        if (a.is(0) || b.is(0))
            return Affine(0);
        Affine result = sum_of(b.value_, a, a.value_, b);
        result.value_ = a.value_ * b.value_;
        result.add_error(a.radius() * b.radius());
        return a.is(1) || b.is(1) ? result : result.rounded(Rounding::sum);
    }
    friend Affine operator/(const Affine& a, const Affine& b) {
        const double quotient = a.value_ / b.value_, least = std::abs(b.value_) - b.radius();
        Affine result = sum_of(1 / b.value_, a, -quotient / b.value_, b);
        result.value_ = quotient;
        // (a + A) / (b + B) - a / b is the linear part times b / (b + B).
        result.add_error(least > 0 ? result.radius() * b.radius() / least : std::numeric_limits<double>::infinity());
        return result.rounded(Rounding::quotient);
    }
    friend Affine sqrt(const Affine& a) {
        const double root = std::sqrt(a.value_), off = a.radius();
        const double low = std::sqrt(std::max(0.0, a.value_ - off)), high = std::sqrt(a.value_ + off);
        if (!(a.value_ > 0))
            return off_by(0, high);
        const double slope = 1 / (2 * root);
        Affine result = sum_of(slope, a, 0, a);
        result.value_ = root;
        result.add_error(std::max(root + off * slope - high, root - off * slope - low));
        return result.rounded(Rounding::root);
    }
    friend Affine abs(const Affine& a) { return a.value_ < 0 ? -a : a; }
    friend Affine floor(const Affine& a) {
        const double off = a.radius();
        affine_run.undecided = affine_run.undecided || std::floor(a.value_ - off) != std::floor(a.value_ + off);
        return Affine(std::floor(a.value_));
    }
    friend Affine ldexp(const Affine& a, int exponent) { return sum_of(std::ldexp(1.0, exponent), a, 0, a); }

    friend bool operator<(const Affine& a, const Affine& b) {
        const bool exact = a.value_ < b.value_;
        const double off = a.place_ == b.place_ ? 0 : sum_of(1, a, -1, b).radius();
        if (!(off > 0 && std::abs(a.value_ - b.value_) <= off))
            return exact;
        affine_run.undecided = true;
        return affine_run.by_chance ? (affine_run.random() & 1) != 0 : exact;
    }
    friend bool operator>(const Affine& a, const Affine& b) { return b < a; }
    friend bool operator<=(const Affine& a, const Affine& b) { return !(b < a); }
    friend bool operator>=(const Affine& a, const Affine& b) { return !(a < b); }
    friend bool operator==(const Affine& a, const Affine& b) { return a.value_ == b.value_; }

private:
    const std::vector<double>& noise() const { return affine_run.noises[place_]; }
    bool is_exact() const { return place_ == 0; }
    bool is(double number) const { return is_exact() && std::abs(value_) == number; }

    void add_error(double error) {
        if (!(error > 0))
            return;
        std::vector<double> more = noise();
        more.resize(affine_run.errors + 1);
        more[affine_run.errors++] = error;
        place_ = affine_run.noises.size();
        affine_run.noises.push_back(std::move(more));
    }

    // f a + g b, exactly.
    static Affine sum_of(double f, const Affine& a, double g, const Affine& b) {
        Affine result(0);
        result.value_ = f * a.value_ + g * b.value_;
        if (a.is_exact() && b.is_exact())
            return result;
        std::vector<double> sum(std::max(a.errors(), b.errors()));
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] = f * a.noise(i) + g * b.noise(i);
        result.place_ = affine_run.noises.size();
        affine_run.noises.push_back(std::move(sum));
        return result;
    }

    Affine rounded(double roundings) const {
        Affine result = *this;
        if (affine_run.rounds)
            result.add_error(roundings * AffineRun::kUnit * (std::abs(value_) + radius()));
        return result;
    }

    double value_;
    std::size_t place_;
};

/// How far a vector may be from `exact`.
template <typename Rounding>
double error_of(const reference::Vector<Affine<Rounding>>& v, const reference::Vector<double>& exact) {
    const double x = v.x.radius(), y = v.y.radius(), z = v.z.radius();
    double sum = 0;
    for (std::size_t i = 0; i < std::max({v.x.errors(), v.y.errors(), v.z.errors()}); ++i)
        sum += std::hypot(v.x.noise(i), v.y.noise(i), v.z.noise(i));
    return std::min(std::hypot(x, y, z), sum) +
           std::hypot(v.x.value() - exact.x, v.y.value() - exact.y, v.z.value() - exact.z);
}

} // namespace forceshade::test

/// Of single precision.
template <typename Rounding>
struct std::numeric_limits<forceshade::test::Affine<Rounding>> : std::numeric_limits<float> {
    static forceshade::test::Affine<Rounding> min() { return forceshade::test::Affine<Rounding>(0x1p-126); }
    static forceshade::test::Affine<Rounding> epsilon() { return forceshade::test::Affine<Rounding>(0x1p-23); }
};
