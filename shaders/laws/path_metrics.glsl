// What is remembered of a path. Needs vector.glsl. What does not count is selected away: on a software device a branch
// costs as much as both its sides.

real least_reach; // m^2: square of the least way that a turn of the force is counted over

// Adds to a sum that keeps what rounding takes from it (Kahan).
void add_to(inout real total, inout real rest, real value, bool counts) {
    precise real corrected = value - rest;
    precise real next = total + corrected;
    precise real lost = (next - total) - corrected;
    total = counts ? next : total;
    rest = counts ? lost : rest;
}

PathMetrics no_metrics() {
    return PathMetrics(ZERO, ZERO, ZERO, ZERO, ZERO, ONE, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO,
                       ZERO, ZERO, -real(LARGEST), real(LARGEST), ZERO, ZERO, 0u, 0u, kNever, 0u, 0u, 0u);
}

// A sample: the depth and facet that the law gave, and the force that is commanded, N.
void add_sample(inout PathMetrics metrics, real depth, bool touches, real3 force) {
    precise real square = product(force, force);
    precise real size = sqrt(square);
    metrics.largest_force = size > metrics.largest_force ? size : metrics.largest_force;
    add_to(metrics.force_square, metrics.force_square_rest, square, true);
    bool least = metrics.contact_samples == 0u || depth < metrics.least_depth;
    metrics.least_depth = touches && least ? depth : metrics.least_depth;
    metrics.largest_depth = touches && depth > metrics.largest_depth ? depth : metrics.largest_depth;
    add_to(metrics.depth, metrics.depth_rest, depth, touches);
    precise real depth_square = depth * depth;
    add_to(metrics.depth_square, metrics.depth_square_rest, depth_square, touches);
    metrics.contact_samples += touches ? 1u : 0u;
}

// About the square of an angle from that of its chord, to tell which of two turns over ways of different length is the
// steeper: the angle is within 4e-4 of itself up to 45 degrees, 4e-3 up to 90, 0.05 up to 180. A chord of a few roundings,
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

// The force's direction at a sample, and at the one before. Its turn is counted from an anchor, over the way from there
// but no less than a stretch; then the anchor moves on. So no way of a few roundings is divided by.
void add_turn(inout PathState state, real3 place, real3 before, real3 direction, bool directed) {
    bool both = state.directed != 0u && directed;
    real3 turn = difference(direction, before);
    precise real square = product(turn, turn);
    state.metrics.largest_turn = both && square > state.metrics.largest_turn ? square : state.metrics.largest_turn;
    real3 anchor = real3(state.anchor_x, state.anchor_y, state.anchor_z);
    real3 from = real3(state.anchor_force_x, state.anchor_force_y, state.anchor_force_z);
    real3 way = difference(place, anchor);
    precise real reach = product(way, way);
    real over = reach > least_reach ? reach : least_reach;
    real3 swing = difference(direction, from);
    precise real chord = product(swing, swing);
    real angle = angle_square(chord);
    precise real one = angle * state.metrics.steepest_way;
    precise real other = state.steepest * over;
    bool steeper = both && one > other;
    state.metrics.steepest_turn = steeper ? chord : state.metrics.steepest_turn;
    state.metrics.steepest_way = steeper ? over : state.metrics.steepest_way;
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

// The speed, m/s, at a step of a path of so many steps: growing oscillations show late.
void add_speed(inout PathMetrics metrics, real3 speed, uint step, uint steps) {
    uint quarter = steps / 4u;
    precise real size = sqrt(product(speed, speed));
    bool early = step >= quarter && step < 2u * quarter;
    bool late = step >= 3u * quarter;
    metrics.early_speed = early && size > metrics.early_speed ? size : metrics.early_speed;
    metrics.late_speed = late && size > metrics.late_speed ? size : metrics.late_speed;
}
