#include "device/report/report_text.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "device/report/count_rows.h"
#include "device/report/units.h"
#include "device/report/wrapped_lines.h"

namespace forceshade::device {
namespace {

// 0.231, 1.94, 1940.
std::string ratio_text(double ratio) {
    return ratio >= 100 ? fmt::format("{:.0f}", ratio) : fmt::format("{:.3g}", ratio);
}

std::string device_text(const LiveOutcome& outcome) {
    const DeviceFacts& facts = outcome.facts;
    std::string text = outcome.device;
    for (const std::string& part : {facts.name, facts.software})
        if (!part.empty() && part != outcome.device)
            text += ", " + part;
    if (std::isfinite(facts.max_force))
        text += fmt::format(", at most {}", quantity(facts.max_force, "N"));
    return text;
}

void add_permissions(WrappedLines& lines, const LiveOutcome& outcome) {
    const char* label = "real time";
    if (outcome.permissions.all.empty())
        lines.add(label, outcome.real_time ? "nothing was asked of the operating system" : "not asked for");
    for (const Permissions::One& one : outcome.permissions.all) {
        lines.add(label, fmt::format("{}: {}{}{}", one.what, one.granted ? "granted" : "NOT granted",
                                     one.detail.empty() ? ""
                                     : one.granted      ? ", "
                                                        : ": ",
                                     one.detail));
        label = "";
    }
}

void add_limits(WrappedLines& lines, const LiveOutcome& outcome) {
    std::string text;
    for (const auto& [name, value] : outcome.limits)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
    lines.add("limits", text.empty() ? "none" : text);
}

void add_log(WrappedLines& lines, const LiveOutcome& outcome) {
    const std::uint64_t lost = outcome.counts.lost;
    const std::string losses =
        lost == 0 ? "none lost" : fmt::format("{} LOST: the log could not keep up", counted(lost, "sample"));
    if (!outcome.log.empty())
        lines.add("log", fmt::format("{}: {}, {}", outcome.log, counted(outcome.logged, "sample"), losses));
    else if (lost > 0)
        lines.add("log", losses);
}

void add_times(WrappedLines& lines, const LiveOutcome& outcome) {
    lines.add_line(fmt::format("{:<14}{:>12}{:>12}{:>12}{:>12}", "times", "p50", "p99", "p99.9", "largest"));
    const LoopCounts& counts = outcome.counts;
    std::vector<NamedTimes> rows{{"compute", counts.computing}, {"read", counts.reading}, {"write", counts.writing}};
    if (outcome.real_time) {
        rows.push_back({"late", counts.late});
        rows.push_back({"jitter", counts.jitter});
    }
    for (const auto& [name, times] : rows) {
        std::string line = fmt::format("  {:<12}", name);
        if (times.count() == 0)
            line += fmt::format("{:>12}", "none");
        else
            for (const double time :
                 {times.quantile(0.5), times.quantile(0.99), times.quantile(0.999), double(times.largest())})
                line += fmt::format("{:>12}", time_text(time, {true, "u"}));
        lines.add_line(line);
    }
}

void add_counts(WrappedLines& lines, const LiveOutcome& outcome) {
    std::vector<NamedTimes> columns{{"compute", outcome.counts.computing}};
    if (outcome.real_time)
        columns.push_back({"jitter", outcome.counts.jitter});
    for (const std::string& line : count_rows(columns))
        lines.add_line(line);
}

} // namespace

std::string pace_text(const LiveOutcome& outcome, std::string_view micro) {
    const LoopCounts& counts = outcome.counts;
    const auto samples = static_cast<double>(counts.samples);
    const NumberStyle style{false, micro};
    std::string text = fmt::format("{} in {}", counted(counts.samples, "sample"), quantity(counts.seconds, "s", style));
    if (outcome.real_time)
        return text + " at " + quantity(outcome.rate, "Hz", style);
    text += fmt::format(", as fast as possible with {} between samples", quantity(1 / outcome.rate, "s", style));
    if (counts.seconds > 0 && outcome.rate > 0 && counts.samples > 0)
        text += fmt::format(": {} times real time", ratio_text(samples / outcome.rate / counts.seconds));
    return text;
}

std::string lateness_text(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    if (!outcome.real_time)
        return "as fast as possible no sample is due at any time, so none is late and nothing jitters";
    const std::uint64_t late = counts.with(kOverrun), own = counts.with(kOwnOverrun);
    if (late == 0)
        return "no sample late";
    return fmt::format("{} late{}, {} of them by our own computing", counted(late, "sample"),
                       share_text(late, counts.samples), own);
}

std::string events_text(const LoopCounts& counts) {
    std::string text;
    for (std::size_t i = 0; i < kHappenings.size(); ++i)
        if (counts.happened[i] > 0 && ((1u << i) & (kOverrun | kOwnOverrun)) == 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kHappenings[i], counts.happened[i]);
    return text.empty() ? "none" : text;
}

std::string extremes_text(const LoopCounts& counts, std::string_view micro) {
    const NumberStyle style{false, micro};
    return fmt::format("force {} by the law, {} commanded; depth {}; speed {}",
                       quantity(counts.largest_force, "N", style), quantity(counts.largest_commanded, "N", style),
                       quantity(counts.largest_depth, "m", style), quantity(counts.largest_speed, "m/s", style));
}

std::string energy_text(const LoopCounts& counts, std::string_view micro) {
    const NumberStyle style{false, micro};
    std::string text = fmt::format("{} given to the hand at the end, {} at most", quantity(counts.energy, "J", style),
                                   quantity(counts.largest_energy, "J", style));
    if (counts.damped != 0)
        text += fmt::format("; {} taken out by the passivity controller", quantity(counts.damped, "J", style));
    return text;
}

std::string report_text(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    WrappedLines lines;
    lines.add("scene", fmt::format("{} ({}){}", outcome.scene, outcome.precision,
                                   outcome.scenes.empty() ? "" : ", SHA-256 " + outcome.scenes.front().sha256));
    lines.add("device", device_text(outcome));
    lines.add("run", pace_text(outcome));
    lines.add("ended", outcome.ended);
    add_permissions(lines, outcome);
    add_times(lines, outcome);
    lines.add("late", lateness_text(outcome));
    lines.add("samples", fmt::format("{} in contact{}; {}; {} without a position before the first", counts.in_contact,
                                     share_text(counts.in_contact, counts.samples), counted(counts.paths, "path"),
                                     counted(counts.waiting, "tick")));
    lines.add("safety", events_text(counts));
    add_limits(lines, outcome);
    lines.add("largest", extremes_text(counts));
    lines.add("energy", energy_text(counts));
    add_log(lines, outcome);
    for (const std::string& remark : outcome.remarks)
        lines.add("note", remark);
    add_counts(lines, outcome);
    return lines.text();
}

} // namespace forceshade::device
