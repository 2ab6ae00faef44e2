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
bool OracleCheck::is_beyond(const glm::dvec3& force, double off, const glm::dvec3& probe) {
    if (exact_bits_)
        return true;
    if (exact_.features.surface == layout::kSurfaceMesh) {
        Reading computed;
        computed.force = force;
        return mesh_bound().compare(computed, probe, 1, layout::kChannelForce) == Verdict::beyond;
    }
    if (!bound_)
        bound_.emplace(prepared_, prepared_.one.scene.precision);
    return !(off <= 2 * bound_->at(probe.x, probe.y, probe.z).force);
}

// Whether single precision rounded the probe, or the edge, so that it is on the other side of an edge of a surface that
// is no mesh.
bool OracleCheck::crosses_edge(const glm::dvec3& force, const glm::dvec3& truth, const glm::dvec3& exact_probe,
                               const glm::dvec3& probe) {
    constexpr double kSurely = 0x1p-18; // of the force: an error of less is no jump worth the look
    if (exact_.features.surface == layout::kSurfaceMesh || !single_ || !(norm(force - truth) > kSurely * norm(truth)))
        return false;
    if (!bound_)
        bound_.emplace(prepared_, prepared_.one.scene.precision);
    if (!rounded_)
        rounded_ =
            make_tables<double>(rounded_scene<float>(prepared_.one.scene), prepared_.images, Extent::what_varies);
    const auto force_at = [law = exact_.law()](const glm::dvec3& place) {
        return reference::evaluate(law, place).force;
    };
    const double allowed = bound_->at(probe.x, probe.y, probe.z).force;
    if (norm(force - truth) <= allowed)
        return false;
    if (norm(force - force_at(probe)) <= allowed)
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
            const glm::vec<3, T> probe(same.x[x], same.y[y], same.z[z]);
            const glm::dvec3 exact_probe(exact_.x[x], exact_.y[y], exact_.z[z]);
            const reference::Contact<T> contact = reference::evaluate(law, probe);
            const reference::Contact<double> exact_contact = reference::evaluate(exact, exact_probe);
            const T* const stored = &chunk.force[3 * (row * chunk.x_pitch + x)];
            const glm::dvec3 force(stored[0], stored[1], stored[2]), &truth = exact_contact.force;
            const T bits[3] = {contact.force.x, contact.force.y, contact.force.z};
            if (std::memcmp(stored, bits, sizeof(bits)) != 0) {
                ++error_.differing;
                error_.beyond += is_beyond(force, norm(force - glm::dvec3(contact.force)), glm::dvec3(probe));
            }
            const double off = norm(force - truth);
            ++error_.compared;
            error_.largest_force = std::max(error_.largest_force, norm(truth));
            if (exact_.features.surface == layout::kSurfaceMesh &&
                (contact.facet != exact_contact.facet || mesh_bound().is_ambiguous(force, glm::dvec3(probe), truth)))
                ++error_.on_edge;
            else if (crosses_edge(force, truth, exact_probe, glm::dvec3(probe)))
                ++error_.on_edge;
            else
                error_.largest =
                    std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error_.largest, off);
        }
    }
}

} // namespace forceshade
