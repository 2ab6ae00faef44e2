#include "host/validate/path_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "host/norm.h"
#include "host/reference/hand.h"
#include "host/reference/motion.h"
#include "host/validate/excuse.h"

namespace forceshade {
namespace {

template <typename T> constexpr double kRoundoff = double(std::numeric_limits<T>::epsilon()) / 2;

/// The law, and what the device displays of it.
template <typename T> struct FeltReferee {
    OracleReferee<T> oracle;
    const layout::HandParams<T>* hand;

    reference::Column<T> column(double x, double y) const { return oracle.column(x, y); }
    Reading at(const reference::Column<T>& column, double z) const {
        reference::Contact<T> contact = reference::contact_at(oracle.law, column, static_cast<T>(z));
        if (hand)
            contact.force = reference::commanded(*hand, contact.force);
        return reading_of(contact);
    }
    static layout::uint facet(const reference::Column<T>& column) { return OracleReferee<T>::facet(column); }
};

} // namespace

template <typename T>
PathBound<T>::PathBound(const PreparedCase& prepared)
    : bound_(prepared, std::is_same_v<T, float> ? Precision::f32 : Precision::f64) {}

template <typename T> double PathBound<T>::size(const layout::PathBatch<T>& one) {
    double sum = 0;
    for (const layout::MotionParams<T>& motion : one.motions)
        for (const T length : {motion.centre_x, motion.centre_y, motion.centre_z, motion.reach, motion.across,
                               motion.depth, motion.depth_back, motion.lift})
            sum += std::abs(double(length));
    for (const T amplitude : one.amplitudes)
        sum += std::abs(double(amplitude));
    return sum;
}

template <typename T>
double PathBound<T>::place(const layout::PathFeatures& features, double size, const Triple& at) const {
    if (features.motion == layout::kMotionRecorded && features.harmonics == 0)
        return 0;
    const double off = (128.0 + 2.0 * features.harmonics) * kRoundoff<T> * size; // m
    double above = 0;
    if (features.follow == layout::kFollowSurface) {
        const layout::Law<double> law = bound_.law();
        const double height = reference::nominal_height(law, at[0]);
        for (const double x : {at[0] - off, at[0] + off})
            above = std::max(above, std::abs(reference::nominal_height(law, x) - height));
        above += bound_.at(at[0], at[1], at[2]).depth;
    }
    return 2 * (std::sqrt(3.0) * off + above);
}

template <typename T>
bool PathBound<T>::allows(const layout::Law<T>& law, const layout::HandParams<T>* hand, const Reading& felt,
                          const Triple& probe, layout::uint channels) const {
    const FeltReferee<T> referee{{law}, hand};
    const auto [x, y, z] = probe;
    const Reading truth = referee.at(referee.column(x, y), z);
    Bound displayed;
    if (hand)
        displayed.force = displayed.magnitude =
            16 * kRoundoff<T> * norm(truth.force[0], truth.force[1], truth.force[2]);
    return !first_misfit(felt, truth, 2 * bound_.at(x, y, z) + displayed, channels) ||
           is_on_edge<T>(felt, probe, referee, bound_, 2, channels);
}

template class PathBound<float>;
template class PathBound<double>;

} // namespace forceshade
