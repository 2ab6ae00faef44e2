// The pictures that accompany a force volume: a mosaic of slices of |F| and an arrow plot of the x-z slice, as PNG
// bytes.
#pragma once

#include "host/picture/field_slice.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

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

/// A point of a line in the x-z plane.
struct LinePoint {
    double x, z; /* m */
};

/// Lines drawn over the arrow plot, each left out if empty.
struct SurfaceLines {
    std::vector<LinePoint> nominal; // the surface that the depth is measured from, solid
    std::vector<LinePoint> smooth;  // the shape that the shading imitates, dashed
};

/// |F| over x and y at each z (at least one, increasing; axes x and y common to all), one colour scale for all.
/// `name`: the case's, in UTF-8, wrapped if it is long.
Picture draw_mosaic(const std::string& name, std::span<const MagnitudeSlice> tiles);

/// An x-z slice: |F| as colour, (Fx, Fz) as arrows whose length is proportional to that part of the force.
Picture draw_arrows(const std::string& name, const FieldSlice& slice, const SurfaceLines& lines = {});

/// A slice and its name, for a picture of two.
struct NamedSlice {
    std::string name;
    const FieldSlice& slice;
};

/// Two such slices side by side, colours and arrows to one scale.
Picture draw_side_by_side(const NamedSlice& left, const NamedSlice& right, const SurfaceLines& lines = {});

} // namespace forceshade::picture
