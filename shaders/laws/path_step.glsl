// One step of an exploration path, open or closed loop: where the probe is, what it feels, where it goes next. The
// kernel evaluates the law between probe_at and take_step. Needs vector.glsl, motion.glsl, hand.glsl, path_metrics.glsl; LOOP.

// What of a sample is written.
struct PathSample {
    real3 position; // m: where the law was evaluated
    real3 force;    // N: commanded
    real depth;     // m
    real3 proxy;    // m
    uint facet;
};

// A path before its first step; `target` is the motion's first place, m.
PathState begin_state(HandParams hand, real3 target) {
    precise real sunk = LOOP == kLoopClosed ? hand.start_depth : exact_zero;
    precise real z = target.z - sunk;
    return PathState(target.x, target.y, z, ZERO, ZERO, ZERO, target.x, target.y, z, ZERO, ZERO, ZERO,
                     ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, no_metrics(), 0u, 0u);
}

// Whether the probe is beyond its bound, now or before. Then it stays where it was last, free of force.
bool leaves(inout PathState state, HandParams hand, real3 target) {
    if (LOOP == kLoopOpen)
        return false;
    real3 away = difference(real3(state.x, state.y, state.z), target);
    precise real square = product(away, away);
    precise real most = hand.bound * hand.bound;
    bool now = state.metrics.unstable_step == kNever && !(square <= most);
    bool pushed = product(real3(hand.push_x, hand.push_y, hand.push_z), away) > ZERO;
    bool falls = now && pushed && state.directed == 0u && state.step > 0u;
    state.metrics.unstable_step = now ? state.step : state.metrics.unstable_step;
    state.metrics.fell = falls ? 1u : state.metrics.fell;
    return state.metrics.unstable_step != kNever;
}

PathSample left_sample(PathState state) {
    real3 place = real3(state.measured_x, state.measured_y, state.measured_z);
    return PathSample(place, real3(ZERO), ZERO, place, kNoFacet);
}

// Where the law is to be evaluated, m.
real3 probe_at(PathState state, HandParams hand, real3 target) {
    return LOOP == kLoopClosed ? measured(hand, real3(state.x, state.y, state.z)) : target;
}

// Open loop: adds the work, J, since the last sample; the first is where the path begins, and adds none.
real add_between(inout PathState state, PathSample taken) {
    real3 way = difference(taken.position, real3(state.measured_x, state.measured_y, state.measured_z));
    real3 forces = sum(real3(state.force_x, state.force_y, state.force_z), taken.force);
    precise real work = real(0.5LF) * product(forces, way);
    add_work(state.metrics, work);
    return work;
}

// Closed loop: over the sample the hand takes the probe to where the next one begins. Adds the work, J.
real carry(inout PathState state, HandParams hand, PathSample taken, real3 target, real3 next, uint steps) {
    Carried now = Carried(real3(state.x, state.y, state.z), real3(state.speed_x, state.speed_y, state.speed_z));
    bool late = hand.delay != 0u;
    real3 applied = real3(late ? state.force_x : taken.force.x, late ? state.force_y : taken.force.y,
                          late ? state.force_z : taken.force.z);
    real3 target_speed = scaled(hand.rate, difference(next, target));
    Carried after = carried(hand, now, target, target_speed, applied);
    real work = product(applied, difference(after.place, now.place));
    add_work(state.metrics, work);
    add_speed(state.metrics, after.speed, state.step, steps);
    state.x = after.place.x;
    state.y = after.place.y;
    state.z = after.place.z;
    state.speed_x = after.speed.x;
    state.speed_y = after.speed.y;
    state.speed_z = after.speed.z;
    return work;
}

// Of the work of a step, J, within which a round of the motion ends, what comes after that. In open loop the round ends
// where it began, so that it is closed, even where strokes turn there and change their depth; else the work is linear in
// time.
real late_work(PathState state, MotionParams motion, PathSample taken, real work) {
    precise real late = work * late_share(motion, state.step);
    if (ENDS_AT_A_PLACE) {
        real3 forces = sum(real3(state.force_x, state.force_y, state.force_z), taken.force);
        late = real(0.5LF) * product(forces, difference(taken.position, round_end));
    }
    return late;
}

// Takes a path that has not left one step on. `target` and `next` are the motion's places at this step and the next, m;
// `unit` is the direction of the last force, and becomes that of this one. `finished`: the proxy came to rest.
void take_step(inout PathState state, inout real3 unit, HandParams hand, MotionParams motion, PathSample taken,
               real3 target, real3 next, bool finished, uint steps) {
    bool touches = taken.facet != kNoFacet;
    add_sample(state.metrics, taken.depth, touches, taken.force);
    state.metrics.unfinished += finished ? 0u : 1u;
    real3 direction = normalised(taken.force);
    bool forceful = product(direction, direction) > ZERO;
    add_turn(state, taken.position, unit, direction, touches && forceful);
    unit = direction;
    real work = LOOP == kLoopClosed ? carry(state, hand, taken, target, next, steps) : add_between(state, taken);
    end_round(state.metrics, late_work(state, motion, taken, work), completes_round(motion, state.step));
    state.measured_x = taken.position.x;
    state.measured_y = taken.position.y;
    state.measured_z = taken.position.z;
    state.force_x = taken.force.x;
    state.force_y = taken.force.y;
    state.force_z = taken.force.z;
    ++state.step;
}
