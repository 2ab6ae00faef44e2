// G3: bilinear interpolation of the nodes' gradients; continuous within the image. Included once for each image:
// SAMPLED_GRADIENT names the function, GRADIENTS the buffer of (dU/dx, dU/dy) pairs, row 0 at the smallest y.

Gradient SAMPLED_GRADIENT(MapParams map, real x, real y) {
    if (!(abs(x) <= map.half_width && abs(y) <= map.half_length))
        return Gradient(exact_zero, exact_zero);
    precise real column = (x + map.half_width) * map.nodes_per_x;
    precise real row = (y + map.half_length) * map.nodes_per_y;
    Cell across = cell_at(column, map.columns);
    Cell along = cell_at(row, map.rows);
    uint low = along.low * map.columns;
    uint high = along.high * map.columns;
    Gradient gradient;
    gradient.x = between(between(GRADIENTS[2u * (low + across.low)], GRADIENTS[2u * (low + across.high)], across.fraction),
                         between(GRADIENTS[2u * (high + across.low)], GRADIENTS[2u * (high + across.high)], across.fraction),
                         along.fraction);
    gradient.y =
        between(between(GRADIENTS[2u * (low + across.low) + 1u], GRADIENTS[2u * (low + across.high) + 1u], across.fraction),
                between(GRADIENTS[2u * (high + across.low) + 1u], GRADIENTS[2u * (high + across.high) + 1u], across.fraction),
                along.fraction);
    return gradient;
}
