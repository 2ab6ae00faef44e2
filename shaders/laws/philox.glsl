// Random numbers by counter (Philox 4x32-10: Salmon, Moraes, Dror & Shaw 2011): the same for a key and a counter
// wherever they are drawn.

uvec4 philox(uvec4 counter, uvec2 key) {
    for (uint i = 0u; i < 10u; ++i) {
        uint one_high, one_low, other_high, other_low;
        umulExtended(0xD2511F53u, counter.x, one_high, one_low);
        umulExtended(0xCD9E8D57u, counter.z, other_high, other_low);
        counter = uvec4(other_high ^ counter.y ^ key.x, other_low, one_high ^ counter.w ^ key.y, one_low);
        key += uvec2(0x9E3779B9u, 0xBB67AE85u);
    }
    return counter;
}
