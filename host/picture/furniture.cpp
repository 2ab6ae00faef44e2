// The colour bar and the heading of a picture.
#include "host/picture/frame.h"

#include <algorithm>

namespace forceshade::picture {
namespace {

constexpr double kBarWidth = 22;
constexpr TextStyle kBarTickStyle{kSmallTextSize, false, Horizontal::left, Vertical::middle, false};
constexpr TextStyle kBarTitleStyle{kTextSize, false, Horizontal::left, Vertical::middle, true};

Axis bar_axis(double largest, double height) {
    return magnitude_axis(largest, static_cast<std::size_t>(std::clamp(height / 38, 3.0, 9.0)));
}

} // namespace

double colour_bar_width(double largest, double height) {
    if (largest == 0)
        return 0;
    const Axis axis = bar_axis(largest, height);
    return kBarWidth + kTickLength + 4 + widest_label(axis) + 10 + measure(axis.title, kBarTitleStyle).width;
}

double colour_bar_least_height(double largest) {
    return largest == 0 ? 0 : measure(bar_axis(largest, 300).title, kBarTitleStyle).height + 8;
}

void draw_colour_bar(Canvas& canvas, Point upper_left, double height, double largest) {
    if (largest == 0)
        return;
    const Axis axis = bar_axis(largest, height);
    const double right = upper_left.x + kBarWidth;
    const auto rows = static_cast<int>(height);
    std::vector<std::uint32_t> pixels;
    for (int y = 0; y < rows; ++y) {
        const Rgb8 c = force_colours()[colour_index(rows - y - 0.5, rows)];
        pixels.insert(pixels.end(), static_cast<std::size_t>(kBarWidth),
                      static_cast<std::uint32_t>(c.r) << 16U | static_cast<std::uint32_t>(c.g) << 8U | c.b);
    }
    canvas.image(static_cast<int>(upper_left.x), static_cast<int>(upper_left.y), static_cast<int>(kBarWidth), rows,
                 pixels);
    canvas.outline({upper_left.x - 0.5, upper_left.y - 0.5, kBarWidth + 1, height + 1}, {});
    for (const AxisTick& tick : axis.ticks) {
        const double y = upper_left.y + (1 - tick.fraction) * height;
        canvas.polyline(std::vector<Point>{{right, y}, {right + kTickLength, y}}, {});
        canvas.text(tick.label, {right + kTickLength + 4, y}, kBarTickStyle);
    }
    canvas.text(axis.title, {right + kTickLength + 4 + widest_label(axis) + 10, upper_left.y + height / 2},
                kBarTitleStyle);
}

std::string largest_note(double largest) {
    if (largest == 0)
        return "";
    const Unit unit = choose_unit(largest, "N");
    const double number = divide_by_power_of_ten(largest, unit.exponent);
    return " (at most " + with_unit(three_digits(number), unit) + ")";
}

Heading plan_heading(const std::string& name, const std::vector<std::string>& notes) {
    constexpr std::size_t kMostBytes = 600, kMostLines = 5;
    const double width = kSheetWidth - 2 * kMargin;
    Heading heading;
    heading.name_style = {kTitleSize, true, Horizontal::left, Vertical::top, false};
    heading.note_style = {kTextSize, false, Horizontal::left, Vertical::top, false};
    heading.name = wrap(name.substr(0, kMostBytes), heading.name_style, width);
    if (heading.name.size() > 2) {
        heading.name_style.size = kTextSize;
        heading.name = wrap(name.substr(0, kMostBytes), heading.name_style, width);
    }
    if (heading.name.size() > kMostLines || name.size() > kMostBytes) {
        heading.name.resize(std::min(heading.name.size(), kMostLines));
        heading.name.back() = wrap(heading.name.back(), heading.name_style, width - 40).front() + "…";
    }
    for (const std::string& note : notes)
        for (const std::string& line : wrap(note, heading.note_style, width))
            heading.notes.push_back(line);
    const auto lines = [](const std::vector<std::string>& text, const TextStyle& style) {
        return static_cast<double>(text.size()) * measure("0", style).height;
    };
    heading.height = lines(heading.name, heading.name_style) + 4 + lines(heading.notes, heading.note_style);
    return heading;
}

void draw_heading(Canvas& canvas, const Heading& heading) {
    double y = kMargin;
    for (const std::string& line : heading.name) {
        canvas.text(line, {kMargin, y}, heading.name_style);
        y += measure("0", heading.name_style).height;
    }
    y += 4;
    for (const std::string& line : heading.notes) {
        canvas.text(line, {kMargin, y}, heading.note_style);
        y += measure("0", heading.note_style).height;
    }
}

} // namespace forceshade::picture
