#include "tests/unit/laws.h"

#include <cmath>

namespace forceshade::test {
namespace {

// Abscissae and weights of Gauss-Legendre quadrature, by Newton's iteration on the Legendre polynomial.
struct Quadrature {
    static constexpr int kOrder = 20;
    std::array<double, kOrder> abscissa{}, weight{};
    Quadrature() {
        for (int i = 0; i < kOrder; ++i) {
            long double x = std::cos(3.14159265358979323846L * (i + 0.75L) / (kOrder + 0.5L)), slope = 1;
            for (int step = 0; step < 50; ++step) {
                long double before = 1, now = x;
                for (int n = 2; n <= kOrder; ++n) {
                    const long double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
                    before = now;
                    now = next;
                }
                slope = kOrder * (x * now - before) / (x * x - 1);
                x -= now / slope;
            }
            abscissa[std::size_t(i)] = double(x);
            weight[std::size_t(i)] = double(2 / ((1 - x * x) * slope * slope));
        }
    }
};

template <typename Integrand>
double integrate(const OwnedLaw<double>& law, Point a, Point b, int pieces, const Integrand& integrand) {
    static const Quadrature quadrature;
    double sum = 0;
    for (int piece = 0; piece < pieces; ++piece)
        for (int i = 0; i < Quadrature::kOrder; ++i) {
            const double t = (piece + 0.5 + 0.5 * quadrature.abscissa[std::size_t(i)]) / pieces;
            const auto force = law(std::lerp(a.x, b.x, t), 0, std::lerp(a.z, b.z, t)).force;
            sum += 0.5 / pieces * quadrature.weight[std::size_t(i)] *
                   integrand(force.x * (b.x - a.x) + force.z * (b.z - a.z));
        }
    return sum;
}

} // namespace

double work(const OwnedLaw<double>& law, Point a, Point b, int pieces) {
    return integrate(law, a, b, pieces, [](double power) { return power; });
}

double turnover(const OwnedLaw<double>& law, Point a, Point b, int pieces) {
    return integrate(law, a, b, pieces, [](double power) { return std::abs(power); });
}

} // namespace forceshade::test
