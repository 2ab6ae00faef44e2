// A single-precision device that rounds as badly as Vulkan lets it, or worse, to run a law's own code with.
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <random>
#include <type_traits>

namespace forceshade::test {

/// How far a division and an inverse root are from the nearest number, to either side, in ULP. Vulkan allows 2.5 and 2,
/// half of one of which is rounding.
struct EmulatedDevice {
    int quotient = 2, inverse_root = 1;
    std::mt19937_64 random{11};

    /// Numbers below the smallest normal one are 0.
    float stepped(double exact, int steps) {
        float value = static_cast<float>(exact);
        const float towards = random() & 1 ? INFINITY : -INFINITY;
        for (int i = 0; i < steps; ++i)
            value = std::nextafter(value, towards);
        return std::abs(value) < std::numeric_limits<float>::min() ? 0.0f : value;
    }
};
inline thread_local EmulatedDevice emulated_device;

class Emulated {
public:
    Emulated() = default;
    template <typename Number>
    requires std::is_arithmetic_v<Number>
    explicit Emulated(Number value) : value_(emulated_device.stepped(static_cast<double>(value), 0)) {}
    template <typename Number>
    requires std::is_arithmetic_v<Number>
    explicit operator Number() const { return static_cast<Number>(value_); }
    static Emulated given(double value) { return Emulated(value); }
    static Emulated made(double value) { return Emulated(value); }

    friend Emulated operator-(Emulated a) { return Emulated(-a.value_); }
    friend Emulated operator+(Emulated a, Emulated b) { return Emulated(a.value_ + b.value_); }
    friend Emulated operator-(Emulated a, Emulated b) { return Emulated(a.value_ - b.value_); }
    friend Emulated operator*(Emulated a, Emulated b) { return Emulated(a.value_ * b.value_); }
    friend Emulated operator/(Emulated a, Emulated b) {
        return Emulated(emulated_device.stepped(double(a.value_) / double(b.value_), emulated_device.quotient));
    }
    friend Emulated sqrt(Emulated a) {
        if (!(a.value_ > 0))
            return Emulated(std::sqrt(a.value_));
        return Emulated(1) /
               Emulated(emulated_device.stepped(1 / std::sqrt(double(a.value_)), emulated_device.inverse_root));
    }
    friend Emulated abs(Emulated a) { return Emulated(std::abs(a.value_)); }
    friend Emulated floor(Emulated a) { return Emulated(std::floor(a.value_)); }
    friend Emulated ldexp(Emulated a, int exponent) { return Emulated(std::ldexp(a.value_, exponent)); }
    friend auto operator<=>(Emulated a, Emulated b) { return a.value_ <=> b.value_; }
    friend bool operator==(Emulated a, Emulated b) { return a.value_ == b.value_; }

private:
    float value_;
};

} // namespace forceshade::test

template <> struct std::numeric_limits<forceshade::test::Emulated> : std::numeric_limits<float> {
    static forceshade::test::Emulated min() { return forceshade::test::Emulated(0x1p-126f); }
    static forceshade::test::Emulated epsilon() { return forceshade::test::Emulated(0x1p-23f); }
};
