// The haply back end with a service that is not well. Whatever it does, it gets no force but those commanded, and the
// loop no position but the device's.
#include "tests/device/haply_loop.h"

namespace forceshade::device::test {
namespace {

using testing::expect_words;

std::string refusal(const HaplyOptions& options) {
    return testing::message_of<DeviceAbsent>([&] { open_haply(options); });
}

TEST(HaplyFaults, NoService) {
    const HaplyOptions options = options_of(SimulatedService({})); // which ends here
    expect_words(refusal(options), {options.url, "connection refused", "Install and start", "haply-inverse-service"});
    EXPECT_NE(look_for_haply(options.url).problem, "");
}

TEST(HaplyFaults, AServiceThatCannotServeIsRefused) {
    const auto service_with = [](Fault fault, const std::vector<std::string>& devices = {"04BA"}) {
        ServiceScript script;
        script.fault = fault;
        script.devices = devices;
        return script;
    };
    ServiceScript no_axes;
    no_axes.basis = "XYZX";
    using Words = std::vector<std::string>;
    for (const auto& [script, words] : {std::pair{service_with(Fault::no_inventory), Words{"no answer within 0.3 s"}},
                                        {service_with(Fault::no_websocket), {"not as a WebSocket", "404"}},
                                        {service_with(Fault::no_http), {"not from a WebSocket"}},
                                        {service_with(Fault::none, {}), {"lists no Inverse3", "plug it in", "3.5.0"}},
                                        {no_axes, {"XYZX", "permutation"}}}) {
        SimulatedService service(script);
        HaplyOptions options = options_of(service);
        if (script.fault == Fault::no_inventory)
            options.wait = 0.3;
        expect_words(refusal(options), words);
    }
}

bool complains(const BackEnd& device, const std::string& part) {
    return device.error_text() != nullptr && std::string(device.error_text()).find(part) != std::string::npos;
}

/// Positions turn into none, not into others; forces stay what they were; once the service is well, all goes on.
void survive(Fault fault, const char* error_text) {
    SimulatedService service({});
    const auto device = open_haply(options_of(service));
    ASSERT_TRUE(runs_well(*device, service));
    service.set(fault);
    const auto failed = [&](const Reading& reading, bool) {
        if (reading.answer != Answer::failed) {
            EXPECT_TRUE(in_reach(reading.position));
            EXPECT_NE(reading.answer, Answer::ended);
        }
        return reading.answer == Answer::failed;
    };
    EXPECT_TRUE(loop_until(*device, failed));
    for (unsigned more = 0; more < 50; ++more)
        loop_until(*device, [&](const Reading& reading, bool taken) {
            failed(reading, taken);
            return true;
        });
    EXPECT_TRUE(
        loop_until(*device, [&](const Reading&, bool) { return complains(*device, error_text); })); // in the end
    EXPECT_TRUE(wait_until([&] {
        loop_until(*device, [](const Reading&, bool) { return true; });
        return ends_without_force(service);
    }));
    service.set(Fault::none);
    EXPECT_TRUE(runs_well(*device, service));
    EXPECT_TRUE(received_only_what_was_commanded(service));
}

TEST(HaplyFaults, AreSurvived) {
    for (const auto& [fault, error_text] : {std::pair{Fault::not_json, "not JSON"},
                                            {Fault::null, "without a position"},
                                            {Fault::huge, "connecti"},
                                            {Fault::closes, "connecti"},
                                            {Fault::late, "in time"}}) {
        SCOPED_TRACE(int(fault));
        survive(fault, error_text);
    }
}

TEST_F(RunningHaply, NeverAnswers) {
    const unsigned connections = service_.connections();
    service_.set(Fault::never_answers);
    const std::size_t before = service_.received().size();
    EXPECT_TRUE(loop_until(*device_, [&](const Reading& reading, bool) { return reading.answer == Answer::failed; }));
    // The command under way, one without force behind it, and nothing more until the connection is given up.
    EXPECT_TRUE(loop_until(*device_, [&](const Reading&, bool) { return service_.connections() > connections; }));
    std::size_t of_the_old = 0;
    glm::dvec3 last_of_the_old = kPush;
    for (const Received& each : service_.received())
        if (each.connection == connections) {
            ++of_the_old;
            last_of_the_old = each.force;
        }
    EXPECT_LE(of_the_old, before + 3);
    EXPECT_EQ(last_of_the_old, glm::dvec3(0));
    EXPECT_TRUE(received_only_what_was_commanded(service_));
    EXPECT_TRUE(ends_without_force(service_));
    service_.set(Fault::none);
    EXPECT_TRUE(runs_well(*device_, service_));
}

/// The loop is silent, so that what is not asked for comes while no answer is owed, but on a machine that is very busy.
TEST_F(RunningHaply, DropsWhatItDidNotAskFor) {
    ASSERT_TRUE(wait_until([&] { return ends_without_force(service_); })); // the loop counts as silent
    service_.set(Fault::unasked);
    unsigned near = 0, far = 0;
    EXPECT_TRUE(wait_until([&] {
        const Reading reading = device_->read();
        if (reading.answer != Answer::failed)
            ++(in_reach(reading.position) ? near : far);
        return near > 400 && complains(*device_, "not asked for");
    }));
    EXPECT_LT(4 * far, near);
}

/// One that comes while an answer is owed passes for it; those after it set the count right again.
TEST_F(RunningHaply, AnswersTooManyAndOutOfOrder) {
    service_.set(Fault::older);
    EXPECT_TRUE(runs_well(*device_, service_));
    EXPECT_TRUE(loop_until(*device_, [&](const Reading& reading, bool) {
        EXPECT_TRUE(reading.answer == Answer::failed || in_reach(reading.position));
        return complains(*device_, "not asked for");
    }));
    EXPECT_TRUE(received_only_what_was_commanded(service_));
}

TEST_F(RunningHaply, GoesAwayAndComesBack) {
    for (int time = 0; time < 2; ++time) {
        service_.go_away();
        EXPECT_TRUE(loop_until(
            *device_, [](const Reading& reading, bool taken) { return reading.answer == Answer::failed && !taken; }));
        for (int i = 0; i < 100; ++i)
            EXPECT_TRUE(loop_until(*device_, [](const Reading& reading, bool taken) {
                EXPECT_EQ(reading.answer, Answer::failed);
                EXPECT_FALSE(taken);
                return true;
            }));
        service_.come_back();
        EXPECT_TRUE(runs_well(*device_, service_));
    }
    EXPECT_TRUE(received_only_what_was_commanded(service_));
}

TEST_F(RunningHaply, LeavesWhileTheServiceIsAway) {
    service_.go_away();
    ASSERT_TRUE(loop_until(*device_, [](const Reading&, bool taken) { return !taken; }));
    device_.reset(); // comes back at all
}

TEST_F(RunningHaply, LeavesWhileTheServiceIsMute) {
    service_.set(Fault::never_answers);
    const auto start = std::chrono::steady_clock::now();
    device_.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(3));
    EXPECT_TRUE(wait_until([&] { return ends_without_force(service_); }));
}

TEST_F(RunningHaply, ASecondDeviceInMidLoopIsLeftAlone) {
    service_.set_devices({"04BA", "049D"});
    EXPECT_TRUE(runs_well(*device_, service_));
    service_.go_away(); // the choice is not made anew
    service_.come_back();
    EXPECT_TRUE(loop_until(*device_, [&](const Reading& reading, bool) {
        EXPECT_TRUE(reading.answer == Answer::failed || in_reach(reading.position));
        return service_.connections() == 3 && reading.answer == Answer::fresh;
    }));
    EXPECT_TRUE(received_only_what_was_commanded(service_, "04BA"));
}

TEST_F(RunningHaply, AnotherDeviceInItsPlaceIsNotTaken) {
    service_.set_devices({"049D"});
    service_.go_away();
    service_.come_back();
    const std::size_t before = service_.received().size();
    EXPECT_TRUE(wait_until([&] {
        device_->write(kPush);
        return service_.connections() >= 5;
    }));
    for (std::size_t i = before; i < service_.received().size(); ++i)
        EXPECT_EQ(service_.received()[i].connection, 2u);
    EXPECT_EQ(device_->read().answer, Answer::failed);
    EXPECT_TRUE(wait_until([&] { return complains(*device_, "does not list the device"); }));
}

} // namespace
} // namespace forceshade::device::test
