#include "tests/unit/loop_work.h"

#include <array>
#include <cmath>
#include <numbers>

namespace forceshade::study {
namespace {

// Abscissae and weights of Gauss-Legendre quadrature on [-1, 1], by Newton's iteration on the Legendre polynomial.
struct Quadrature {
    static constexpr std::size_t kOrder = 20;
    std::array<double, kOrder> abscissa{}, weight{};
    Quadrature() {
        for (std::size_t i = 0; i < kOrder; ++i) {
            long double x =
                std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.75L) / (kOrder + 0.5L));
            long double slope = 1;
            for (int step = 0; step < 50; ++step) {
                long double before = 1, now = x;
                for (int n = 2; n <= static_cast<int>(kOrder); ++n) {
                    const long double next = ((2 * n - 1) * x * now - (n - 1) * before) / n;
                    before = now;
                    now = next;
                }
                slope = kOrder * (x * now - before) / (x * x - 1);
                x -= now / slope;
            }
            abscissa[i] = static_cast<double>(x);
            weight[i] = static_cast<double>(2 / ((1 - x * x) * slope * slope));
        }
    }
};

// use(share of the way, weight) over [0, 1] in equal pieces.
template <typename Use> void over_nodes(Pieces pieces, const Use& use) {
    static const Quadrature quadrature;
    for (int piece = 0; piece < pieces.count; ++piece)
        for (std::size_t i = 0; i < Quadrature::kOrder; ++i)
            use((piece + 0.5 + 0.5 * quadrature.abscissa[i]) / pieces.count, 0.5 / pieces.count * quadrature.weight[i]);
}

Work share_of(double power, double weight) {
    return {weight * power, weight * std::abs(power)};
}

} // namespace

Work& operator+=(Work& sum, const Work& more) {
    sum.work += more.work;
    sum.effort += more.effort;
    return sum;
}

Work work_along(const ForceAt& force, const Vector& from, const Vector& to, Pieces pieces) {
    const Vector way = to - from;
    Work sum;
    over_nodes(pieces, [&](double share, double weight) {
        const Vector place(std::lerp(from.x, to.x, share), std::lerp(from.y, to.y, share),
                           std::lerp(from.z, to.z, share));
        sum += share_of(reference::dot(force(place), way), weight);
    });
    return sum;
}

Work work_round(const ForceAt& force, const std::vector<Vector>& corners, Pieces pieces) {
    Work sum;
    for (std::size_t i = 0; i < corners.size(); ++i)
        sum += work_along(force, corners[i], corners[(i + 1) % corners.size()], pieces);
    return sum;
}

} // namespace forceshade::study
