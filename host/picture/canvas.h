// A sheet to draw on: boxes, lines, images, text that knows its size, and out comes a PNG. Units are pixels, y runs
// down.
#pragma once

#include "host/picture/picture.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct _cairo; // NOLINT(bugprone-reserved-identifier): the name that Cairo gives it

namespace forceshade::picture {

struct Point {
    double x = 0, y = 0;
};

inline constexpr Rgb8 kInk{26, 26, 26};
inline constexpr Rgb8 kPaper{255, 255, 255};
inline constexpr double kTextSize = 16; // pixels
inline constexpr double kSmallTextSize = 14.5;
inline constexpr double kTitleSize = 21;

enum class Horizontal { left, centre, right };
enum class Vertical { top, middle, bottom };

struct TextStyle {
    double size = kTextSize;
    bool bold = false;
    Horizontal horizontal = Horizontal::left; // which side of the text its anchor is
    Vertical vertical = Vertical::middle;
    bool upwards = false; // turned to read from below; horizontal and vertical are then those of the turned box
};

struct Stroke {
    Rgb8 colour = kInk;
    double width = 1;
    std::vector<double> dashes; // lengths of dash and gap in turn; empty: solid
    bool round_joins = false;
};

struct Extent {
    double width = 0, height = 0;
};

/// The space that `text` takes: advance width, line height; of the turned box if upwards.
Extent measure(std::string_view text, const TextStyle& style);

/// `text` in lines no wider than `width` (pixels), broken after a space, '_', '-' or '/', or anywhere if it must be.
std::vector<std::string> wrap(std::string_view text, const TextStyle& style, double width);

class Canvas {
public:
    Canvas(int width, int height);

    void fill(const Box& box, Rgb8 colour);
    void outline(const Box& box, const Stroke& stroke);
    void polyline(std::span<const Point> points, const Stroke& stroke);
    /// A filled polygon with an outline of that stroke drawn beneath the filling.
    void polygon(std::span<const Point> points, Rgb8 filling, const Stroke& stroke);
    void disc(Point centre, double radius, Rgb8 colour);
    /// `pixels`: 0x00RRGGBB, row 0 at the top, width * height of them, placed with the upper left corner at whole (x,
    /// y).
    void image(int x, int y, int width, int height, std::span<const std::uint32_t> pixels);
    /// From here on only what lies within `box` is drawn, until end_clip.
    void begin_clip(const Box& box);
    void end_clip();
    void text(std::string_view text, Point anchor, const TextStyle& style, Rgb8 colour = kInk);

    /// The finished picture. Throws std::runtime_error if the drawing library failed (out of memory).
    Picture finish() const;

private:
    int width_, height_; // pixels
    std::shared_ptr<_cairo_surface> surface_;
    std::shared_ptr<_cairo> context_;
    std::vector<PlacedText> texts_;
};

// Colours and marks of series by the name, the same in files and on the report's page.

/// A number for each name, of which colour and mark follow: known names have theirs everywhere, the others get in
/// their order the first colours that are left; without a name it is 0.
std::vector<std::size_t> series_numbers(std::span<const std::string> names);
/// {"direct": 0, ...}: the known names, for the page.
std::string known_series_json();

/// Those of the page (--plot-s0 and so on), again from the ninth on.
Rgb8 series_colour(std::size_t number);
/// Half way to white.
Rgb8 lighter(Rgb8 colour);
/// Seven shapes by number, again from the eighth on, in the order of d3: circle, square, triangle, diamond, cross,
/// star, wye.
void draw_mark(Canvas& canvas, Rgb8 colour, std::size_t shape, Point at);

} // namespace forceshade::picture
