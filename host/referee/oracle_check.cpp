#include "host/referee/oracle_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "host/norm.h"
#include "host/referee/reading.h"
#include "host/referee/validate.h"
#include "host/reference/contact.h"

namespace forceshade {

namespace {

// Voxels compared at most: a fraction of a second on one core.
constexpr std::uint64_t kBudget = std::uint64_t(1) << 20;

} // namespace

OracleCheck::OracleCheck(const PreparedCase& prepared, bool exact_bits)
    : prepared_(prepared), exact_bits_(exact_bits),
      exact_(make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies)) {
    if (prepared.one.scene.precision == Precision::f32)
        single_ = make_tables<float>(prepared.one.scene, prepared.images, Extent::what_varies);
    const std::uint64_t voxels = std::uint64_t(exact_.x.size()) * exact_.y.size() * exact_.z.size();
    every_ = std::max<std::uint64_t>(1, (voxels + kBudget - 1) / kBudget);
}

void OracleCheck::add(const layout::FieldChunk<float>& chunk) {
    compare(chunk, *single_);
}

void OracleCheck::add(const layout::FieldChunk<double>& chunk) {
    compare(chunk, exact_);
}

// Both sides round, so the bound counts twice.
bool OracleCheck::is_beyond(const Triple& force, double off, const Triple& probe) {
    if (exact_bits_)
        return true;
    const auto [x, y, z] = probe;
    if (exact_.features.surface == layout::kSurfaceMesh) {
        Reading computed;
        computed.force = force;
        return mesh_bound().compare(computed, {x, y, z}, 1, layout::kChannelForce) == Verdict::beyond;
    }
    if (!bound_)
        bound_.emplace(prepared_, prepared_.one.scene.precision);
    return !(off <= 2 * bound_->at(x, y, z).force);
}

// Whether single precision rounded the probe, or the edge, so that it is on the other side of an edge of a surface that
// is no mesh.
bool OracleCheck::crosses_edge(const Triple& force, const Triple& truth, const Triple& exact_probe,
                               const Triple& probe) {
    constexpr double kSurely = 0x1p-18; // of the force: an error of less is no jump worth the look
    const auto apart = [](const Triple& a, const Triple& b) { return norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]); };
    if (exact_.features.surface == layout::kSurfaceMesh || !single_ ||
        !(apart(force, truth) > kSurely * norm(truth[0], truth[1], truth[2])))
        return false;
    if (!bound_)
        bound_.emplace(prepared_, prepared_.one.scene.precision);
    if (!rounded_)
        rounded_ =
            make_tables<double>(rounded_scene<float>(prepared_.one.scene), prepared_.images, Extent::what_varies);
    const auto force_at = [law = exact_.law()](const Triple& place) {
        const auto there = reference::evaluate(law, {place[0], place[1], place[2]}).force;
        return Triple{there.x, there.y, there.z};
    };
    const double allowed = bound_->at(probe[0], probe[1], probe[2]).force;
    if (apart(force, truth) <= allowed)
        return false;
    if (apart(force, force_at(probe)) <= allowed)
        return jumps_between(exact_probe, probe, force_at);
    Reading computed;
    computed.force = force;
    return is_on_edge<float>(computed, probe, OracleReferee<double>{rounded_->law()}, *bound_, 1,
                             layout::kChannelForce);
}

MeshBound& OracleCheck::mesh_bound() {
    if (!mesh_bound_)
        mesh_bound_.emplace(prepared_, prepared_.one.scene.precision);
    return *mesh_bound_;
}

template <typename T> void OracleCheck::compare(const layout::FieldChunk<T>& chunk, const FieldTables<T>& same) {
    const layout::Law<T> law = same.law();
    const layout::Law<double> exact = exact_.law();
    for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
        const std::size_t z = chunk.z_first + row / chunk.y_count, y = chunk.y_first + row % chunk.y_count;
        if ((z * exact_.y.size() + y) % every_)
            continue;
        for (std::size_t x = 0; x < chunk.x_count; ++x) {
            const T* const force = &chunk.force[3 * (row * chunk.x_pitch + x)];
            const reference::Contact<T> contact = reference::evaluate(law, {same.x[x], same.y[y], same.z[z]});
            const reference::Contact<double> exact_contact =
                reference::evaluate(exact, {exact_.x[x], exact_.y[y], exact_.z[z]});
            const reference::Vector<T>& expected = contact.force;
            const reference::Vector<double>& truth = exact_contact.force;
            const Triple computed{double(force[0]), double(force[1]), double(force[2])};
            const Triple probe{double(same.x[x]), double(same.y[y]), double(same.z[z])};
            const T bits[3] = {expected.x, expected.y, expected.z};
            if (std::memcmp(force, bits, sizeof(bits)) != 0) {
                ++error_.differing;
                const double apart = norm(double(force[0]) - double(expected.x), double(force[1]) - double(expected.y),
                                          double(force[2]) - double(expected.z));
                error_.beyond += is_beyond(computed, apart, probe);
            }
            const double off = norm(double(force[0]) - truth.x, double(force[1]) - truth.y, double(force[2]) - truth.z);
            ++error_.compared;
            error_.largest_force = std::max(error_.largest_force, norm(truth.x, truth.y, truth.z));
            if (exact_.features.surface == layout::kSurfaceMesh &&
                (contact.facet != exact_contact.facet ||
                 mesh_bound().is_ambiguous(computed, {probe[0], probe[1], probe[2]}, {truth.x, truth.y, truth.z}))) {
                ++error_.on_edge;
                continue;
            }
            if (crosses_edge(computed, {truth.x, truth.y, truth.z}, {exact_.x[x], exact_.y[y], exact_.z[z]}, probe)) {
                ++error_.on_edge;
                continue;
            }
            error_.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error_.largest, off);
        }
    }
}

} // namespace forceshade
