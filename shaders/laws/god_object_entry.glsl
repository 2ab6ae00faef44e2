// L6: where a god-object that comes from far off enters the region in which it minds the mesh, step for step as
// host/reference/god_object_entry.h: in double in every precision.

void cut(double near_end, double far_end, inout double begin, inout double end, inout bool crosses) {
    const double side = 1.5LF;
    precise double way = far_end - near_end;
    precise double low = (-side - near_end) / way;
    precise double high = (side - near_end) / way;
    double first = high < low ? high : low;
    double last = low < high ? high : low;
    bool finite_way = abs(way) <= 1.7976931348623157e308LF;
    crosses = crosses && finite_way;
    if (way == 0.0LF)
        end = abs(near_end) > side ? -1.0LF : end;
    else {
        begin = begin < first ? first : begin;
        end = last < end ? last : end;
    }
}

real entered(double near_end, double far_end, double time) {
    const double side = 1.5LF;
    precise double there = near_end + time * (far_end - near_end);
    return real(there < -side ? -side : side < there ? side : there);
}

real on_side(real coordinate) {
    return coordinate < ZERO ? real(-1.5LF) : real(1.5LF);
}

// False if a straight way from a proxy outside of the region does not enter it.
bool find_entry(real3 proxy, real3 probe, out real3 place) {
    bool back = largest_of(probe) < largest_of(proxy);
    dvec3 near_end = dvec3(back ? probe : proxy);
    dvec3 far_end = dvec3(back ? proxy : probe);
    double begin = 0.0LF;
    double end = 1.0LF;
    bool crosses = true;
    cut(near_end.x, far_end.x, begin, end, crosses);
    cut(near_end.y, far_end.y, begin, end, crosses);
    cut(near_end.z, far_end.z, begin, end, crosses);
    double time = back ? end : begin;
    place = real3(entered(near_end.x, far_end.x, time), entered(near_end.y, far_end.y, time),
                  entered(near_end.z, far_end.z, time));
    // On the region's border to the last bit, so that it is outside of the mesh.
    uint side = abs(place.x) < abs(place.y) ? 1u : 0u;
    side = (side == 1u ? abs(place.y) : abs(place.x)) < abs(place.z) ? 2u : side;
    if (side == 0u)
        place.x = on_side(place.x);
    else if (side == 1u)
        place.y = on_side(place.y);
    else
        place.z = on_side(place.z);
    return crosses && begin <= end;
}
