#include "host/picture/canvas.h"

#include <algorithm>
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <cassert>
#include <cstring>
#include <fmt/format.h>
#include <numbers>
#include <stdexcept>

#include "host/output/files.h"
#include "host/spelling.h"

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

void require(cairo_status_t status) {
    if (status != CAIRO_STATUS_SUCCESS)
        throw std::runtime_error(fmt::format("drawing a picture: {}", cairo_status_to_string(status)));
}

using Surface = std::shared_ptr<cairo_surface_t>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

Surface owned(cairo_surface_t* surface) {
    return {surface, cairo_surface_destroy};
}

Context context_of(const Surface& surface) {
    return {cairo_create(surface.get()), cairo_destroy};
}

Surface recording_of(int width, int height) {
    const cairo_rectangle_t extents{0, 0, static_cast<double>(width), static_cast<double>(height)};
    return owned(cairo_recording_surface_create(CAIRO_CONTENT_COLOR, &extents));
}

// What was drawn, again on a surface of another kind.
void replay(const Surface& recording, const Surface& surface) {
    const Context context = context_of(surface);
    cairo_set_source_surface(context.get(), recording.get(), 0, 0);
    cairo_paint(context.get());
    require(cairo_status(context.get()));
}

// Its bytes are there when the surface is finished.
void replay_to_end(const Surface& recording, const Surface& surface) {
    replay(recording, surface);
    cairo_surface_finish(surface.get());
    require(cairo_surface_status(surface.get()));
}

double aligned(Horizontal side, double width) {
    return side == Horizontal::left ? 0 : side == Horizontal::right ? -width : -width / 2;
}
double aligned(Vertical side, double height) {
    return side == Vertical::top ? 0 : side == Vertical::bottom ? -height : -height / 2;
}

} // namespace

std::string Picture::svg() const {
    std::string bytes;
    const Surface surface = owned(cairo_svg_surface_create_for_stream(append<std::string>, &bytes, width, height));
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
    replay_to_end(drawing, surface);
    return bytes;
}

std::string Picture::pdf() const {
    std::string bytes;
    const Surface surface = owned(cairo_pdf_surface_create_for_stream(append<std::string>, &bytes, width, height));
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z"); // always one
    replay_to_end(drawing, surface);
    return bytes;
}

Extent measure(std::string_view text, const TextStyle& style) {
    const Context context = context_of(owned(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1)));
    set_font(context.get(), style);
    cairo_text_extents_t extents;
    cairo_font_extents_t font;
    cairo_text_extents(context.get(), std::string(text).c_str(), &extents);
    cairo_font_extents(context.get(), &font);
    const Extent flat{extents.x_advance, font.ascent + font.descent};
    return style.upwards ? Extent{flat.height, flat.width} : flat;
}

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), surface_(recording_of(width, height)), context_(context_of(surface_)) {
    fill({0, 0, static_cast<double>(width), static_cast<double>(height)}, kPaper);
}

void Canvas::fill(const Box& box, Rgb8 colour) {
    set_colour(context_.get(), colour);
    cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
    cairo_fill(context_.get());
}

void Canvas::outline(const Box& box, const Stroke& stroke) {
    set_stroke(context_.get(), stroke);
    cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
    cairo_stroke(context_.get());
}

void Canvas::polyline(std::span<const Point> points, const Stroke& stroke) {
    set_stroke(context_.get(), stroke);
    trace(context_.get(), points);
    cairo_stroke(context_.get());
}

void Canvas::polygon(std::span<const Point> points, Rgb8 filling, const Stroke& stroke) {
    set_stroke(context_.get(), stroke);
    trace(context_.get(), points);
    cairo_close_path(context_.get());
    cairo_stroke_preserve(context_.get());
    set_colour(context_.get(), filling);
    cairo_fill(context_.get());
}

void Canvas::disc(Point centre, double radius, Rgb8 colour) {
    set_colour(context_.get(), colour);
    cairo_new_path(context_.get());
    cairo_arc(context_.get(), centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(context_.get());
}

void Canvas::image(int x, int y, int width, int height, std::span<const std::uint32_t> pixels) {
    assert(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    const Surface source = owned(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
    unsigned char* data = cairo_image_surface_get_data(source.get());
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(source.get()));
    const auto row_bytes = static_cast<std::size_t>(width) * sizeof(std::uint32_t);
    for (std::size_t row = 0; data && row < static_cast<std::size_t>(height); ++row)
        std::memcpy(data + row * stride, pixels.data() + row * static_cast<std::size_t>(width), row_bytes);
    cairo_surface_mark_dirty(source.get());
    cairo_set_source_surface(context_.get(), source.get(), x, y);
    cairo_paint(context_.get());
}

void Canvas::begin_clip(const Box& box) {
    cairo_save(context_.get());
    cairo_new_path(context_.get());
    cairo_rectangle(context_.get(), box.x, box.y, box.width, box.height);
    cairo_clip(context_.get());
}

void Canvas::end_clip() {
    cairo_restore(context_.get());
}

void Canvas::text(std::string_view text, Point anchor, const TextStyle& style, Rgb8 colour) {
    cairo_t* context = context_.get();
    const std::string whole(text);
    const Extent size = measure(text, style);
    const Point corner{anchor.x + aligned(style.horizontal, size.width),
                       anchor.y + aligned(style.vertical, size.height)};
    set_font(context, style);
    set_colour(context, colour);
    cairo_font_extents_t font;
    cairo_text_extents_t ink;
    cairo_font_extents(context, &font);
    cairo_text_extents(context, whole.c_str(), &ink);
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
    cairo_show_text(context, whole.c_str());
    cairo_restore(context);
    texts_.push_back({whole, box});
}

Picture Canvas::finish() const {
    require(cairo_status(context_.get()));
    const Surface surface = owned(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width_, height_));
    replay(surface_, surface);
    std::vector<std::uint8_t> png;
    require(cairo_surface_write_to_png_stream(surface.get(), append<decltype(png)>, &png));
    return {std::move(png), width_, height_, texts_, surface_};
}

namespace {

bool breaks_after(char c) {
    return c == ' ' || c == '_' || c == '-' || c == '/';
}

// How many bytes of `text` go on a line of `width`: up to the last allowed break, or else as many characters as fit.
std::size_t line_length(std::string_view text, const TextStyle& style, double width) {
    std::size_t fitting = 0, at_break = 0;
    while (fitting < text.size()) {
        const std::size_t next = fitting + character_length(text.substr(fitting));
        if (fitting > 0 && measure(text.substr(0, next), style).width > width)
            return at_break > 0 ? at_break : fitting;
        fitting = next;
        if (breaks_after(text[fitting - 1]))
            at_break = fitting;
    }
    return fitting;
}

} // namespace

std::vector<std::string> wrap(std::string_view text, const TextStyle& style, double width) {
    const std::string clean = printable(text);
    std::vector<std::string> lines;
    for (std::string_view rest = clean; !rest.empty();) {
        const std::size_t length = line_length(rest, style, width);
        lines.emplace_back(rest.substr(0, length));
        rest.remove_prefix(length);
    }
    return lines;
}

bool Endings::add(std::string_view name) {
    for (const auto& [known, wanted] : {std::pair("png", &png), {"svg", &svg}, {"pdf", &pdf}})
        if (name == known)
            return *wanted = true;
    return false;
}

std::vector<std::string> names_with(const std::string& stem, const Endings& endings) {
    std::vector<std::string> names;
    for (const auto& [wanted, ending] : {std::pair(endings.png, ".png"), {endings.svg, ".svg"}, {endings.pdf, ".pdf"}})
        if (wanted)
            names.push_back(stem + ending);
    return names;
}

std::vector<FileRecord> write_picture(const std::filesystem::path& stem, const Endings& endings,
                                      const Picture& picture) {
    std::vector<FileRecord> records;
    for (const std::string& name : names_with(stem.filename().string(), endings)) {
        const std::string vectors = name.ends_with(".svg")   ? picture.svg()
                                    : name.ends_with(".pdf") ? picture.pdf()
                                                             : "";
        const auto bytes = vectors.empty() ? std::as_bytes(std::span(picture.png)) : std::as_bytes(std::span(vectors));
        write_file_atomically(stem.parent_path() / name, bytes);
        records.push_back({name, sha256_of(bytes), bytes.size()});
    }
    return records;
}

} // namespace forceshade::picture
