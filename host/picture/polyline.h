// Lines cut to what a plot shows, so that far-away or non-finite points and a million vertices do no harm.
#pragma once

#include "host/picture/canvas.h"

#include <span>
#include <vector>

namespace forceshade::picture {

/// The connected pieces of the line that pass within a few pixels of `box`; points closer than a third of a pixel to
/// the one before are dropped. A point that is not finite breaks the line.
std::vector<std::vector<Point>> visible_pieces(std::span<const Point> line, const Box& box);

/// Whether the segment passes through `box`.
bool crosses(Point from, Point to, const Box& box);

/// The piece; one that stays in one place, as the force's direction in taps does, as a short bar there.
std::vector<Point> seen_as_line(std::vector<Point> piece);

} // namespace forceshade::picture
