// What the pictures of a field show: a mosaic, arrows, what shading changes.
#include <algorithm>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

#include "host/picture/frame.h"
#include "host/picture/panels.h"
#include "host/picture/slice_collector.h"

namespace forceshade::picture {
namespace {

constexpr std::size_t kShownTiles = 12;

std::string non_finite_note(const Census& census) {
    return fmt::format("not a finite number ({} of {} samples)", census.non_finite, census.samples);
}

void add_axes_notes(const PlaneAxes& axes, bool arrows, std::vector<std::string>& notes) {
    if (!axes.stretch_note.empty())
        notes.push_back(axes.stretch_note + (arrows ? "; arrows keep their true direction" : ""));
    if (const std::string sampling = sampling_note(axes); !sampling.empty())
        notes.push_back(sampling);
}

// From the lowest to the highest place of the lines over the slice.
std::optional<std::array<double, 2>> reach_of(const SurfaceLines& lines, const SliceAxes& axes) {
    std::array<double, 2> reach{INFINITY, -INFINITY};
    for (const auto* line : {&lines.nominal, &lines.smooth})
        for (const LinePoint& point : *line)
            if (point.x >= axes.u.front() && point.x <= axes.u.back())
                reach = {std::min(reach[0], point.z), std::max(reach[1], point.z)};
    return reach[0] <= reach[1] ? std::optional(reach) : std::nullopt;
}

// "x–z slice at y = 0.2 mm"
std::string where(const SliceAxes& axes, const Unit& unit) {
    const std::string at = position_labels(kAxisNames[axes.axis[2]], {axes.at}, axes.at_spacing, unit).front();
    return fmt::format("{}–{} slice at {}", kAxisNames[axes.axis[0]], kAxisNames[axes.axis[1]], at);
}

std::string arrows_note(const SliceAxes& axes) {
    return fmt::format("in-plane force (F{}, F{}) as arrows centred on their samples", kAxisNames[axes.axis[0]],
                       kAxisNames[axes.axis[1]]);
}

// Of forces before and after shading.
std::string magnitude_note(const ValueSlice& before, const ValueSlice& after) {
    double largest = 0, change = 0;
    for (std::size_t i = 0; i < before.value.size(); ++i)
        if (std::isfinite(before.value[i]) && std::isfinite(after.value[i])) {
            largest = std::max(largest, before.value[i]);
            change = std::max(change, std::fabs(after.value[i] - before.value[i]));
        }
    if (change <= 1e-5 * largest)
        return "stays";
    return "changes by up to " + quantity_text(change, "N");
}

bool has_force(const ValueSlice& tile) {
    const Census census = take_census(tile.value);
    return census.none < census.samples;
}

} // namespace

Picture draw_mosaic(const Look& look, std::span<const ValueSlice> tiles, Quantity quantity) {
    assert(!tiles.empty());
    Census census;
    std::vector<ValueSlice> filled;
    for (const ValueSlice& tile : tiles) {
        census = census + take_census(tile.value);
        if (has_force(tile))
            filled.push_back(tile);
    }
    const bool nothing = filled.empty();
    if (nothing)
        filled.push_back(tiles[0]);
    const Window window = contact_window(filled);
    PanelSheet sheet{look, {}, {}, {scale_for(quantity, census.largest, tiles[0].axes.axis)}, {}, ""};
    std::vector<double> heights;
    for (std::size_t i = 0; i < filled.size(); i += (filled.size() + kShownTiles - 1) / kShownTiles) {
        heights.push_back(filled[i].axes.at);
        sheet.panels.push_back({"", cropped(filled[i], window), 0});
    }
    const PlaneAxes axes = plan_axes(sheet.panels[0].values.axes);
    const std::vector<std::string> labels = position_labels("z", heights, tiles[0].axes.at_spacing, axes.longer_unit);
    for (std::size_t i = 0; i < labels.size(); ++i)
        sheet.panels[i].label = labels[i];
    sheet.notes.push_back((labels.size() == 1
                               ? sheet.scales[0].words + " in one slice of constant z"
                               : fmt::format("{} in {} slices of constant z through the contact, one colour scale",
                                             sheet.scales[0].words, labels.size())) +
                          largest_note(sheet.scales[0], census.largest));
    add_axes_notes(axes, false, sheet.notes);
    if (nothing)
        sheet.notes.push_back("no force in this field");
    sheet.non_finite_note = non_finite_note(census);
    return draw_panels(sheet);
}

Picture draw_arrows(const Look& look, const FieldSlice& slice, const SurfaceLines& lines, Quantity quantity,
                    const FieldSlice& unshaded) {
    assert(slice.force.size() == slice.axes.u.size() * slice.axes.v.size() && !slice.force.empty());
    const ValueSlice values = values_of(slice, quantity, unshaded);
    const Window window = contact_window(std::span(&values, 1), reach_of(lines, slice.axes));
    const Census census = take_census(values.value);
    PanelSheet sheet{look,
                     {},
                     {{"", cropped(values, window), 0, cropped(slice, window)}},
                     {scale_for(quantity, census.largest, slice.axes.axis)},
                     lines,
                     non_finite_note(census)};
    const PlaneAxes axes = plan_axes(sheet.panels[0].values.axes);
    sheet.notes.push_back(fmt::format("{}: {} as colour{}, {}", where(slice.axes, axes.longer_unit),
                                      sheet.scales[0].words, largest_note(sheet.scales[0], census.largest),
                                      arrows_note(slice.axes)));
    add_axes_notes(axes, true, sheet.notes);
    return draw_panels(sheet);
}

Picture draw_shading(const Look& look, const FieldSlice& unshaded, const FieldSlice& shaded,
                     const SurfaceLines& lines) {
    assert(unshaded.force.size() == shaded.force.size());
    const SliceAxes& whole = shaded.axes;
    const std::array values{values_of(unshaded, Quantity::magnitude), values_of(shaded, Quantity::magnitude),
                            values_of(shaded, Quantity::angle, unshaded)};
    const Window window = contact_window(values, reach_of(lines, whole));
    const Census force = take_census(values[0].value) + take_census(values[1].value);
    const Census angle = take_census(values[2].value);
    PanelSheet sheet{look,
                     {},
                     {{"unshaded", cropped(values[0], window), 0, cropped(unshaded, window)},
                      {"shaded", cropped(values[1], window), 0, cropped(shaded, window)},
                      {"angle between unshaded and shaded force", cropped(values[2], window), 1}},
                     {scale_for(Quantity::magnitude, force.largest, whole.axis),
                      scale_for(Quantity::angle, angle.largest, whole.axis)},
                     lines,
                     non_finite_note(force + angle)};
    const PlaneAxes axes = plan_axes(sheet.panels[0].values.axes);
    sheet.notes.push_back(fmt::format("{}: {} as colour{}, {}", where(whole, axes.longer_unit), sheet.scales[0].words,
                                      largest_note(sheet.scales[0], force.largest), arrows_note(whole)));
    sheet.notes.push_back(angle.largest > 0
                              ? fmt::format("shading turns the force by up to {}°; the magnitude {}",
                                            three_digits(angle.largest), magnitude_note(values[0], values[1]))
                              : "shading turns the force nowhere in this slice");
    add_axes_notes(axes, true, sheet.notes);
    return draw_panels(sheet);
}

} // namespace forceshade::picture
