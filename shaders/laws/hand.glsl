// The hand and the device over one sample: mass, damping and spring, stepped exactly (laws: sampled stability). FRICTION
// and QUANTISED are constants of the kernel: whether any hand has them. Needs vector.glsl.

// What acts on one axis during a sample.
struct AxisPush {
    real error;  // m: from the target
    real speed;  // m/s: at the sample's begin
    real force;  // N: all that is constant over the sample, friction excepted
    real spring; // N/m: that pulls to the target
};

// How an axis moves in one sample.
struct AxisMotion {
    real shift; // m
    real speed; // m/s: at the sample's end
};

AxisMotion moved(AxisMap map, AxisPush push, real force) {
    precise real shift = map.x_error * push.error + map.x_speed * push.speed + map.x_force * force;
    precise real speed = map.v_error * push.error + map.v_speed * push.speed + map.v_force * force;
    return AxisMotion(shift, speed);
}

// Coulomb friction opposes the motion with a constant force. What would be turned round within the sample is held
// where it stops, as if it slowed down evenly; what rests moves only if it is pushed harder than the friction holds.
AxisMotion moved_with_friction(AxisMap map, AxisPush push, real coulomb, real period) {
    precise real pull = push.force - push.spring * push.error;
    real way = push.speed != ZERO ? push.speed : pull;
    bool held = push.speed == ZERO && !(abs(pull) > coulomb);
    precise real back = -coulomb;
    precise real force = push.force - (way > ZERO ? coulomb : back);
    AxisMotion motion = moved(map, push, force);
    precise real turning = push.speed * motion.speed;
    bool turns = turning < ZERO;
    precise real stop = real(0.5LF) * period * push.speed * (push.speed / (push.speed - motion.speed));
    return AxisMotion(held ? exact_zero : turns ? stop : motion.shift, held || turns ? exact_zero : motion.speed);
}

AxisMotion axis_moved(AxisMap map, AxisPush push, HandParams hand) {
    AxisMotion motion = moved(map, push, push.force);
    if (FRICTION == 0u)
        return motion;
    AxisMotion rubbing = moved_with_friction(map, push, hand.coulomb, hand.period);
    bool rubs = hand.coulomb > ZERO;
    return AxisMotion(rubs ? rubbing.shift : motion.shift, rubs ? rubbing.speed : motion.speed);
}

// The position that the device reports, m.
real3 measured(HandParams hand, real3 place) {
    if (QUANTISED == 0u)
        return place;
    precise real x = floor(place.x / hand.quantum + real(0.5LF)) * hand.quantum;
    precise real y = floor(place.y / hand.quantum + real(0.5LF)) * hand.quantum;
    precise real z = floor(place.z / hand.quantum + real(0.5LF)) * hand.quantum;
    bool rounds = hand.quantum > ZERO;
    return real3(rounds ? x : place.x, rounds ? y : place.y, rounds ? z : place.z);
}

// The force, N, that the device displays of the one that the law gives: no larger than it can; none if that is no
// finite number.
real3 commanded(HandParams hand, real3 law_force) {
    precise real x = hand.gain * law_force.x;
    precise real y = hand.gain * law_force.y;
    precise real z = hand.gain * law_force.z;
    precise real size = sqrt(product(real3(x, y, z), real3(x, y, z)));
    precise real share = hand.max_force / size;
    precise real less_x = share * x;
    precise real less_y = share * y;
    precise real less_z = share * z;
    bool whole = size <= hand.max_force;
    bool finite = size <= LARGEST;
    return real3(whole ? x : finite ? less_x : exact_zero, whole ? y : finite ? less_y : exact_zero,
                 whole ? z : finite ? less_z : exact_zero);
}

// Where a probe is, and how fast.
struct Carried {
    real3 place; // m
    real3 speed; // m/s
};

// All that acts on an axis: the grip's damping takes it to the target's speed, the hand pushes, the device too.
AxisPush axis_push(HandParams hand, real error, real speed, real target_speed, real push, real force, real spring) {
    precise real all = (hand.damping * target_speed + push) + force;
    return AxisPush(error, speed, all, spring);
}

// Over one sample: `target` and its speed, m and m/s, and the device's force, N, are held.
Carried carried(HandParams hand, Carried now, real3 target, real3 target_speed, real3 force) {
    real3 error = difference(now.place, target);
    AxisMotion x = axis_moved(
        hand.lateral, axis_push(hand, error.x, now.speed.x, target_speed.x, hand.push_x, force.x, hand.stiffness), hand);
    AxisMotion y = axis_moved(
        hand.lateral, axis_push(hand, error.y, now.speed.y, target_speed.y, hand.push_y, force.y, hand.stiffness), hand);
    AxisMotion z = axis_moved(
        hand.vertical, axis_push(hand, error.z, now.speed.z, target_speed.z, hand.push_z, force.z, hand.stiffness_z), hand);
    return Carried(sum(now.place, real3(x.shift, y.shift, z.shift)), real3(x.speed, y.speed, z.speed));
}
