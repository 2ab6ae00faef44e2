// Slices side by side on one sheet: colours, arrows, outlines, the axes common to all.
#pragma once

#include <string>
#include <vector>

#include "host/picture/picture.h"

namespace forceshade::picture {

struct Panel {
    std::string label; // above it
    ValueSlice values; // its axes are those of all panels, but for `at`
    std::size_t scale = 0;
    FieldSlice force{}; // drawn as arrows unless it has no samples
};

struct PanelSheet {
    Look look;
    std::vector<std::string> notes; // below the title
    std::vector<Panel> panels;      // at least one
    std::vector<ColourScale> scales;
    SurfaceLines lines;          // over every panel
    std::string non_finite_note; // what the checker stands for
};

/// As many columns as make the panels largest.
Picture draw_panels(const PanelSheet& sheet);

} // namespace forceshade::picture
