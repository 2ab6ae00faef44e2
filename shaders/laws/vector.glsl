// Vectors, as host/reference/vector.h has them: products written out from left to right. Built-in ones round otherwise.

real product(real3 u, real3 v) {
    precise real value = u.x * v.x + u.y * v.y + u.z * v.z;
    return value;
}

real3 cross_product(real3 u, real3 v) {
    precise real x = u.y * v.z - u.z * v.y;
    precise real y = u.z * v.x - u.x * v.z;
    precise real z = u.x * v.y - u.y * v.x;
    return real3(x, y, z);
}

real3 sum(real3 u, real3 v) {
    precise real3 value = u + v;
    return value;
}

real3 difference(real3 u, real3 v) {
    precise real3 value = u - v;
    return value;
}

real3 scaled(real factor, real3 v) {
    precise real3 value = real3(factor) * v; // a vector times a scalar is open to other roundings
    return value;
}

real3 divided(real3 v, real divisor) {
    precise real3 value = v / divisor;
    return value;
}

// v / |v|; 0 where v.v is not above 0.
real3 normalised(real3 v) {
    precise real square = product(v, v);
    precise real size = sqrt(square);
    precise real3 direction = v / size;
    return square > ZERO ? direction : real3(ZERO);
}
