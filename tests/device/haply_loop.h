// A loop such as the live one, in small: reads, answers with a force that depends on what it read, writes.
#pragma once

#include <functional>
#include <memory>

#include "device/backends/haply.h"
#include "tests/device/simulated_service.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::test {

using testing::wait_until;

/// The force of the tests' loop, N: told apart from none and bounded.
inline const glm::dvec3 kPush{0.25, -0.5, 0.75};

inline HaplyOptions options_of(const SimulatedService& service) {
    HaplyOptions options;
    options.url = service.url();
    return options;
}

/// At 1 kHz until `enough` says so; no force while there is no position, as the live loop has it.
inline bool loop_until(BackEnd& device, const std::function<bool(const Reading&, bool taken)>& enough) {
    return wait_until([&] {
        const Reading reading = device.read();
        return enough(reading, device.write(reading.answer == Answer::failed ? glm::dvec3(0) : kPush));
    });
}

/// Runs until the device gives positions and the service has got the push.
inline ::testing::AssertionResult runs_well(BackEnd& device, const SimulatedService& service) {
    unsigned fresh = 0;
    const std::size_t before = service.received().size();
    const bool enough = loop_until(device, [&](const Reading& reading, bool) {
        fresh += reading.answer == Answer::fresh ? 1 : 0;
        if (fresh < 20)
            return false;
        const auto received = service.received();
        for (std::size_t i = before; i < received.size(); ++i)
            if (received[i].force == kPush)
                return true;
        return false;
    });
    if (enough)
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << fresh << " positions; error_text: "
                                         << (device.error_text() != nullptr ? device.error_text() : "none");
}

/// A service and a device of it that runs well.
class RunningHaply : public ::testing::Test {
protected:
    void SetUp() override { ASSERT_TRUE(runs_well(*device_, service_)); }

    SimulatedService service_{{}};
    std::unique_ptr<BackEnd> device_ = open_haply(options_of(service_));
};

/// Every force that was received is none or the push, and of the device.
inline ::testing::AssertionResult received_only_what_was_commanded(const SimulatedService& service,
                                                                   const std::string& id = "04BA") {
    for (const Received& each : service.received())
        if (!each.understood || each.device_id != id || (each.force != kPush && each.force != glm::dvec3(0)))
            return ::testing::AssertionFailure() << each.device_id << " got " << each.force.x << ' ' << each.force.y
                                                 << ' ' << each.force.z << (each.understood ? "" : ", not understood");
    return ::testing::AssertionSuccess();
}

inline bool ends_without_force(const SimulatedService& service) {
    const auto received = service.received();
    return !received.empty() && received.back().force == glm::dvec3(0);
}

/// Where the simulated probe may be.
inline bool in_reach(const glm::dvec3& position) {
    const ServiceScript script;
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(position[i] - script.center[i]) <= script.amplitude[i] + 1e-9))
            return false;
    return true;
}

} // namespace forceshade::device::test
