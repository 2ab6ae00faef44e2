// What all laws are made of: the precision, vectors, the circle, cos and exp, step for step as host/reference/elementary.h.
// Products are written out from left to right, series in + and * alone, so that both sides round alike; built-in functions
// round otherwise.

// The precision a kernel is compiled for. Constants are written real(0.5LF): rounded once, by the compiler.
#ifdef FS_F64
#define real double
#define real2 dvec2
#define real3 dvec3
#define real4 dvec4
#define SMALLEST_NORMAL 2.2250738585072014e-308LF
#define LARGEST 1.7976931348623157e308LF
#define EPSILON 2.220446049250313e-16LF
#else
#define real float
#define real2 vec2
#define real3 vec3
#define real4 vec4
#define SMALLEST_NORMAL 1.1754943508222875e-38
#define LARGEST 3.4028234663852886e38
#define EPSILON 1.1920928955078125e-07
#endif
#define ZERO real(0.0LF)
#define ONE real(1.0LF)

// Goes on with a hash, word by word.
uint hashed(uint hash, uint word) {
    uint mixed = hash ^ word;
    return (mixed << 13 | mixed >> 19) * 16777619u;
}

uint hashed(uint hash, real value) {
#ifdef FS_F64
    uvec2 words = unpackDouble2x32(value);
    return hashed(hashed(hash, words.x), words.y);
#else
    return hashed(hash, floatBitsToUint(value));
#endif
}

// A number in one word.
uint folded(real value) {
#ifdef FS_F64
    uvec2 words = unpackDouble2x32(value);
    return words.x * 2246822519u + words.y;
#else
    return floatBitsToUint(value);
#endif
}

uint hashed(uint hash, real3 v) {
    return hashed(hashed(hashed(hash, v.x), v.y), v.z);
}

// Writes a vector to three places of a buffer.
#define STORE_VECTOR(buffer, at, value)                                                                                \
    {                                                                                                                  \
        buffer[3u * (at)] = value.x;                                                                                   \
        buffer[3u * (at) + 1u] = value.y;                                                                              \
        buffer[3u * (at) + 2u] = value.z;                                                                              \
    }

// Quotients and roots, rounded to the nearest. Vulkan lets a device's own of floats be some units in the last place off.
// FS_EXACT takes those of doubles, which round a quotient or root of floats to the same float (Figueroa 1995: twice the
// digits and two more are enough to round twice).
#ifdef FS_EXACT
#define QUOTIENT(real_n, wide_n)                                                                                       \
    real_n quotient(real_n a, real_n b) {                                                                              \
        precise wide_n value = wide_n(a) / wide_n(b);                                                                  \
        return real_n(value);                                                                                          \
    }
QUOTIENT(float, double)
QUOTIENT(vec3, dvec3)
QUOTIENT(vec4, dvec4)
float root(float a) {
    precise double value = sqrt(double(a));
    return float(value);
}
#else
#define QUOTIENT(real_n)                                                                                               \
    real_n quotient(real_n a, real_n b) {                                                                              \
        precise real_n value = a / b;                                                                                  \
        return value;                                                                                                  \
    }
QUOTIENT(real)
QUOTIENT(real3)
QUOTIENT(real4)
real root(real a) {
    precise real value = sqrt(a);
    return value;
}
#endif
real3 quotient(real3 v, real divisor) {
    return quotient(v, real3(divisor));
}
real4 quotient(real4 v, real divisor) {
    return quotient(v, real4(divisor));
}

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
    precise real3 value = quotient(v, divisor);
    return value;
}

// v / |v|; 0 where v.v is not above 0.
real3 normalised(real3 v) {
    precise real square = product(v, v);
    precise real size = root(square);
    precise real3 direction = quotient(v, size);
    return square > ZERO ? direction : real3(ZERO);
}

// G1: the reference cylinder, written so that it does not cancel for R much larger than a.

// sqrt(R^2 - x^2), m: how far the circle stands above its axis at x, |x| <= R.
real circle_rise(real radius, real x) {
    precise real rise = root((radius - x) * (radius + x));
    return rise;
}

// U(x), m: the cylinder above the nominal plane; 0 for |x| >= a. centre_depth is sqrt((R-a)(R+a)).
real cylinder_height(real half_width, real radius, real centre_depth, real x) {
    precise real product = (half_width - x) * (half_width + x);
    if (!(product > ZERO))
        return ZERO;
    precise real height = quotient(product, circle_rise(radius, x) + centre_depth);
    return height;
}

// cos(2 pi turns). The argument is reduced to a quarter turn exactly; then the series of sin(2 pi s).
real cosine_of_turns(real turns) {
    precise real whole = floor(turns + real(0.5LF));
    precise real folded = abs(turns - whole);         // [0, 1/2]
    precise real s = real(0.25LF) - folded;          // cos(2 pi folded) = sin(2 pi s)
    precise real q = s * s;
    // (2 pi)^23 / 23!, and so on down to 2 pi. In single precision the first three change no bit of any sum.
#ifdef FS_F64
    precise real sum = real(-8.823533599243006e-05LF);
    sum = sum * q + real(0.0011309237482517963LF);
    sum = sum * q + real(-0.012031585942120627LF);
    sum = sum * q + real(0.10422916220813984LF);
#else
    precise real sum = real(0.10422916220813984LF);
#endif
    sum = sum * q + real(-0.7181223017785006LF);
    sum = sum * q + real(3.819952584848282LF);
    sum = sum * q + real(-15.09464257682299LF);
    sum = sum * q + real(42.058693944897655LF);
    sum = sum * q + real(-76.70585975306139LF);
    sum = sum * q + real(81.60524927607506LF);
    sum = sum * q + real(-41.34170224039976LF);
    sum = sum * q + real(6.283185307179586LF);
    precise real cosine = sum * s;
    return cosine;
}

#ifdef FS_F64
#define EXP_LARGEST real(708.0LF)
#define LN2_HIGH real(0.693147180559663LF)
#define LN2_LOW real(2.8235290563031577e-13LF)
real power_of_half(uint k) {
    return packDouble2x32(uvec2(0u, (1023u - k) << 20));
}
#else
#define EXP_LARGEST real(87.0LF)
#define LN2_HIGH real(0.693115234375LF)
#define LN2_LOW real(3.1946184945309415e-05LF)
real power_of_half(uint k) {
    return uintBitsToFloat((127u - k) << 23);
}
#endif

// exp(-u) for u >= 0; 0 where the result would be no normal number, and for u infinite.
real exponential_decay(real u) {
    if (!(u < EXP_LARGEST))
        return ZERO;
    precise real k = floor(u * real(1.4426950408889634LF) + real(0.5LF));
    precise real r = (k * LN2_HIGH - u) + k * LN2_LOW; // exp(-u) = 2^-k exp(r), |r| <= ln(2) / 2
    // 1 / 14!, and so on down to 1. In single precision the first three change no bit of any sum.
#ifdef FS_F64
    precise real sum = real(1.1470745597729725e-11LF);
    sum = sum * r + real(1.6059043836821613e-10LF);
    sum = sum * r + real(2.08767569878681e-09LF);
    sum = sum * r + real(2.505210838544172e-08LF);
#else
    precise real sum = real(2.505210838544172e-08LF);
#endif
    sum = sum * r + real(2.755731922398589e-07LF);
    sum = sum * r + real(2.7557319223985893e-06LF);
    sum = sum * r + real(2.48015873015873e-05LF);
    sum = sum * r + real(0.0001984126984126984LF);
    sum = sum * r + real(0.001388888888888889LF);
    sum = sum * r + real(0.008333333333333333LF);
    sum = sum * r + real(0.041666666666666664LF);
    sum = sum * r + real(0.16666666666666666LF);
    sum = sum * r + real(0.5LF);
    sum = sum * r + ONE;
    sum = sum * r + ONE;
    precise real decay = sum * power_of_half(uint(k));
    return decay;
}
