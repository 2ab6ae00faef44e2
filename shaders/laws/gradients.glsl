// G3: the gradients of the scene's two height maps: one that directions follow (L5, L9), one for texture (L8).

Gradient map_gradient(real x, real y) {
    if (MAP == kMapCylinder || MAP == kMapDip)
        return cylinder_gradient(law.map, x, MAP == kMapDip);
    if (MAP == kMapSine)
        return sine_gradient(law.map, x);
    if (MAP == kMapGaussian)
        return gaussian_gradient(law.map, x, y);
    if (MAP == kMapSamples)
        return sampled_map_gradient(law.map, x, y);
    return Gradient(ZERO, ZERO);
}

Gradient texture_gradient(real x, real y) {
    if (TEXTURE == kMapCylinder || TEXTURE == kMapDip)
        return cylinder_gradient(law.texture, x, TEXTURE == kMapDip);
    if (TEXTURE == kMapSine)
        return sine_gradient(law.texture, x);
    if (TEXTURE == kMapGaussian)
        return gaussian_gradient(law.texture, x, y);
    if (TEXTURE == kMapSamples)
        return sampled_texture_gradient(law.texture, x, y);
    return Gradient(ZERO, ZERO);
}
