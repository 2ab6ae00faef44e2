#include "device/report/report_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "host/picture/canvas.h"
#include "host/program.h"

namespace forceshade::device {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json text(const std::string& value) {
    return picture::printable(value);
}

Json point(const glm::dvec3& at) {
    return Json::array({number(at.x), number(at.y), number(at.z)});
}

Json device_json(const LiveOutcome& outcome) {
    const DeviceFacts& facts = outcome.facts;
    return {{"asked_for", text(outcome.device)},      {"name", text(facts.name)},
            {"software", text(facts.software)},       {"simulated", facts.simulated},
            {"max_force_N", number(facts.max_force)}, {"lasting_force_N", number(facts.lasting_force)},
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
    for (std::size_t i = 0; i < kHappenings.size(); ++i)
        json[std::string(kHappenings[i])] = counts.happened[i];
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
        json[picture::printable(name)] = text(value);
    return json;
}

Json scenes_json(const LiveOutcome& outcome) {
    Json json = Json::array();
    for (const UsedScene& scene : outcome.scenes)
        json.push_back({{"path", scene.path}, {"sha256", scene.sha256}, {"toml", scene.toml}});
    return json;
}

} // namespace

nlohmann::ordered_json report_json(const LiveOutcome& outcome) {
    const LoopCounts& counts = outcome.counts;
    Json json{{"version", version()},
              {"scene", text(outcome.scene)},
              {"scenes", scenes_json(outcome)},
              {"precision", text(outcome.precision)},
              {"device", device_json(outcome)},
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
              {"permissions", permissions_json(outcome.permissions)}};
    json["log"] = {{"file", outcome.log.empty() ? Json(nullptr) : text(outcome.log)},
                   {"samples", outcome.logged},
                   {"lost", counts.lost}};
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

} // namespace forceshade::device
