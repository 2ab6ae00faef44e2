// Vectors of the oracle. Products are written out from left to right, as the kernels have them: GLM's dot and
// normalize round otherwise.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include <glm/vec3.hpp>

namespace forceshade::reference {

// A number type of one's own, as the tests have, brings its own.
using std::abs, std::floor, std::ldexp, std::sqrt;

template <typename T> using Vector = glm::vec<3, T>;

template <typename T> [[gnu::always_inline]] inline T dot(const Vector<T>& u, const Vector<T>& v) noexcept {
    return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <typename T> [[gnu::always_inline]] inline Vector<T> cross(const Vector<T>& u, const Vector<T>& v) noexcept {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// v / |v|; 0 where v.v is not above 0.
template <typename T> Vector<T> normalised(const Vector<T>& v) noexcept {
    const T square = dot(v, v);
    if (!(square > T(0)))
        return Vector<T>(T(0));
    const T length = sqrt(square);
    return {v.x / length, v.y / length, v.z / length};
}

/// The vector that stands at `index` in a table of three numbers each.
template <typename T>
[[gnu::always_inline]] inline Vector<T> vector_at(std::span<const T> table, std::size_t index) noexcept {
    return {table[3 * index], table[3 * index + 1], table[3 * index + 2]};
}

template <typename T> T largest_coordinate(const Vector<T>& v) noexcept {
    const T x = abs(v.x), y = abs(v.y), z = abs(v.z);
    const T xy = x > y ? x : y;
    return xy > z ? xy : z;
}

template <typename T> bool is_finite(const Vector<T>& v) noexcept {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Goes on with a hash, word by word, as shaders/laws/elementary.glsl does.
inline std::uint32_t hashed(std::uint32_t hash, std::uint32_t word) noexcept {
    return std::rotl(hash ^ word, 13) * 16777619u;
}

template <typename T> std::uint32_t hashed(std::uint32_t hash, const Vector<T>& v) noexcept {
    static_assert(sizeof(T) == 4 || sizeof(T) == 8);
    for (int i = 0; i < 3; ++i)
        for (const std::uint32_t word : std::bit_cast<std::array<std::uint32_t, sizeof(T) / 4>>(v[i]))
            hash = hashed(hash, word);
    return hash;
}

/// A number in one word.
inline std::uint32_t folded(float value) noexcept {
    return std::bit_cast<std::uint32_t>(value);
}
inline std::uint32_t folded(double value) noexcept {
    const auto words = std::bit_cast<std::array<std::uint32_t, 2>>(value);
    return words[0] * 2246822519u + words[1];
}

/// sqrt(v . v), rounded as the kernels do it: overflows where v . v does.
template <typename T> T length(const Vector<T>& v) noexcept {
    return sqrt(dot(v, v));
}

/// The angle between two vectors of any length but 0, rad; good however small it is.
inline double angle_between(const Vector<double>& u, const Vector<double>& v) noexcept {
    return std::atan2(length(cross(u, v)), dot(u, v));
}

// G1: the reference cylinder, step for step as shaders/laws/elementary.glsl.

/// sqrt(R^2 - x^2), m: how far the circle stands above its axis at x, |x| <= R.
template <typename T> T circle_rise(T radius, T x) noexcept {
    return sqrt((radius - x) * (radius + x));
}

/// G1: U(x), m, the cylinder above the nominal plane; 0 for |x| >= a. `centre_depth` is sqrt((R-a)(R+a)), m.
template <typename T> T cylinder_height(T half_width, T radius, T centre_depth, T x) noexcept {
    const T product = (half_width - x) * (half_width + x);
    if (!(product > T(0)))
        return T(0);
    return product / (circle_rise(radius, x) + centre_depth);
}

/// The same from R and a alone.
template <typename T> T cylinder_height(T half_width, T radius, T x) noexcept {
    return cylinder_height(half_width, radius, circle_rise(radius, half_width), x);
}

// cos and exp out of + - * and exact steps only, step for step as shaders/laws/elementary.glsl.

/// Coefficients of sin(2 pi s) / s in powers of s^2, the highest first: (2 pi)^23 / 23! and so on, signs alternating.
inline constexpr std::array<double, 12> kSineSeries{
    -8.823533599243006e-05, 0.0011309237482517963, -0.012031585942120627, 0.10422916220813984,
    -0.7181223017785006,    3.819952584848282,     -15.09464257682299,    42.058693944897655,
    -76.70585975306139,     81.60524927607506,     -41.34170224039976,    6.283185307179586};

/// Of exp, the highest first: 1 / 14! and so on.
inline constexpr std::array<double, 15> kExponentialSeries{1.1470745597729725e-11,
                                                           1.6059043836821613e-10,
                                                           2.08767569878681e-09,
                                                           2.505210838544172e-08,
                                                           2.755731922398589e-07,
                                                           2.7557319223985893e-06,
                                                           2.48015873015873e-05,
                                                           0.0001984126984126984,
                                                           0.001388888888888889,
                                                           0.008333333333333333,
                                                           0.041666666666666664,
                                                           0.16666666666666666,
                                                           0.5,
                                                           1.0,
                                                           1.0};

/// With so many terms left out, the two give the same bits in single precision for every argument.
template <typename T> inline constexpr std::size_t kLeftOut = std::is_same_v<T, float> ? 3 : 0;

/// The sum of a series from the coefficient `first` on.
template <std::size_t first, typename T, std::size_t n>
T sum_of_series(const std::array<double, n>& series, T argument) noexcept {
    T sum = T(series[first]);
    for (std::size_t i = first + 1; i < n; ++i)
        sum = sum * argument + T(series[i]);
    return sum;
}

/// cos(2 pi turns), within a few ULP of 1. The argument is reduced to a quarter turn exactly.
template <typename T, std::size_t first = kLeftOut<T>> T cosine_of_turns(T turns) noexcept {
    const T folded = abs(turns - floor(turns + T(0.5)));
    const T s = T(0.25) - folded;
    return sum_of_series<first>(kSineSeries, s * s) * s;
}

/// exp(-u) for u >= 0; 0 where the result would be no normal number, and for u infinite.
template <typename T, std::size_t first = kLeftOut<T>> T exponential_decay(T u) noexcept {
    constexpr bool kDouble = std::is_same_v<T, double>;
    constexpr double kLargest = kDouble ? 708.0 : 87.0;
    constexpr double kLn2High = kDouble ? 0.693147180559663 : 0.693115234375;
    constexpr double kLn2Low = kDouble ? 2.8235290563031577e-13 : 3.1946184945309415e-05;
    if (!(u < T(kLargest)))
        return T(0);
    const T k = floor(u * T(1.4426950408889634) + T(0.5));
    const T r = (k * T(kLn2High) - u) + k * T(kLn2Low);
    return sum_of_series<first>(kExponentialSeries, r) * ldexp(T(1), -static_cast<int>(k));
}

} // namespace forceshade::reference
