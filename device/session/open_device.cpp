#include "device/session/open_device.h"

#include <array>
#include <chrono>
#include <cmath>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "device/backends/dhd.h"
#include "device/backends/haply.h"
#include "device/backends/hd.h"
#include "device/backends/replay.h"
#include "device/backends/sim.h"
#include "device/loop/live_loop.h"
#include "host/error.h"
#include "host/prepare/prepared_case.h"
#include "host/program.h"
#include "host/scene/value.h"

namespace forceshade::device {

namespace {

class PlacedDevice final : public BackEnd {
public:
    PlacedDevice(std::unique_ptr<BackEnd> device, const glm::dvec3& origin)
        : device_(std::move(device)), origin_(origin), facts_(device_->facts()) {
        facts_.low -= origin;
        facts_.high -= origin;
    }

    const DeviceFacts& facts() const noexcept override { return facts_; }
    Reading read() noexcept override {
        Reading reading = device_->read();
        reading.position -= origin_;
        return reading;
    }
    bool write(const glm::dvec3& force) noexcept override { return device_->write(force); }
    void halt() noexcept override { device_->halt(); }
    void rest() noexcept override { device_->rest(); }
    const char* withheld() const noexcept override { return device_->withheld(); }
    const char* complaint() const noexcept override { return device_->complaint(); }

private:
    std::unique_ptr<BackEnd> device_;
    const glm::dvec3 origin_; /* m */
    DeviceFacts facts_;
};

glm::dvec3 first_position(BackEnd& device, double patience) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(std::min(patience, 3600.0));
    do {
        check_interrupt();
        const Reading reading = device.read();
        const glm::dvec3& p = reading.position;
        if (reading.answer == Answer::fresh && std::isfinite(p.x + p.y + p.z) && device.withheld() == nullptr)
            return p;
        device.write(glm::dvec3(0)); // some devices answer only what they are told
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } while (Clock::now() < end);
    const char* const withheld = device.withheld();
    if (withheld != nullptr)
        throw DeviceAbsent(fmt::format("{} displays no force: {}", device.facts().name, withheld));
    const char* const complaint = device.complaint();
    throw DeviceAbsent(fmt::format("{} tells no position{}{}", device.facts().name, complaint != nullptr ? ": " : "",
                                   complaint != nullptr ? complaint : ""));
}

} // namespace

std::unique_ptr<BackEnd> place_device(std::unique_ptr<BackEnd> device, const Placement& placement, double patience) {
    const glm::dvec3 origin = placement.here ? first_position(*device, patience) : placement.origin;
    if (origin == glm::dvec3(0))
        return device;
    return std::make_unique<PlacedDevice>(std::move(device), origin);
}

namespace {

constexpr double kUsualRate = 1000; /* Hz */

// The rate of a recording, as far as clocks and rounding leave it: samples at 10 kHz may lie 99.9 us apart.
double rounded_rate(double recorded) {
    constexpr double kOff = 0.02;
    for (const double end : {kSlowestRate, kFastestRate})
        if (std::abs(recorded - end) <= kOff * end)
            return end;
    return recorded;
}

OpenDevice open_sim(const PreparedCase& prepared, std::optional<double> rate, double ramp) {
    const std::optional<PathsSpec>& paths = prepared.one.scene.paths;
    const double chosen = rate ? *rate : paths ? paths->rate : kUsualRate;
    constexpr double kMost = 1e9; // samples
    const double still = ramp > 0 ? std::min(std::ceil(ramp * chosen) + 1, kMost) : 0;
    return {make_sim(prepared, chosen, static_cast<std::uint64_t>(still)), chosen};
}

OpenDevice open_replay(std::string_view file) {
    if (file.empty())
        throw UsageError("--device replay: which file? replay:FILE.csv");
    OpenDevice open{make_replay(std::string(file)), kUsualRate};
    if (const double recorded = rate_of(*open.back_end); recorded > 0)
        open.rate = rounded_rate(recorded);
    open.warning = warning_of(*open.back_end);
    return open;
}

} // namespace

OpenDevice open_device(const std::string& name, const PreparedCase& prepared, std::optional<double> rate, double ramp) {
    const std::size_t colon = name.find(':');
    const std::string_view kind = std::string_view(name).substr(0, colon);
    const std::string_view further =
        colon == std::string::npos ? std::string_view() : std::string_view(name).substr(colon + 1);
    if (kind == "sim" && colon == std::string::npos)
        return open_sim(prepared, rate, ramp);
    if (kind == "replay")
        return open_replay(further);
    if (kind == "haply")
        return {open_haply(parse_haply(further)), kUsualRate};
    if (kind == "dhd")
        return {open_dhd(further), kUsualRate};
    if (kind == "hd")
        return {open_hd(further), kUsualRate};
    const std::array<std::string, 5> kinds{"sim", "replay", "haply", "dhd", "hd"};
    if (kind == "sim")
        throw UsageError(fmt::format("--device {}: sim takes nothing further", name));
    throw UsageError(fmt::format("--device {}: there are {}{}", name, kDeviceNames, did_you_mean(kind, kinds)));
}

} // namespace forceshade::device
