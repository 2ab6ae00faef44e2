// What both examples need of a triangle.
#pragma once

#include <algorithm>
#include <cmath>

#include "forceshade_renderer.h"

struct Vec {
    double x, y, z;
};
inline Vec operator+(Vec a, Vec b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec operator-(Vec a, Vec b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec operator*(double s, Vec a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline double dot(Vec a, Vec b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Vec cross(Vec a, Vec b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec a) {
    return std::sqrt(dot(a, a));
}

struct Triangle {
    Vec a, b, c;
};

inline Triangle triangle_of(const fsr_scene& scene, std::size_t i) {
    const auto corner = [&](int k) {
        const double* v = scene.vertices + 3 * std::size_t(scene.corners[3 * i + std::size_t(k)]);
        return Vec{v[0], v[1], v[2]};
    };
    return {corner(0), corner(1), corner(2)};
}

inline Vec unit_normal(const Triangle& t) {
    const Vec n = cross(t.b - t.a, t.c - t.a);
    return (1 / length(n)) * n;
}

// The place of a triangle nearest to p (Ericson 2005, 5.1.5).
inline Vec nearest(const Triangle& t, Vec p) {
    const Vec ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0)
        return t.a;
    const Vec bp = p - t.b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3)
        return t.b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0)
        return t.a + d1 / (d1 - d3) * ab;
    const Vec cp = p - t.c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6)
        return t.c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0)
        return t.a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
        return t.b + (d4 - d3) / (d4 - d3 + (d5 - d6)) * (t.c - t.b);
    const double whole = 1 / (va + vb + vc);
    return t.a + vb * whole * ab + vc * whole * ac;
}
