#include "device/report/live_picture.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "device/report/text.h"
#include "host/picture/chart.h"

namespace forceshade::device {
namespace {

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

// The share that took longer, at the end of each bin of the histogram, and marks at the quantiles.
void add_times(picture::Chart& chart, const char* name, const Histogram& times) {
    if (times.count() == 0) {
        chart.notes.push_back(fmt::format("{}: no samples", name));
        return;
    }
    const auto all = static_cast<double>(times.count()), largest = static_cast<double>(times.largest());
    picture::ChartSeries series{name, {}, true, true, false};
    const auto add = [&](double time, double share, const std::string& label) {
        series.points.push_back({std::max(time, 1.0), share, {}, {}, {}, {}, label, !label.empty()});
    };
    std::uint64_t longer = times.count();
    for (std::size_t bin = 0; bin < Histogram::kBins && longer > 0; ++bin) {
        if (times.bin(bin) > 0 && longer == times.count())
            add(static_cast<double>(Histogram::begin_of(bin)), 1, "");
        longer -= times.bin(bin);
        if (times.bin(bin) > 0 && longer > 0)
            add(static_cast<double>(Histogram::begin_of(bin + 1)), static_cast<double>(longer) / all, "");
    }
    for (const auto& [word, share] : {std::pair("p50", 0.5), {"p99", 0.01}, {"p99.9", 0.001}})
        if (all * share > 1)
            add(times.quantile(1 - share), share,
                fmt::format("{} {}", word, time_text(times.quantile(1 - share), {false, "µ"})));
    add(largest, 1 / all, fmt::format("largest {}", time_text(largest, {false, "µ"})));
    std::ranges::sort(series.points, {}, [](const picture::ChartPoint& one) { return std::pair(one.x, -one.y); });
    chart.series.push_back(std::move(series));
}

} // namespace

picture::Picture draw_live_report(const LiveOutcome& outcome) {
    picture::Chart chart;
    chart.title = fmt::format("{} ({}), live at {}", outcome.scene, outcome.precision, quantity(outcome.rate, "Hz"));
    chart.notes = notes_of(outcome);
    chart.x = {"time", true, [](double time, int) { return time_text(time, {false, "µ"}); }};
    chart.y = {"share of the samples that took longer", true};
    add_times(chart, "computing the force and its safety", outcome.counts.computing);
    if (outcome.real_time) {
        add_times(chart, "late: woken after the sample was due", outcome.counts.late);
        add_times(chart, "jitter: the time between two samples off the period", outcome.counts.jitter);
        const double period = 1e9 / outcome.rate, few = 0.3 / std::max(1.0, double(outcome.counts.computing.count()));
        if (outcome.rate > 0)
            chart.series.push_back(
                {"period " + time_text(period, {false, "µ"}), {{period, 1}, {period, few}}, false, true, true});
    }
    return draw_chart(chart);
}

} // namespace forceshade::device
