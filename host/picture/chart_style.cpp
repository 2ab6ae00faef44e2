#include "host/picture/chart_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

namespace forceshade::picture {
namespace {

constexpr double kMarkSize = 5; // pixels
constexpr std::size_t kMarks = 7;
constexpr std::array<Rgb8, 8> kColours{{{0, 98, 173},
                                        {194, 65, 12},
                                        {0, 121, 92},
                                        {138, 58, 149},
                                        {125, 96, 0},
                                        {11, 118, 145},
                                        {179, 23, 79},
                                        {77, 77, 77}}};

// Names that meet in a figure differ in their colours: number modulo 8.
constexpr auto kKnownSeries = std::to_array<std::pair<std::string_view, std::size_t>>(
    {{"direct", 0},
     {"look-up, trilinear", 1},
     {"look-up, tricubic", 2},
     {"god-object", 3},
     {"field, kernel", 4},
     {"field, CPU on one thread", 5},
     {"static field", 8},
     {"closed loop, kernel", 6},
     {"closed loop, CPU on one thread", 7},
     {"flat", 8},
     {"facet", 9},
     {"edge", 10},
     {"rim", 11},
     {"boundary", 12},
     {"slope", 13},
     {"crest", 14},
     {"hollow", 15},
     {"shaded", 16},
     {"reference", 16},
     {"morgenbesser", 17},
     {"barycentric", 18},
     {"two_pass", 19},
     {"mean_value", 20},
     {"height_map", 21},
     {"computing the force and its safety", 24},
     {"late: woken after the sample was due", 25},
     {"jitter: the time between two samples off the period", 26},
     {"shaded mesh", 24},
     {"map of a bump", 25},
     {"shaded bump", 26},
     {"bump", 27},
     {"strokes", 28},
     {"map of a dip", 29},
     {"mesh", 30},
     {"plane", 31},
     {"unshaded, normal depth", 33},
     {"shaded, normal depth", 34},
     {"none", 23},
     {"unshaded", 23}});

constexpr std::size_t kFirstUnknown = 40; // no mark of a known name has its colour, too

Point polar(double radius, double turns) { // from the top
    const double angle = 2 * std::numbers::pi * turns;
    return {radius * std::sin(angle), -radius * std::cos(angle)};
}

// Corners at radii that take turns.
std::vector<Point> corners(int count, double turn, double radius, double other) {
    std::vector<Point> outline;
    for (int i = 0; i < count; ++i)
        outline.push_back(polar(i % 2 ? other : radius, (i + turn) / count));
    return outline;
}

std::vector<Point> arms(int count, double turn, double length, double half_width) {
    std::vector<Point> outline;
    for (int i = 0; i < count; ++i) {
        const Point end = polar(length, (i + turn) / count), aside = polar(half_width, (i + turn) / count + 0.25);
        outline.push_back({end.x - aside.x, end.y - aside.y});
        outline.push_back({end.x + aside.x, end.y + aside.y});
        outline.push_back(polar(half_width / std::sin(std::numbers::pi / count), (i + turn + 0.5) / count));
    }
    return outline;
}

std::vector<Point> mark_outline(std::size_t kind) {
    switch (kind) {
    case 1:
        return corners(4, 0.5, 1.3, 1.3);
    case 2:
        return corners(3, 0, 1.45, 1.45);
    case 3:
        return corners(4, 0, 1.6, 1);
    case 4:
        return arms(4, 0, 1.35, 0.45);
    case 5:
        return corners(10, 0, 1.6, 0.65);
    default:
        return arms(3, 0.5, 1.35, 0.5);
    }
}

} // namespace

std::vector<std::size_t> series_numbers(std::span<const std::string> names) {
    std::vector<std::size_t> numbers;
    std::set<std::size_t> colours;
    const auto known = [](const std::string& name) {
        return std::ranges::find(kKnownSeries, name, &std::pair<std::string_view, std::size_t>::first);
    };
    for (const std::string& name : names)
        if (const auto found = known(name); found != kKnownSeries.end())
            colours.insert(found->second % kColours.size());
    std::size_t next = kFirstUnknown;
    for (const std::string& name : names) {
        if (const auto found = known(name); found != kKnownSeries.end()) {
            numbers.push_back(found->second);
            continue;
        }
        for (std::size_t tries = 0; tries < kColours.size() && colours.contains(next % kColours.size()); ++tries)
            ++next;
        numbers.push_back(next++);
    }
    return numbers;
}

std::string known_series_json() {
    std::string text;
    for (const auto& [name, number] : kKnownSeries)
        text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", name, number);
    return "{" + text + "}";
}

Rgb8 series_colour(std::size_t number) {
    return kColours[number % kColours.size()];
}

Rgb8 lighter(Rgb8 colour) {
    const auto half = [](std::uint8_t c) { return static_cast<std::uint8_t>(255 - (255 - c) / 2); };
    return {half(colour.r), half(colour.g), half(colour.b)};
}

void draw_mark(Canvas& canvas, std::size_t number, Point at) {
    const Rgb8 colour = series_colour(number);
    if (number % kMarks == 0) {
        canvas.disc(at, kMarkSize + 0.8, kPaper);
        canvas.disc(at, kMarkSize, colour);
        return;
    }
    std::vector<Point> outline = mark_outline(number % kMarks);
    for (Point& point : outline)
        point = {at.x + kMarkSize * point.x, at.y + kMarkSize * point.y};
    canvas.polygon(outline, colour, {kPaper, 1.6, {}, false});
}

} // namespace forceshade::picture
