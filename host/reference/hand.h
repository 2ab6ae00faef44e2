// The hand and the device over one sample: mass, damping and spring, stepped exactly (laws: sampled stability). Step
// for step as shaders/laws/hand.glsl.
#pragma once

#include <limits>

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

/// What acts on one axis during a sample.
template <typename T> struct AxisPush {
    T error;  /* m: from the target */
    T speed;  /* m/s: at the sample's begin */
    T force;  /* N: all that is constant over the sample, friction excepted */
    T spring; /* N/m: that pulls to the target */
};

/// How an axis moves in one sample.
template <typename T> struct AxisMotion {
    T shift; /* m */
    T speed; /* m/s: at the sample's end */
};

template <typename T> AxisMotion<T> moved(const layout::AxisMap<T>& map, const AxisPush<T>& push, T force) noexcept {
    return {map.x_error * push.error + map.x_speed * push.speed + map.x_force * force,
            map.v_error * push.error + map.v_speed * push.speed + map.v_force * force};
}

/// Coulomb friction opposes the motion with a constant force. What would be turned round within the sample is held
/// where it stops, as if it slowed down evenly; what rests moves only if it is pushed harder than the friction holds.
template <typename T>
AxisMotion<T> moved_with_friction(const layout::AxisMap<T>& map, const AxisPush<T>& push, T coulomb,
                                  T period) noexcept {
    const T pull = push.force - push.spring * push.error;
    const T way = push.speed != T(0) ? push.speed : pull;
    const bool held = push.speed == T(0) && !(std::abs(pull) > coulomb);
    const T friction = way > T(0) ? coulomb : -coulomb;
    const AxisMotion<T> motion = moved(map, push, push.force - friction);
    const bool turns = push.speed * motion.speed < T(0);
    const T stop = T(0.5) * period * push.speed * (push.speed / (push.speed - motion.speed));
    return {held ? T(0) : turns ? stop : motion.shift, held || turns ? T(0) : motion.speed};
}

/// The position that the device reports, m.
template <typename T> Vector<T> measured(const layout::HandParams<T>& hand, const Vector<T>& place) noexcept {
    if (!(hand.quantum > T(0)))
        return place;
    return {std::floor(place.x / hand.quantum + T(0.5)) * hand.quantum,
            std::floor(place.y / hand.quantum + T(0.5)) * hand.quantum,
            std::floor(place.z / hand.quantum + T(0.5)) * hand.quantum};
}

/// The force, N, that the device displays of the one that the law gives: no larger than it can; none if that is no
/// finite number.
template <typename T> Vector<T> commanded(const layout::HandParams<T>& hand, const Vector<T>& law_force) noexcept {
    const Vector<T> force{hand.gain * law_force.x, hand.gain * law_force.y, hand.gain * law_force.z};
    const T size = std::sqrt(dot(force, force));
    if (size <= hand.max_force)
        return force;
    if (!(size <= std::numeric_limits<T>::max()))
        return Vector<T>(T(0));
    const T share = hand.max_force / size;
    return {share * force.x, share * force.y, share * force.z};
}

/// Where a probe is, and how fast.
template <typename T> struct Carried {
    Vector<T> place; /* m */
    Vector<T> speed; /* m/s */
};

/// Over one sample: `target` and its speed, m and m/s, and the device's force, N, are held.
template <typename T>
Carried<T> carried(const layout::HandParams<T>& hand, const Carried<T>& now, const Vector<T>& target,
                   const Vector<T>& target_speed, const Vector<T>& force) noexcept {
    const Vector<T> push{hand.push_x, hand.push_y, hand.push_z};
    Carried<T> next = now;
    for (int i = 0; i < 3; ++i) {
        const layout::AxisMap<T>& map = i == 2 ? hand.vertical : hand.lateral;
        const AxisPush<T> axis{now.place[i] - target[i], now.speed[i],
                               (hand.damping * target_speed[i] + push[i]) + force[i],
                               i == 2 ? hand.stiffness_z : hand.stiffness};
        const AxisMotion<T> motion = hand.coulomb > T(0) ? moved_with_friction(map, axis, hand.coulomb, hand.period)
                                                         : moved(map, axis, axis.force);
        next.place[i] = now.place[i] + motion.shift;
        next.speed[i] = motion.speed;
    }
    return next;
}

} // namespace forceshade::reference
