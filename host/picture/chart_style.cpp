#include "host/picture/chart_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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

// The names of a family get numbers from `first` on. Names that meet in a figure differ in their colours: number modulo
// 8.
struct Family {
    std::size_t first;
    std::initializer_list<std::string_view> names;
};
const Family kFamilies[] = {
    {0,
     {"direct", "look-up, trilinear", "look-up, tricubic", "god-object", "field, kernel", "field, CPU on one thread"}},
    {6, {"closed loop, kernel", "closed loop, CPU on one thread", "static field"}},
    {8, {"flat", "facet", "edge", "rim", "boundary", "slope", "crest", "hollow"}},
    {16, {"shaded"}},
    {16, {"reference", "morgenbesser", "barycentric", "two_pass", "mean_value", "height_map"}},
    {23, {"none"}},
    {23, {"unshaded"}},
    {24,
     {"computing the force and its safety", "late: woken after the sample was due",
      "jitter: the time between two samples off the period"}},
    {24, {"shaded mesh", "map of a bump", "shaded bump", "bump", "strokes", "map of a dip", "mesh", "plane"}},
    {33, {"unshaded, normal depth", "shaded, normal depth"}}};

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

std::map<std::string_view, std::size_t> make_known() {
    std::map<std::string_view, std::size_t> known;
    for (const Family& family : kFamilies)
        for (std::size_t i = 0; i < family.names.size(); ++i)
            known.emplace(family.names.begin()[i], family.first + i);
    return known;
}
const std::map<std::string_view, std::size_t> kKnown = make_known();

} // namespace

std::vector<std::size_t> series_numbers(std::span<const std::string> names) {
    std::vector<std::size_t> numbers;
    std::set<std::size_t> colours;
    for (const std::string& name : names)
        if (const auto found = kKnown.find(name); found != kKnown.end())
            colours.insert(found->second % kColours.size());
    std::size_t next = kFirstUnknown;
    for (const std::string& name : names) {
        if (const auto found = kKnown.find(name); found != kKnown.end()) {
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
    for (const auto& [name, number] : kKnown)
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
