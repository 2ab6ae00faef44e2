// G2 and L3: the bump of n flat facets inscribed in the reference cylinder, on the plane.

struct Facet {
    real height;   // m: the nominal surface above the plane at the probe's x
    real normal_x; // 1: unit normal (normal_x, 0, normal_z)
    real normal_z;
    uint id; // 0 .. n-1 from left to right, n for the plane beside the bump
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

// What of a facet does not depend on the probe.
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
    // The chord of a circle descends by (x_i + x_i+1) / (rise_i + rise_i+1): no difference of heights, so nothing cancels.
    precise real rises = circle_rise(law.radius, left) + circle_rise(law.radius, right);
    precise real descent = rises > ZERO ? (left + right) / rises : ZERO;
    real top = cylinder_height(law.half_width, law.radius, law.centre_depth, left);
    precise real normal_z = ONE / sqrt(ONE + descent * descent);
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
