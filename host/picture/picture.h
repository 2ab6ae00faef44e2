// Pictures as PNG bytes and vectors: of a force volume slices and arrows, of explored paths, and charts; and their
// files.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/output/record.h"
#include "host/picture/values.h"

struct _cairo_surface;

namespace forceshade::picture {

/// Pixels; (x, y) is the upper left corner.
struct Box {
    double x = 0, y = 0, width = 0, height = 0;
};

struct PlacedText {
    std::string text;
    Box ink; // where its ink lies
};

/// A finished picture. The same input gives the same bytes: the file holds no date and no program version.
struct Picture {
    std::vector<std::uint8_t> png;
    int width = 0, height = 0;     // pixels
    std::vector<PlacedText> texts; // every text drawn, so that a test can see that none overlaps or is cut
    std::shared_ptr<_cairo_surface> drawing;

    /// As vectors; letters are outlines in SVG. \throws std::runtime_error if the drawing library fails (out of
    /// memory).
    std::string svg() const;
    std::string pdf() const;
};

/// What the user may choose of any picture.
struct Look {
    std::string title;   // UTF-8, wrapped if it is long
    int width = 1400;    // pixels; texts keep their size
    int most_height = 0; // pixels: plots become smaller to keep it, as far as they can; 0: as high as they need
    friend bool operator==(const Look&, const Look&) = default;
};

/// A point of a line in the x-z plane.
struct LinePoint {
    double x, z; /* m */
};

/// Lines drawn over a slice, each left out if empty.
struct SurfaceLines {
    std::vector<LinePoint> nominal; // the surface that the depth is measured from, solid
    std::vector<LinePoint> smooth;  // the shape that the shading imitates, dashed
};

/// A quantity over x and y at each z (at least one, increasing; axes x and y common to all), one colour scale for all.
/// Shown are the part of the grid and the slices, at most 12, where there is a force.
Picture draw_mosaic(const Look& look, std::span<const ValueSlice> tiles, Quantity quantity = Quantity::magnitude);

/// A slice: a quantity as colour, the force in the plane as arrows. `lines` are of its own plane, u and v. An angle
/// needs `unshaded`.
Picture draw_arrows(const Look& look, const FieldSlice& slice, const SurfaceLines& lines = {},
                    Quantity quantity = Quantity::magnitude, const FieldSlice& unshaded = {});

/// What shading changes: unshaded and shaded force to one scale, and the angle between them.
Picture draw_shading(const Look& look, const FieldSlice& unshaded, const FieldSlice& shaded,
                     const SurfaceLines& lines = {});

/// A path to draw: sample i was at way[i]; direction[i] is the force's, NaN without force.
struct DrawnPath {
    std::string label;
    std::vector<LinePoint> way;
    std::vector<double> direction; /* deg: in the x-z plane, from z towards x */
};

struct PathDrawing {
    Look look;
    std::vector<std::string> notes; // lines below the title
    std::vector<DrawnPath> paths;   // one at least, with a finite sample
    SurfaceLines surface;           // its normals are drawn with the forces' directions
    bool draws_normals = true;
};

/// Explored paths over the section of the surface, and below it where the force pointed.
Picture draw_paths(const PathDrawing& drawing);

/// A force on a probe that strokes the surface along x, with and without shading.
struct StrokedForce {
    double x;                      /* m */
    std::array<double, 3> force{}; /* N */
    std::array<double, 3> unshaded{};
};

/// The direction in the x-z plane and both components over x, shaded and unshaded on the same axes; `differs`: unshaded
/// is another force.
Picture draw_stroke(const Look& look, const std::vector<std::string>& notes, std::span<const StrokedForce> forces,
                    bool differs);

/// The normals of a line whose x increases, as a line of its own: x in m, z the angle from z towards x in deg. A
/// segment's normal stands at both its ends.
std::vector<LinePoint> normals_of(const std::vector<LinePoint>& line);

/// m: the x between which paths are drawn, before a border. Paths that are hardly wide, as taps are, are shown as wide
/// as high, so that the surface below them is seen. Without a finite sample low > high.
struct Breadth {
    double low = 0, high = 0;
};
Breadth drawn_breadth(const std::vector<DrawnPath>& paths);

/// Which files of a picture to write.
struct Endings {
    bool png = false, svg = false, pdf = false;
    bool any() const { return png || svg || pdf; }
    /// False if `name` is none of them.
    bool add(std::string_view name);
};

/// "STEM.png" and so on.
std::vector<std::string> names_with(const std::string& stem, const Endings& endings);

/// Writes them, each whole or not at all. \throws IoError.
std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture);

} // namespace forceshade::picture
