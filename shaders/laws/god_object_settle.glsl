// L6: when a god-object that came to rest goes on, and when it stays, step for step as host/reference/god_object_rest.h.
// What is to be done next is a number, so that invocations do the same at the same time wherever they are.

const uint kRounds = 1000u;
const uint kWays = 4u; // the steepest
#ifdef FS_F64
const uint kStrides = 6u;
#else
const uint kStrides = 3u;
#endif
const real kLengthen = real(8.0LF);
const real kShort = kWidth * real(2.0LF); // what is not further off is the same place
const real kRounding = EPSILON * real(16.0LF);

// What is to be done next.
const uint kDoHold = 0u; // find what holds `now`
const uint kDoHoldAgain = 1u; // likewise, with the triangles seen from both sides
const uint kDoBehind = 2u; // find whether something is between the proxy and `found`
const uint kDoKeep = 3u; // take what the walk ended with for what holds `now`
const uint kDoAccept = 4u; // go on from `now`, if it is closer to the probe
const uint kDoCorner = 5u; // find the corner that ways begin from
const uint kDoWay = 6u; // find the next way
const uint kDoNext = 7u; // try something else
const uint kDoCrossing = 8u; // try what begins elsewhere
const uint kDoTrial = 9u; // try a place along the way
const uint kDoWalk = 10u; // walk, or jump
const uint kDoEnd = 11u;
const uint kDoHost = 12u; // what a kernel cannot do

// What was tried last.
const uint kTryNothing = 0u;
const uint kTryCorner = 1u; // ways from a corner
const uint kTryBeside = 2u; // ways from the place itself
const uint kTryAgain = 3u; // the walk begun anew

uint doing;
uint trying;
Kept before; // the last rest
Rest felt; // its contact
Kept now; // where the walk ended
Rest found; // what may be its contact
bool both_sides;
bool halted; // the walk to the last rest, where a line between two faces ended
uint rounds;
Crossing crossing;
Way way;
uint ways_tried;
uint strides_tried;
bool lifted;
bool jumps_over; // a second jump follows
real3 way_goal;

// Where a rest is, without its skin where that is known.
real3 place_of(Kept kept, Rest contact) {
    return contact.count > 0u ? contact.proxy : kept.proxy;
}

// Ways that gain less end where they begin but for rounding.
real least_of_ways(real3 pull) {
    real far = largest_of(pull) > kFarWay ? real(0.0625LF) : ONE;
    precise real least = far * kRounding * sqrt(product(pull, pull));
    return kShort < least ? least : kShort;
}

// Whether one place is elsewhere than another and closer to the probe for certain. Of a probe far off, of whose distance
// rounding leaves little, what counts is the way.
bool comes_closer(real3 from, real3 to) {
    real3 shift = difference(to, from);
    real3 both = sum(difference(walk_probe, from), difference(walk_probe, to));
    real square = product(shift, shift);
    precise real rounding = kRounding * sqrt(square * product(both, both));
    const real most = real(8.0LF) * kFarWay * kWidth;
    return square > kShort * kShort && product(shift, both) > (most < rounding ? most : rounding);
}

void begin_ways(Crossing from) {
    crossing = from;
    way.gain = LARGEST;
    ways_tried = 0u;
    doing = kDoWay;
}

real stride_size() {
    precise real size = kStride;
    for (uint i = 0u; i < kStrides; ++i)
        if (i < strides_tried)
            size = size * kLengthen;
    return size;
}

// A jump along the way, straight or over a place above the crossing.
void begin_trial() {
    real size = stride_size();
    real stride = size < way.gain ? size : way.gain;
    way_goal = place_along(crossing, way, difference(walk_probe, crossing.place), stride, before.front);
    jumps = true;
    jumps_over = lifted;
    jump_goal = lifted ? sum(crossing.place, scaled(stride, crossing.out_way)) : way_goal;
    walk_proxy = before.proxy;
    forget_all();
    doing = kDoWalk;
}

// The ways of one crossing have been tried.
void next_crossing() {
    real3 place = place_of(before, felt);
    real3 off = difference(crossing.place, place);
    bool apart = !crossing.corner || product(off, off) > kCorner * kCorner;
    if (trying == kTryCorner && apart) {
        trying = kTryBeside;
        begin_ways(Crossing(place, reach_of(false), normalised(difference(before.proxy, place)), false, 0u));
    } else {
        trying = kTryAgain;
        jumps = false;
        put_back(before.proxy, before.count, before.triangles);
        doing = kDoWalk;
    }
}

// What is tried after what was tried last.
void try_next() {
    bool has_out = product(crossing.out_way, crossing.out_way) > ZERO;
    bool same = !lifted && has_out;
    lifted = same;
    strides_tried += same ? 0u : 1u;
    bool along = same || (strides_tried < kStrides && stride_size() < way.gain);
    doing = trying == kTryAgain ? kDoEnd : along ? kDoTrial : ways_tried < kWays ? kDoWay : kDoCrossing;
}

// `now` is where the proxy goes on from, if it is closer to the probe.
void accept() {
    bool far = largest_of(difference(walk_probe, before.proxy)) > kFarWay;
    real3 from = far ? before.proxy : place_of(before, felt);
    real3 to = far ? now.proxy : place_of(now, found);
    bool surely = trying == kTryNothing || (trying == kTryAgain && halted);
    if (!surely && !comes_closer(from, to)) {
        doing = kDoNext;
        return;
    }
    if (trying != kTryNothing) {
        ++rounds;
        halted = walk_corner;
    }
    before = now;
    felt = found;
    // Beyond what the law counts, the host takes over.
    bool counts = rounds < kRounds && walk_substeps < kSubsteps;
    doing = !counts ? kDoHost : before.cornered ? kDoCorner : kDoEnd;
    trying = kTryCorner;
}

// The walk has ended.
void keep() {
    now = Kept(walk_proxy, uvec3(index_at(resting.one.source), index_at(resting.two.source), index_at(resting.three.source)),
               resting.count, resting.count > 0u && (!walk_rests || is_doubtful()), false);
    real3 shift = difference(now.proxy, before.proxy);
    bool surely = trying == kTryAgain && halted;
    bool stays = product(shift, shift) <= kShort * kShort;
    doing = !surely && stays ? kDoNext : kDoHold;
    both_sides = false;
    if (walk_substeps >= kSubsteps)
        doing = kDoHost;
}

// One piece of a walk, or a jump.
void walk_or_jump() {
    walk_on();
    if (overrun)
        return;
    bool over = jumps && !jump_blocked;
    if (jumps && jump_blocked)
        doing = kDoNext;
    if (over) {
        walk_proxy = jump_goal;
        forget_all();
        jump_goal = way_goal;
        jumps = jumps_over;
        jumps_over = false;
    }
    if (over && !jumps)
        begin_walk();
    if (doing == kDoWalk && !jumps && !walk_runs)
        keep();
}
