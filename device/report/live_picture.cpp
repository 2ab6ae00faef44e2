#include "device/report/live_picture.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "device/report/text.h"
#include "device/report/time_panel.h"
#include "host/picture/chart_style.h"
#include "host/picture/frame.h"

namespace forceshade::device {
namespace {

constexpr double kBetween = 14;         // pixels from panel to panel
constexpr std::size_t kMostBytes = 400; // of a note that others wrote

std::string shortened(const std::string& text) {
    return text.size() <= kMostBytes ? text : text.substr(0, kMostBytes) + "…";
}

std::vector<std::string> notes_of(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    std::string device = shortened(outcome.device);
    for (const std::string& part : {outcome.facts.name, outcome.facts.software})
        if (!part.empty() && part != outcome.device)
            device += ", " + shortened(part);
    std::vector<std::string> notes{"device: " + device};
    notes.push_back(fmt::format("{}; ended: {}", pace_text(outcome, "µ"), shortened(outcome.ended)));
    notes.push_back(fmt::format("{}; largest {}", lateness_text(outcome), extremes_text(counts, "µ")));
    notes.push_back(fmt::format("safety: {}; energy: {}", events_text(counts), energy_text(counts, "µ")));
    return notes;
}

std::vector<TimePanel> panels_of(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    const double period = outcome.rate > 0 ? 1e9 / outcome.rate : 0;
    const auto title = [](const char* what, const Histogram& times) {
        const std::uint64_t zeros = times.bin(0);
        return fmt::format("{}: {}{}", what, counted(times.count(), "sample"),
                           zeros > 0 ? fmt::format(", {} of 0 ns at the left edge", zeros) : "");
    };
    std::vector<TimePanel> panels{{title("computing the force and its safety", counts.computing),
                                   &counts.computing,
                                   picture::series_colour(0),
                                   {}}};
    if (outcome.real_time) {
        panels.push_back(
            {title("late: woken after the sample was due", counts.late), &counts.late, picture::series_colour(1), {}});
        panels.push_back({title("jitter: the time between two samples off the period", counts.jitter),
                          &counts.jitter,
                          picture::series_colour(2),
                          {}});
    }
    std::vector<const Histogram*> shown;
    for (const TimePanel& panel : panels)
        shown.push_back(panel.times);
    const bool anything = counts.computing.count() > 0;
    const picture::Range range = time_range(shown, outcome.real_time || !anything ? period : 0);
    for (TimePanel& panel : panels) {
        panel.range = range;
        if (period >= range.low && period <= range.high)
            panel.period = period;
    }
    return panels;
}

} // namespace

picture::Picture draw_live_report(const LiveOutcome& outcome) {
    const picture::Look look{
        fmt::format("{} ({}), live at {}", outcome.scene, outcome.precision, quantity(outcome.rate, "Hz"))};
    const picture::Heading heading = picture::plan_heading(look, notes_of(outcome));
    const std::vector<TimePanel> panels = panels_of(outcome);
    double y = std::floor(picture::kMargin + heading.height + 18);
    const double step = std::ceil(time_panel_height() + kBetween);
    const double height = y + step * static_cast<double>(panels.size()) - kBetween + picture::kMargin;
    picture::Canvas canvas(look.width, static_cast<int>(std::ceil(height)));
    picture::draw_heading(canvas, heading);
    for (const TimePanel& panel : panels) {
        draw_time_panel(canvas, panel, {picture::kMargin, y}, look.width - 2 * picture::kMargin);
        y += step;
    }
    return canvas.finish();
}

} // namespace forceshade::device
