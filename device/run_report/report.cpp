#include "device/run_report/report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/run_report/text.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/program.h"
#include "host/report/report.h"
#include "host/spelling.h"

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
        lines.add(label, outcome.real_time ? "no permissions requested" : "not requested");
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

void add_sent(WrappedLines& lines, const LiveOutcome& outcome) {
    if (outcome.sent_to.empty())
        return;
    const std::uint64_t dropped = outcome.counts.samples - outcome.sent;
    const std::string& why = outcome.send_failure;
    lines.add("sent", fmt::format("{}: {}, {}", outcome.sent_to, counted(outcome.sent, "sample"),
                                  dropped == 0 ? "none dropped"
                                               : fmt::format("{} DROPPED: {}", counted(dropped, "sample"),
                                                             why.empty() ? "they came too fast" : why)));
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

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json text(const std::string& value) {
    return printable(value);
}

Json point(const glm::dvec3& at) {
    return Json::array({number(at.x), number(at.y), number(at.z)});
}

Json device_json(const LiveOutcome& outcome) {
    const DeviceFacts& facts = outcome.facts;
    return {{"asked_for", text(outcome.device)},      {"name", text(facts.name)},
            {"software", text(facts.software)},       {"simulated", facts.simulated},
            {"max_force_N", number(facts.max_force)}, {"lasting_force_N", number(facts.continuous_force)},
            {"has_watchdog", facts.has_watchdog},     {"workspace_low_m", point(facts.low)},
            {"workspace_high_m", point(facts.high)}};
}

Json times_json(const Histogram& times) {
    const bool any = times.count() > 0;
    const auto known = [&](double time) { return any ? number(time) : Json(nullptr); };
    Json bins = Json::array();
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin)
        if (times.bin(bin) > 0)
            bins.push_back({{"from_ns", Histogram::begin_of(bin)},
                            {"to_ns", Histogram::begin_of(bin + 1)},
                            {"count", times.bin(bin)}});
    return {{"count", times.count()},
            {"mean_ns", known(times.mean())},
            {"p50_ns", known(times.quantile(0.5))},
            {"p99_ns", known(times.quantile(0.99))},
            {"p99_9_ns", known(times.quantile(0.999))},
            {"largest_ns", any ? Json(times.largest()) : Json(nullptr)},
            {"histogram", std::move(bins)}};
}

Json happened_json(const LoopCounts& counts) {
    Json json = Json::object();
    for (std::size_t i = 0; i < kSampleFlagNames.size(); ++i)
        json[std::string(kSampleFlagNames[i])] = counts.flags[i];
    return json;
}

Json permissions_json(const Permissions& permissions) {
    Json json = Json::array();
    for (const Permissions::One& one : permissions.all)
        json.push_back({{"what", text(one.what)}, {"granted", one.granted}, {"detail", text(one.detail)}});
    return json;
}

Json limits_json(const LiveOutcome& outcome) {
    Json json = Json::object();
    for (const auto& [name, value] : outcome.limits)
        json[printable(name)] = text(value);
    return json;
}

constexpr std::size_t kMostBytes = 400; // of a text from outside the program

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
        {"what", "", "which time", &TimeRow::what},
        {"time_ns", "ns", "", &TimeRow::time},
        {"share", "1", "of the samples took longer", &TimeRow::share},
        {"quantile", "", "", [](const TimeRow& r) { return r.label.empty() ? study::Cell() : study::Cell(r.label); }}};
    data.tables = {study::table_of("times", "Times", columns, rows),
                   study::table_of("period", "The period", columns, period)};
    study::Figure& figure = data.figures.emplace_back(study::make_figure(
        "times", "How long samples took", "", study::FigureKind::scatter, "times", {}, {"time_ns", "time / ns", true},
        {"share", "share of the samples that took longer", true}, "what", "quantile"));
    figure.joined = true;
    figure.curves = {{"period", {}, "time_ns", "share", "period " + time_text(1e9 / outcome.rate, {false, "µ"}), true}};
}

Json scenes_json(const LiveOutcome& outcome) {
    Json json = Json::array();
    for (const UsedScene& scene : outcome.scenes)
        json.push_back({{"path", scene.path}, {"sha256", scene.sha256}, {"toml", scene.toml}});
    return json;
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
        return "as fast as possible no sample is due at any time, so none is late and there is no jitter";
    const std::uint64_t late = counts.with(kOverrun), own = counts.with(kOwnOverrun);
    if (late == 0)
        return "no sample late";
    return fmt::format("{} late{}, {} of them by our own computing", counted(late, "sample"),
                       share_text(late, counts.samples), own);
}

std::string events_text(const LoopCounts& counts) {
    std::string text;
    for (std::size_t i = 0; i < kSampleFlagNames.size(); ++i)
        if (counts.flags[i] > 0 && ((1u << i) & (kOverrun | kOwnOverrun)) == 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kSampleFlagNames[i], counts.flags[i]);
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
    if (!outcome.law.empty())
        lines.add("forces", outcome.law);
    lines.add("device", device_text(outcome));
    if (!outcome.manner.empty())
        lines.add("setup", outcome.manner);
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
    if (!outcome.stability.empty())
        lines.add("stability", outcome.stability);
    lines.add("largest", extremes_text(counts));
    lines.add("energy", energy_text(counts));
    add_log(lines, outcome);
    add_sent(lines, outcome);
    for (const std::string& remark : outcome.remarks)
        lines.add("note", remark);
    add_counts(lines, outcome);
    return lines.text();
}

nlohmann::ordered_json report_json(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    Json json{{"version", version()},
              {"scene", text(outcome.scene)},
              {"scenes", scenes_json(outcome)},
              {"precision", text(outcome.precision)},
              {"device", device_json(outcome)},
              {"mapping",
               {{"origin_m", point(outcome.mapping.origin)},
                {"scene_x", point(outcome.mapping.turn[0])},
                {"scene_y", point(outcome.mapping.turn[1])},
                {"scene_z", point(outcome.mapping.turn[2])},
                {"scale", number(outcome.mapping.scale)}}},
              {"rate_Hz", number(outcome.rate)},
              {"real_time", outcome.real_time},
              {"ended", text(outcome.ended)},
              {"elapsed_s", number(counts.seconds)},
              {"samples", counts.samples},
              {"waiting", counts.waiting},
              {"in_contact", counts.in_contact},
              {"paths", counts.paths},
              {"happened", happened_json(counts)},
              {"largest_force_N", number(counts.largest_force)},
              {"largest_commanded_N", number(counts.largest_commanded)},
              {"largest_depth_m", number(counts.largest_depth)},
              {"largest_speed_m_per_s", number(counts.largest_speed)},
              {"energy_J", number(counts.energy)},
              {"largest_energy_J", number(counts.largest_energy)},
              {"damped_J", number(counts.damped)},
              {"limits", limits_json(outcome)},
              {"stability", text(outcome.stability)},
              {"permissions", permissions_json(outcome.permissions)}};
    if (!outcome.law.empty())
        json["law"] = text(outcome.law);
    json["log"] = {{"file", outcome.log.empty() ? Json(nullptr) : text(outcome.log)},
                   {"samples", outcome.logged},
                   {"lost", counts.lost}};
    const bool sent = !outcome.sent_to.empty();
    json["sent"] = {{"to", sent ? text(outcome.sent_to) : Json(nullptr)},
                    {"samples", outcome.sent},
                    {"dropped", sent ? counts.samples - outcome.sent : 0}};
    json["compute"] = times_json(counts.computing);
    json["read"] = times_json(counts.reading);
    json["write"] = times_json(counts.writing);
    json["late"] = times_json(counts.late);
    json["jitter"] = times_json(counts.jitter);
    json["remarks"] = Json::array();
    for (const std::string& remark : outcome.remarks)
        json["remarks"].push_back(text(remark));
    return json;
}

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
         {"Forces", outcome.law.empty() ? "by the scene's law" : outcome.law},
         {"Setup", outcome.manner.empty() ? "the device's space is the scene's" : outcome.manner},
         {"Run", pace_text(outcome, "µ")},
         {"Ended", shortened(outcome.ended)},
         {"Late", lateness_text(outcome)},
         {"Largest", extremes_text(counts, "µ")},
         {"Safety", events_text(counts)},
         {"Energy", energy_text(counts, "µ")}},
        data);
}

void write_live_report(const LiveOutcome& outcome, const std::filesystem::path& stem,
                       const std::filesystem::path& log) {
    const auto named = [&](const char* ending) { return std::filesystem::path(stem) += ending; };
    write_file_atomically(named(".txt"), report_text(outcome));
    write_file_atomically(named(".json"), report_json(outcome).dump(2) + "\n");
    write_file_atomically(named(".html"), live_page(outcome, log));
}

} // namespace forceshade::device
