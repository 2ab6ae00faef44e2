// What every law needs of the probe's (x, y) alone: computed once for all z above it.

struct Column {
    real x;
    Facet facet;      // L3: the nominal surface below the probe
    real3 direction;  // L4, L5: the smooth surface's unit normal above the probe
    Gradient texture; // L8
    bool on_bump;     // |x| < a
};

// G1: N(x) on the bump, z elsewhere.
real3 reference_normal(real x, bool on_bump) {
    if (!on_bump)
        return real3(exact_zero, exact_zero, ONE);
    precise real normal_x = x / law.radius;
    precise real normal_z = circle_rise(law.radius, x) / law.radius;
    return real3(normal_x, exact_zero, normal_z);
}

// L5: the unit normal of the height map.
real3 map_normal(real x, real y) {
    Gradient gradient = map_gradient(x, y);
    precise real normal_z = ONE / sqrt(gradient.x * gradient.x + gradient.y * gradient.y + ONE);
    precise real normal_x = -(gradient.x * normal_z);
    precise real normal_y = -(gradient.y * normal_z);
    return real3(normal_x, normal_y, normal_z);
}

// `facet`: the bump's at x; of other surfaces the plane.
Column column_over(Facet facet, real x, real y) {
    Column column;
    column.x = x;
    column.on_bump = abs(x) < law.half_width;
    column.facet = facet;
    column.direction = real3(exact_zero, exact_zero, ONE);
    if (SHADING == kShadingReference && REFERENCE == kReferenceNormal)
        column.direction = reference_normal(x, column.on_bump);
    if (SHADING == kShadingHeightMap)
        column.direction = map_normal(x, y);
    column.texture = texture_gradient(x, y);
    return column;
}

Column column_at(real x, real y) {
    if (SURFACE == kSurfaceBump)
        return column_over(facet_at(x), x, y);
    return column_over(Facet(exact_zero, exact_zero, ONE, 0u), x, y);
}
