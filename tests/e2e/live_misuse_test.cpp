// What a live loop is asked for by mistake: refused with where and what would be right, before anything is felt or
// written.
#include "tests/e2e/live_workplace.h"

namespace forceshade::testing {
namespace {

class LiveMisuse : public Live {
protected:
    // With a log, so that there is something that could be written.
    static std::vector<std::string> fast(const std::vector<std::string>& further) {
        return with({"live", "bump.toml", "--fast", "--duration", "0.1 s", "--log", "log.csv"}, further);
    }
};

TEST_F(LiveMisuse, OfDevices) {
    const auto on = [](const std::string& device) {
        return live("bump.toml", {"--device", device, "--log", "log.csv"});
    };
    expect_refused(on("replai:x.csv"), {"--device replai:x.csv", "did you mean \"replay\"?"});
    expect_refused(on("mouse"),
                   {"--device mouse", "sim[:BUTTONS], replay:FILE, haply[:URL], dhd[:INDEX] or hd[:NAME]"});
    expect_refused(on(""), {"--device", "sim[:BUTTONS], replay:FILE"});
    expect_refused(on("replay:"), {"replay:FILE.csv"});
    expect_refused(on("replay"), {"replay:FILE.csv"});
    expect_refused(on("replay:nosuch.csv"), {"nosuch.csv", "No such file"}, 4);
    expect_refused(fast({"--dead-man", "1"}), {"--dead-man 1", "no buttons"});
    expect_refused(fast({"--device", "sim:1@0 s..1 s", "--clutch", "2"}), {"--clutch 2", "at most 1 button"});
    expect_refused(fast({"--device", "sim:1@0 s..1 s", "--clutch", "1", "--dead-man", "1"}), {"cannot be both"});
    expect_refused(fast({"--rotate", "z90"}), {"--rotate", "an axis of the device and an angle"});
    expect_refused(fast({"--rotate", "z 90 mm"}), {"--rotate", "angle"});
    expect_refused(fast({"--scale", "-1"}), {"--scale", "0.001 to 1000"});
}

TEST_F(LiveMisuse, OfRecordings) {
    const auto from = [](const std::string& file) {
        return live("bump.toml", {"--device", "replay:" + file, "--fast", "--log", "log.csv"});
    };
    write("nan.csv", "path,t,x,y,z\n0,0,0,0,0\n0,0.001,0,nan,0\n");
    expect_refused(from("nan.csv"), {"nan.csv:3:11: y: \"nan\" is not finite"});
    write("cut.csv", "path,t,x,y,z\n0,0,0,0,0\n0,0.001,0,0.0");
    expect_refused(from("cut.csv"), {"cut.csv:3", "cut off"});
}

TEST_F(LiveMisuse, InterleavedPathsOfARecordingArePlayedOneAfterTheOther) {
    write("two.csv", "path,t,x,y,z\n7,0,0,0,-0.001\n3,0,0.001,0,-0.001\n7,0.001,0,0,-0.002\n3,0.001,0.001,0,-0.002\n");
    expect_success(live("bump.toml", {"--device", "replay:two.csv", "--fast", "--log", "log.csv"}));
    std::string order;
    for (const auto& row : rows("log.csv"))
        order += row.at("path") + ":" + row.at("x") + " ";
    EXPECT_EQ(order, "0:0 0:0 1:0.001 1:0.001 ");
}

TEST_F(LiveMisuse, ARecordingThatMayBeCutOffIsWarnedOf) {
    write("cut.csv", "path,t,x,y,z\n0,0,0,0,0\n0,0.001,0,0,0.0");
    const std::vector<std::string> arguments = live("bump.toml", {"--device", "replay:cut.csv", "--fast"});
    EXPECT_TRUE(says(expect_success(arguments).error, "warning: cut.csv:3:16: the last line has no line feed"));
}

TEST_F(LiveMisuse, OfQuantities) {
    const std::vector<std::pair<const char*, const char*>> flags{
        {"--rate", "1 kHz"},      {"--duration", "1 s"}, {"--patience", "1 s"}, {"--lasting-force", "1 N"},
        {"--max-force", "1 N"},   {"--slew", "1 N/s"},   {"--ramp", "1 s"},     {"--contact-ramp", "1 s"},
        {"--max-speed", "1 m/s"}, {"--stale", "1 s"}};
    for (const auto& [flag, fine] : flags) {
        const std::string unit = std::string(fine).substr(1);
        for (const std::string& wrong : {std::string("1"), "-1" + unit, "nan" + unit, "inf" + unit, std::string("1 kg"),
                                         std::string("fast"), std::string("1e999") + unit}) {
            SCOPED_TRACE(wrong);
            expect_refused({"live", "bump.toml", "--log", "log.csv", fmt::format("{}={}", flag, wrong)}, {flag});
        }
    }
    for (const char* const wrong : {"0 ms", "20", "-3 ms", "nan", "inf", "never"})
        expect_refused(fast({fmt::format("--watchdog={}", wrong)}), {"--watchdog"});
    for (const char* const wrong : {"--cpu=-1", "--cpu=1000", "--cpu=9999999"})
        expect_refused(fast({wrong}), {"--cpu", "may run on"});
    expect_refused(fast({"--damping", "5 N s/m"}), {"--damping", "--passivity"});
    for (const char* const rate : {"99 Hz", "10001 Hz", "1 MHz", "1 Hz"})
        expect_refused({"live", "bump.toml", "--duration", "1 s", "--log", "log.csv", "--rate", rate},
                       {"100 Hz to 10 kHz", "--rate"});
    for (const char* const duration : {"1e300 s", "1 ns", "1e9 s"})
        expect_refused({"live", "bump.toml", "--fast", "--log", "log.csv", "--duration", duration},
                       {"--duration", "between a sample (1 ms) and a year"});
}

TEST_F(LiveMisuse, EveryLimitCanBeSwitchedOff) {
    for (const char* const flag : {"--max-force", "--lasting-force", "--slew", "--ramp", "--contact-ramp",
                                   "--max-speed", "--stale", "--watchdog", "--workspace", "--patience"})
        expect_success(live("bump.toml", {"--fast", "--duration", "0.1 s", flag, "none"}));
}

TEST_F(LiveMisuse, OfPlaces) {
    const auto within = [](const std::string& ends) { return fast({"--workspace", ends}); };
    expect_refused(within("0 m, 0 m, 0 m, 1 m, 1 m"), {"--workspace needs 6 lengths, got 5"});
    expect_refused(within("0 m, 0 m, 0 m, 1 m, 0 m, 1 m"), {"--workspace: 0 m is not below 0 m", "first the lowest"});
    expect_refused(within("0 m, 0 m, 2 m, 1 m, 1 m, 1 m"), {"--workspace: 2 m is not below 1 m"});
    expect_refused(within("0 m, 0 m, 0, 1 m, 1 m, 1 m"), {"--workspace:", "unit"});
    expect_refused(within("0 m, 0 m, nan m, 1 m, 1 m, 1 m"), {"--workspace:"});
    expect_refused(within("nowhere"), {"--workspace:"});
    expect_refused(fast({"--origin", "0 m, 0 m"}), {"--origin needs 3 lengths, got 2"});
    expect_refused(fast({"--origin", "there"}), {"--origin:"});
    expect_refused(fast({"--origin", "0 m, 0 m, inf m"}), {"--origin:"});
}

TEST_F(LiveMisuse, OfWaysToRun) {
    expect_refused({"live", "bump.toml", "--fast", "--log", "log.csv"}, {"--fast needs --duration"});
    for (const char* const device : {"dhd", "hd", "haply"})
        expect_refused(fast({"--device", device}), {"--fast is for sim and replay"});
    expect_refused(fast({"--gpu", "0"}), {"--gpu", "CPU"});
    expect_refused(fast({"--view"}), {"--fast is too fast to watch"});
    expect_refused(fast({"--port", "8080"}), {"--port", "say --view, too"});
    const std::vector<std::string> viewed = live("bump.toml", {"--duration", "1 s", "--log", "log.csv", "--view"});
    for (const auto& [port, words] :
         {std::pair{"70000", "1 to 65535, got 70000"}, {"-1", "--port"}, {"http", "--port"}})
        expect_refused(with(viewed, {"--port", port}), {words});
    for (const char* const to : {"5005", "udp:0"})
        expect_refused(fast({"--send", to}), {"--send ", to, "udp:192.168.1.20:5005", "udp:[::1]:5005"});
    expect_refused(fast({"--send", "udp:255.255.255.255:5005"}), {"--send", "cannot send there"}, 4);
    expect_refused({"live", "nosuch.toml"}, {"nosuch.toml", "No such file"}, 4);
    write("axis.toml", "[surface]\nfacets = [1, 2]\n");
    expect_refused({"live", "axis.toml", "--log", "log.csv"}, {"axis.toml:2"});
    write("lost.toml", "[surface]\nkind = \"mesh\"\nfile = \"nosuch.obj\"\n");
    expect_refused({"live", "lost.toml", "--log", "log.csv"}, {"nosuch.obj"}, 4);
    expect_refused({"live"}, {"SCENE"});
}

TEST_F(LiveMisuse, OfFiles) {
    write("log.csv", "a recording of yesterday\n");
    expect_refused(fast({}), {"--log", "log.csv", "is there already", "--overwrite"});
    std::filesystem::remove(path("log.csv"));
    expect_refused(live("bump.toml", {"--log", "nosuch/log.csv"}), {"nosuch"}, 4);
    expect_refused(live("bump.toml", {"--report", "nosuch/said"}), {"nosuch"}, 4);
    std::filesystem::create_directory(path("folder"));
    expect_refused(live("bump.toml", {"--log", "folder", "--overwrite"}), {"--log folder: is a folder"});
    expect_refused(live("bump.toml", {"--log", "log.exr"}), {"--log log.exr", ".csv"});
    write("in.csv", "path,t,x,y,z\n0,0,0,0,0\n0,0.001,0,0,0\n");
    expect_refused(live("bump.toml", {"--device", "replay:in.csv", "--fast", "--log", "in.csv", "--overwrite"}),
                   {"--log in.csv would replace in.csv, which is read"});
    expect_refused({"live", "bump.toml", "--fast", "--duration", "1 s", "--log", "bump.toml", "--overwrite"},
                   {"would replace bump.toml"});
    expect_refused({"live", "mesh.toml", "--fast", "--duration", "1 s", "--log", "spot.obj", "--overwrite"},
                   {"would replace", "spot.obj"});
    write("log.scene-1.toml", text("bump.toml")); // of an earlier run
    expect_refused(live("log.scene-1.toml", {"--fast", "--duration", "1 s", "--log", "log.csv"}),
                   {"--log log.csv", "log.scene-1.toml", "choose another name"});
    write("in.txt", text("in.csv"));
    expect_refused(live("bump.toml", {"--device", "replay:in.txt", "--fast", "--report", "in"}),
                   {"in.txt would replace"});
}

TEST_F(LiveMisuse, OfFoldersThatOthersOwn) {
    if (!is_root())
        GTEST_SKIP() << "only root can become somebody else";
    for (const char* const flag : {"--log", "--report"}) {
        Launch launch = this->launch(live("bump.toml", {"--fast", "--duration", "1 s", flag, "here"}));
        launch.user = kNobody;
        expect_refused(launch, {"here", "Permission denied"}, 4);
    }
}

} // namespace
} // namespace forceshade::testing
