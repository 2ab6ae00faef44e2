// L7 to L9: depth, force, proxy and facet of a probe that touches a mesh, step for step as host/reference/mesh_contact.h.

// L7: the vertex normals of a facet, interpolated at a point of it. Loops over a facet's corners take UNROLL of them an
// iteration: drivers may end long loops.

struct MeshCorner {
    real3 offset; // 1: corner - point
    real distance;
    real3 normal;
};

MeshCorner corner_at(uint corner, real3 point) {
    uint vertex = facet_words[corner];
    real3 offset = difference(vertex_position(vertex), point);
    precise real distance = root(product(offset, offset));
    return MeshCorner(offset, distance, vertex_normal(vertex));
}

real3 morgenbesser_normal(uint begin, uint end, real3 point) {
    precise real distances = ZERO;
    real3 normals = real3(ZERO);
    real3 weighted = real3(ZERO);
    uint i = begin;
    while (i < end)
        [[unroll]] for (uint j = 0u; j < UNROLL; ++j)
            if (i < end) {
                MeshCorner corner = corner_at(i++, point);
                distances = distances + corner.distance;
                normals = sum(normals, corner.normal);
                weighted = sum(weighted, scaled(corner.distance, corner.normal));
            }
    if (i != end)
        atomicOr(status, kStatusUnfinished);
    return difference(scaled(distances, normals), weighted);
}

real not_negative(real value) {
    return value > ZERO ? value : ZERO;
}

real3 barycentric_normal(uint begin, real3 normal, real3 point) {
    MeshCorner a = corner_at(begin, point);
    MeshCorner b = corner_at(begin + 1u, point);
    MeshCorner c = corner_at(begin + 2u, point);
    real at_a = not_negative(product(normal, cross_product(b.offset, c.offset)));
    real at_b = not_negative(product(normal, cross_product(c.offset, a.offset)));
    real at_c = not_negative(product(normal, cross_product(a.offset, b.offset)));
    return sum(sum(scaled(at_a, a.normal), scaled(at_b, b.normal)), scaled(at_c, c.normal));
}

// A corner, projected into the facet's plane.
MeshCorner flat_corner_at(uint index, real3 point, real3 normal) {
    MeshCorner corner = corner_at(index, point);
    corner.offset = difference(corner.offset, scaled(product(normal, corner.offset), normal));
    precise real distance = root(product(corner.offset, corner.offset));
    corner.distance = distance;
    return corner;
}

// The sum over the facet's edges as far as it has come; `decided` where the point lies on an edge or a corner.
struct MeanValue {
    real3 sum;
    real weights;
    bool decided;
};

void add_edge(inout MeanValue mean, MeshCorner start, MeshCorner stop, real3 normal) {
    precise real reach = start.distance * stop.distance;
    real along = product(start.offset, stop.offset);
    real across = product(normal, cross_product(start.offset, stop.offset));
    precise real least = EPSILON * reach;
    if (!(stop.distance > ZERO)) {
        mean = MeanValue(stop.normal, ONE, true);
        return;
    }
    if (!(along > ZERO) && !(abs(across) > least)) {
        mean = MeanValue(sum(scaled(stop.distance, start.normal), scaled(start.distance, stop.normal)), ONE, true);
        return;
    }
    precise real above = reach + along;
    precise real below = reach - along;
    precise real tangent = along > ZERO ? quotient(across, above) : quotient(below, across);
    precise real at_start = quotient(tangent, start.distance);
    precise real at_stop = quotient(tangent, stop.distance);
    mean.sum = sum(mean.sum, sum(scaled(at_start, start.normal), scaled(at_stop, stop.normal)));
    precise real weights = mean.weights + (at_start + at_stop);
    mean.weights = weights;
}

real3 mean_value_normal(uint begin, uint end, real3 normal, real3 point) {
    MeanValue mean = MeanValue(real3(ZERO), ZERO, false);
    MeshCorner start = flat_corner_at(end - 1u, point, normal);
    uint i = begin;
    while (i < end)
        [[unroll]] for (uint j = 0u; j < UNROLL; ++j)
            if (i < end) {
                MeshCorner stop = flat_corner_at(i++, point, normal);
                add_edge(mean, start, stop, normal);
                start = stop;
                if (mean.decided)
                    i = end;
            }
    if (i != end)
        atomicOr(status, kStatusUnfinished);
    if (mean.weights < ZERO)
        return -mean.sum;
    return mean.sum;
}

real3 shading_direction(uint facet, real3 normal, real3 point) {
    if (SHADING == kShadingNone)
        return normal;
    uint begin = facet_words[facet];
    uint end = facet_words[facet + 1u];
    uint corners = mesh.facets + 1u;
    if (SHADING == kShadingMorgenbesser)
        return normalised(morgenbesser_normal(corners + begin, corners + end, point));
    if (SHADING == kShadingBarycentric)
        return normalised(barycentric_normal(corners + begin, normal, point));
    return normalised(mean_value_normal(corners + begin, corners + end, normal, point));
}

// The contact.

struct Contact {
    real depth;     // m, 0 out of contact
    real3 force;    // N
    real3 unshaded; // N: what shading "none" would give
    real3 proxy;    // m, from the scene's origin: the nearest point of the mesh; the probe itself out of contact
    uint facet;
};

// m, from the scene's origin.
real3 to_scene(real3 point) {
    precise real x = point.x * mesh.scale + mesh.centre_x;
    precise real y = point.y * mesh.scale + mesh.centre_y;
    precise real z = point.z * mesh.scale + mesh.centre_z;
    return real3(x, y, z);
}

// m: where a height map is read.
real2 map_place(real3 point) {
    precise real x = point.x * mesh.scale + mesh.map_x;
    precise real y = point.y * mesh.scale + mesh.map_y;
    return real2(x, y);
}

// The part of a height map's gradient that lies in a facet's plane.
real3 in_plane(Gradient gradient, real3 normal) {
    precise real across = gradient.x * normal.x + gradient.y * normal.y;
    precise real x = gradient.x - across * normal.x;
    precise real y = gradient.y - across * normal.y;
    precise real z = -(across * normal.z);
    return real3(x, y, z);
}

// Where a probe touches a mesh.
struct MeshTouch {
    uint facet;
    real3 offset; // 1: proxy - probe
    real3 point;  // 1: the proxy, in the mesh's frame
    real distance;
};

// L7 and L9: the force before texture; as the unshaded one where the direction has no length or `two_pass` would pull.
real3 shaded_force(MeshTouch touch, real3 unshaded) {
    if (SHADING == kShadingNone && MAP == kMapNone)
        return unshaded;
    real3 normal = facet_normal(touch.facet);
    real3 direction = shading_direction(touch.facet, normal, touch.point);
    if (!(product(direction, direction) > ZERO))
        return unshaded;
    if (MAP != kMapNone) {
        real2 place = map_place(touch.point);
        direction = normalised(difference(direction, in_plane(map_gradient(place.x, place.y), normal)));
        if (!(product(direction, direction) > ZERO))
            return unshaded;
    }
    precise real magnitude = mesh.stiffness * touch.distance;
    if (SHADING == kShadingTwoPass) {
        real lift = product(direction, normal);
        if (!(lift > ZERO))
            return unshaded;
        magnitude = quotient(magnitude, lift);
    }
    return scaled(magnitude, direction);
}

Contact touching_contact(MeshTouch touch) {
    Contact contact;
    precise real depth = touch.distance * mesh.scale;
    contact.depth = depth;
    contact.facet = touch.facet;
    contact.proxy = to_scene(touch.point);
    contact.unshaded = scaled(mesh.stiffness, touch.offset);
    contact.force = shaded_force(touch, contact.unshaded);
    if (TEXTURE != kMapNone) {
        real2 place = map_place(touch.point);
        real3 slope = in_plane(texture_gradient(place.x, place.y), facet_normal(touch.facet));
        precise real pull = law.texture_stiffness * depth;
        contact.force = difference(contact.force, scaled(pull, slope));
        contact.unshaded = difference(contact.unshaded, scaled(pull, slope));
    }
    return contact;
}
