// cos and exp out of + - * and exact steps only, so that both sides round alike; built-in ones are hundreds of ULP off.

// cos(2 pi turns). The argument is reduced to a quarter turn exactly; then the series of sin(2 pi s).
real cosine_of_turns(real turns) {
    precise real whole = floor(turns + real(0.5LF));
    precise real folded = abs(turns - whole);         // [0, 1/2]
    precise real s = real(0.25LF) - folded;          // cos(2 pi folded) = sin(2 pi s)
    precise real q = s * s;
    precise real sum = real(-8.823533599243006e-05LF); // (2 pi)^23 / 23!, and so on down to 2 pi
    sum = sum * q + real(0.0011309237482517963LF);
    sum = sum * q + real(-0.012031585942120627LF);
    sum = sum * q + real(0.10422916220813984LF);
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
    precise real sum = real(1.1470745597729725e-11LF); // 1 / 14!, and so on down to 1
    sum = sum * r + real(1.6059043836821613e-10LF);
    sum = sum * r + real(2.08767569878681e-09LF);
    sum = sum * r + real(2.505210838544172e-08LF);
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
