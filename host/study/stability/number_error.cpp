#include "host/study/stability/number_error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "host/error.h"
#include "host/prepare/prepared_case.h"
#include "host/referee/mesh_referee.h"
#include "host/referee/referee.h"
#include "host/referee/rounding_bound.h"
#include "host/reference/contact.h"
#include "host/reference/god_object.h"
#include "host/study/error_time/angle.h"

namespace forceshade::study {
namespace {

using Vector = reference::Vector<double>;
using Forces = std::vector<Vector>;
using ForceOf = std::function<Vector(const Vector& place)>;

constexpr double kWeak = 1e-3; /* of the largest force: less has no direction to speak of */
constexpr double kOff = 1e-6;
constexpr double kAlike = 1e-12; /* of the largest force: neighbours that differ by less are a period apart */

template <typename T> Forces evaluated(Engine& engine, const PreparedCase& prepared) {
    const FieldTables<T> tables = make_tables<T>(prepared.one.scene, prepared.images, Extent::everything);
    const layout::FieldInput<T> input = tables.input();
    Forces forces(input.x.size() * input.z.size());
    engine.evaluate(input, [&](const layout::FieldChunk<T>& chunk) {
        for (std::size_t k = 0; k < chunk.z_count; ++k)
            for (std::size_t i = 0; i < chunk.x_count; ++i)
                forces[(chunk.z_first + k) * chunk.x_count + i] =
                    Vector(reference::vector_at(chunk.force, k * chunk.y_count * chunk.x_pitch + i));
    });
    return forces;
}

/// Voxel by voxel, x fastest, then z.
std::vector<Vector> voxels_of(const PreparedCase& prepared) {
    const GridSpec& grid = prepared.one.scene.grid;
    std::vector<Vector> places;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        for (std::size_t i = 0; i < grid.size[0]; ++i)
            places.emplace_back(grid.origin[0] + grid.spacing[0] * static_cast<double>(i), grid.origin[1],
                                grid.origin[2] + grid.spacing[2] * static_cast<double>(k));
    return places;
}

Forces true_forces(const PreparedCase& home, const ForceOf& force) {
    Forces forces;
    for (const Vector& place : voxels_of(home))
        forces.push_back(force(place));
    return forces;
}

Forces by_oracle(const PreparedCase& home) {
    const FieldTables<double> tables = make_tables<double>(home.one.scene, home.images, Extent::everything);
    const layout::Law<double> law = tables.law();
    return true_forces(home, [&](const Vector& place) {
        const bool mesh = law.features.surface == layout::kSurfaceMesh;
        return reference::evaluate(law, mesh ? reference::to_mesh_frame(law.mesh.params, place) : place).force;
    });
}

Vector vector_of(const brute::Answer& answer) {
    return {static_cast<double>(answer.force[0]), static_cast<double>(answer.force[1]),
            static_cast<double>(answer.force[2])};
}

Forces by_referee(const PreparedCase& home) {
    if (home.images.mesh) {
        brute::MeshLaw law;
        law.stiffness = home.one.scene.force.stiffness;
        law.shading = brute::MeshShading::mean_value;
        const brute::MeshReferee referee(home.images.mesh->mesh, law);
        return true_forces(home, [&](const Vector& place) { return vector_of(referee.at(place)); });
    }
    const brute::Referee referee(home.one.scene, home.images);
    std::optional<brute::Column> column; // finding it loops over all facets
    Forces forces;
    const std::size_t columns = home.one.scene.grid.size[0];
    const std::vector<Vector> places = voxels_of(home);
    forces.resize(places.size());
    for (std::size_t i = 0; i < columns; ++i) {
        column = referee.column(places[i].x, places[i].y);
        for (std::size_t at = i; at < places.size(); at += columns)
            forces[at] = vector_of(referee.at(*column, places[at].z));
    }
    return forces;
}

/// Sums over the fields of a case, in N.
struct Sums {
    double largest = 0, off = 0, step = 0, step_off = -1, bound = 0;
    std::size_t voxels = 0;
    std::vector<double> all_off;
};

void add_field(const Forces& found, const Forces& truth, std::size_t columns, Sums& sums) {
    for (std::size_t at = 0; at < found.size(); ++at) {
        const double off = reference::length(found[at] - truth[at]);
        sums.largest = std::max(sums.largest, reference::length(truth[at]));
        sums.off = std::isfinite(off) ? std::max(sums.off, off) : std::numeric_limits<double>::infinity();
        sums.all_off.push_back(off);
        if (at % columns == 0)
            continue;
        const Vector step = truth[at] - truth[at - 1];
        sums.step = std::max(sums.step, reference::length(step));
        sums.step_off = std::max(sums.step_off, reference::length(found[at] - found[at - 1] - step));
    }
}

double turned(const Forces& found, const Forces& truth, double largest) {
    double most = 0;
    for (std::size_t at = 0; at < found.size(); ++at)
        if (reference::length(truth[at]) > kWeak * largest && reference::length(found[at]) > 0)
            most = std::max(most, angle_between(found[at] / reference::length(found[at]),
                                                truth[at] / reference::length(truth[at])));
    return most;
}

/// The largest bound of a field's voxels, N; where each coordinate is rounded, too.
double bound_of(const PreparedCase& prepared, Precision precision) {
    const RoundingBound bound(prepared, precision);
    const double unit = precision == Precision::f32 ? 0x1p-24 : 0x1p-53;
    double most = 0;
    for (const Vector& at : voxels_of(prepared))
        most = std::max(most, bound.at(at.x, at.y, at.z).force + bound.over(unit * reference::length(at)).force);
    return most;
}

template <typename T, typename Truth>
NumberErrors errors_of(Engine& engine, const NumberCase& one, Precision precision, const Truth& truth_of) {
    NumberErrors errors;
    Sums sums;
    std::vector<std::pair<Forces, Forces>> all;
    for (const NumberField& field : one.fields) {
        const PreparedCase& home = field.home ? *field.home : field.prepared;
        try {
            all.emplace_back(evaluated<T>(engine, field.prepared), truth_of(home));
        } catch (const UsageError& error) {
            errors.refused = error.what();
            return errors;
        }
        add_field(all.back().first, all.back().second, home.one.scene.grid.size[0], sums);
        if (!home.images.mesh)
            sums.bound = std::max(sums.bound, bound_of(field.prepared, precision));
    }
    if (!(sums.largest > 0))
        return errors;
    errors.force = sums.off / sums.largest;
    if (sums.step > kAlike * sums.largest)
        errors.step = sums.step_off / sums.step;
    if (!one.fields.front().prepared.images.mesh)
        errors.bound = sums.bound / sums.largest;
    for (const auto& [found, truth] : all)
        errors.direction = std::max(errors.direction, turned(found, truth, sums.largest));
    const auto off = std::ranges::count_if(sums.all_off, [&](double by) { return !(by <= kOff * sums.largest); });
    errors.share_off = static_cast<double>(off) / static_cast<double>(sums.all_off.size());
    return errors;
}

} // namespace

NumberErrors single_errors(Engine& engine, const NumberCase& one) {
    return errors_of<float>(engine, one, Precision::f32, by_oracle);
}

NumberErrors double_errors(Engine& engine, const NumberCase& one) {
    return errors_of<double>(engine, one, Precision::f64, by_referee);
}

} // namespace forceshade::study
