#include "host/picture/canvas.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <cassert>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <numbers>
#include <stdexcept>

namespace forceshade::picture {
namespace {

constexpr const char* kFont = "DejaVu Sans";

void set_colour(cairo_t* context, Rgb8 c) {
    cairo_set_source_rgb(context, c.r / 255.0, c.g / 255.0, c.b / 255.0);
}

// Hinting and subpixel order would depend on the machine's font settings, so they are off.
void set_font(cairo_t* context, const TextStyle& style) {
    cairo_select_font_face(context, kFont, CAIRO_FONT_SLANT_NORMAL,
                           style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context, style.size);
    cairo_font_options_t* options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(context, options);
    cairo_font_options_destroy(options);
}

void trace(cairo_t* context, std::span<const Point> points) {
    cairo_new_path(context);
    for (const Point& point : points)
        cairo_line_to(context, point.x, point.y);
}

void set_stroke(cairo_t* context, const Stroke& stroke) {
    set_colour(context, stroke.colour);
    cairo_set_line_width(context, stroke.width);
    cairo_set_dash(context, stroke.dashes.data(), static_cast<int>(stroke.dashes.size()), 0);
    cairo_set_line_join(context, stroke.round_joins ? CAIRO_LINE_JOIN_ROUND : CAIRO_LINE_JOIN_MITER);
}

template <typename Bytes> cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
    auto& all = *static_cast<Bytes*>(bytes);
    all.insert(all.end(), data, data + length);
    return CAIRO_STATUS_SUCCESS;
}

[[noreturn]] void refuse(cairo_status_t status) {
    throw std::runtime_error(fmt::format("drawing a picture: {}", cairo_status_to_string(status)));
}

// What was drawn, to be drawn again on a surface of another kind.
class RecordedDrawing final : public Drawing {
public:
    RecordedDrawing(cairo_surface_t* recording, int width, int height)
        : recording_(cairo_surface_reference(recording)), width_(width), height_(height) {}
    ~RecordedDrawing() override { cairo_surface_destroy(recording_); }
    RecordedDrawing(const RecordedDrawing&) = delete;
    RecordedDrawing& operator=(const RecordedDrawing&) = delete;

    std::string svg() const override {
        std::string bytes;
        cairo_surface_t* surface = cairo_svg_surface_create_for_stream(append<std::string>, &bytes, width_, height_);
        cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
        draw_on(surface);
        return bytes;
    }
    std::string pdf() const override {
        std::string bytes;
        cairo_surface_t* surface = cairo_pdf_surface_create_for_stream(append<std::string>, &bytes, width_, height_);
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z"); // always one
        draw_on(surface);
        return bytes;
    }
    std::vector<std::uint8_t> png() const {
        cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_);
        std::vector<std::uint8_t> bytes;
        replay(surface);
        const cairo_status_t status = cairo_surface_write_to_png_stream(surface, append<decltype(bytes)>, &bytes);
        cairo_surface_destroy(surface);
        if (status != CAIRO_STATUS_SUCCESS)
            refuse(status);
        return bytes;
    }

private:
    void replay(cairo_surface_t* surface) const {
        cairo_t* context = cairo_create(surface);
        cairo_set_source_surface(context, recording_, 0, 0);
        cairo_paint(context);
        const cairo_status_t status = cairo_status(context);
        cairo_destroy(context);
        if (status != CAIRO_STATUS_SUCCESS) {
            cairo_surface_destroy(surface);
            refuse(status);
        }
    }
    void draw_on(cairo_surface_t* surface) const {
        replay(surface);
        cairo_surface_finish(surface);
        const cairo_status_t status = cairo_surface_status(surface);
        cairo_surface_destroy(surface);
        if (status != CAIRO_STATUS_SUCCESS)
            refuse(status);
    }

    cairo_surface_t* recording_;
    int width_, height_;
};

cairo_surface_t* recording_of(int width, int height) {
    const cairo_rectangle_t extents{0, 0, static_cast<double>(width), static_cast<double>(height)};
    return cairo_recording_surface_create(CAIRO_CONTENT_COLOR, &extents);
}

double aligned(Horizontal side, double width) {
    return side == Horizontal::left ? 0 : side == Horizontal::right ? -width : -width / 2;
}
double aligned(Vertical side, double height) {
    return side == Vertical::top ? 0 : side == Vertical::bottom ? -height : -height / 2;
}

} // namespace

struct Canvas::Sheet {
    Sheet(int wide, int high)
        : width(wide), height(high), surface(recording_of(wide, high)), context(cairo_create(surface)) {}
    ~Sheet() {
        cairo_destroy(context);
        cairo_surface_destroy(surface);
    }
    Sheet(const Sheet&) = delete;
    Sheet& operator=(const Sheet&) = delete;

    int width, height; // pixels
    cairo_surface_t* surface;
    cairo_t* context;
    std::vector<PlacedText> texts;
};

Extent measure(std::string_view text, const TextStyle& style) {
    cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
    cairo_t* context = cairo_create(surface);
    set_font(context, style);
    cairo_text_extents_t extents;
    cairo_font_extents_t font;
    cairo_text_extents(context, std::string(text).c_str(), &extents);
    cairo_font_extents(context, &font);
    cairo_destroy(context);
    cairo_surface_destroy(surface);
    const Extent flat{extents.x_advance, font.ascent + font.descent};
    return style.upwards ? Extent{flat.height, flat.width} : flat;
}

Canvas::Canvas(int width, int height) : sheet_(std::make_unique<Sheet>(width, height)) {
    fill({0, 0, static_cast<double>(width), static_cast<double>(height)}, kPaper);
}

Canvas::~Canvas() = default;

void Canvas::fill(const Box& box, Rgb8 colour) {
    set_colour(sheet_->context, colour);
    cairo_rectangle(sheet_->context, box.x, box.y, box.width, box.height);
    cairo_fill(sheet_->context);
}

void Canvas::outline(const Box& box, const Stroke& stroke) {
    set_stroke(sheet_->context, stroke);
    cairo_rectangle(sheet_->context, box.x, box.y, box.width, box.height);
    cairo_stroke(sheet_->context);
}

void Canvas::polyline(std::span<const Point> points, const Stroke& stroke) {
    set_stroke(sheet_->context, stroke);
    trace(sheet_->context, points);
    cairo_stroke(sheet_->context);
}

void Canvas::polygon(std::span<const Point> points, Rgb8 filling, const Stroke& stroke) {
    set_stroke(sheet_->context, stroke);
    trace(sheet_->context, points);
    cairo_close_path(sheet_->context);
    cairo_stroke_preserve(sheet_->context);
    set_colour(sheet_->context, filling);
    cairo_fill(sheet_->context);
}

void Canvas::disc(Point centre, double radius, Rgb8 colour) {
    set_colour(sheet_->context, colour);
    cairo_new_path(sheet_->context);
    cairo_arc(sheet_->context, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(sheet_->context);
}

void Canvas::image(int x, int y, int width, int height, std::span<const std::uint32_t> pixels) {
    assert(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    cairo_surface_t* source = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    unsigned char* data = cairo_image_surface_get_data(source);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(source));
    const auto row_bytes = static_cast<std::size_t>(width) * sizeof(std::uint32_t);
    for (std::size_t row = 0; data && row < static_cast<std::size_t>(height); ++row)
        std::memcpy(data + row * stride, pixels.data() + row * static_cast<std::size_t>(width), row_bytes);
    cairo_surface_mark_dirty(source);
    cairo_set_source_surface(sheet_->context, source, x, y);
    cairo_paint(sheet_->context);
    cairo_surface_destroy(source);
}

void Canvas::begin_clip(const Box& box) {
    cairo_save(sheet_->context);
    cairo_new_path(sheet_->context);
    cairo_rectangle(sheet_->context, box.x, box.y, box.width, box.height);
    cairo_clip(sheet_->context);
}

void Canvas::end_clip() {
    cairo_restore(sheet_->context);
}

void Canvas::text(std::string_view text, Point anchor, const TextStyle& style, Rgb8 colour) {
    cairo_t* context = sheet_->context;
    const std::string owned(text);
    const Extent size = measure(text, style);
    const Point corner{anchor.x + aligned(style.horizontal, size.width),
                       anchor.y + aligned(style.vertical, size.height)};
    set_font(context, style);
    set_colour(context, colour);
    cairo_font_extents_t font;
    cairo_text_extents_t ink;
    cairo_font_extents(context, &font);
    cairo_text_extents(context, owned.c_str(), &ink);
    cairo_save(context);
    Box box;
    if (style.upwards) {
        const Point origin{corner.x + font.ascent, corner.y + size.height};
        cairo_translate(context, origin.x, origin.y);
        cairo_rotate(context, -std::numbers::pi / 2);
        box = {origin.x + ink.y_bearing, origin.y - ink.x_bearing - ink.width, ink.height, ink.width};
    } else {
        const Point origin{corner.x, corner.y + font.ascent};
        cairo_translate(context, origin.x, origin.y);
        box = {origin.x + ink.x_bearing, origin.y + ink.y_bearing, ink.width, ink.height};
    }
    cairo_move_to(context, 0, 0);
    cairo_show_text(context, owned.c_str());
    cairo_restore(context);
    sheet_->texts.push_back({owned, box});
}

Picture Canvas::finish() const {
    if (const cairo_status_t drawn = cairo_status(sheet_->context); drawn != CAIRO_STATUS_SUCCESS)
        refuse(drawn);
    const auto drawing = std::make_shared<RecordedDrawing>(sheet_->surface, sheet_->width, sheet_->height);
    return {drawing->png(), sheet_->width, sheet_->height, sheet_->texts, drawing};
}

} // namespace forceshade::picture
