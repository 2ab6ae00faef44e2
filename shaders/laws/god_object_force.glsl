// L7 to L9 on the god-object's contact (L6), step for step as host/reference/god_object_contact.h.

// The force on a probe (in the mesh's frame) that a god-object holds. The facet shaded is the lowest of those that hold
// it; seen from behind, its interpolated normal is reversed.
Contact force_of(Rest rest, real3 probe) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), to_world(probe), kNoFacet);
    if (rest.count == 0u)
        return contact;
    real3 offset = difference(rest.proxy, probe);
    precise real size = sqrt(product(offset, offset));
    MeshTouch touch = MeshTouch(rest.facets.x, offset, rest.proxy, size);
    real3 world = to_world(rest.proxy);
    real3 pull = scaled(mesh.stiffness, offset);
    precise real depth = size * mesh.scale;
    contact.depth = depth;
    contact.facet = touch.facet;
    contact.proxy = world;
    contact.unshaded = pull;
    real3 shaded = shaded_force(touch, rest.back ? -pull : pull, world);
    contact.force = shaded;
    if (TEXTURE != kMapNone) {
        real3 slope = in_plane(texture_gradient(world.x, world.y), facet_normal(touch.facet));
        precise real tug = law.texture_stiffness * depth;
        contact.force = difference(contact.force, scaled(tug, slope));
        contact.unshaded = difference(contact.unshaded, scaled(tug, slope));
    }
    if (rest.back)
        contact.force = difference(difference(contact.unshaded, pull), shaded);
    return contact;
}
