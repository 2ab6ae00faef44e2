#include "host/field/case_law.h"

#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "host/output/files.h"
#include "host/reference/path_step.h"

namespace forceshade {

template <typename T>
CaseLaw<T>::CaseLaw(const PreparedCase& prepared, Extent grid)
    : mesh_(prepared.images.mesh), origin_(scene_origin(prepared)),
      tables_(make_tables<T>(prepared.one.scene, prepared.images, grid)), law_(tables_.law()) {}

template <typename T> void CaseLaw<T>::find_obstacles() {
    if (!on_mesh())
        return;
    forceshade::find_obstacles(tables_);
    law_ = tables_.law();
}

template <typename T> bool CaseLaw<T>::reaches(const glm::dvec3& probe) const noexcept {
    if (!(std::abs(probe.x) <= kLargestLength<T> && std::abs(probe.y) <= kLargestLength<T> &&
          std::abs(probe.z) <= kLargestLength<T>))
        return false;
    return !on_mesh() || reference::largest_coordinate(
                             reference::to_mesh_frame(law_.mesh.params, from_origin(probe))) <= T(kMeshReach<T>);
}

template <typename T> reference::Vector<T> CaseLaw<T>::rounded(const glm::dvec3& place) const noexcept {
    return reference::Vector<T>(on_mesh() ? to_mesh_frame(mesh_->structure, place) : place);
}

template <typename T>
reference::Contact<T> CaseLaw<T>::at_rounded(const reference::Vector<T>& place, layout::uint& hint) const noexcept {
    return on_mesh() ? reference::mesh_contact(law_, place, hint) : reference::evaluate(law_, place);
}

template <typename T>
reference::LawContact<T> CaseLaw<T>::follow(Path& path, reference::Neighbourhood<T>& around,
                                            const glm::dvec3& probe) const noexcept {
    const reference::Vector<T> place = from_origin(probe);
    if (!on_mesh()) // L1 to L5: no history
        return {reference::evaluate(law_, place)};
    const reference::Vector<T> local = reference::to_mesh_frame(law_.mesh.params, place);
    if (!path.begun)
        path = {reference::god_object_at(reference::proxy_start(law_, around, local)), true};
    return reference::follow(law_, path.proxy, around, place, local);
}

template <typename T> ProbeContact CaseLaw<T>::widened(const reference::LawContact<T>& found) const noexcept {
    const reference::Contact<T>& contact = found.contact;
    const glm::dvec3 force(contact.force);
    return {in_world(contact.proxy), force, force, double(contact.depth), contact.facet, found.finished};
}

template <typename T> std::string beyond_reach(const glm::dvec3& probe) {
    return fmt::format("path position ({}, {}, {}) m is more than {:.0f} times the mesh's size from its centre, "
                       "further than {} can follow; is the unit right?",
                       probe.x, probe.y, probe.z, kMeshReach<T> / 2, std::is_same_v<T, float> ? "f32" : "f64");
}

template class CaseLaw<float>;
template class CaseLaw<double>;
template std::string beyond_reach<float>(const glm::dvec3&);
template std::string beyond_reach<double>(const glm::dvec3&);

namespace {

template <typename T> class InPrecision final : public ProbeLaw {
public:
    InPrecision(const PreparedCase& prepared, double period)
        : probe_(prepared), hand_(prepared.one.scene.hand), stiffness_(prepared.one.scene.force.stiffness),
          surface_(surface_forces<T>(prepared, period)) {
        probe_.law().find_obstacles();
    }

    bool reaches(const glm::dvec3& probe) const noexcept override { return probe_.law().reaches(probe); }
    void begin_path() noexcept override {
        probe_.begin_path();
        lag_ = -1;
        path_ += std::exchange(begun_, false) ? 1 : 0;
        if (surface_)
            surface_->begin_path(path_);
    }
    void couple(double scale, double period) noexcept override {
        coupling_ = coupling_of<T>(hand_, scale * stiffness_, period);
    }
    ProbeContact at(const glm::dvec3& probe) noexcept override {
        reference::LawContact<T> found = probe_.at(probe);
        if (surface_)
            surface_->add_to(found.contact, probe_.law().from_origin(probe));
        begun_ = true;
        ProbeContact contact = probe_.law().widened(found);
        contact.coupled =
            glm::dvec3(reference::through_coupling(coupling_, found.contact.force, found.contact.depth, lag_));
        return contact;
    }

private:
    CaseProbe<T> probe_;
    HandSpec hand_;
    double stiffness_; /* N/m */
    layout::Coupling<T> coupling_{};
    T lag_ = -1; /* m: of the coupling */
    std::optional<reference::SurfaceForces<T>> surface_;
    std::uint64_t path_ = 0; // its number, on which the noise of a vibration depends
    bool begun_ = false;     // it has a sample
};

} // namespace

template <typename T> layout::Coupling<T> coupling_of(const HandSpec& hand, double stiffness, double period) noexcept {
    if (!hand.coupled())
        return {};
    const double filtered = period + hand.coupling_filter.value_or(0), kept = 1 - period / filtered;
    const double damper = hand.coupling_damping / filtered, both = hand.coupling_stiffness + damper; /* N/m */
    return {T(both / (stiffness + both)), T(damper / (stiffness + both)), T(kept + (1 - kept) * damper / both), T(kept),
            T(stiffness / (stiffness + hand.coupling_stiffness))};
}

template layout::Coupling<float> coupling_of<float>(const HandSpec&, double, double) noexcept;
template layout::Coupling<double> coupling_of<double>(const HandSpec&, double, double) noexcept;

template <typename T>
std::optional<reference::SurfaceForces<T>> surface_forces(const PreparedCase& prepared, double period) {
    const Scene& scene = prepared.one.scene;
    if (!scene.rubs())
        return std::nullopt;
    std::optional<reference::FrictionParams<T>> friction;
    if (const auto& spec = scene.friction) {
        const double coefficient = friction_coefficient(prepared);
        const double excess = spec->static_coefficient.value_or(coefficient) - coefficient;
        friction = {T(coefficient),     T(excess),        T(spec->stribeck_speed),
                    T(spec->stiffness), T(spec->damping), T(spec->viscous)};
    }
    std::optional<Vibration> vibration;
    if (scene.vibration)
        vibration.emplace(prepared.images.vibration, 1 / period, scene.vibration->seed);
    std::optional<reference::SurfaceForces<T>> forces;
    forces.emplace(friction, std::move(vibration), T(scene.vibration.value_or(VibrationSpec{}).mass), T(period));
    forces->begin_path(0);
    return forces;
}

template std::optional<reference::SurfaceForces<float>> surface_forces(const PreparedCase&, double);
template std::optional<reference::SurfaceForces<double>> surface_forces(const PreparedCase&, double);

std::uint64_t scene_id(const PreparedCase& prepared) {
    const std::string digest = sha256_of(prepared.scene);
    std::uint64_t id = 0;
    std::from_chars(digest.data(), digest.data() + 16, id, 16);
    return id;
}

std::unique_ptr<ProbeLaw> make_probe_law(const PreparedCase& prepared, double period) {
    const double rate = prepared.one.scene.paths.value_or(PathsSpec{}).rate;
    auto law =
        in_precision(prepared.one.scene.precision, [&]<typename T>(std::type_identity<T>) -> std::unique_ptr<ProbeLaw> {
            return std::make_unique<InPrecision<T>>(prepared, period > 0 ? period : 1 / rate);
        });
    law->scene = scene_id(prepared);
    return law;
}

} // namespace forceshade
