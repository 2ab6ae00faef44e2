#include "host/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "host/error.h"
#include "host/field/case_law.h"
#include "host/field/engine.h"
#include "host/referee/referee.h"
#include "host/referee/rounding_bound.h"

namespace forceshade {
namespace {

using Vector = reference::Vector<double>;
using Forces = std::vector<Vector>;
using ForceOf = std::function<Vector(const Vector& place)>;

constexpr double kAlike = 1e-12; /* of the largest force: neighbours that differ by less are a period apart */

template <typename T> Forces evaluated(Engine& engine, const PreparedCase& prepared) {
    const std::vector<T> numbers = evaluate<T>(prepared, engine).force;
    Forces forces;
    for (std::size_t i = 0; i < numbers.size() / 3; ++i)
        forces.emplace_back(reference::vector_at<T>(numbers, i));
    return forces;
}

/// Voxel by voxel, x fastest, then z.
std::vector<Vector> voxels_of(const PreparedCase& prepared) {
    const GridSpec& grid = prepared.one.scene.grid;
    std::vector<Vector> places;
    for (std::size_t k = 0; k < grid.size[2]; ++k)
        for (std::size_t i = 0; i < grid.size[0]; ++i)
            places.emplace_back(grid.at(0, i), grid.origin[1], grid.at(2, k));
    return places;
}

Forces true_forces(const PreparedCase& home, const ForceOf& force) {
    Forces forces;
    for (const Vector& place : voxels_of(home))
        forces.push_back(force(place));
    return forces;
}

Forces by_oracle(const PreparedCase& home) {
    const CaseLaw<double> law(home);
    return true_forces(home, [&](const Vector& place) { return law.at(place).force; });
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
    const std::size_t columns = home.one.scene.grid.size[0];
    const std::vector<Vector> places = voxels_of(home);
    Forces forces(places.size());
    for (std::size_t i = 0; i < columns; ++i) {
        const brute::Column column = referee.column(places[i].x, places[i].y); // loops over all facets
        for (std::size_t at = i; at < places.size(); at += columns)
            forces[at] = vector_of(referee.at(column, places[at].z));
    }
    return forces;
}

/// Sums over the fields of a case, in N.
struct Sums {
    double largest = 0, off = 0, step = 0, step_off = -1, bound = 0;
};

void add_field(const Forces& found, const Forces& truth, std::size_t columns, Sums& sums) {
    for (std::size_t at = 0; at < found.size(); ++at) {
        const double off = reference::length(found[at] - truth[at]);
        sums.largest = std::max(sums.largest, reference::length(truth[at]));
        sums.off = std::isfinite(off) ? std::max(sums.off, off) : std::numeric_limits<double>::infinity();
        if (at % columns == 0)
            continue;
        const Vector step = truth[at] - truth[at - 1];
        sums.step = std::max(sums.step, reference::length(step));
        sums.step_off = std::max(sums.step_off, reference::length(found[at] - found[at - 1] - step));
    }
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
PrecisionErrors errors_of(Engine& engine, std::span<const FieldAtHome> fields, Precision precision,
                          const Truth& truth_of) {
    PrecisionErrors errors;
    Sums sums;
    for (const FieldAtHome& field : fields) {
        const PreparedCase& home = field.home;
        try {
            add_field(evaluated<T>(engine, field.prepared), truth_of(home), home.one.scene.grid.size[0], sums);
        } catch (const UsageError& error) {
            errors.refused = error.what();
            return errors;
        }
        if (!home.images.mesh)
            sums.bound = std::max(sums.bound, bound_of(field.prepared, precision));
    }
    errors.force = sums.largest > 0 ? sums.off / sums.largest : 0;
    if (!(sums.largest > 0))
        return errors;
    if (sums.step > kAlike * sums.largest)
        errors.step = sums.step_off / sums.step;
    if (!fields.front().prepared.images.mesh)
        errors.bound = sums.bound / sums.largest;
    return errors;
}

} // namespace

PrecisionErrors single_errors(Engine& engine, std::span<const FieldAtHome> fields) {
    return errors_of<float>(engine, fields, Precision::f32, by_oracle);
}

PrecisionErrors double_errors(Engine& engine, std::span<const FieldAtHome> fields) {
    return errors_of<double>(engine, fields, Precision::f64, by_referee);
}

} // namespace forceshade
