#include "host/mesh/exact_cross.h"

#include <array>

#include <CGAL/Exact_rational.h>

namespace forceshade {
namespace {

using Rational = CGAL::Exact_rational;
using RationalVector = std::array<Rational, 3>;

RationalVector difference(const glm::dvec3& a, const glm::dvec3& b) {
    return {Rational(a.x) - Rational(b.x), Rational(a.y) - Rational(b.y), Rational(a.z) - Rational(b.z)};
}

} // namespace

glm::dvec3 exact_cross_direction(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const RationalVector u = difference(b, a), v = difference(c, a);
    RationalVector cross;
    Rational largest(0);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        cross[i] = u[j] * v[k] - u[k] * v[j];
        const Rational size = CGAL::abs(cross[i]);
        if (size > largest)
            largest = size;
    }
    if (largest == 0)
        return glm::dvec3(0);
    return {CGAL::to_double(Rational(cross[0] / largest)), CGAL::to_double(Rational(cross[1] / largest)),
            CGAL::to_double(Rational(cross[2] / largest))};
}

} // namespace forceshade
