// Pictures as PNG bytes and vectors: of a force volume slices and arrows, of explored paths, and charts.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/picture/values.h"

namespace forceshade::picture {

/// Pixels; (x, y) is the upper left corner.
struct Box {
    double x = 0, y = 0, width = 0, height = 0;
};

struct PlacedText {
    std::string text;
    Box ink; // where its ink lies
};

/// What a picture shows, as vectors. Text is text or outlines of it. \throws std::runtime_error if the drawing library
/// fails (out of memory).
class Drawing {
public:
    virtual ~Drawing() = default;
    virtual std::string svg() const = 0;
    virtual std::string pdf() const = 0;
};

/// A finished picture. The same input gives the same bytes: the file holds no date and no program version.
struct Picture {
    std::vector<std::uint8_t> png;
    int width = 0, height = 0;     // pixels
    std::vector<PlacedText> texts; // every text drawn, so that a test can see that none overlaps or is cut
    std::shared_ptr<const Drawing> drawing;
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

} // namespace forceshade::picture
