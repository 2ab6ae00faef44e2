#include "device/session/limits_text.h"

#include <cmath>

#include <fmt/format.h>

namespace forceshade::device {
namespace {

std::string force_text(double force) {
    return std::isinf(force) ? "none" : fmt::format("{:.6g} N", force);
}
std::string time_text(double time) {
    return std::isinf(time) ? "none" : fmt::format("{:.6g} ms", 1000 * time);
}

} // namespace

std::vector<std::pair<std::string, std::string>> limits_as_text(const SafetyLimits& limits) {
    std::vector<std::pair<std::string, std::string>> texts{
        {"largest force", force_text(limits.max_force)},
        {"lasting force", force_text(limits.lasting_force)},
        {"slew", std::isinf(limits.slew) ? "none" : fmt::format("{:.6g} N/s", limits.slew)},
        {"ramp", time_text(limits.ramp)},
        {"ramp at contact", time_text(limits.contact_ramp)},
        {"speed", std::isinf(limits.max_speed) ? "none" : fmt::format("{:.6g} m/s", limits.max_speed)},
        {"stale position", time_text(limits.stale)},
        {"watchdog", std::isinf(limits.late) ? "none" : fmt::format("{:.6g} periods", limits.late)},
        {"passivity", limits.passivity ? fmt::format("on, damping up to {:.6g} N s/m", limits.damping) : "off"}};
    const auto side = [](double low, double high) { return fmt::format("{:.6g} to {:.6g} mm", 1e3 * low, 1e3 * high); };
    if (!std::isinf(limits.low.x) || !std::isinf(limits.high.x))
        texts.emplace_back("workspace",
                           fmt::format("x {}, y {}, z {}", side(limits.low.x, limits.high.x),
                                       side(limits.low.y, limits.high.y), side(limits.low.z, limits.high.z)));
    else
        texts.emplace_back("workspace", "none");
    return texts;
}

} // namespace forceshade::device
