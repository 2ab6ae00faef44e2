// The Inverse Service's messages, addresses and axes as text.
#include <bit>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "device/backends/haply.h"
#include "tests/io/folder.h"

namespace forceshade::device {
namespace {

using forceshade::testing::says;

using Dialect = HaplyOptions::Dialect;

TEST(HaplyProtocol, WritesTheForceOfEachDialect) {
    std::string text = "what was there before";
    write_command(text, Dialect::vector, "04BA", {1.5, -0.25, 1e-7});
    EXPECT_EQ(text, R"({"inverse3":[{"device_id":"04BA","commands":)"
                    R"({"set_cursor_force":{"vector":{"x":1.5,"y":-0.25,"z":1e-07}}}}]})");
    EXPECT_TRUE(nlohmann::json::accept(text));
    write_command(text, Dialect::values, "04BA", {0, 0, 0.1});
    EXPECT_EQ(text, R"({"inverse3":[{"device_id":"04BA","commands":)"
                    R"({"set_cursor_force":{"values":{"x":0,"y":0,"z":0.1}}}}]})");
}

TEST(HaplyProtocol, QuotesADeviceIdThatNeedsIt) {
    std::string text;
    write_command(text, Dialect::vector, "a\"b\\\xff", {0, 0, 0});
    EXPECT_TRUE(nlohmann::json::parse(text)["inverse3"][0].contains("commands"));
}

TEST(HaplyProtocol, FramesAreMaskedText) {
    for (const std::size_t size : {std::size_t(5), std::size_t(125), std::size_t(126), std::size_t(300)}) {
        const std::string message(size, 'a');
        const std::string bytes = frame(message);
        const std::size_t head = size < 126 ? 2 : 4;
        ASSERT_EQ(bytes.size(), head + 4 + size);
        EXPECT_EQ(static_cast<unsigned char>(bytes[0]), 0x81);
        EXPECT_EQ(static_cast<unsigned char>(bytes[1]), 0x80u | (size < 126 ? size : 126));
        if (head == 4) {
            EXPECT_EQ(static_cast<unsigned char>(bytes[2]) * 256u + static_cast<unsigned char>(bytes[3]), size);
        }
        for (std::size_t i = 0; i < size; ++i)
            EXPECT_EQ(bytes[head + 4 + i] ^ bytes[head + i % 4], 'a');
    }
}

TEST(HaplyProtocol, TheVersionChoosesTheDialect) {
    for (const char* old : {"3.0.8", "3.1.1", "3.1", "3.4.9.0", "2.9.9"})
        EXPECT_EQ(dialect_of(old), Dialect::values) << old;
    for (const char* current : {"3.5.0", "3.5.0-2-gce34c39e", "3.10.1", "4.0.0", "10.0", "", "main", "3", "3.x"})
        EXPECT_EQ(dialect_of(current), Dialect::vector) << current;
}

TEST(HaplyProtocol, ReadsTheVersion) {
    EXPECT_EQ(read_version(R"({"git_tag":"3.5.0","project_version":"3.5.0.0"})"), "3.5.0");
    EXPECT_EQ(read_version(R"({"project_version":"3.1.1.0"})"), "3.1.1.0");
    EXPECT_EQ(read_version(R"({"ok":true,"data":{"git_tag":"v3.6.1"}})"), "3.6.1");
    for (const char* none : {"", "3.5", "[]", R"({"git_tag":3.5})", R"({"git_tag":""})", "<html>", R"({"data":[1]})"})
        EXPECT_EQ(read_version(none), "") << none;
}

TEST(HaplyProtocol, ReadsTheInventory) {
    const auto devices = read_inventory(R"({"session_id":7,"inverse3":[
        {"device_id":"049D","config":{"type":"inverse3","basis":{"permutation":"XZY"}},
         "status":{"calibrated":false,"in_use":false,"ready":true}},
        {"device_id":"04BA"}],"verse_grip":[{"device_id":"61548"}]})");
    ASSERT_TRUE(devices);
    ASSERT_EQ(devices->size(), 2u);
    EXPECT_EQ((*devices)[0].id, "049D");
    EXPECT_EQ((*devices)[0].type, "inverse3");
    EXPECT_EQ((*devices)[0].basis, "XZY");
    EXPECT_EQ((*devices)[0].status, "not calibrated, not in use, ready");
    EXPECT_EQ((*devices)[1].id, "04BA");
    EXPECT_EQ((*devices)[1].status, "");
    ASSERT_TRUE(read_inventory("{}"));
    EXPECT_TRUE(read_inventory("{}")->empty());
    for (const char* none : {"", "[]", "7", "{", R"({"inverse3":{}})", R"({"inverse3":[7]})",
                             R"({"inverse3":[{"device_id":7}]})", R"({"inverse3":[{}]})"})
        EXPECT_FALSE(read_inventory(none)) << none;
}

TEST(HaplyProtocol, TellsWhatTheServiceMakesOfPositionsAndForces) {
    const auto remark = [](const std::string& config, const std::string& status = "{}") {
        return (*read_inventory(R"({"inverse3":[{"device_id":"04BA","config":)" + config + R"(,"status":)" + status +
                                "}]}"))[0]
            .remark;
    };
    EXPECT_EQ(remark(R"({"mount":{"transform":{"scale":{"x":1,"y":1,"z":1}}},"force_gate":1,"damping":{"scalar":0}})"),
              "");
    EXPECT_TRUE(says(remark(R"({"mount":{"transform":{"scale":{"x":2,"y":2,"z":1}}}})"), "x 2, y 2"));
    EXPECT_TRUE(says(remark(R"({"mount":{"scale":{"x":1,"y":1,"z":3}}})"), "z 3"));
    EXPECT_TRUE(says(remark(R"({"filters":{"force_gate":{"gain":0.3}}})"), "gain 0.3"));
    EXPECT_TRUE(says(remark(R"({"filters":{"damping":{"scalar":6}}})"), "scalar 6"));
    EXPECT_TRUE(says(remark(R"({"damping":{"scalar":6}})"), "scalar 6"));
    EXPECT_TRUE(says(remark("{}", R"({"in_use":true})"), "another program"));
    for (const char* odd : {"[]", "7", R"({"mount":3,"damping":"much","force_gate":null})"})
        EXPECT_EQ(remark(odd), "") << odd;
}

TEST(HaplyProtocol, ReadsThePositionOfItsDeviceOnly) {
    const State state = read_state(R"({"inverse3":[
        {"device_id":"AAAA","state":{"cursor_position":{"x":9,"y":9,"z":9}}},
        {"device_id":"04BA","state":{"cursor_position":{"x":0.5,"y":-1.25e-1,"z":0}}}]})",
                                   "04BA");
    EXPECT_EQ(state.fault, nullptr);
    EXPECT_EQ(state.position, glm::dvec3(0.5, -0.125, 0));
}

TEST(HaplyProtocol, TakesNothingElseForAPosition) {
    const auto of = [](const std::string& position) {
        return R"({"inverse3":[{"device_id":"04BA","state":{"cursor_position":)" + position + "}}]}";
    };
    ASSERT_EQ(read_state(of(R"({"x":0,"y":0,"z":0})"), "04BA").fault, nullptr);
    const std::vector<std::pair<std::string, std::vector<std::string>>> faults{
        {"not JSON",
         {"", "nonsense", "\xff\xfe", std::string(900'000, '['), R"({"inverse3":[{"device_id":"04BA","sta)",
          of(R"({"x":NaN,"y":0,"z":0})"), of(R"({"x":1e999,"y":0,"z":0})")}},
        {"without a list of devices",
         {"null", "[]", "{}", R"({"inverse3":{}})", R"({"inverse3":{"device_id":4,"state":[1,null]},"session_id":"7"})",
          std::string(400'000, '[') + std::string(400'000, ']')}},
        {"does not list the device",
         {R"({"inverse3":[]})", R"({"inverse3":[null,3]})",
          R"({"inverse3":[{"device_id":"XXXX","state":{"cursor_position":{"x":0,"y":0,"z":0}}}]})"}},
        {"without a position",
         {R"({"inverse3":[{"device_id":"04BA"}]})", R"({"inverse3":[{"device_id":"04BA","state":{}}]})",
          of(R"({"x":null,"y":0,"z":0})"), of(R"({"x":"0","y":0,"z":0})"), of(R"({"x":true,"y":0,"z":0})"),
          of(R"({"y":0,"z":0})"), of(R"({"x":11,"y":0,"z":0})"), of(R"({"x":0,"y":-1e300,"z":0})"), of("[0,0,0]"),
          of("null"), of("\"origin\""), of("{}")}},
        {"another dialect", {R"({"ok":false,"error":"no"})"}}};
    for (const auto& [words, messages] : faults)
        for (const std::string& message : messages) {
            const char* const fault = read_state(message, "04BA").fault;
            EXPECT_TRUE(fault != nullptr && says(fault, words)) << message.substr(0, 100);
        }
}

TEST(HaplyProtocol, ReadsWhetherTheDeviceIsReadyForAForce) {
    const auto of = [](const std::string& status) {
        return read_state(R"({"inverse3":[{"device_id":"04BA","state":{"cursor_position":{"x":0,"y":0,"z":0}},)"
                          R"("status":)" +
                              status + "}]}",
                          "04BA")
            .readiness;
    };
    const auto why = [&](const std::string& status) { return std::string(objection(of(status).unmet)); };
    const Readiness all = of(R"({"calibrated":true,"in_use":false,"power_supply":true,"ready":true,"started":true})");
    EXPECT_EQ(all.unmet, 0u);
    EXPECT_EQ(objection(all.unmet), nullptr);
    EXPECT_EQ(std::popcount(all.known), 4);
    EXPECT_TRUE(says(why(R"({"calibrated":false})"), "not calibrated"));
    EXPECT_TRUE(says(why(R"({"power_supply":false})"), "no power supply"));
    EXPECT_TRUE(says(why(R"({"ready":false})"), "not ready"));
    EXPECT_TRUE(says(why(R"({"started":false})"), "not started"));
    EXPECT_TRUE(says(why(R"({"calibrated":"yes"})"), "not calibrated")) << "only true is true";
    EXPECT_TRUE(says(why(R"({"calibrated":null})"), "not calibrated"));
    EXPECT_TRUE(says(why(R"({"frozen":true})"), "frozen"));
    EXPECT_EQ(of(R"({"frozen":false})").unmet, 0u);
    EXPECT_EQ(of("{}").known, 0u) << "an absent condition keeps its state";
    EXPECT_EQ(of("[]").known, 0u);
    EXPECT_NE(objection((*read_inventory(R"({"inverse3":[{"device_id":"04BA","status":{"ready":false}}]})"))[0].unmet),
              nullptr);
}

TEST(HaplyAxes, FollowABasis) {
    // The device's own axes are the world's: right, forward (away from the user), up.
    EXPECT_EQ(parse_basis("XYZ")->to_world({1, 2, 3}), glm::dvec3(1, 2, 3));
    EXPECT_EQ(parse_basis("")->to_service({1, 2, 3}), glm::dvec3(1, 2, 3));
    // The service's documentation: "YZX" has its x along the device's y, its y along z, its z along x.
    EXPECT_EQ(parse_basis("YZX")->to_world({1, 2, 3}), glm::dvec3(3, 1, 2));
    EXPECT_EQ(parse_basis("X-YZ")->to_world({1, 2, 3}), glm::dvec3(1, -2, 3)); // left-handed, z up
    EXPECT_EQ(parse_basis("XZY")->to_world({1, 2, 3}), glm::dvec3(1, 3, 2));   // y up
    for (const char* basis : {"XYZ", "YZX", "ZXY", "X-YZ", "-Z+X-Y", "xzy"})
        EXPECT_EQ(parse_basis(basis)->to_world(parse_basis(basis)->to_service({1, 2, 3})), glm::dvec3(1, 2, 3))
            << basis;
    for (const char* none : {"XY", "XXZ", "XYZX", "XYW", "X--YZ", "XYZ-", "X Y Z"})
        EXPECT_FALSE(parse_basis(none)) << none;
}

TEST(HaplyAddress, TakesAUrlApart) {
    const Address address = parse_address("ws://localhost:10001");
    EXPECT_EQ(address.host, "localhost");
    EXPECT_EQ(address.port, "10001");
    EXPECT_EQ(address.path, "/");
    EXPECT_EQ(parse_address("ws://lab").port, "10001");
    EXPECT_EQ(parse_address("ws://[::1]:8500/x/y").host, "::1");
    EXPECT_EQ(parse_address("ws://[::1]:8500/x/y").host_field(), "[::1]:8500");
    EXPECT_EQ(parse_address("ws://[::1]:8500/x/y").path, "/x/y");
    for (const char* bad : {"", "localhost:10001", "http://localhost:10001", "wss://localhost", "ws://", "ws://:10001",
                            "ws://lab:", "ws://lab:0", "ws://lab:65536", "ws://lab:1x", "ws://[::1", "ws://[::1]x",
                            "ws://a b", "ws://a/b c"})
        EXPECT_THROW((void)parse_address(bad), UsageError) << bad;
}

TEST(HaplyOptionsText, ReadsUrlDeviceAndDialect) {
    EXPECT_EQ(parse_haply("").url, "ws://localhost:10001");
    EXPECT_EQ(parse_haply("").dialect, Dialect::by_version);
    const HaplyOptions options = parse_haply("ws://lab:8500?device=04BA&dialect=values");
    EXPECT_EQ(options.url, "ws://lab:8500");
    EXPECT_EQ(options.device_id, "04BA");
    EXPECT_EQ(options.dialect, Dialect::values);
    EXPECT_EQ(parse_haply("?device=049D").url, "ws://localhost:10001");
    EXPECT_EQ(parse_haply("?dialect=vector").dialect, Dialect::vector);
    for (const char* bad : {"lab", "ws://lab?", "ws://lab?device", "ws://lab?device=", "ws://lab?dialect=3.1",
                            "ws://lab?colour=red", "ws://lab?device=A&", "ws://lab:x?device=A"})
        EXPECT_THROW((void)parse_haply(bad), UsageError) << bad;
}

TEST(HaplyLockStep, TellsWhichAnswerIsWhich) {
    LockStep step;
    EXPECT_EQ(step.answered(), LockStep::Kind::unasked);
    step.sent();
    EXPECT_EQ(step.answered(), LockStep::Kind::current);
    step.sent();
    step.sent();
    EXPECT_EQ(step.answered(), LockStep::Kind::older);
    EXPECT_EQ(step.answered(), LockStep::Kind::current);
    EXPECT_EQ(step.answered(), LockStep::Kind::unasked);
    step.sent();
    step.reset();
    EXPECT_EQ(step.owed(), 0u);
}

} // namespace
} // namespace forceshade::device
