// What a path was like, in numbers that people read: made of its metrics, in double.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/output/path_rows.h"
#include "host/picture/path_plot.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Nothing where a number has no meaning: depths without contact, a speed ratio in open loop. The deviation of depths
/// is a difference of sums: in single precision it is known to about 3e-4 of the mean depth.
struct PathFigures {
    std::uint64_t steps = 0;
    double contact_time = 0;                 /* s: of recorded paths as ContactTime says */
    double largest_force = 0, rms_force = 0; /* N; over the samples before a path left its bound */
    double largest_turn = 0;                 /* deg: of the force between two samples in a row, both in contact */
    double steepest_turn = 0;                /* deg/mm: of the force, over ways of a stretch or more */
    double work = 0;                         /* J: done on the hand */
    double effort = 0;                       /* J: sum of |F . dx| */
    std::optional<double> eta;               /* 1: work / effort */
    std::uint64_t rounds = 0;                /* complete ones */
    std::optional<double> least_round, mean_round, largest_round; /* J: done on the hand in a complete round */
    std::optional<double> least_depth, mean_depth, largest_depth, depth_deviation; /* m: in contact */
    std::optional<double> unstable_time; /* s: t of the sample at which the probe left its bound */
    bool fell = false;                   /* free of contact, the way the hand pushes: off the rim of a surface */
    std::optional<double> speed_ratio;   /* 1: largest speed of the last quarter over that of the second */
    bool began_inside = false;
    std::uint64_t unfinished = 0; /* samples at which the proxy did not come to rest */
};

/// Of a path whose samples come at times of their own.
struct PathTimes {
    double contact = 0;  /* s: in contact, as ContactTime counts it */
    double unstable = 0; /* s: t of the sample at which the probe left its bound, if it did */
};

/// What a path's metrics do not say of it.
struct PathFacts {
    std::uint64_t steps = 0; /* samples of the path */
    double rate = 1;         /* 1/s: samples a second */
    bool closed = false;
    bool began_inside = false;
    std::optional<PathTimes> times{}; /* of a recorded path; else samples come at the rate, the first at 0 s */
};

template <typename T> PathFigures figures_of(const layout::PathMetrics<T>& metrics, const PathFacts& facts);

extern template PathFigures figures_of<float>(const layout::PathMetrics<float>&, const PathFacts&);
extern template PathFigures figures_of<double>(const layout::PathMetrics<double>&, const PathFacts&);

// Keeps of explored paths what a picture shows: a handful of them, evenly chosen, however many and long they are.

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
