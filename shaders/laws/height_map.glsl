// G3: the gradient of a height map U(x, y), analytic or sampled. U is 0 beyond a cylinder, a dip or an image.
// GRADIENTS names the buffer of sampled gradients, so that the file can be included once per map.

struct Gradient {
    real x; // 1: dU/dx
    real y; // 1: dU/dy
};

Gradient cylinder_gradient(MapParams map, real x, bool dip) {
    Gradient gradient = Gradient(exact_zero, exact_zero);
    if (!(abs(x) < map.half_width))
        return gradient;
    precise real slope = x / circle_rise(map.radius, x);
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
