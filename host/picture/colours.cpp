// Colours and marks.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "d3_colours.h"
#include "host/picture/canvas.h"

namespace forceshade::picture {
namespace {

// From "440154450256...": six digits a colour.
std::vector<Rgb8> colours_in(std::string_view digits) {
    std::vector<Rgb8> colours;
    for (; digits.size() >= 6; digits.remove_prefix(6)) {
        std::uint32_t value = 0;
        std::from_chars(digits.data(), digits.data() + 6, value, 16);
        colours.push_back({static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
                           static_cast<std::uint8_t>(value)});
    }
    return colours;
}

Rgb8 rounded(double r, double g, double b) {
    const auto part = [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    };
    return {part(r), part(g), part(b)};
}

Rgb8 ramp(const std::vector<Rgb8>& colours, double share) {
    const auto count = static_cast<double>(colours.size());
    return colours[static_cast<std::size_t>(std::clamp(std::floor(share * count), 0.0, count - 1))];
}

// d3.interpolateRdBu: a uniform cubic B-spline through the colours' components, from red to blue.
Rgb8 red_blue(double share) {
    static const std::vector<Rgb8> colours = colours_in(k_red_blue);
    const auto last = static_cast<int>(colours.size()) - 1;
    const int piece = std::min(static_cast<int>(share * last), last - 1);
    const double t = share * last - piece, t2 = t * t, t3 = t2 * t;
    const auto component = [&](std::uint8_t Rgb8::*of) {
        const auto at = [&](int i) { return static_cast<double>(colours[static_cast<std::size_t>(i)].*of); };
        const double before = piece > 0 ? at(piece - 1) : 2 * at(0) - at(1);
        const double after = piece < last - 1 ? at(piece + 2) : 2 * at(last) - at(last - 1);
        return ((1 - 3 * t + 3 * t2 - t3) * before + (4 - 6 * t2 + 3 * t3) * at(piece) +
                (1 + 3 * t + 3 * t2 - 3 * t3) * at(piece + 1) + t3 * after) /
               6;
    };
    return rounded(component(&Rgb8::r), component(&Rgb8::g), component(&Rgb8::b));
}

// d3.interpolateRainbow, in the colour space of Green 2011, "A colour scheme for the display of astronomical intensity
// images".
Rgb8 rainbow(double share) {
    const double away = std::fabs(share - 0.5), lightness = 0.8 - 0.9 * away;
    const double hue = (360 * share + 20) * std::numbers::pi / 180;
    const double strength = (1.5 - 1.5 * away) * lightness * (1 - lightness), c = std::cos(hue), s = std::sin(hue);
    return rounded(255 * (lightness + strength * (-0.14861 * c + 1.78277 * s)),
                   255 * (lightness + strength * (-0.29227 * c - 0.90649 * s)),
                   255 * (lightness + strength * 1.97294 * c));
}

} // namespace

Rgb8 colour_at(ColourMap map, double share) {
    static const std::vector<Rgb8> viridis = colours_in(k_viridis), plasma = colours_in(k_plasma);
    share = std::clamp(share, 0.0, 1.0);
    switch (map) {
    case ColourMap::sequential:
        return ramp(viridis, share);
    case ColourMap::second:
        return ramp(plasma, share);
    case ColourMap::diverging:
        return red_blue(1 - share);
    case ColourMap::cyclic:
        return rainbow(share);
    }
    return kNoForceColour;
}

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
    {1, {"look-up"}},
    {4, {"field"}},
    {16, {"shaded"}},
    {16, {"reference", "morgenbesser", "barycentric", "two_pass", "mean_value", "height_map"}},
    {23, {"none"}},
    {23, {"unshaded"}},
    {24,
     {"computing the force and its safety", "late: woken after the sample was due",
      "jitter: the time between two samples off the period"}},
    {24, {"shaded mesh", "map of a bump", "shaded bump", "bump", "strokes", "map of a dip", "mesh", "plane"}},
    {28, {"textured plane"}},
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
        if (const auto found = kKnown.find(name); found != kKnown.end() || name.empty()) {
            numbers.push_back(name.empty() ? 0 : found->second);
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

void draw_mark(Canvas& canvas, Rgb8 colour, std::size_t shape, Point at) {
    if (shape % kMarks == 0) {
        canvas.disc(at, kMarkSize + 0.8, kPaper);
        canvas.disc(at, kMarkSize, colour);
        return;
    }
    std::vector<Point> outline = mark_outline(shape % kMarks);
    for (Point& point : outline)
        point = {at.x + kMarkSize * point.x, at.y + kMarkSize * point.y};
    canvas.polygon(outline, colour, {kPaper, 1.6, {}, false});
}

} // namespace forceshade::picture
