#include "host/referee/oracle_check.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/geometric.hpp>

#include "host/norm.h"
#include "host/random.h"
#include "host/referee/validate.h"
#include "host/reference/chunks.h"
#include "host/reference/contact.h"

namespace forceshade {

namespace {

// Voxels of a kind, so that a check takes about a tenth of a second on one core.
constexpr std::size_t kOfMesh = 1024, kOfOthers = 16384;
// Voxels that these are drawn from: looking at one takes some nanoseconds.
constexpr double kLookedAt = 0x1p21;
constexpr double kJump = 0.02; // rad: of the direction between neighbours along x

// What a referee of one thread needs; bounds are made when they are first asked for.
class VoxelReferee {
public:
    VoxelReferee(const PreparedCase& prepared, bool exact_bits, const CaseLaw<double>& exact, bool single)
        : prepared_(prepared), exact_bits_(exact_bits), single_(single),
          mesh_(exact.law().features.surface == layout::kSurfaceMesh), law_(exact) {}

    // Both sides round, so the bound counts twice.
    bool is_beyond(const glm::dvec3& force, double off, const glm::dvec3& probe) {
        if (exact_bits_)
            return true;
        if (!mesh_)
            return !(off <= 2 * bound().at(probe.x, probe.y, probe.z).force);
        Reading computed;
        computed.force = force;
        return mesh_bound().compare(computed, probe, 1, layout::kChannelForce) == Verdict::beyond;
    }

    // Whether an error is meaningless: rounding chose another facet of a mesh, or took the probe, or an edge, so that
    // it is on the other side of an edge.
    bool is_on_edge(const glm::dvec3& force, const glm::dvec3& truth, const glm::dvec3& exact_probe,
                    const glm::dvec3& probe) {
        if (mesh_)
            return mesh_bound().is_ambiguous(force, probe, truth);
        constexpr double kSurely = 0x1p-18; // of the force: a smaller error is not a jump
        if (!single_ || !(norm(force - truth) > kSurely * norm(truth)))
            return false;
        const double allowed = bound().at(probe.x, probe.y, probe.z).force;
        if (norm(force - truth) <= allowed)
            return false;
        const auto force_at = [&](const glm::dvec3& place) { return law_.at(place).force; };
        if (norm(force - force_at(probe)) <= allowed)
            return jumps_between(exact_probe, probe, force_at);
        if (!rounded_)
            rounded_ =
                make_tables<double>(rounded_scene<float>(prepared_.one.scene), prepared_.images, Extent::nothing);
        Reading computed;
        computed.force = force;
        return forceshade::is_on_edge<float>(computed, probe, OracleReferee<double>{rounded_->law()}, bound(), 1,
                                             layout::kChannelForce);
    }

private:
    const RoundingBound& bound() {
        if (!bound_)
            bound_.emplace(prepared_, prepared_.one.scene.precision);
        return *bound_;
    }
    const MeshBound& mesh_bound() {
        if (!mesh_bound_)
            mesh_bound_.emplace(prepared_, prepared_.one.scene.precision);
        return *mesh_bound_;
    }

    const PreparedCase& prepared_;
    const bool exact_bits_, single_, mesh_;
    const CaseLaw<double>& law_;
    std::optional<RoundingBound> bound_;
    std::optional<MeshBound> mesh_bound_;
    std::optional<FieldTables<double>> rounded_; // of the scene as single precision holds it
};

} // namespace

OracleCheck::OracleCheck(const PreparedCase& prepared, bool exact_bits)
    : prepared_(prepared), exact_bits_(exact_bits), exact_(prepared, Extent::what_varies),
      most_(exact_.law().features.surface == layout::kSurfaceMesh ? kOfMesh : kOfOthers) {
    if (prepared.one.scene.precision == Precision::f32)
        single_.emplace(prepared, Extent::what_varies);
    const FieldTables<double>& grid = exact_.tables();
    touched_.resize(grid.x.size() * grid.y.size());
    const double voxels = static_cast<double>(touched_.size()) * static_cast<double>(grid.z.size());
    last_row_ = static_cast<std::uint64_t>(0x1p63 * std::min(1.0, kLookedAt / voxels));
}

void OracleCheck::keep(VoxelKind kind, const Voxel& voxel) {
    std::vector<Voxel>& heap = drawn_[static_cast<std::size_t>(kind)];
    if (heap.size() == most_) {
        if (!(voxel < heap.front()))
            return;
        std::pop_heap(heap.begin(), heap.end());
        heap.pop_back();
    }
    heap.push_back(voxel);
    std::push_heap(heap.begin(), heap.end());
}

// Whether voxels of a row, counted in the order of the grid, are drawn: of large grids some rows are enough.
bool OracleCheck::draws_from(std::size_t row) const {
    return Random(row).word() >> 1 <= last_row_;
}

// Neighbours are looked up on both sides along x, and towards lower y and z.
template <typename T> void OracleCheck::add(const layout::FieldChunk<T>& chunk) {
    const T least = static_cast<T>(std::cos(kJump) * std::cos(kJump));
    const std::size_t y_rows = exact_.tables().y.size(), x_count = chunk.x_count;
    for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
        const std::size_t z = chunk.z_first + row / chunk.y_count, y = chunk.y_first + row % chunk.y_count;
        const std::size_t number = z * y_rows + y;
        const T* const forces = &chunk.force[3 * row * chunk.x_pitch];
        const auto force_at = [&](std::size_t x) {
            return glm::vec<3, T>(forces[3 * x], forces[3 * x + 1], forces[3 * x + 2]);
        };
        char* const touched = &touched_[y * x_count];
        if (!draws_from(number)) {
            if ((y + 1 < y_rows && draws_from(number + 1)) || draws_from(number + y_rows))
                for (std::size_t x = 0; x < x_count; ++x)
                    touched[x] = !(glm::dot(force_at(x), force_at(x)) == 0);
            continue;
        }
        const char* const previous_row = y > 0 ? touched - x_count : touched;
        glm::vec<3, T> force = force_at(0);
        T square = glm::dot(force, force);
        VoxelKind before = square == 0 ? VoxelKind::free : VoxelKind::inside;
        for (std::size_t x = 0; x < x_count; ++x) {
            const glm::vec<3, T> next = force_at(std::min(x + 1, x_count - 1));
            const T next_square = glm::dot(next, next), along = glm::dot(force, next);
            const bool touches = !(square == 0);
            VoxelKind after = touches ? VoxelKind::inside : VoxelKind::free;
            if (touches != !(next_square == 0))
                after = VoxelKind::boundary;
            else if (touches && !(along >= 0 && along * along >= least * square * next_square))
                after = VoxelKind::jump;
            VoxelKind kind = touches ? VoxelKind::inside : VoxelKind::free;
            if (before == VoxelKind::boundary || after == VoxelKind::boundary ||
                (z > 0 && touches != (touched[x] != 0)) || (y > 0 && touches != (previous_row[x] != 0)))
                kind = VoxelKind::boundary;
            else if (before == VoxelKind::jump || after == VoxelKind::jump)
                kind = VoxelKind::jump;
            touched[x] = touches;
            keep(kind, {Random(number * x_count + x).word(),
                        {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(z)},
                        glm::dvec3(force)});
            before = after;
            force = next;
            square = next_square;
        }
    }
}

template void OracleCheck::add<float>(const layout::FieldChunk<float>&);
template void OracleCheck::add<double>(const layout::FieldChunk<double>&);

template <typename T>
OracleError OracleCheck::compare_some(std::span<const Voxel> voxels, const CaseLaw<T>& same) const {
    OracleError error;
    VoxelReferee referee(prepared_, exact_bits_, exact_, single_.has_value());
    layout::uint same_hint = 0, exact_hint = 0;
    for (const Voxel& voxel : voxels) {
        const auto [x, y, z] = voxel.at;
        const reference::Vector<T> probe = same.voxel(x, y, z);
        const glm::dvec3 exact_probe = exact_.voxel(x, y, z);
        const reference::Contact<T> contact = same.at_rounded(probe, same_hint);
        const reference::Contact<double> exact_contact = exact_.at_rounded(exact_probe, exact_hint);
        const glm::dvec3 &force = voxel.force, &truth = exact_contact.force;
        const T stored[3] = {static_cast<T>(force.x), static_cast<T>(force.y), static_cast<T>(force.z)};
        const T bits[3] = {contact.force.x, contact.force.y, contact.force.z};
        if (std::memcmp(stored, bits, sizeof(bits)) != 0) {
            ++error.differing;
            error.beyond += referee.is_beyond(force, norm(force - glm::dvec3(contact.force)), glm::dvec3(probe));
        }
        ++error.compared;
        error.largest_force = std::max(error.largest_force, norm(truth));
        const double off = norm(force - truth);
        const bool other_facet =
            same.law().features.surface == layout::kSurfaceMesh && contact.facet != exact_contact.facet;
        if (other_facet || referee.is_on_edge(force, truth, exact_probe, glm::dvec3(probe)))
            ++error.on_edge;
        else
            error.largest = std::isnan(off) ? std::numeric_limits<double>::infinity() : std::max(error.largest, off);
    }
    return error;
}

OracleError OracleCheck::compare(unsigned threads) const {
    std::vector<Voxel> voxels;
    for (const std::vector<Voxel>& some : drawn_)
        voxels.insert(voxels.end(), some.begin(), some.end());
    std::sort(voxels.begin(), voxels.end()); // so that threads share the kinds evenly
    std::vector<OracleError> errors(std::max(1u, threads));
    reference::share_out(errors.size(), errors.size(), [&](std::size_t, std::size_t share) {
        const std::size_t from = voxels.size() * share / errors.size(),
                          to = voxels.size() * (share + 1) / errors.size();
        const std::span<const Voxel> some = std::span(voxels).subspan(from, to - from);
        errors[share] = single_ ? compare_some(some, *single_) : compare_some(some, exact_);
    });
    OracleError all;
    for (const OracleError& one : errors) {
        all.compared += one.compared;
        all.differing += one.differing;
        all.beyond += one.beyond;
        all.on_edge += one.on_edge;
        all.largest = std::max(all.largest, one.largest);
        all.largest_force = std::max(all.largest_force, one.largest_force);
    }
    return all;
}

} // namespace forceshade
