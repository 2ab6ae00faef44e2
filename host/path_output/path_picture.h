// Keeps of explored paths what a picture shows: a handful of them, evenly chosen, however many and long they are.
#pragma once

#include <vector>

#include "host/io/path_rows.h"
#include "host/picture/path_plot.h"

namespace forceshade {

class PathCollector {
public:
    PathCollector(std::uint64_t paths, std::uint64_t steps);

    template <typename T> void add(const PathRows<T>& rows);

    const std::vector<picture::DrawnPath>& paths() const { return paths_; }
    /// m: the x between which the paths kept are drawn (`picture::drawn_breadth`), and their mean y.
    struct Reach {
        double from = 0, to = 0, y = 0;
    };
    Reach reach() const;
    /// The picture of them. `paths` in all.
    picture::Picture draw(const std::string& name, const picture::SurfaceLines& surface) const;

private:
    template <typename T> void add_path(const PathRows<T>& rows, std::size_t path);

    std::uint64_t count_, every_, stride_;
    std::vector<picture::DrawnPath> paths_;
    double y_sum_ = 0;
    std::uint64_t y_samples_ = 0;
};

/// How paths in contact follow a line: it is sunk by their mean distance from it, then they are compared.
struct Following {
    std::uint64_t samples = 0; /* in contact, over the line */
    double sunk = 0;           /* m: mean distance below the line, along z */
    double distance = 0;       /* m: root mean square from the line so sunk, along z */
    double angle = 0;          /* deg: root mean square between the force and the line's normal */
    double median_angle = 0;   /* deg: likewise the median, which an edge that the probe rattles on does not move */
};

/// Of a line whose x increases; no samples where there is none.
Following following(const std::vector<picture::DrawnPath>& paths, const std::vector<picture::LinePoint>& line);

/// True if a height can be read off the line at every x: no pieces, x increasing.
bool is_graph(const std::vector<picture::LinePoint>& line);

} // namespace forceshade
