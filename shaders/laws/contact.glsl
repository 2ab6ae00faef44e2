// L1 to L5 and L8: depth, force, proxy and facet of a probe at height z in a column.

struct Contact {
    real depth;     // m, 0 out of contact
    real3 force;    // N
    real3 unshaded; // N: what shading "none" would give
    real3 proxy;    // m: the contact point on the nominal surface; the probe itself out of contact
    uint facet;
};

// The unit vector from the cylinder's axis to the probe and its distance; z where the probe is on the axis.
struct Radial {
    real3 direction;
    real distance; // m
};

Radial radial_at(real x, real z) {
    precise real rise = z + law.centre_depth;
    precise real square = x * x + rise * rise;
    if (!(square >= SMALLEST_NORMAL))
        return Radial(real3(exact_zero, exact_zero, ONE), ZERO);
    precise real distance = root(square);
    precise real direction_x = quotient(x, distance);
    precise real direction_z = quotient(rise, distance);
    return Radial(real3(direction_x, exact_zero, direction_z), distance);
}

real3 along(real magnitude, real3 direction) {
    precise real x = magnitude * direction.x;
    precise real y = magnitude * direction.y;
    precise real z = magnitude * direction.z;
    return real3(x, y, z);
}

// L8: the tangential force of the texture, added to any law.
real3 textured(real3 force, real depth, Gradient texture) {
    if (TEXTURE == kMapNone)
        return force;
    precise real scale = law.texture_stiffness * depth;
    precise real x = force.x - scale * texture.x;
    precise real y = force.y - scale * texture.y;
    return real3(x, y, force.z);
}

// L2: plane and cylinder, each computed alone, superposed.
Contact cylinder_bump_contact(Column column, real y, real z) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), real3(column.x, y, z), kNoFacet);
    precise real plane_depth = z < ZERO ? -z : ZERO;
    // R^2 - r^2 = (a-x)(a+x) - z(z + 2 sqrt(R^2-a^2)): R - r without cancellation.
    precise real power = (law.half_width - column.x) * (law.half_width + column.x) -
                         z * (z + (law.centre_depth + law.centre_depth));
    if (!(plane_depth > ZERO || power > ZERO))
        return contact;
    Radial radial = radial_at(column.x, z);
    precise real cylinder_depth = power > ZERO ? quotient(power, law.radius + radial.distance) : ZERO;
    precise real plane_force = law.stiffness * plane_depth;
    precise real cylinder_force = law.stiffness * cylinder_depth;
    precise real force_x = cylinder_force * radial.direction.x;
    precise real force_z = plane_force + cylinder_force * radial.direction.z;
    bool on_cylinder = cylinder_depth >= plane_depth;
    contact.depth = on_cylinder ? cylinder_depth : plane_depth;
    contact.facet = on_cylinder ? 0u : 1u;
    contact.force = textured(real3(force_x, exact_zero, force_z), contact.depth, column.texture);
    contact.unshaded = contact.force;
    precise real proxy_x = column.x + cylinder_depth * radial.direction.x;
    precise real proxy_z = z + cylinder_depth * radial.direction.z;
    contact.proxy = on_cylinder ? real3(proxy_x, y, proxy_z) : real3(column.x, y, ZERO);
    return contact;
}

// L1, L3, L4, L5: one nominal facet below the probe; shading replaces the direction and keeps the magnitude.
Contact facet_contact(Column column, real y, real z) {
    Contact contact = Contact(ZERO, real3(ZERO), real3(ZERO), real3(column.x, y, z), kNoFacet);
    precise real depth = column.facet.height - z;
    if (!(depth > ZERO))
        return contact;
    contact.proxy = real3(column.x, y, column.facet.height);
    if (DEPTH == kDepthNormal) {
        depth = depth * column.facet.normal_z;
        precise real proxy_x = column.x + depth * column.facet.normal_x;
        precise real proxy_z = z + depth * column.facet.normal_z;
        contact.proxy = real3(proxy_x, y, proxy_z);
    }
    precise real magnitude = law.stiffness * depth;
    real3 normal = real3(column.facet.normal_x, exact_zero, column.facet.normal_z);
    real3 direction = SHADING == kShadingNone ? normal : column.direction;
    if (SHADING == kShadingReference && REFERENCE == kReferenceRadial && column.on_bump)
        direction = radial_at(column.x, z).direction;
    contact.depth = depth;
    contact.facet = column.facet.id;
    contact.force = textured(along(magnitude, direction), depth, column.texture);
    contact.unshaded = textured(along(magnitude, normal), depth, column.texture);
    return contact;
}

Contact contact_at(Column column, real y, real z) {
    if (SURFACE == kSurfaceCylinderBump)
        return cylinder_bump_contact(column, y, z);
    return facet_contact(column, y, z);
}
