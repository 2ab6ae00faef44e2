// L6: what a god-object that settles looks at around it, and what follows: the corner and the ways that lead from a place
// (host/reference/god_object_ways.h), and what holds a proxy (god_object_held.h). All that is looked at goes one way
// through the tree, so that invocations do so together whatever they look for.

// What the triangles around are looked at for.
struct Look {
    real3 place;
    real3 way; // 0, or to where something may be behind
    real least; // squared distance up to which triangles are listed; or corners kept
    real last; // of the way
};

Look look_for() {
    Look look = Look(walk_proxy, real3(ZERO), kNear * kNear, ZERO);
    if (doing == kDoCorner) {
        look.place = place_of(before, felt);
        // Folds narrower than the skin may keep the proxy, but not its contact, off a corner.
        real reach = all(equal(look.place, before.proxy)) ? kFold : kCorner;
        precise real square = reach * reach;
        look.least = square;
    }
    if (doing == kDoWay) {
        look.place = crossing.place;
        precise real square = crossing.reach * crossing.reach;
        look.least = square;
    }
    if (doing == kDoBehind) {
        look.way = difference(found.proxy, walk_proxy);
        precise real last = real(0.99LF) - kWidth / sqrt(product(look.way, look.way));
        look.last = last;
        look.least = kRest * kRest;
    }
    return look;
}

// Looks at all triangles around: true if one of them is in the way. Lists those that are near, and finds a corner.
bool look_around(Look look, inout Crossing corner) {
    bool is_way = doing == kDoWay;
    bool is_behind = doing == kDoBehind;
    bool is_hold = doing == kDoHold && now.cornered;
    bool lists = is_way || is_hold;
    Move move = Move(look.place, look.way, is_behind ? ONE : ZERO);
    real nearest_square = look.least;
    bool behind = false;
    begin_search();
    if (lists)
        near_count = 0u;
    if (!lists && !is_behind && doing != kDoCorner)
        stack_height = 0u;
    [[dont_unroll]] do {
        search_on(move);
        RunCursor cursor = first_of_runs();
        bool next = true;
        [[dont_unroll]] do {
            uint index;
            next = next_of_runs(cursor, index);
            if (next) {
                Triangle triangle = triangle_at(index);
                uvec3 corners = triangle_corners(index);
                real height = product(triangle.normal, difference(look.place, triangle.a));
                real to = product(triangle.normal, difference(found.proxy, triangle.a));
                precise real sides = height * to;
                precise real time = height / (height - to);
                real3 point = look.place;
                if (is_behind)
                    point = sum(look.place, scaled(time, look.way));
                TrianglePoint nearest = nearest_on_triangle(point, triangle);
                bool is_near = nearest.square <= look.least;
                behind = behind || (is_behind && sides < ZERO && !(time > look.last) && is_near);
                bool at_vertex = is_way && crossing.corner && any(equal(corners, uvec3(crossing.vertex)));
                bool level = !is_hold || abs(height) <= kNear;
                if (doing == kDoCorner) {
                    consider_corner(corners.x, triangle.a, corner, nearest_square);
                    consider_corner(corners.y, triangle.b, corner, nearest_square);
                    consider_corner(corners.z, triangle.c, corner, nearest_square);
                }
                if (lists && level && (is_near || at_vertex)) {
                    near_crowded = near_crowded || near_count == kMostNear;
                    bool above = is_above(triangle, nearest, look.place, now.front);
                    near_listed[near_crowded ? 0u : near_count++] = index << 1 | (above ? 1u : 0u);
                }
            }
            ++spent;
        } while (next && spent < spent_limit);
        overrun = overrun || (next && spent >= spent_limit);
    } while (search_goes_on());
    return behind;
}

// The corner that was found, if any, and what is tried first.
void found_corner(Crossing corner) {
    real3 normal = normalised(vertex_pseudonormal(corner.vertex));
    if (corner.corner) {
        corner.place = vertex_place(corner.vertex);
        corner.out_way = before.front ? normal : -normal;
    }
    begin_ways(corner);
    if (!corner.corner)
        doing = kDoCrossing;
}

// The steepest way that is less steep than the last one, of the lowest facet and triangle among equals.
void find_next_way() {
    real3 pull = difference(walk_probe, crossing.place);
    WaySearch search = WaySearch(pull, way.gain, Way(least_of_ways(pull), 0u, 3u), false);
    bool finding = doing == kDoWay;
    uint count = finding ? near_count : 0u;
    uint i = 0u;
    [[dont_unroll]] do {
        if (i < count) {
            uint index = near_listed[i] >> 1;
            Triangle triangle = triangle_at(index);
            offer_face(triangle, index, crossing, search);
            offer_edge(triangle, index, 0u, crossing, search);
            offer_edge(triangle, index, 1u, crossing, search);
            offer_edge(triangle, index, 2u, crossing, search);
        }
        ++i;
        ++spent;
    } while (i < count);
    if (finding) {
        ++ways_tried;
        strides_tried = 0u;
        lifted = false;
        doing = search.found ? kDoTrial : kDoCrossing;
    }
    if (finding && search.found)
        way = search.best;
}

// The contact that was found is none, or is not at the proxy.
void hold_otherwise() {
    doing = now.cornered && !both_sides ? kDoHoldAgain : kDoKeep;
    both_sides = true;
}

// What holds `now`: of the triangles that were listed, or of those that the walk ended with.
void find_contact() {
    bool keeps = doing == kDoKeep;
    bool finding = doing == kDoHold || doing == kDoHoldAgain;
    bool of_list = finding && now.cornered;
    Projection all = holders_of_all(of_list, walk_proxy, now.front, both_sides, walk_probe);
    uint count = of_list ? all.count : now.count;
    Holder at[3];
    uint i = 0u;
    [[dont_unroll]] do {
        uint listed = held_at(all, i).source;
        uint index = i >= count ? 0u : of_list ? listed >> 1 : kept_triangle(now, i);
        Triangle triangle = triangle_at(index);
        bool above = is_above(triangle, nearest_on_triangle(walk_proxy, triangle), walk_proxy, now.front);
        at[i] = holder_of(index, triangle, of_list ? (listed & 1u) != 0u : above);
        if (!now.cornered)
            at[i] = holder_at(i < count ? held_at(resting, i).source : 0u);
        ++i;
        ++spent;
    } while (i < 3u);
    Rest rest = contact_of(at[0], at[1], at[2], count, walk_probe);
    if (!now.cornered && count == 1u)
        rest = contact_of_one(at[0], walk_probe);
    real skins = skins_away(rest);
    precise real reach = real(4.0LF) * (ONE + skins_to_planes(at[rest.sources.x], at[rest.sources.y], at[rest.sources.z],
                                                              rest.count));
    if (keeps) {
        rest = out_of_contact(walk_probe);
        rest.proxy = walk_proxy;
        [[unroll]] for (uint j = 0u; j < 3u; ++j)
            if (j < count)
                add_holder(at[j], j, rest);
    }
    bool touching = rest.count > 0u;
    if (finding || keeps)
        found = rest;
    if (keeps || (finding && (touching ? skins <= real(2.0LF) : !now.cornered || both_sides)))
        doing = kDoAccept;
    else if (finding && touching && skins <= reach)
        doing = kDoBehind;
    else if (finding)
        hold_otherwise();
}

// One look at what is around, or none, and what follows from it.
void look_on() {
    bool front = is_in_front(now);
    if (doing == kDoHold && now.cornered)
        now.front = front;
    Look look = look_for();
    Crossing corner = Crossing(look.place, reach_of(true), real3(ZERO), false, 0u);
    bool was_behind = doing == kDoBehind;
    bool was_corner = doing == kDoCorner;
    bool behind = look_around(look, corner);
    if (overrun)
        return;
    if (near_crowded)
        doing = kDoHost;
    find_next_way();
    find_contact();
    if (was_behind && behind)
        hold_otherwise();
    else if (was_behind)
        doing = kDoAccept;
    if (was_corner)
        found_corner(corner);
    if (doing == kDoAccept)
        accept();
    if (doing == kDoNext)
        try_next();
    if (doing == kDoCrossing)
        next_crossing();
    if (doing == kDoTrial)
        begin_trial();
}

