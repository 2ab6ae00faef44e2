// What is remembered of a path. Needs vector.glsl. What does not count is selected away: on a software device a branch
// costs as much as both its sides.

// Adds to a sum that keeps what rounding takes from it (Kahan).
void add_to(inout real total, inout real rest, real value, bool counts) {
    precise real corrected = value - rest;
    precise real next = total + corrected;
    precise real lost = (next - total) - corrected;
    total = counts ? next : total;
    rest = counts ? lost : rest;
}

PathMetrics no_metrics() {
    return PathMetrics(ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO,
                       ZERO, ZERO, ZERO, ZERO, 0u, 0u, kNever, 0u);
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

// Two samples in a row, both in contact: how far the force turned between them; `one` and `other` are its directions.
void add_turn(inout PathMetrics metrics, real3 one, real3 other, real3 way, bool both) {
    bool turns = both && product(one, one) > ZERO && product(other, other) > ZERO;
    real3 turn = difference(other, one);
    precise real square = product(turn, turn);
    precise real reach = product(way, way);
    metrics.largest_turn = turns && square > metrics.largest_turn ? square : metrics.largest_turn;
    precise real steepness = square / reach;
    metrics.steepest_turn =
        turns && reach > ZERO && steepness > metrics.steepest_turn ? steepness : metrics.steepest_turn;
}

// Work, J, that the device did on the hand between two samples.
void add_work(inout PathMetrics metrics, real work, bool counts) {
    add_to(metrics.work, metrics.work_rest, work, counts);
    add_to(metrics.effort, metrics.effort_rest, abs(work), counts);
}

void end_round(inout PathMetrics metrics, bool ends) {
    precise real round = metrics.work - metrics.round_begin;
    bool larger = metrics.rounds == 0u || abs(round) > abs(metrics.largest_round);
    metrics.largest_round = ends && larger ? round : metrics.largest_round;
    metrics.round_begin = ends ? metrics.work : metrics.round_begin;
    metrics.rounds_end = ends ? metrics.work : metrics.rounds_end;
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
