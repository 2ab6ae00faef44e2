// G1: the reference cylinder, written so that it does not cancel for R much larger than a.

// sqrt(R^2 - x^2), m: how far the circle stands above its axis at x, |x| <= R.
real circle_rise(real radius, real x) {
    precise real rise = sqrt((radius - x) * (radius + x));
    return rise;
}

// U(x), m: the cylinder above the nominal plane; 0 for |x| >= a. centre_depth is sqrt((R-a)(R+a)).
real cylinder_height(real half_width, real radius, real centre_depth, real x) {
    precise real product = (half_width - x) * (half_width + x);
    if (!(product > ZERO))
        return ZERO;
    precise real height = product / (circle_rise(radius, x) + centre_depth);
    return height;
}
