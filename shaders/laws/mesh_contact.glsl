// L7 to L9: depth, force, proxy and facet of a probe that touches a mesh; step for step as host/reference/mesh_contact.h.

struct Contact {
    real depth;     // m, 0 out of contact
    real3 force;    // N
    real3 unshaded; // N: what shading "none" would give
    real3 proxy;    // m, world: the nearest point of the mesh; the probe itself out of contact
    uint facet;
};

real3 to_world(real3 point) {
    precise real x = point.x * mesh.scale + mesh.centre_x;
    precise real y = point.y * mesh.scale + mesh.centre_y;
    precise real z = point.z * mesh.scale + mesh.centre_z;
    return real3(x, y, z);
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
real3 shaded_force(MeshTouch touch, real3 unshaded, real3 world) {
    if (SHADING == kShadingNone && MAP == kMapNone)
        return unshaded;
    real3 normal = facet_normal(touch.facet);
    real3 direction = shading_direction(touch.facet, normal, touch.point);
    if (!(product(direction, direction) > ZERO))
        return unshaded;
    if (MAP != kMapNone) {
        direction = normalised(difference(direction, in_plane(map_gradient(world.x, world.y), normal)));
        if (!(product(direction, direction) > ZERO))
            return unshaded;
    }
    precise real magnitude = mesh.stiffness * touch.distance;
    if (SHADING == kShadingTwoPass) {
        real lift = product(direction, normal);
        if (!(lift > ZERO))
            return unshaded;
        magnitude = magnitude / lift;
    }
    return scaled(magnitude, direction);
}

Contact touching_contact(MeshTouch touch) {
    Contact contact;
    real3 world = to_world(touch.point);
    precise real depth = touch.distance * mesh.scale;
    contact.depth = depth;
    contact.facet = touch.facet;
    contact.proxy = world;
    contact.unshaded = scaled(mesh.stiffness, touch.offset);
    contact.force = shaded_force(touch, contact.unshaded, world);
    if (TEXTURE != kMapNone) {
        real3 slope = in_plane(texture_gradient(world.x, world.y), facet_normal(touch.facet));
        precise real pull = law.texture_stiffness * depth;
        contact.force = difference(contact.force, scaled(pull, slope));
        contact.unshaded = difference(contact.unshaded, scaled(pull, slope));
    }
    return contact;
}
