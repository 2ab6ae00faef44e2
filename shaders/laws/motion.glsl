// Where the intended motion of a path is at a step, step for step as host/reference/motion.h. Phases are whole numbers:
// they do not drift, and a step needs none before it. Needs MOTION, LOOP and HARMONICS, constants of the kernel; the buffer
// `harmonics`. Where KEPT_HARMONICS is set, keep_harmonics comes before the first step. Zeros are `exact_zero`: what they
// enter may be a zero with a sign.

// Random numbers by counter (Philox 4x32-10: Salmon, Moraes, Dror & Shaw 2011): the same for a key and a counter
// wherever they are drawn.
uvec4 philox(uvec4 counter, uvec2 key) {
    for (uint i = 0u; i < 10u; ++i) {
        uint one_high, one_low, other_high, other_low;
        umulExtended(0xD2511F53u, counter.x, one_high, one_low);
        umulExtended(0xCD9E8D57u, counter.z, other_high, other_low);
        counter = uvec4(other_high ^ counter.y ^ key.x, other_low, one_high ^ counter.w ^ key.y, one_low);
        key += uvec2(0x9E3779B9u, 0xBB67AE85u);
    }
    return counter;
}

// A place in the motion's own frame, m: along the heading, to its left, and above the surface.
struct Place {
    real along;
    real across;
    real above;
};

// The stretch between two points of a minimum-jerk motion, kept from step to step; `index` kNever: none yet.
struct Stretch {
    uint index;
    real2 from;
    real2 to;
};
Stretch stretch = Stretch(kNever, real2(ZERO), real2(ZERO));

// -1 at phase 0, 1 half a turn later, straight in between.
real triangle_wave(uint phase) {
    uint folded = phase < kHalfTurn ? phase : 0u - phase;
    precise real wave = real(int(folded - kQuarterTurn)) * real(9.31322574615478515625e-10LF); // 2^-30
    return wave;
}

real cosine_of_phase(uint phase) {
    precise real turns = real(int(phase)) * real(2.3283064365386962890625e-10LF); // 2^-32
    return cosine_of_turns(turns);
}

// The share of the way from point to point after a share of the time: 10 t^3 - 15 t^4 + 6 t^5.
real minimum_jerk(real t) {
    precise real share = t * t * t * (real(10.0LF) + t * (t * real(6.0LF) - real(15.0LF)));
    return share;
}

Place stroke_place(MotionParams motion, uint phase) {
    precise real along = motion.reach * triangle_wave(phase);
    precise real above = -(phase < kHalfTurn ? motion.depth : motion.depth_back);
    return Place(along, exact_zero, above);
}

// Where the line of a raster lies: -1 at the first, 1 at the last; lines are walked there and back.
real raster_line(MotionParams motion, uint index) {
    uint last = motion.lines - 1u;
    uint folded = index % max(2u * last, 1u);
    uint line = folded > last ? 2u * last - folded : folded;
    precise real place = quotient(real(int(2u * line)), real(int(last))) - ONE;
    return last > 0u ? place : exact_zero;
}

Place raster_place(MotionParams motion, uint step) {
    uint pitch = motion.run + motion.turn;
    uint index = step / pitch;
    uint within = step - index * pitch;
    bool running = within < motion.run;
    precise real ran = quotient(real(int(within)), real(int(motion.run)));
    precise real crossed = quotient(real(int(within - motion.run)), real(int(motion.turn)));
    real share = running ? ran : ONE;
    real turned = running ? exact_zero : crossed;
    precise real forth = share * real(2.0LF) - ONE;
    precise real back = -forth;
    real here = raster_line(motion, index);
    real next = raster_line(motion, index + 1u);
    precise real along = motion.reach * ((index & 1u) == 0u ? forth : back);
    precise real across = motion.across * (here + turned * (next - here));
    precise real above = -motion.depth;
    return Place(along, across, above);
}

Place round_place(MotionParams motion, real radius, uint phase) {
    precise real along = radius * cosine_of_phase(phase);
    precise real across = radius * cosine_of_phase(phase - kQuarterTurn);
    precise real above = -motion.depth;
    return Place(along, across, above);
}

Place spiral_place(MotionParams motion, uint phase, uint step) {
    precise real share = real(0.5LF) * (ONE + triangle_wave(motion.radius_phase + step * motion.radius_step));
    precise real radius = motion.across + share * (motion.reach - motion.across);
    return round_place(motion, radius, phase);
}

Place tap_place(MotionParams motion, uint phase) {
    precise real share = real(0.5LF) * (ONE + cosine_of_phase(phase));
    precise real above = (motion.depth + motion.lift) * share - motion.depth;
    return Place(exact_zero, exact_zero, above);
}

// The point number `index` of a path, anywhere within the region, in shares of its half sides.
real2 via_point(MotionParams motion, uint index) {
    uvec4 words = philox(uvec4(index, 1u, 0u, 0u), uvec2(motion.key_low, motion.key_high));
    precise real along = real(int(words.x)) * real(4.656612873077392578125e-10LF); // 2^-31
    precise real across = real(int(words.y)) * real(4.656612873077392578125e-10LF);
    return real2(along, across);
}

Place minimum_jerk_place(MotionParams motion, uint step) {
    uint index = step / motion.run;
    uint within = step - index * motion.run;
    // Seldom another one; a software device goes through this all the same.
    while (stretch.index != index)
        stretch = Stretch(index, via_point(motion, index), via_point(motion, index + 1u));
    precise real time = quotient(real(int(within)), real(int(motion.run)));
    precise real share = minimum_jerk(time);
    precise real along = motion.reach * (stretch.from.x + share * (stretch.to.x - stretch.from.x));
    precise real across = motion.across * (stretch.from.y + share * (stretch.to.y - stretch.from.y));
    precise real above = -motion.depth;
    return Place(along, across, above);
}

Place place_at(MotionParams motion, uint step) {
    uint phase = motion.phase + step * motion.phase_step;
    if (MOTION == kMotionStrokes)
        return stroke_place(motion, phase);
    if (MOTION == kMotionRaster)
        return raster_place(motion, step);
    if (MOTION == kMotionCircle)
        return round_place(motion, motion.reach, phase);
    if (MOTION == kMotionSpiral)
        return spiral_place(motion, phase, step);
    if (MOTION == kMotionTaps)
        return tap_place(motion, phase);
    if (MOTION == kMotionMinimumJerk)
        return minimum_jerk_place(motion, step);
    precise real above = -motion.depth;
    return Place(exact_zero, exact_zero, above);
}

// Up to KEPT_HARMONICS of each axis a path keeps from its beginning on, where a kernel says so: in a loop a software device
// would load them lane by lane. Loops over them are unrolled, so that they are registers.
#ifndef KEPT_HARMONICS
#define KEPT_HARMONICS 0u
#endif
Harmonic kept_harmonics[3u * KEPT_HARMONICS + 1u];

void keep_harmonics(uint path, uint paths) {
    if (HARMONICS > KEPT_HARMONICS)
        return;
    [[unroll]] for (uint i = 0u; i < 3u * KEPT_HARMONICS; ++i)
        if (i < 3u * HARMONICS)
            kept_harmonics[i] = harmonics[i * paths + path];
}

real harmonic_at(Harmonic harmonic, uint step) {
    precise real value = harmonic.amplitude * cosine_of_phase(harmonic.phase + step * harmonic.phase_step);
    return value;
}

real3 with_harmonics(real3 sum, Harmonic along_x, Harmonic along_y, Harmonic along_z, uint step) {
    precise real x = sum.x + harmonic_at(along_x, step);
    precise real y = sum.y + harmonic_at(along_y, step);
    precise real z = sum.z + harmonic_at(along_z, step);
    return real3(x, y, z);
}

// Harmonic motions added to path number `path` of `paths`: the whole of a random walk, the tremor of others.
real3 harmonics_at(uint path, uint paths, uint step) {
    real3 sum = real3(exact_zero);
    if (HARMONICS > KEPT_HARMONICS) {
        for (uint i = 0u; i < HARMONICS; ++i) {
            uint at = 3u * i * paths + path;
            sum = with_harmonics(sum, harmonics[at], harmonics[at + paths], harmonics[at + 2u * paths], step);
        }
        return sum;
    }
    [[unroll]] for (uint i = 0u; i < KEPT_HARMONICS; ++i)
        if (i < HARMONICS)
            sum = with_harmonics(sum, kept_harmonics[3u * i], kept_harmonics[3u * i + 1u], kept_harmonics[3u * i + 2u], step);
    return sum;
}

// A random walk turns round where it reaches the edge of its region, half a side, m, from the middle: its harmonics
// reach 4 half sides at most.
real turned_round(real place, real half_side) {
    precise real turned = place;
    for (int i = 0; i < 2; ++i)
        turned = turned > half_side ? real(2.0LF) * half_side - turned : turned < -half_side ? real(-2.0LF) * half_side - turned : turned;
    return turned;
}

// A place in the world, m, plus the displacement `more`; one that follows the surface lies the nominal height above it.
real3 in_world(MotionParams motion, Place place, real3 more) {
    precise real x = motion.centre_x + (place.along * motion.heading_x - place.across * motion.heading_y) + more.x;
    precise real y = motion.centre_y + (place.along * motion.heading_y + place.across * motion.heading_x) + more.y;
    precise real z = motion.centre_z + place.above + more.z;
    return real3(x, y, z);
}

// The intended place of the probe at a step, m.
real3 motion_at(MotionParams motion, uint path, uint paths, uint step) {
    Place place = place_at(motion, step);
    real3 more = harmonics_at(path, paths, step);
    if (MOTION == kMotionRandomWalk)
        more = real3(turned_round(more.x, motion.reach), turned_round(more.y, motion.across), more.z);
    return in_world(motion, place, more);
}

real3 round_end;     // m: where rounds begin and end, tremor left out
real per_phase_step; // 1: one over the phase step

// Since the beginning of the path, when the work that a step adds begins.
uint phase_of_work(MotionParams motion, uint step) {
    return (LOOP == kLoopOpen ? step - 1u : step) * motion.phase_step;
}

// Whether the work that a step adds completes a round of the motion (there and back, once about, a tap): in open loop
// the work since the step before, in closed loop that until the next.
bool completes_round(MotionParams motion, uint step) {
    if (MOTION == kMotionRaster || MOTION == kMotionRandomWalk || MOTION == kMotionMinimumJerk || MOTION == kMotionRecorded)
        return false;
    uint phase = phase_of_work(motion, step);
    bool goes = motion.phase_step != 0u && motion.phase_step < kHalfTurn; // beyond, it seems to go the other way
    return goes && !(LOOP == kLoopOpen && step == 0u) && phase + motion.phase_step < phase;
}

// Of the step whose work completes a round, the share of time after the round is complete.
real late_share(MotionParams motion, uint step) {
    uint late = phase_of_work(motion, step) + motion.phase_step;
    precise real share = real(int(late)) * per_phase_step;
    return share;
}

// Whether a round ends at `round_end`; a spiral does not come back to where it was, nor a probe in a hand.
const bool ENDS_AT_A_PLACE =
    LOOP == kLoopOpen && (MOTION == kMotionStrokes || MOTION == kMotionCircle || MOTION == kMotionTaps);
