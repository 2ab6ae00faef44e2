// A step of an exploration path, open or closed loop, step for step as host/reference/path_step.h: the hand and its device,
// the state of the path, where the probe goes next. The kernel evaluates the law between probe_at and take_step.
// Needs motion.glsl; LOOP, FRICTION, QUANTISED and COUPLED, constants of the kernel.

// The hand and the device over one sample: mass, damping and spring, stepped exactly (laws: sampled stability).

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

// Coulomb friction opposes the motion with a constant force. What would reverse within the sample stays
// where it stops, as if it slowed down evenly; what rests moves only if it is pushed harder than the friction holds.
AxisMotion moved_with_friction(AxisMap map, AxisPush push, real coulomb, real period) {
    precise real pull = push.force - push.spring * push.error;
    real direction = push.speed != ZERO ? push.speed : pull;
    bool sticks = push.speed == ZERO && !(abs(pull) > coulomb);
    precise real back = -coulomb;
    precise real force = push.force - (direction > ZERO ? coulomb : back);
    AxisMotion motion = moved(map, push, force);
    precise real turning = push.speed * motion.speed;
    bool turns = turning < ZERO;
    precise real stop = real(0.5LF) * period * push.speed * quotient(push.speed, push.speed - motion.speed);
    return AxisMotion(sticks ? exact_zero : turns ? stop : motion.shift, sticks || turns ? exact_zero : motion.speed);
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
    precise real x = floor(quotient(place.x, hand.quantum) + real(0.5LF)) * hand.quantum;
    precise real y = floor(quotient(place.y, hand.quantum) + real(0.5LF)) * hand.quantum;
    precise real z = floor(quotient(place.z, hand.quantum) + real(0.5LF)) * hand.quantum;
    bool rounds = hand.quantum > ZERO;
    return real3(rounds ? x : place.x, rounds ? y : place.y, rounds ? z : place.z);
}

// The force, N, that the device displays of the one that the law gives: no larger than it can; none if that is no
// finite number.
real3 commanded(HandParams hand, real3 law_force) {
    precise real x = hand.gain * law_force.x;
    precise real y = hand.gain * law_force.y;
    precise real z = hand.gain * law_force.z;
    precise real size = root(product(real3(x, y, z), real3(x, y, z)));
    precise real share = quotient(hand.max_force, size);
    precise real less_x = share * x;
    precise real less_y = share * y;
    precise real less_z = share * z;
    bool whole = size <= hand.max_force;
    bool finite = size <= LARGEST;
    return real3(whole ? x : finite ? less_x : exact_zero, whole ? y : finite ? less_y : exact_zero,
                 whole ? z : finite ? less_z : exact_zero);
}

// The force, N, through a virtual coupling to a tool without mass, on which the law acts: the tool is at the depth, m, where both
// forces balance. `lag`, m: how much less deep than the probe it was at the last sample, then is now; below 0 where a path begins.
real3 through_coupling(Coupling coupling, real3 law_force, real depth, inout real lag) {
    if (COUPLED == 0u)
        return law_force;
    const real gone = real(1e-30LF); // m: less only makes denormal numbers
    bool finite = depth <= LARGEST;
    precise real at_rest = coupling.rest * depth;
    real before = lag < ZERO ? (finite ? at_rest : ZERO) : lag;
    precise real tool = coupling.depth * depth - coupling.lag * before;
    bool touches = tool > ZERO && finite;
    precise real behind = depth - tool;
    precise real taken = ONE - coupling.kept;
    precise real of_before = coupling.kept * before;
    precise real of_behind = taken * behind;
    precise real filtered = of_before + of_behind;
    precise real left = coupling.free * before;
    real share = quotient(tool, depth);
    precise real x = share * law_force.x;
    precise real y = share * law_force.y;
    precise real z = share * law_force.z;
    bool coupled = coupling.depth > ZERO;
    lag = !coupled ? lag : touches ? filtered : left > gone ? left : ZERO;
    return real3(!coupled ? law_force.x : touches ? x : exact_zero, !coupled ? law_force.y : touches ? y : exact_zero,
                 !coupled ? law_force.z : touches ? z : exact_zero);
}

// What the device displays of the law's force, N.
real3 displayed(inout real lag, HandParams hand, real3 law_force, real depth) {
    if (LOOP == kLoopOpen)
        return law_force;
    return commanded(hand, through_coupling(hand.coupling, law_force, depth, lag));
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

// The state of a path. Values that do not count are selected away: on a software device a branch costs as much as both
// its sides.

real least_reach; // m^2: square of the least distance that a turn of the force is counted over

// Adds to a sum that keeps what rounding takes from it (Kahan).
void add_to(inout real total, inout real rest, real value, bool counts) {
    precise real corrected = value - rest;
    precise real next = total + corrected;
    precise real lost = (next - total) - corrected;
    total = counts ? next : total;
    rest = counts ? lost : rest;
}

PathMetrics no_metrics() {
    return PathMetrics(ZERO, ZERO, ZERO, ZERO, ZERO, ONE, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO,
                       ZERO, ZERO, -real(LARGEST), real(LARGEST), ZERO, ZERO, 0u, 0u, kNever, 0u, 0u, 0u);
}

// A sample: the depth and facet that the law gave, and the force that is commanded, N.
void add_sample(inout PathMetrics metrics, real depth, bool touches, real3 force) {
    precise real square = product(force, force);
    precise real size = root(square);
    metrics.largest_force = size > metrics.largest_force ? size : metrics.largest_force;
    add_to(metrics.force_square, metrics.force_square_rest, square, true);
    bool first = metrics.contact_samples == 0u;
    metrics.least_depth = touches && (first || depth < metrics.least_depth) ? depth : metrics.least_depth;
    metrics.largest_depth = touches && depth > metrics.largest_depth ? depth : metrics.largest_depth;
    metrics.first_depth = touches && first ? depth : metrics.first_depth;
    precise real deeper = depth - metrics.first_depth;
    add_to(metrics.depth, metrics.depth_rest, deeper, touches);
    precise real depth_square = deeper * deeper;
    add_to(metrics.depth_square, metrics.depth_square_rest, depth_square, touches);
    metrics.contact_samples += touches ? 1u : 0u;
}

// About the square of an angle from that of its chord, to find the steeper of two turns over different
// distances: the angle is within 4e-4 of itself up to 45 degrees, 4e-3 up to 90, 0.05 up to 180. A chord of a few roundings,
// as an unshaded facet has from sample to sample, is its own angle to the last bit; its powers would be denormal, which many
// processors are slow with.
real angle_square(real chord_square) {
    bool counts = chord_square > EPSILON;
    real base = counts ? chord_square : real(EPSILON);
    precise real square = base * base;
    precise real more = real(0.0890539LF) + real(0.00343149LF) * (square * base);
    precise real value = base + square * more;
    return counts ? value : chord_square;
}

real square_of(real value) {
    precise real square = value * value;
    return square;
}

// The force's direction at a sample, and at the one before. Its turn is counted from an anchor, over the distance from there
// but no less than a stretch; then the anchor moves on. So no distance of a few roundings is divided by.
void add_turn(inout PathState state, real3 place, real3 before, real3 direction, bool directed) {
    bool both = state.directed != 0u && directed;
    real3 turn = difference(direction, before);
    precise real square = product(turn, turn);
    state.metrics.largest_turn = both && square > state.metrics.largest_turn ? square : state.metrics.largest_turn;
    real3 anchor = real3(state.anchor_x, state.anchor_y, state.anchor_z);
    real3 from = real3(state.anchor_force_x, state.anchor_force_y, state.anchor_force_z);
    real3 displacement = difference(place, anchor);
    precise real reach = product(displacement, displacement);
    real over = reach > least_reach ? reach : least_reach;
    real3 swing = difference(direction, from);
    precise real chord = product(swing, swing);
    real angle = angle_square(chord);
    precise real one = angle * state.metrics.steepest_distance;
    precise real other = state.steepest * over;
    bool steeper = both && one > other;
    state.metrics.steepest_turn = steeper ? chord : state.metrics.steepest_turn;
    state.metrics.steepest_distance = steeper ? over : state.metrics.steepest_distance;
    state.steepest = steeper ? angle : state.steepest;
    bool moves = !both || reach >= least_reach;
    state.anchor_x = moves ? place.x : anchor.x;
    state.anchor_y = moves ? place.y : anchor.y;
    state.anchor_z = moves ? place.z : anchor.z;
    state.anchor_force_x = moves ? direction.x : from.x;
    state.anchor_force_y = moves ? direction.y : from.y;
    state.anchor_force_z = moves ? direction.z : from.z;
    state.directed = directed ? 1u : 0u;
}

// Work, J, that the device did on the hand between two samples.
void add_work(inout PathMetrics metrics, real work) {
    add_to(metrics.work, metrics.work_rest, work, true);
    add_to(metrics.effort, metrics.effort_rest, abs(work), true);
}

// Where a round ends within a step, `late`, J, of the step's work belongs to the next one.
void end_round(inout PathMetrics metrics, real late, bool ends) {
    precise real rest = metrics.work_rest + late;
    precise real round = (metrics.work - metrics.round_begin) - (rest - metrics.round_begin_rest);
    metrics.largest_round = ends && round > metrics.largest_round ? round : metrics.largest_round;
    metrics.least_round = ends && round < metrics.least_round ? round : metrics.least_round;
    metrics.round_begin = ends ? metrics.work : metrics.round_begin;
    metrics.round_begin_rest = ends ? rest : metrics.round_begin_rest;
    metrics.rounds += ends ? 1u : 0u;
}

// The speed, m/s, at a step of a path of `steps` steps: growing oscillations show late.
void add_speed(inout PathMetrics metrics, real3 speed, uint step, uint steps) {
    uint quarter = steps / 4u;
    precise real size = root(product(speed, speed));
    bool early = step >= quarter && step < 2u * quarter;
    bool late = step >= 3u * quarter;
    metrics.early_speed = early && size > metrics.early_speed ? size : metrics.early_speed;
    metrics.late_speed = late && size > metrics.late_speed ? size : metrics.late_speed;
}

// The step itself.

// The values of a sample that are written.
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
                     ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, -ONE, no_metrics(), 0u, 0u);
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
    real3 displacement = difference(taken.position, real3(state.measured_x, state.measured_y, state.measured_z));
    real3 forces = sum(real3(state.force_x, state.force_y, state.force_z), taken.force);
    precise real work = real(0.5LF) * product(forces, displacement);
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
// `unit` is the direction of the last force, and becomes that of this one. `finished`: the proxy came to rest; `trail`:
// hash of its walk.
void take_step(inout PathState state, inout real3 unit, HandParams hand, MotionParams motion, PathSample taken,
               real3 target, real3 next, bool finished, uint trail, uint steps) {
    bool touches = taken.facet != kNoFacet;
    add_sample(state.metrics, taken.depth, touches, taken.force);
    state.metrics.unfinished += finished ? 0u : 1u;
    state.metrics.trail = hashed(state.metrics.trail, trail);
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
