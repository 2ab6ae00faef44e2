// L3 along a path: the facet of the last probe serves until one leaves it. Where no lane's has, a software device goes
// through the search once all the same, with nothing to show for it, but not round its bisection.

Slope remembered_slope = Slope(ZERO, ZERO, ZERO, ZERO, ZERO, ONE); // holds no x
uint remembered_id = 0u;

// The same as facet_at(x).
Facet remembered_facet_at(real x) {
    bool on_facets = is_on_facets(x);
    bool elsewhere = on_facets && !(x >= remembered_slope.left && x < remembered_slope.right);
    while (elsewhere) {
        remembered_id = facet_index(x, law.facets);
        remembered_slope = slope_of(remembered_id);
        elsewhere = false;
    }
    return Facet(on_facets ? height_on(remembered_slope, x) : exact_zero, on_facets ? remembered_slope.normal_x : exact_zero,
                 on_facets ? remembered_slope.normal_z : ONE, on_facets ? remembered_id : law.facets);
}
