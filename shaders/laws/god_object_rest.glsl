// L6: what constrains a god-object at rest, and where it is without its skin, step for step as
// host/reference/god_object_rest.h, for one or two faces right below the proxy.

// The result of an update.
struct Rest {
    real3 proxy; // on the surface; the probe itself out of contact
    uint count; // facets that constrain the proxy
    uvec2 facets; // the lowest first
    uvec2 triangles;
    uvec2 sources; // where the triangles are in the pool
    bool back; // the first is touched from behind
};

Rest out_of_contact(real3 probe) {
    return Rest(probe, 0u, uvec2(0u), uvec2(0u), uvec2(0u), false);
}

// A probe less deep than rounding makes it is out of contact.
real touch_tolerance(real3 probe) {
    precise real tolerance = real(16.0LF) * EPSILON * (ONE + largest_of(probe));
    return tolerance;
}

// The plane of a triangle that may constrain a proxy.
struct Holder {
    uint triangle;
    real3 normal; // of the face, towards the proxy
    real3 corner; // the triangle's first
    bool back;
};

// What is `source` in the pool.
Holder holder_at(uint source) {
    Touch touch = touch_at(source);
    return Holder(index_at(source), touch.face, touch.triangle.a, product(touch.face, touch.triangle.normal) < ZERO);
}

// Adds a triangle that constrains the proxy.
void add_holder(Holder holder, uint source, inout Rest rest) {
    uint facet = triangle_words[2u * holder.triangle].x;
    bool first = rest.count == 0u || facet < rest.facets.x;
    rest.facets = first ? uvec2(facet, rest.facets.x) : uvec2(rest.facets.x, facet);
    rest.triangles = first ? uvec2(holder.triangle, rest.triangles.x) : uvec2(rest.triangles.x, holder.triangle);
    rest.sources = first ? uvec2(source, rest.sources.x) : uvec2(rest.sources.x, source);
    rest.back = first ? holder.back : rest.back;
    ++rest.count;
}

Rest contact_of_one(Holder holder, uint source, real3 probe) {
    Rest rest = out_of_contact(probe);
    real depth = product(holder.normal, difference(holder.corner, probe));
    if (!(depth > touch_tolerance(probe)))
        return rest;
    rest.proxy = sum(probe, scaled(depth, holder.normal));
    rest.proxy = sum(rest.proxy, scaled(product(holder.normal, difference(holder.corner, rest.proxy)), holder.normal));
    add_holder(holder, source, rest);
    return rest;
}

// The facets of two whose planes keep the probe from the proxy, and the nearest point to the probe in front of them: the
// proxy without its skin.
Rest contact_of_two(Holder one, uint source_one, Holder two, uint source_two, real3 probe) {
    real tolerance = touch_tolerance(probe);
    HalfSpace first = HalfSpace(one.normal, product(one.normal, difference(one.corner, probe)), source_one);
    HalfSpace second = HalfSpace(two.normal, product(two.normal, difference(two.corner, probe)), source_two);
    Projection projection = free_projection(real3(exact_zero));
    uint left = kProjectionRounds;
    bool seeking = true;
    [[dont_unroll]] do {
        HalfSpace worst = first;
        real most = miss_of(first, projection.vector);
        if (miss_of(second, projection.vector) > (most > tolerance ? most : tolerance)) {
            worst = second;
            most = miss_of(second, projection.vector);
        }
        bool fits = false;
        if (seeking && most > tolerance)
            fits = add_half_space(real3(exact_zero), worst, tolerance, projection);
        --left;
        seeking = seeking && fits && left > 0u;
    } while (seeking);
    Rest rest = out_of_contact(probe);
    rest.proxy = sum(probe, projection.vector);
    if (projection.count > 0u && projection.one.source == source_one)
        add_holder(one, source_one, rest);
    else if (projection.count > 0u)
        add_holder(two, source_two, rest);
    if (projection.count > 1u && projection.two.source == source_one)
        add_holder(one, source_one, rest);
    else if (projection.count > 1u)
        add_holder(two, source_two, rest);
    return rest;
}

// Whether a place is where the walk's proxy is, but for its skin.
bool is_beside_proxy(real3 place) {
    real3 shift = difference(place, walk_proxy);
    precise real most = (real(2.0LF) * kWidth) * (real(2.0LF) * kWidth);
    return product(shift, shift) <= most;
}

// The contact of a proxy that rests on one or two faces right below it, with its certificate: it is where the proxy is,
// and without a contact so is the probe. What rests otherwise is left to the host.
Rest contact_at_rest() {
    uint source_one = resting.count > 0u ? resting.one.source : 0u;
    uint source_two = resting.count > 1u ? resting.two.source : 0u;
    Holder one = holder_at(source_one);
    Rest rest = out_of_contact(walk_probe);
    if (resting.count == 1u)
        rest = contact_of_one(one, source_one, walk_probe);
    else if (resting.count == 2u)
        rest = contact_of_two(one, source_one, holder_at(source_two), source_two, walk_probe);
    bool faces = (resting.count == 0u || is_above(source_one)) && (resting.count < 2u || is_above(source_two));
    bool certain = (rest.count == 0u && resting.count < 2u) || is_beside_proxy(rest.proxy);
    is_left = is_left || !faces || !certain;
    return rest;
}
