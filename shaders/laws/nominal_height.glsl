// The nominal surface that a motion follows. Needs remembered_facet.glsl.

// The nominal surface, m, from which a motion that follows it measures its depth.
real nominal_height(real x) {
    if (SURFACE == kSurfaceBump)
        return remembered_facet_at(x).height;
    if (SURFACE == kSurfaceCylinderBump && abs(x) < law.half_width)
        return cylinder_height(law.half_width, law.radius, law.centre_depth, x);
    return exact_zero;
}

// A place that was measured from the surface below or above it.
real3 above_surface(real3 place) {
    precise real z = place.z + nominal_height(place.x);
    return real3(place.xy, z);
}
