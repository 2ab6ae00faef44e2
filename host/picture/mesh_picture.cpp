// Of meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/mesh/findings.h"
#include "host/picture/frame.h"

namespace forceshade::picture {

namespace {

constexpr int kFiner = 2; // samples a pixel, across and down
constexpr Rgb8 kFront{176, 190, 205}, kBack{214, 178, 142};
constexpr Rgb8 kInward{148, 103, 189}, kCrossing{255, 160, 40};
constexpr Rgb8 kRim{214, 39, 40}, kCrowded{197, 27, 200}, kSharpEdge{40, 60, 90};

Rgb8 mixed(Rgb8 one, Rgb8 other, double share) {
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
    };
    return {mix(one.r, other.r), mix(one.g, other.g), mix(one.b, other.b)};
}

/// Where we look from, and what lies right and up in the picture; unit vectors.
struct ViewPoint {
    glm::dvec3 from, right, up;

    explicit ViewPoint(const glm::dvec3& towards_us)
        : from(glm::normalize(towards_us)), right(right_of(from)), up(glm::cross(from, right)) {}
    // Where we look along z, x is right.
    static glm::dvec3 right_of(const glm::dvec3& from) {
        const glm::dvec3 across = glm::cross(glm::dvec3(0, 0, 1), from);
        return glm::length(across) > 1e-9 ? glm::normalize(across) : glm::dvec3(1, 0, 0);
    }
    glm::dvec3 seen(const glm::dvec3& place) const {
        return {glm::dot(right, place), glm::dot(up, place), glm::dot(from, place)};
    }
};

/// A square image of a mesh, drawn triangle by triangle into a depth buffer, then the marked edges.
class View {
public:
    /// \param half_width m, of the square about `middle`
    View(const ViewPoint& point, const glm::dvec3& middle, double half_width, int pixels)
        : point_(point), middle_(point.seen(middle)), size_(pixels * kFiner), scale_(size_ / (2 * half_width)),
          depth_(area(), -std::numeric_limits<double>::infinity()), colour_(area(), kPaper) {}

    /// In samples from the upper left; z towards us, in samples too.
    glm::dvec3 at(const glm::dvec3& place) const {
        const glm::dvec3 off = scale_ * (point_.seen(place) - middle_);
        return {0.5 * size_ + off.x, 0.5 * size_ - off.y, off.z};
    }

    void triangle(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& normal, Rgb8 front, Rgb8 back) {
        const double facing = glm::dot(normal, point_.from);
        triangle(corners, mixed({30, 34, 40}, facing < 0 ? back : front, 0.35 + 0.65 * std::abs(facing)));
    }
    void triangle(const std::array<glm::dvec3, 3>& corners, Rgb8 colour) {
        const glm::dvec3 a = at(corners[0]), b = at(corners[1]), c = at(corners[2]);
        const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (twice == 0)
            return;
        const auto [left, right] = std::minmax({a.x, b.x, c.x});
        const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
        for (int y = first_of(top); y <= last_of(bottom); ++y)
            for (int x = first_of(left); x <= last_of(right); ++x) {
                const double px = x + 0.5 - a.x, py = y + 0.5 - a.y;
                const double v = (px * (c.y - a.y) - py * (c.x - a.x)) / twice;
                const double w = ((b.x - a.x) * py - (b.y - a.y) * px) / twice;
                if (v < 0 || w < 0 || v + w > 1)
                    continue;
                const double z = a.z + v * (b.z - a.z) + w * (c.z - a.z);
                if (z <= depth_[index(x, y)])
                    continue;
                depth_[index(x, y)] = z;
                colour_[index(x, y)] = colour;
            }
    }

    /// Pale where a triangle is in front of it.
    void edge(const MeshMarks::Edge& edge, Rgb8 colour, double width) {
        const glm::dvec3 from = at(edge[0]), to = at(edge[1]);
        const double length = std::hypot(to.x - from.x, to.y - from.y), radius = 0.5 * width * kFiner;
        const int steps = std::clamp(static_cast<int>(std::ceil(length)), 1, 4 * size_);
        for (int i = 0; i <= steps; ++i) {
            const glm::dvec3 place = from + (double(i) / steps) * (to - from);
            for (int y = first_of(place.y - radius); y <= last_of(place.y + radius); ++y)
                for (int x = first_of(place.x - radius); x <= last_of(place.x + radius); ++x)
                    if (std::hypot(x + 0.5 - place.x, y + 0.5 - place.y) <= radius)
                        mark(index(x, y), place.z, colour);
        }
    }

    std::vector<std::uint32_t> pixels() {
        for (const auto& [sample, colour] : hidden_)
            if (!marked_[sample])
                colour_[sample] = mixed(colour_[sample], colour, 0.4);
        const int pixels = size_ / kFiner;
        std::vector<std::uint32_t> result;
        for (int y = 0; y < pixels; ++y)
            for (int x = 0; x < pixels; ++x) {
                std::array<int, 3> sum{};
                for (int i = 0; i < kFiner * kFiner; ++i) {
                    const Rgb8 c = colour_[index(x * kFiner + i % kFiner, y * kFiner + i / kFiner)];
                    sum = {sum[0] + c.r, sum[1] + c.g, sum[2] + c.b};
                }
                constexpr int kSamples = kFiner * kFiner;
                result.push_back(
                    packed({static_cast<std::uint8_t>(sum[0] / kSamples), static_cast<std::uint8_t>(sum[1] / kSamples),
                            static_cast<std::uint8_t>(sum[2] / kSamples)}));
            }
        return result;
    }

private:
    std::size_t area() const { return std::size_t(size_) * std::size_t(size_); }
    std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(size_) + std::size_t(x); }
    int first_of(double low) const { return static_cast<int>(std::clamp(std::floor(low), 0.0, double(size_))); }
    int last_of(double high) const { return static_cast<int>(std::clamp(std::ceil(high), -1.0, size_ - 1.0)); }

    void mark(std::size_t sample, double z, Rgb8 colour) {
        if (marked_.empty())
            marked_.resize(area());
        constexpr double kSamples = 3; // how far behind its own triangles rounding may put an edge
        if (z < depth_[sample] - kSamples * kFiner) {
            hidden_.emplace_back(sample, colour);
            return;
        }
        marked_[sample] = true;
        colour_[sample] = colour;
    }

    ViewPoint point_;
    glm::dvec3 middle_;
    int size_;     // samples
    double scale_; // samples a metre
    std::vector<double> depth_;
    std::vector<Rgb8> colour_;
    std::vector<bool> marked_;
    std::vector<std::pair<std::size_t, Rgb8>> hidden_;
};

std::vector<LegendItem> legend(const MeshMarks& marks) {
    std::vector<LegendItem> items{swatch_item("outer side", kFront), swatch_item("inner side", kBack)};
    if (const auto inward = std::count(marks.inward.begin(), marks.inward.end(), true); inward > 0)
        items.push_back(swatch_item(
            counted(static_cast<std::size_t>(inward), "facet that faces inward", "facets that face inward"), kInward));
    if (!marks.crossing.empty())
        items.push_back(swatch_item(counted(marks.crossing.size(), "triangle that touches or crosses others",
                                            "triangles that touch or cross others"),
                                    kCrossing));
    const auto add = [&](const std::vector<MeshMarks::Edge>& edges, Rgb8 colour, double width,
                         const std::string& what) {
        if (!edges.empty())
            items.push_back(
                line_item(fmt::format("{} {}", counted(edges.size(), "edge"), what), {colour, width, {}, false}));
    };
    add(marks.rims, kRim, 3, "of holes or rims");
    add(marks.crowded, kCrowded, 3, "of more than two facets");
    add(marks.sharp, kSharpEdge, 1.6, fmt::format("sharper than {}°", MeshMarks::kSharp));
    return items;
}

void draw_axes_of(Canvas& canvas, const ViewPoint& point, Point origin) {
    constexpr double kLength = 34;
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 unit(0);
        unit[axis] = 1;
        const glm::dvec3 seen = point.seen(unit);
        const Point ends[] = {origin, {origin.x + kLength * seen.x, origin.y - kLength * seen.y}};
        canvas.polyline(ends, {kInk, 1.6, {}, false});
        canvas.text(std::string(1, "xyz"[axis]),
                    {origin.x + (kLength + 11) * seen.x, origin.y - (kLength + 11) * seen.y},
                    {kSmallTextSize, false, Horizontal::centre, Vertical::middle, false});
    }
}

/// A bar of 1, 2 or 5 times a power of ten, about a fifth of the picture long.
LegendItem scale_item(double pixels_a_unit, double pixels, const std::string& unit) {
    const double length = round_below(0.2 * pixels / pixels_a_unit);
    const Unit best = choose_unit(length, "m");
    return line_item(unit == "m" ? fmt::format("{:.3g} {}", divide_by_power_of_ten(length, best.exponent), best.name)
                                 : fmt::format("{:.3g} {}", length, unit),
                     {kInk, 3, {}, false}, length * pixels_a_unit);
}

/// Half the side of a square about `middle` that holds the mesh as seen from all points, m.
double half_width_of(const Mesh& mesh, const glm::dvec3& middle, std::span<const ViewPoint> points) {
    double half = 0;
    for (const ViewPoint& point : points)
        for (const std::uint32_t corner : mesh.polygons.corners) {
            const glm::dvec3 seen = point.seen(mesh.polygons.vertices[corner] - middle);
            half = std::max({half, std::abs(seen.x), std::abs(seen.y)});
        }
    return 1.06 * half;
}

glm::dvec3 middle_of(const Mesh& mesh) {
    const MeshBox box = bounding_box(mesh.polygons);
    return box.low + 0.5 * (box.high - box.low);
}

/// deg: that 99 % of the parts do not exceed; the largest where these are not turned at all.
double usual_turn(std::vector<float> turns) {
    if (turns.empty())
        return 0;
    const auto at = turns.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(turns.size() - 1));
    std::ranges::nth_element(turns, at);
    return *at > 0 ? *at : *std::ranges::max_element(turns);
}

void draw_turned(View& view, const ViewPoint& point, const Mesh& mesh, const TurnedMesh& turned,
                 const ColourScale& scale) {
    const bool nowhere = std::ranges::all_of(turned.turns, [](float turn) { return turn == 0; });
    auto turn = turned.turns.begin();
    for (std::size_t triangle = 0; triangle < mesh.triangles.corners.size(); ++triangle) {
        const auto& [first, second, third] = mesh.triangles.corners[triangle];
        const glm::dvec3 from = mesh.polygons.vertices[first], across = mesh.polygons.vertices[second] - from,
                         up = mesh.polygons.vertices[third] - from;
        const double lit = 0.6 + 0.4 * std::abs(glm::dot(mesh.triangles.normals[triangle], point.from));
        for_each_part(turned.parts, [&](const auto& shares) {
            std::array<glm::dvec3, 3> places{};
            std::ranges::transform(shares, places.begin(),
                                   [&](const auto& share) { return from + share[0] * across + share[1] * up; });
            const Rgb8 of_turn = nowhere ? kFront : scale.of(std::min<double>(*turn, scale.high)); // grey shows facets
            const Rgb8 colour = mixed({30, 34, 40}, of_turn, lit);
            view.triangle(places, colour);
            ++turn;
        });
    }
}

} // namespace

Picture draw_turns(const Look& look, const std::vector<std::string>& notes, const Mesh& mesh,
                   std::span<const TurnedMesh> shadings, const std::array<double, 3>& view) {
    const ViewPoint point({view[0], view[1], view[2]});
    const glm::dvec3 middle = middle_of(mesh);
    const double half = half_width_of(mesh, middle, std::span(&point, 1));
    double usual = 0;
    for (const TurnedMesh& shaded : shadings)
        usual = std::max(usual, usual_turn(shaded.turns));
    const ColourScale scale = scale_for(Quantity::angle, usual, {0, 2, 1});
    const Heading heading = plan_heading(look, notes);
    const std::size_t columns = std::min<std::size_t>(shadings.size(), 2), rows = (shadings.size() + 1) / 2;
    const double bar = colour_bar_width(scale, 400) + kBarGap;
    std::vector<LegendItem> items{scale_item(1, 1, "m")}; // for its height
    const double below = legend_height(items, look.width) + kMargin;
    int side = static_cast<int>((look.width - bar - kMargin) / static_cast<double>(columns) - kMargin);
    const double around = heading.height + below + 2 * kMargin;
    if (look.most_height > 0)
        side = std::clamp(static_cast<int>((look.most_height - around) / static_cast<double>(rows) - kMargin), 120,
                          std::max(side, 120));
    const int strip = static_cast<int>(kMargin), step = side + strip; // a pane's title stands in the strip above it
    const int top = static_cast<int>(kMargin + heading.height) + strip;
    Canvas canvas(look.width, top + static_cast<int>(rows) * step + static_cast<int>(below));
    draw_heading(canvas, heading);
    for (std::size_t i = 0; i < shadings.size(); ++i) {
        View pane(point, middle, half, side);
        draw_turned(pane, point, mesh, shadings[i], scale);
        const int left = strip + static_cast<int>(i % 2) * step, upper = top + static_cast<int>(i / 2) * step;
        canvas.image(left, upper, side, side, pane.pixels());
        canvas.outline({left + 0.5, upper + 0.5, side - 1.0, side - 1.0}, {kGridInk, 1, {}, false});
        const double most = shadings[i].turns.empty() ? 0 : *std::ranges::max_element(shadings[i].turns);
        const bool grows = shadings[i].shading == "two_pass"; // the others keep the size
        canvas.text(fmt::format("{}: {}", shadings[i].shading,
                                most > 0 ? fmt::format("up to {:.3g}°{}", most, grows ? ", size times 1/cos of it" : "")
                                         : "the facets' own directions"),
                    {double(left), upper - 12.0}, {kSmallTextSize}, kQuietInk);
        if (i == 0)
            draw_axes_of(canvas, point, {left + 58.0, upper + side - 58.0});
    }
    if (scale.shows())
        draw_colour_bar(canvas, {kMargin + static_cast<double>(columns) * step - kMargin + kBarGap, double(top)},
                        std::max(colour_bar_least_height(scale), std::min(400.0, double(side))), scale);
    items.front() = scale_item(side / (2 * half), side, "m");
    draw_legend(canvas, items, {kMargin, top + static_cast<double>(rows) * step - kMargin / 2},
                look.width - 2 * kMargin);
    return canvas.finish();
}

Picture draw_mesh(const Look& look, const std::vector<std::string>& notes, const Mesh& mesh, const MeshMarks& marks,
                  const std::string& unit) {
    const glm::dvec3 front(kView[0], kView[1], kView[2]);
    const std::array<ViewPoint, 2> points{ViewPoint(front), ViewPoint(-front)};
    const glm::dvec3 middle = middle_of(mesh);
    const double half = half_width_of(mesh, middle, points);
    const Heading heading = plan_heading(look, notes);
    const double width = look.width - 2 * kMargin;
    std::vector<LegendItem> items = legend(marks);
    items.insert(items.begin(), scale_item(1, 1, unit)); // for its height
    const double below = legend_height(items, width) + kMargin;
    int side = static_cast<int>((width - kMargin) / 2);
    if (look.most_height > 0)
        side = std::clamp(look.most_height - static_cast<int>(heading.height + below + 2.5 * kMargin), 120, side);
    items.front() = scale_item(side / (2 * half), side, unit);
    const int top = static_cast<int>(2 * kMargin + heading.height);
    Canvas canvas(look.width, top + side + static_cast<int>(kMargin / 2 + below));
    draw_heading(canvas, heading);
    std::vector<bool> crossing(mesh.triangles.corners.size());
    for (const std::uint32_t triangle : marks.crossing)
        crossing[triangle] = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
        View view(points[i], middle, half, side);
        for (std::size_t triangle = 0; triangle < mesh.triangles.corners.size(); ++triangle) {
            const auto& [a, b, c] = mesh.triangles.corners[triangle];
            const bool inward = marks.inward[mesh.triangles.facets[triangle]];
            const std::optional<Rgb8> marked = crossing[triangle] ? std::optional(kCrossing)
                                               : inward           ? std::optional(kInward)
                                                                  : std::nullopt;
            view.triangle({mesh.polygons.vertices[a], mesh.polygons.vertices[b], mesh.polygons.vertices[c]},
                          mesh.triangles.normals[triangle], marked.value_or(kFront), marked.value_or(kBack));
        }
        for (const MeshMarks::Edge& edge : marks.sharp)
            view.edge(edge, kSharpEdge, 1.2);
        for (const MeshMarks::Edge& edge : marks.crowded)
            view.edge(edge, kCrowded, 3);
        for (const MeshMarks::Edge& edge : marks.rims)
            view.edge(edge, kRim, 3);
        const double left = kMargin + static_cast<double>(i) * (side + kMargin);
        canvas.image(static_cast<int>(left), top, side, side, view.pixels());
        canvas.outline({std::floor(left) + 0.5, top + 0.5, side - 1.0, side - 1.0}, {kGridInk, 1, {}, false});
        canvas.text(i == 0 ? "from the right, in front and above" : "from the opposite side",
                    {std::floor(left), top - 12.0}, {kSmallTextSize}, kQuietInk);
        draw_axes_of(canvas, points[i], {left + 58, top + side - 58.0});
    }
    draw_legend(canvas, items, {kMargin, top + side + kMargin / 2}, width);
    return canvas.finish();
}

} // namespace forceshade::picture
