// The nominal surfaces, and what every law needs of the probe's (x, y) alone, step for step as host/reference/surfaces.h.

// G2 and L3: the bump of n flat facets inscribed in the reference cylinder, on the plane.
struct Facet {
    real height;   // m: the nominal surface above the plane at the probe's x
    real normal_x; // 1: unit normal (normal_x, 0, normal_z)
    real normal_z;
    uint id; // 0 .. n-1 from left to right, n for the plane around the bump
};

// The facet [x_i, x_i+1) that holds x, by bisection; needs x_0 <= x < x_n.
uint facet_index(real x, uint facets) {
    uint low = 0u;
    uint high = facets;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (facet_vertices[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// The part of a facet that does not depend on the probe.
struct Slope {
    real left; // m: where it begins, and where it ends
    real right;
    real top;      // m: its height where it begins
    real descent;  // 1: a metre along x
    real normal_x; // 1: unit normal (normal_x, 0, normal_z)
    real normal_z;
};

Slope slope_of(uint id) {
    real left = facet_vertices[id];
    real right = facet_vertices[id + 1u];
    // The chord of a circle descends by (x_i + x_i+1) / (rise_i + rise_i+1): no difference of heights, so no digits cancel.
    precise real rises = circle_rise(law.radius, left) + circle_rise(law.radius, right);
    precise real descent = rises > ZERO ? quotient(left + right, rises) : ZERO;
    real top = cylinder_height(law.half_width, law.radius, law.centre_depth, left);
    precise real normal_z = quotient(ONE, root(ONE + descent * descent));
    precise real normal_x = descent * normal_z;
    return Slope(left, right, top, descent, normal_x, normal_z);
}

real height_on(Slope slope, real x) {
    precise real height = slope.top - slope.descent * (x - slope.left);
    return height;
}

bool is_on_facets(real x) {
    return x >= -law.half_width && x < law.half_width;
}

Facet facet_at(real x) {
    Facet facet = Facet(exact_zero, exact_zero, ONE, law.facets);
    if (!is_on_facets(x))
        return facet;
    facet.id = facet_index(x, law.facets);
    Slope slope = slope_of(facet.id);
    facet.height = height_on(slope, x);
    facet.normal_x = slope.normal_x;
    facet.normal_z = slope.normal_z;
    return facet;
}

// What every law needs of (x, y): computed once for all z above it.
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
    precise real normal_x = quotient(x, law.radius);
    precise real normal_z = quotient(circle_rise(law.radius, x), law.radius);
    return real3(normal_x, exact_zero, normal_z);
}

// L5: the unit normal of the height map.
real3 map_normal(real x, real y) {
    Gradient gradient = map_gradient(x, y);
    precise real normal_z = quotient(ONE, root(gradient.x * gradient.x + gradient.y * gradient.y + ONE));
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
