// G3: the gradient of a height map U(x, y), analytic or sampled, and those of the scene's two maps. U is 0 beyond a
// cylinder, a dip or an image. Step for step as host/reference/surfaces.h. Needs MAP and TEXTURE, constants of the kernel,
// and the buffers `map_gradients` and `texture_gradients`.

struct Gradient {
    real x; // 1: dU/dx
    real y; // 1: dU/dy
};

Gradient cylinder_gradient(MapParams map, real x, bool dip) {
    Gradient gradient = Gradient(exact_zero, exact_zero);
    if (!(abs(x) < map.half_width))
        return gradient;
    precise real slope = quotient(x, circle_rise(map.radius, x));
    gradient.x = dip ? slope : -slope;
    return gradient;
}

Gradient sine_gradient(MapParams map, real x) {
    precise real turns = x * map.inverse_length;
    precise real slope = map.slope * cosine_of_turns(turns);
    return Gradient(slope, exact_zero);
}

Gradient gaussian_gradient(MapParams map, real x, real y) {
    precise real u = x * map.inverse_length;
    precise real v = y * map.inverse_length;
    precise real steepness = map.slope * exponential_decay(u * u + v * v);
    precise real gradient_x = -(steepness * u);
    precise real gradient_y = -(steepness * v);
    // Far away u is infinite and the steepness 0: the product would be no number.
    if (!(steepness != ZERO))
        return Gradient(exact_zero, exact_zero);
    return Gradient(gradient_x, gradient_y);
}

// Where a coordinate falls between two nodes: the lower node, the upper node and the fraction of the way.
struct Cell {
    uint low;
    uint high;
    real fraction;
};

Cell cell_at(real position, uint nodes) {
    Cell cell;
    uint last = nodes - 1u;
    cell.low = uint(position);
    if (cell.low > last)
        cell.low = last;
    cell.high = cell.low < last ? cell.low + 1u : last;
    precise real fraction = position - real(cell.low);
    cell.fraction = fraction < ONE ? fraction : ONE;
    return cell;
}

real between(real low, real high, real fraction) {
    precise real value = low + fraction * (high - low);
    return value;
}

// Bilinear interpolation of the nodes' gradients; continuous within the image. `gradients`: pairs (dU/dx, dU/dy), row 0 at
// the smallest y.
#define SAMPLED_GRADIENT(name, gradients)                                                                              \
    Gradient name(MapParams map, real x, real y) {                                                                     \
        if (!(abs(x) <= map.half_width && abs(y) <= map.half_length))                                                  \
            return Gradient(exact_zero, exact_zero);                                                                   \
        precise real column = (x + map.half_width) * map.nodes_per_x;                                                  \
        precise real row = (y + map.half_length) * map.nodes_per_y;                                                    \
        Cell across = cell_at(column, map.columns);                                                                    \
        Cell along = cell_at(row, map.rows);                                                                           \
        uint low = along.low * map.columns;                                                                            \
        uint high = along.high * map.columns;                                                                          \
        Gradient gradient;                                                                                             \
        gradient.x = between(between(gradients[2u * (low + across.low)], gradients[2u * (low + across.high)], across.fraction),\
                             between(gradients[2u * (high + across.low)], gradients[2u * (high + across.high)], across.fraction),\
                             along.fraction);                                                                          \
        gradient.y =                                                                                                   \
            between(between(gradients[2u * (low + across.low) + 1u], gradients[2u * (low + across.high) + 1u], across.fraction),\
                    between(gradients[2u * (high + across.low) + 1u], gradients[2u * (high + across.high) + 1u], across.fraction),\
                    along.fraction);                                                                                   \
        return gradient;                                                                                               \
    }
SAMPLED_GRADIENT(sampled_map_gradient, map_gradients)
SAMPLED_GRADIENT(sampled_texture_gradient, texture_gradients)

// Of the map that directions follow (L5, L9), and of the texture (L8).
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
