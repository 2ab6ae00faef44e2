// L6: the projection onto the directions that up to three planes allow, step for step as
// host/reference/god_object_planes.h.

// normal . v >= slack.
struct HalfSpace {
    real3 normal; // unit
    real slack;
    uint source; // whose it is
};

// The vector nearest to a wish among those that the half-spaces allow, and the half-spaces that hold it there.
struct Projection {
    real3 vector;
    HalfSpace one;
    HalfSpace two;
    HalfSpace three;
    real3 multipliers; // vector - wish = sum multipliers * normals
    uint count;
};

// What rounding of a projection explains.
struct Tolerance {
    real push;
    real least; // of a height
    real most;
};

const HalfSpace kNoHalfSpace = HalfSpace(real3(ZERO), ZERO, 0u);

real largest_of(real3 v) {
    real x = abs(v.x);
    real y = abs(v.y);
    real z = abs(v.z);
    real xy = x > y ? x : y;
    return xy > z ? xy : z;
}

bool is_finite(real3 v) {
    return largest_of(v) <= LARGEST;
}

Projection free_projection(real3 wish) {
    return Projection(wish, kNoHalfSpace, kNoHalfSpace, kNoHalfSpace, real3(ZERO), 0u);
}

HalfSpace held_at(Projection projection, uint i) {
    HalfSpace held = projection.one;
    if (i == 1u)
        held = projection.two;
    if (i == 2u)
        held = projection.three;
    return held;
}

// Whether the half-space of `source` is among those that hold.
bool holds(Projection projection, uint source) {
    return (projection.count > 0u && projection.one.source == source) ||
           (projection.count > 1u && projection.two.source == source) ||
           (projection.count > 2u && projection.three.source == source);
}

real miss_of(HalfSpace space, real3 vector) {
    precise real miss = space.slack - product(space.normal, vector);
    return miss;
}

Projection onto_plane(real3 wish, HalfSpace one) {
    real multiplier = miss_of(one, wish);
    real3 vector = sum(wish, scaled(multiplier, one.normal));
    vector = sum(vector, scaled(miss_of(one, vector), one.normal));
    return Projection(vector, one, kNoHalfSpace, kNoHalfSpace, real3(multiplier, ZERO, ZERO), 1u);
}

// Onto the line where two planes meet; count stays 0 if they are parallel.
Projection onto_line(real3 wish, HalfSpace one, HalfSpace other) {
    const real parallel = EPSILON * EPSILON * real(256.0LF);
    real3 line = cross_product(one.normal, other.normal);
    real square = product(line, line);
    real3 to_one = divided(cross_product(other.normal, line), square);
    real3 to_other = divided(cross_product(line, one.normal), square);
    precise real along = product(line, wish) / square;
    real3 vector = sum(sum(scaled(along, line), scaled(one.slack, to_one)), scaled(other.slack, to_other));
    vector = sum(vector, sum(scaled(miss_of(one, vector), to_one), scaled(miss_of(other, vector), to_other)));
    real3 shift = difference(vector, wish);
    return Projection(vector, one, other, kNoHalfSpace, real3(product(shift, to_one), product(shift, to_other), ZERO),
                      square > parallel ? 2u : 0u);
}

#ifdef FS_RARE
real3 meeting(real one, real two, real three, real3 bc, real3 ca, real3 ab, real volume) {
    return divided(sum(sum(scaled(one, bc), scaled(two, ca)), scaled(three, ab)), volume);
}

// The corner where three planes meet; count stays 0 if they have none.
Projection onto_corner(real3 wish, HalfSpace a, HalfSpace b, HalfSpace c) {
    const real flat_volume = EPSILON * real(16.0LF);
    real3 bc = cross_product(b.normal, c.normal);
    real3 ca = cross_product(c.normal, a.normal);
    real3 ab = cross_product(a.normal, b.normal);
    real volume = product(a.normal, bc);
    real3 vector = meeting(a.slack, b.slack, c.slack, bc, ca, ab, volume);
    vector = sum(vector, meeting(miss_of(a, vector), miss_of(b, vector), miss_of(c, vector), bc, ca, ab, volume));
    real3 shift = difference(vector, wish);
    precise real at_a = product(shift, bc) / volume;
    precise real at_b = product(shift, ca) / volume;
    precise real at_c = product(shift, ab) / volume;
    return Projection(vector, a, b, c, real3(at_a, at_b, at_c), abs(volume) > flat_volume ? 3u : 0u);
}
#endif

real height_tolerance(Tolerance tolerance, real3 vector) {
    precise real rounding = tolerance.least + real(8.0LF) * EPSILON * largest_of(vector);
    return rounding < tolerance.most ? rounding : tolerance.most;
}

Tolerance one_tolerance(real tolerance) {
    return Tolerance(tolerance, tolerance, tolerance);
}

bool stays_within(HalfSpace space, real3 vector, real below) {
    precise real least = space.slack - below;
    return product(space.normal, vector) >= least;
}

// Whether a projection pushes only off its planes and stays within those of another.
bool is_nearest(Projection result, Projection others, Tolerance tolerance) {
    bool pushes = result.multipliers.x >= -tolerance.push &&
                  (result.count < 2u || result.multipliers.y >= -tolerance.push) &&
                  (result.count < 3u || result.multipliers.z >= -tolerance.push);
    real below = height_tolerance(tolerance, result.vector);
    bool within = (others.count < 1u || stays_within(others.one, result.vector, below)) &&
                  (others.count < 2u || stays_within(others.two, result.vector, below)) &&
                  (others.count < 3u || stays_within(others.three, result.vector, below));
    return result.count > 0u && pushes && within;
}

// Adds a half-space that `now` violates. False, and nothing changed, if no vector satisfies them all. The hot kernel
// leaves corners to the other one.
bool hold_also(real3 wish, HalfSpace added, Tolerance tolerance, inout Projection now) {
    uint lines = now.count + 1u;
#ifdef FS_RARE
    uint last = now.count == 3u ? 7u : now.count == 2u ? 4u : lines;
#else
    uint last = lines;
#endif
    uint tried = 0u;
    bool found = false;
    [[dont_unroll]] do {
        Projection next = onto_plane(wish, added);
        if (tried > 0u)
            next = onto_line(wish, added, held_at(now, tried - 1u));
#ifdef FS_RARE
        if (tried >= lines) {
            uint pair = tried - lines; // 01, 02, 12
            next = onto_corner(wish, added, held_at(now, pair == 2u ? 1u : 0u), held_at(now, pair == 0u ? 1u : 2u));
        }
#endif
        found = is_nearest(next, now, tolerance);
        if (found)
            now = next;
        ++tried;
        ++spent;
    } while (!found && tried < last);
#ifndef FS_RARE
    is_rare = is_rare || (!found && now.count > 1u);
#endif
    return found;
}
