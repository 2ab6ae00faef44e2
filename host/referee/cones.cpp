#include "host/referee/cones.h"

#include <array>
#include <limits>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

namespace forceshade {

namespace {

using Real = long double;
constexpr Real kDependent = 1e-13L; // length of a unit vector off the span of others, below which it depends on them
constexpr int kMostRounds = 200;    // a few are needed; rounding could go round for ever

// The shares of the columns whose sum is nearest to a target; false if the last column depends on the others.
template <int N, std::size_t Most>
bool least_squares(const std::vector<glm::vec<N, Real>>& columns, const glm::vec<N, Real>& target,
                   std::array<Real, Most>& shares) {
    std::array<glm::vec<N, Real>, Most> axes;
    std::array<std::array<Real, Most>, Most> parts{};
    for (std::size_t i = 0; i < columns.size(); ++i) {
        axes[i] = columns[i];
        for (int twice = 0; twice < 2; ++twice)
            for (std::size_t j = 0; j < i; ++j) {
                const Real part = glm::dot(axes[j], axes[i]);
                parts[j][i] += part;
                axes[i] -= part * axes[j];
            }
        parts[i][i] = glm::length(axes[i]);
        if (!(parts[i][i] > kDependent))
            return false;
        axes[i] /= parts[i][i];
    }
    for (std::size_t i = columns.size(); i-- > 0;) {
        shares[i] = glm::dot(axes[i], target);
        for (std::size_t j = i + 1; j < columns.size(); ++j)
            shares[i] -= parts[i][j] * shares[j];
        shares[i] /= parts[i][i];
    }
    return true;
}

// What a target leaves of itself off the cone that columns span.
template <int N>
glm::vec<N, Real> off_cone(const std::vector<glm::vec<N, Real>>& columns, const glm::vec<N, Real>& target) {
    constexpr std::size_t kMost = N + 1;
    std::vector<glm::vec<N, Real>> active;
    std::array<Real, kMost> held{}, wanted{};
    glm::vec<N, Real> left = target;
    for (int round = 0; round < kMostRounds; ++round) {
        const auto steepest = std::ranges::max_element(
            columns, {}, [&](const glm::vec<N, Real>& column) { return glm::dot(column, left); });
        if (steepest == columns.end() || !(glm::dot(*steepest, left) > 1e-15L * glm::length(target)))
            break;
        active.push_back(*steepest);
        held[active.size() - 1] = 0;
        if (active.size() == kMost || !least_squares(active, target, wanted))
            break;
        for (;;) {
            Real step = 1;
            for (std::size_t i = 0; i < active.size(); ++i)
                if (wanted[i] <= 0)
                    step = std::min(step, held[i] / (held[i] - wanted[i]));
            std::size_t kept = 0;
            for (std::size_t i = 0; i < active.size(); ++i) {
                const Real share = held[i] + step * (wanted[i] - held[i]);
                if (step < 1 && wanted[i] <= 0 && !(share > 1e-18L))
                    continue;
                active[kept] = active[i];
                held[kept++] = share;
            }
            active.resize(kept);
            if (step == 1 || !least_squares(active, target, wanted))
                break;
        }
        left = target;
        for (std::size_t i = 0; i < active.size(); ++i)
            left -= held[i] * active[i];
    }
    return left;
}

} // namespace

double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans) {
    return double(glm::length(off_cone<3>({spans.begin(), spans.end()}, glm::vec<3, Real>(vector))));
}

double distance_of_offset_planes(std::span<const glm::dvec3> normals) {
    std::vector<glm::vec<4, Real>> columns;
    for (const glm::dvec3& normal : normals)
        columns.emplace_back(glm::vec<3, Real>(normal), 1);
    const glm::vec<4, Real> left = off_cone<4>(columns, {0, 0, 0, 1});
    return left.w > 1e-15L ? double(glm::length(glm::vec<3, Real>(left)) / left.w)
                           : std::numeric_limits<double>::infinity();
}

} // namespace forceshade
