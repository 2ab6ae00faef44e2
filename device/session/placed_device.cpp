#include "device/session/placed_device.h"

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "host/interrupt.h"

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

} // namespace forceshade::device
