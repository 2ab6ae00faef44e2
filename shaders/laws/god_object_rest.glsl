// L6: what holds a god-object at rest, and where it is without its skin, step for step as
// host/reference/god_object_rest.h. The hot kernel knows one or two faces right below the proxy.

// What an update found.
struct Rest {
    real3 proxy; // on the surface; the probe itself out of contact
    uint count; // facets that hold the proxy
    uvec3 facets; // the lowest first
    uvec3 triangles;
    uvec3 sources; // where the triangles were listed
    bool back; // the first is touched from behind
};

Rest out_of_contact(real3 probe) {
    return Rest(probe, 0u, uvec3(0u), uvec3(0u), uvec3(0u), false);
}

// A probe less deep than rounding makes it is out of contact.
real touch_tolerance(real3 probe) {
    precise real tolerance = real(16.0LF) * EPSILON * (ONE + largest_of(probe));
    return tolerance;
}

// A plane of a triangle that may hold a proxy.
struct Holder {
    uint triangle;
    real3 normal; // of the face, towards the proxy
    real3 corner; // the triangle's first
    bool back;
};

// Adds a triangle that holds the proxy.
void add_holder(Holder holder, uint source, inout Rest rest) {
    uint facet = triangle_words[2u * holder.triangle].x;
    uvec4 added = uvec4(facet, holder.triangle, source, holder.back ? 1u : 0u);
    uvec4 first = uvec4(rest.facets.x, rest.triangles.x, rest.sources.x, rest.back ? 1u : 0u);
    uvec4 second = uvec4(rest.facets.y, rest.triangles.y, rest.sources.y, 0u);
    uvec4 third = uvec4(0u);
    bool before_first = rest.count == 0u || first.x > facet;
    bool before_second = rest.count < 2u || second.x > facet;
    third = before_second ? second : added;
    second = before_first ? first : before_second ? added : second;
    first = before_first ? added : first;
    rest.facets = uvec3(first.x, second.x, third.x);
    rest.triangles = uvec3(first.y, second.y, third.y);
    rest.sources = uvec3(first.z, second.z, third.z);
    rest.back = first.w != 0u;
    ++rest.count;
}

Rest contact_of_one(Holder holder, real3 probe) {
    Rest rest = out_of_contact(probe);
    real depth = product(holder.normal, difference(holder.corner, probe));
    if (!(depth > touch_tolerance(probe)))
        return rest;
    rest.proxy = sum(probe, scaled(depth, holder.normal));
    rest.proxy = sum(rest.proxy, scaled(product(holder.normal, difference(holder.corner, rest.proxy)), holder.normal));
    add_holder(holder, 0u, rest);
    return rest;
}

HalfSpace plane_of(Holder holder, real3 probe, uint source) {
    return HalfSpace(holder.normal, product(holder.normal, difference(holder.corner, probe)), source);
}

void more_violated(HalfSpace plane, bool holding, real3 shift, inout real most, inout HalfSpace worst) {
    real violation = miss_of(plane, shift);
    if (holding && violation > most) {
        most = violation;
        worst = plane;
    }
}

// The facets whose planes hold the probe back, and the nearest point to the probe in front of them: the proxy without
// its skin.
Rest contact_of(Holder one, Holder two, Holder three, uint count, real3 probe) {
    real tolerance = touch_tolerance(probe);
    HalfSpace first = plane_of(one, probe, 0u);
    HalfSpace second = plane_of(two, probe, 1u);
    HalfSpace third = plane_of(three, probe, 2u);
    Projection projection = free_projection(real3(exact_zero));
    uint left = kProjectionRounds;
    bool seeking = true;
    [[dont_unroll]] do {
        real most = tolerance;
        HalfSpace worst = first;
        more_violated(first, count > 0u, projection.vector, most, worst);
        more_violated(second, count > 1u, projection.vector, most, worst);
        more_violated(third, count > 2u, projection.vector, most, worst);
        bool fits = false;
        if (seeking && most > tolerance)
            fits = hold_also(real3(exact_zero), worst, one_tolerance(tolerance), projection);
        --left;
        seeking = seeking && fits && left > 0u;
    } while (seeking);
    Rest rest = out_of_contact(probe);
    rest.proxy = sum(probe, projection.vector);
    [[unroll]] for (uint i = 0u; i < 3u; ++i) {
        HalfSpace held = held_at(projection, i);
        Holder holder = one;
        if (held.source == 1u)
            holder = two;
        if (held.source == 2u)
            holder = three;
        if (i < projection.count)
            add_holder(holder, held.source, rest);
    }
    return rest;
}

// How far from the walk's proxy the contact is, in skins.
real skins_away(Rest rest) {
    real3 shift = difference(rest.proxy, walk_proxy);
    precise real skins = sqrt(product(shift, shift)) / kWidth;
    return skins;
}

// What is `source` in the pool.
Holder holder_at(uint source) {
    Touch touch = touch_at(source);
    return Holder(index_at(source), touch.face, touch.triangle.a, product(touch.face, touch.triangle.normal) < ZERO);
}

// Whether only one or two faces right below the proxy leave no other way.
bool is_doubtful() {
    return resting.count == 3u || (resting.count > 0u && !is_above(resting.one.source)) ||
           (resting.count > 1u && !is_above(resting.two.source));
}

#ifndef FS_RARE
// The contact of a proxy that rests on one or two faces; is_rare where it is another.
Rest contact_at_rest() {
    Holder one = holder_at(resting.count > 0u ? resting.one.source : 0u);
    Holder two = holder_at(resting.count > 1u ? resting.two.source : 0u);
    Rest rest = contact_of_one(one, walk_probe);
    Rest both = contact_of(one, two, two, resting.count, walk_probe);
    if (resting.count == 0u)
        rest = out_of_contact(walk_probe);
    if (resting.count == 2u) {
        rest = both;
        rest.sources.x = rest.sources.x == 0u ? resting.one.source : resting.two.source;
        rest.sources.y = rest.sources.y == 0u ? resting.one.source : resting.two.source;
    } else
        rest.sources.x = resting.one.source;
    is_rare = is_rare || is_doubtful() || (rest.count > 0u && !(skins_away(rest) <= real(2.0LF)));
    return rest;
}
#else
HalfSpace skin_of(Holder holder) {
    return HalfSpace(holder.normal, -ONE, 0u);
}

// How far from the proxy, in skins, the planes that hold it meet.
real skins_to_planes(Holder one, Holder two, Holder three, uint count) {
    Projection meeting_point = onto_line(real3(exact_zero), skin_of(one), skin_of(two));
    if (count == 3u)
        meeting_point = onto_corner(real3(exact_zero), skin_of(one), skin_of(two), skin_of(three));
    precise real size = sqrt(product(meeting_point.vector, meeting_point.vector));
    return count > 1u && meeting_point.count > 0u ? size : ONE;
}

bool crosses(uint index, real3 way, real3 place, real last) {
    Triangle triangle = triangle_at(index);
    real from = product(triangle.normal, difference(walk_proxy, triangle.a));
    real to = product(triangle.normal, difference(place, triangle.a));
    precise real sides = from * to;
    precise real time = from / (from - to);
    real3 crossing = sum(walk_proxy, scaled(time, way));
    return sides < ZERO && !(time > last) && nearest_on_triangle(crossing, triangle).square <= kRest * kRest;
}

// Whether something is in the way from the proxy to a place that may touch: more than a skin, and a hundredth of the way
// in acute corners, before its end.
bool is_behind(real3 place) {
    real3 way = difference(place, walk_proxy);
    precise real last = real(0.99LF) - kWidth / sqrt(product(way, way));
    Move move = Move(walk_proxy, way, ONE);
    bool behind = false;
    begin_search();
    [[dont_unroll]] do {
        search_on(move);
        RunCursor cursor = first_of_runs();
        bool next = true;
        [[dont_unroll]] do {
            uint index;
            next = next_of_runs(cursor, index);
            if (next)
                behind = behind || crosses(index, way, place, last);
            ++spent;
        } while (next);
    } while (search_goes_on());
    return behind;
}

// The contact of a proxy in the open or held by faces alone, where a walk came to rest. One that is not at the proxy is
// none: the proxy is, then, with its skin.
Rest contact_at_rest() {
    uint count = resting.count;
    Holder at[3];
    uint i = 0u;
    [[dont_unroll]] do {
        at[i] = holder_at(i < count ? held_at(resting, i).source : 0u);
        ++i;
        ++spent;
    } while (i < 3u);
    Rest rest = contact_of(at[0], at[1], at[2], count, walk_probe);
    if (count == 1u)
        rest = contact_of_one(at[0], walk_probe);
    real skins = skins_away(rest);
    // The planes in the order of the contact's facets.
    precise real reach = real(4.0LF) * (ONE + skins_to_planes(at[rest.sources.x], at[rest.sources.y], at[rest.sources.z],
                                                              rest.count));
    bool at_proxy = rest.count == 0u || skins <= real(2.0LF);
    if (!at_proxy && skins <= reach)
        at_proxy = !is_behind(rest.proxy);
    if (at_proxy)
        return rest;
    rest = out_of_contact(walk_probe);
    rest.proxy = walk_proxy;
    [[unroll]] for (uint j = 0u; j < 3u; ++j)
        if (j < count)
            add_holder(at[j], j, rest);
    return rest;
}
#endif
