// L10 and L11: friction on the surface and a material's recorded vibration, of paths and of the live loop. Both have a
// history, so that static fields have neither, and no kernel has them.
//
// Friction: Canudas de Wit, Olsson, Astrom & Lischinsky 1995 (LuGre); with one coefficient and no damping it is the
// model of Dahl 1968. Its bristle is stepped as Hayward & Armstrong 2000 step theirs: by displacement, not by speed.
// Vibration: Culbertson, Unwin & Kuchenbecker 2014.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "host/reference/elementary.h"
#include "host/reference/surfaces.h"
#include "host/vibration/vibration.h"

namespace forceshade::reference {

/// Of L10, in a loop of one period.
template <typename T> struct FrictionParams {
    T coefficient = 0;    /* 1: Coulomb's */
    T excess = 0;         /* 1: by which the static coefficient is more */
    T stribeck_speed = 1; /* m/s */
    T stiffness = 1;      /* N/m: of the bristle */
    T damping = 0;        /* N s/m: of the bristle */
    T viscous = 0;        /* N s/m */
};

/// A bristle after a sample: how far it is bent, m, and the force on the probe, N.
template <typename T> struct BentBristle { Vector<T> bent, force; };

/// The part of a vector across a unit normal.
template <typename T> Vector<T> across(const Vector<T>& v, const Vector<T>& normal) noexcept {
    return v - dot(v, normal) * normal;
}

/// L10: a sample in contact. `bent`, m, is of the sample before, `slip`, m, the displacement along the surface since,
/// `load`, N, the force along the unit `normal`. The bristle is bent by at most g = load mu(v) / stiffness, with mu a
/// rational Stribeck curve, half way down at the Stribeck speed as LuGre's Gaussian is at 0.83 of it, but without an
/// exponential function. z' = (z + s) / (1 + |s| / g) is the implicit step of dz/dt = v - |v| z / g. From |z| <= g
/// follows |z'| <= (g + |s|) / (1 + |s| / g) = g; where the load has fallen, z' is cut to g. With z = z' (1 + |s| / g)
/// - s the force at the end of each step does at most the work of a spring: -z' s <= z^2 / 2 - z'^2 / 2, so that under
/// a constant load, with one coefficient, no loop gives energy.
template <typename T>
BentBristle<T> bend(const FrictionParams<T>& friction, const Vector<T>& bent, const Vector<T>& normal, T load,
                    const Vector<T>& slip, T period) noexcept {
    const Vector<T> before = across(bent, normal);
    const T distance = length(slip), speeds = distance / period / friction.stribeck_speed; /* m, 1 */
    const T coefficient = friction.coefficient + friction.excess / (T(1) + speeds * speeds);
    const T most = load * coefficient / friction.stiffness; /* m */
    BentBristle<T> after{Vector<T>(T(0)), Vector<T>(T(0))};
    if (most > T(0) && most <= std::numeric_limits<T>::max()) {
        after.bent = (most / (most + distance)) * (before + slip);
        if (const T size = length(after.bent); size > most)
            after.bent *= most / size;
    }
    after.force = -(friction.stiffness * after.bent + (friction.damping / period) * (after.bent - before) +
                    (friction.viscous / period) * slip);
    return after;
}

/// What a scene adds to its law's force along one path: parameters and state. A copy of one that has not begun is that
/// of another path. Neither allocates nor throws, but where it is made and copied.
template <typename T> class SurfaceForces {
public:
    /// `vibration`: empty for none; its acceleration, m/s^2, times `mass`, kg, is a force.
    SurfaceForces(const std::optional<FrictionParams<T>>& friction, std::optional<Vibration> vibration, T mass,
                  T period)
        : friction_(friction), vibration_(std::move(vibration)), mass_(mass), period_(period) {}

    /// The next sample is the first of the path of this number, on which alone the vibration's noise depends.
    void begin_path(std::uint64_t path) noexcept {
        touches_ = false;
        bent_ = Vector<T>(T(0));
        if (vibration_)
            vibration_->begin(path);
    }

    /// The next sample, at a probe, m. The normal is that of the law's force, the load its magnitude. Displacements
    /// count from the first sample of a contact on, which thus has no force of these. The vibration acts along the
    /// direction of motion, as Culbertson et al. display it; it is not passive: where it acts along the motion it gives
    /// energy.
    void add_to(Contact<T>& contact, const Vector<T>& probe) noexcept {
        const T load = length(contact.force);
        const bool touched = touches_;
        touches_ = contact.facet != layout::kNoFacet && load > T(0) && load <= std::numeric_limits<T>::max();
        const Vector<T> moved = touched ? probe - last_ : Vector<T>(T(0));
        last_ = probe;
        if (!touches_) {
            bent_ = Vector<T>(T(0));
            return;
        }
        const Vector<T> normal = contact.force / load, slip = across(moved, normal);
        if (friction_) {
            const BentBristle<T> bristle = bend(*friction_, bent_, normal, load, slip, period_);
            bent_ = bristle.bent;
            contact.force += bristle.force;
        }
        if (vibration_) {
            const T distance = length(slip);
            const double acceleration = vibration_->next(double(distance / period_), double(load));
            if (distance > T(0))
                contact.force += (mass_ * T(acceleration) / distance) * slip;
        }
    }

private:
    std::optional<FrictionParams<T>> friction_;
    std::optional<Vibration> vibration_;
    T mass_, period_;                   /* kg, s */
    Vector<T> bent_{T(0)}, last_{T(0)}; /* m */
    bool touches_ = false;
};

} // namespace forceshade::reference
