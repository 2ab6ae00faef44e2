// Explored paths over the section of the surface, and below it where the force pointed.
#pragma once

#include "host/picture/picture.h"

#include <string>
#include <vector>

namespace forceshade::picture {

/// A path to draw: sample i was at way[i]; direction[i] is the force's, NaN where there is none.
struct DrawnPath {
    std::string label;
    std::vector<LinePoint> way;
    std::vector<double> direction; /* deg: in the x-z plane, from z towards x */
};

struct PathDrawing {
    Look look;
    std::vector<std::string> notes; // lines below the title
    std::vector<DrawnPath> paths;   // one at least, with a finite sample
    SurfaceLines surface;           // its normals are drawn beside the forces' directions
    bool draws_normals = true;
};

/// The normals of a line whose x increases, as a line of its own: x in m, z the angle from z towards x in deg. A
/// segment's normal stands at both its ends.
std::vector<LinePoint> normals_of(const std::vector<LinePoint>& line);

/// m: the x between which paths are drawn, before a border. Paths that are hardly wide, as taps are, are shown as wide
/// as high, so that the surface below them is seen. Without a finite sample low > high.
struct Breadth {
    double low = 0, high = 0;
};
Breadth drawn_breadth(const std::vector<DrawnPath>& paths);

/// Like every picture, the same bytes for the same input.
Picture draw_paths(const PathDrawing& drawing);

} // namespace forceshade::picture
