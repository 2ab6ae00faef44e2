// The end of a run as a page: how many samples took how long to compute and how late they were, and what its log holds.
#include <algorithm>

#include <fmt/format.h>

#include "device/report/report.h"
#include "device/report/text.h"
#include "host/program.h"
#include "host/report/run_page.h"
#include "host/study/data/study_data.h"

namespace forceshade::device {
namespace {

constexpr std::size_t kMostBytes = 400; // of a text that others wrote

std::string shortened(const std::string& text) {
    return text.size() <= kMostBytes ? text : text.substr(0, kMostBytes) + "…";
}

struct TimeRow {
    const char* what;
    double time, share; /* ns, 1 */
    std::string label;
};

// The share that took longer, at the end of each bin of the histogram, and marks at the quantiles.
void add_rows(std::vector<TimeRow>& rows, const char* what, const Histogram& times) {
    const auto all = static_cast<double>(times.count());
    const std::size_t first = rows.size();
    const auto add = [&](double time, double share, const std::string& word) {
        rows.push_back({what, std::max(time, 1.0), share,
                        word.empty() ? "" : fmt::format("{} {}", word, time_text(time, {false, "µ"}))});
    };
    std::uint64_t longer = times.count();
    for (std::size_t bin = 0; bin < Histogram::kBins && longer > 0; ++bin)
        if (times.bin(bin) > 0 && (longer -= times.bin(bin)) > 0)
            add(static_cast<double>(Histogram::begin_of(bin + 1)), static_cast<double>(longer) / all, "");
    for (const auto& [word, share] : {std::pair("p50", 0.5), {"p99", 0.01}, {"p99.9", 0.001}})
        if (all * share > 1)
            add(times.quantile(1 - share), share, word);
    if (times.count() > 0)
        add(static_cast<double>(times.largest()), 1 / all, "largest");
    std::ranges::sort(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), {},
                      [](const TimeRow& row) { return std::pair(row.time, -row.share); });
}

void add_times(study::StudyData& data, const LiveOutcome& outcome) {
    std::vector<TimeRow> rows, period;
    add_rows(rows, "computing the force and its safety", outcome.counts.computing);
    if (outcome.real_time) {
        add_rows(rows, "late: woken after the sample was due", outcome.counts.late);
        add_rows(rows, "jitter: the time between two samples off the period", outcome.counts.jitter);
        const double few = 0.3 / std::max(1.0, double(outcome.counts.computing.count()));
        period = {{"period", 1e9 / outcome.rate, 1, ""}, {"period", 1e9 / outcome.rate, few, ""}};
    }
    const std::vector<study::ColumnOf<TimeRow>> columns{
        {{"what", "", "which time"}, [](const TimeRow& r) { return study::Cell(std::string(r.what)); }},
        {{"time_ns", "ns", ""}, [](const TimeRow& r) { return study::cell(r.time); }},
        {{"share", "1", "of the samples took longer"}, [](const TimeRow& r) { return study::cell(r.share); }},
        {{"quantile", "", ""},
         [](const TimeRow& r) { return r.label.empty() ? study::Cell() : study::Cell(r.label); }}};
    data.tables.push_back(study::table_of<TimeRow>("times", "Times", columns, rows));
    data.tables.push_back(study::table_of<TimeRow>("period", "The period", columns, period));
    study::Figure figure;
    figure.name = figure.table = "times";
    figure.title = "How long samples took";
    figure.x = {"time_ns", "time / ns", true};
    figure.y = {"share", "share of the samples that took longer", true};
    figure.series = "what";
    figure.label = "quantile";
    figure.joined = true;
    figure.curves = {{"period", {}, "time_ns", "share", "period " + time_text(1e9 / outcome.rate, {false, "µ"}), true}};
    data.figures.push_back(std::move(figure));
}

} // namespace

std::string live_page(const LiveOutcome& outcome, const std::filesystem::path& log) {
    const LoopCounts& counts = outcome.counts;
    std::string device = shortened(outcome.device);
    for (const std::string& part : {outcome.facts.name, outcome.facts.software})
        if (!part.empty() && part != outcome.device)
            device += ", " + shortened(part);
    study::StudyData data;
    add_times(data, outcome);
    if (outcome.logged > 0 && !log.empty())
        report::add_samples(data, log);
    return report::run_page(
        fmt::format("{} ({}), live at {}", outcome.scene, outcome.precision, quantity(outcome.rate, "Hz")),
        {{"Program", "forceshade " + version()},
         {"Device", device},
         {"Felt", outcome.manner.empty() ? "the device's space is the scene's" : outcome.manner},
         {"Run", pace_text(outcome, "µ")},
         {"Ended", shortened(outcome.ended)},
         {"Late", lateness_text(outcome)},
         {"Largest", extremes_text(counts, "µ")},
         {"Safety", events_text(counts)},
         {"Energy", energy_text(counts, "µ")}},
        data);
}

} // namespace forceshade::device
