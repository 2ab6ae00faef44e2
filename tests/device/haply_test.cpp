// The haply back end with a service that is well: dialects, axes, devices to choose from, ways out.
#include <glm/common.hpp>

#include "tests/device/haply_loop.h"
#include "tests/io/folder.h"

namespace forceshade::device::test {
namespace {

using forceshade::testing::message_of;
using forceshade::testing::says;

TEST(Haply, ReadsPositionsAndDisplaysForces) {
    SimulatedService service({});
    const auto device = open_haply(options_of(service));
    EXPECT_EQ(device->facts().name, "Inverse3 04BA");
    EXPECT_EQ(device->facts().software, "Inverse Service 3.5.0.0");
    EXPECT_EQ(device->facts().max_force, 4);
    EXPECT_EQ(device->facts().low, glm::dvec3(-0.6));
    EXPECT_EQ(device->facts().high, glm::dvec3(0.6));
    EXPECT_FALSE(device->facts().simulated);
    EXPECT_TRUE(runs_well(*device, service));
    glm::dvec3 low(1), high(-1);
    EXPECT_TRUE(loop_until(*device, [&](const Reading& reading, bool) {
        if (reading.answer == Answer::failed)
            return false;
        EXPECT_TRUE(in_reach(reading.position));
        low = glm::min(low, reading.position);
        high = glm::max(high, reading.position);
        return high.z - low.z > 0.03; // half of its swing
    }));
    EXPECT_TRUE(received_only_what_was_commanded(service));
}

TEST(Haply, TellsTheButtonsOfAGrip) {
    EXPECT_EQ(open_haply(options_of(SimulatedService({})))->facts().buttons, 0u) << "without a grip";
    ServiceScript script;
    script.grip = "-";
    SimulatedService service(script);
    const auto device = open_haply(options_of(service));
    EXPECT_EQ(device->facts().buttons, 3u);
    const auto tells = [&](std::uint32_t buttons) {
        return loop_until(*device, [&](const Reading& reading, bool) {
            return reading.answer == Answer::fresh && reading.buttons == buttons;
        });
    };
    for (const auto& [grip, mask] : {std::pair("b", 2u), {"-", 0u}, {"c", 4u}, {"a", 1u}, {"", 0u}}) {
        service.set_grip(grip);
        EXPECT_TRUE(tells(mask)) << grip << ": of a grip that is gone nothing is held";
    }
}

TEST(Haply, SpeaksTheDialectAndFollowsTheAxesOfItsService) {
    struct Row {
        const char *version, *basis;
        bool speaks_vector;
        HaplyOptions::Dialect stated;
    };
    using Dialect = HaplyOptions::Dialect;
    for (const Row& row : {Row{"3.1.1", "XYZ", false, Dialect::by_version},
                           {"", "XYZ", false, Dialect::values}, // would be taken for 3.5
                           {"", "XYZ", true, Dialect::by_version},
                           {"3.5.0", "Z-XY", true, Dialect::by_version}}) {
        SCOPED_TRACE(std::string(row.version) + row.basis);
        ServiceScript script;
        script.version = row.version;
        script.basis = row.basis;
        script.speaks_vector = row.speaks_vector;
        SimulatedService service(script);
        HaplyOptions options = options_of(service);
        options.dialect = row.stated;
        const auto device = open_haply(options);
        EXPECT_TRUE(runs_well(*device, service));
        EXPECT_TRUE(loop_until(*device, [&](const Reading& reading, bool) {
            return reading.answer == Answer::fresh && in_reach(reading.position);
        }));
        EXPECT_TRUE(received_only_what_was_commanded(service));
    }
}

TEST(Haply, OneOfSeveralDevicesMustBeChosen) {
    ServiceScript script;
    script.devices = {"04BA", "049D"};
    SimulatedService service(script);
    HaplyOptions options = options_of(service);
    EXPECT_TRUE(says(message_of<UsageError>([&] { open_haply(options); }), "04BA, 049D", "?device=04BA"));
    options.device_id = "04BA";
    const auto device = open_haply(options);
    EXPECT_TRUE(runs_well(*device, service));
    EXPECT_TRUE(received_only_what_was_commanded(service, "04BA"));
    options.device_id = "FFFF";
    EXPECT_THROW(open_haply(options), DeviceAbsent);
}

TEST_F(RunningHaply, TakesLeavePolitelyWithoutForce) {
    ASSERT_TRUE(wait_until([&] { return service_.farewells() == 1; })); // of the look before
    device_.reset();
    EXPECT_TRUE(wait_until([&] { return service_.open() == 0; }));
    EXPECT_EQ(service_.farewells(), 2u);
    EXPECT_TRUE(ends_without_force(service_));
    EXPECT_TRUE(received_only_what_was_commanded(service_));
}

TEST_F(RunningHaply, HaltsForGood) {
    device_->halt();
    device_->halt();
    for (int i = 0; i < 100; ++i) {
        EXPECT_FALSE(device_->write(kPush));
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(device_->read().answer, Answer::failed);
    EXPECT_TRUE(wait_until([&] { return service_.open() == 0; }));
    EXPECT_TRUE(ends_without_force(service_));
    const unsigned connections = service_.connections();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(service_.connections(), connections); // does not come back
}

TEST(Haply, DisplaysNoForceUntilTheDeviceIsReadyAndSaysWhy) {
    for (const auto& [fault, words] : {std::pair{Fault::uncalibrated, "not calibrated"},
                                       {Fault::no_power, "no power supply"},
                                       {Fault::not_ready, "not ready"},
                                       {Fault::not_started, "not started"}}) {
        SCOPED_TRACE(words);
        ServiceScript script;
        script.fault = fault;
        SimulatedService service(script);
        const auto device = open_haply(options_of(service));
        const auto withheld = [&] {
            const char* const reason = device->withheld();
            return reason != nullptr && std::string(reason).find(words) != std::string::npos;
        };
        const auto comes_up = [&] { // from zero
            return wait_until([&] {
                device->read();
                device->write(glm::dvec3(0));
                return device->withheld() == nullptr;
            });
        };
        ASSERT_TRUE(loop_until(*device, [&](const Reading& reading, bool) {
            return reading.answer == Answer::fresh && service.received().size() > 50;
        }));
        EXPECT_TRUE(withheld());
        EXPECT_FALSE(device->write(kPush)) << "it is not displayed";
        EXPECT_TRUE(device->write(glm::dvec3(0)));
        for (const Received& each : service.received())
            ASSERT_EQ(each.force, glm::dvec3(0));
        service.set(Fault::none);
        const std::size_t ready = service.received().size();
        ASSERT_TRUE(loop_until(*device, [&](const Reading&, bool) { return service.received().size() > ready + 50; }));
        EXPECT_TRUE(withheld()) << "a loop that has not asked for no force has not seen it";
        EXPECT_TRUE(comes_up());
        EXPECT_TRUE(runs_well(*device, service));
        EXPECT_EQ(device->withheld(), nullptr);
        service.set(fault);
        ASSERT_TRUE(loop_until(*device, [&](const Reading&, bool) { return withheld(); }));
        const std::size_t from = service.received().size() + 2;
        ASSERT_TRUE(loop_until(*device, [&](const Reading&, bool) { return service.received().size() > from + 20; }));
        const std::vector<Received> all = service.received();
        for (std::size_t i = from; i < all.size(); ++i)
            ASSERT_EQ(all[i].force, glm::dvec3(0));
        service.go_away(); // and is ready when it comes back
        service.set(Fault::none);
        service.come_back();
        EXPECT_TRUE(comes_up());
        EXPECT_TRUE(runs_well(*device, service));
        EXPECT_EQ(device->withheld(), nullptr);
    }
}

TEST_F(RunningHaply, ALoopThatStopsLeavesNoForce) {
    EXPECT_TRUE(wait_until([&] { return ends_without_force(service_); }));
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_TRUE(ends_without_force(service_));
    EXPECT_TRUE(runs_well(*device_, service_)); // until it goes on
}

TEST_F(RunningHaply, AForceThatIsNoNumberIsNone) {
    const std::size_t before = service_.received().size();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    ASSERT_TRUE(wait_until([&] {
        device_->write({nan, 0, std::numeric_limits<double>::infinity()});
        return service_.received().size() > before + 20;
    }));
    EXPECT_TRUE(received_only_what_was_commanded(service_));
    EXPECT_TRUE(ends_without_force(service_));
}

} // namespace
} // namespace forceshade::device::test
