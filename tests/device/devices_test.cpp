// What the list of devices says of stubs of the vendors' libraries, and of none.
#include "device/backends/devices.h"
#include "tests/device/simulated_service.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::testing {
namespace {

DeviceKind kind(const std::string& option) {
    for (const DeviceKind& one : list_devices({}, 0.2))
        if (one.option == option)
            return one;
    ADD_FAILURE() << "no " << option;
    return {};
}

using Names = std::vector<std::string>;

TEST(Devices, that_need_nothing_are_always_there) {
    EXPECT_EQ(kind("sim").devices, Names{"sim"});
    EXPECT_EQ(kind("replay:FILE").devices, Names{"replay:FILE"});
    EXPECT_EQ(kind("sim").problem, "");
}

TEST(Devices, of_force_dimension_are_counted) {
    const StubLibrary stub("FORCESHADE_DHD_LIBRARY", DHD_STUB);
    stub.devices(2);
    const DeviceKind two = kind("dhd[:INDEX]");
    EXPECT_EQ(two.devices, (Names{"dhd:0", "dhd:1"}));
    EXPECT_EQ(two.software, "DHD SDK 3.17.6.1");
    EXPECT_EQ(two.place, DHD_STUB);
    EXPECT_EQ(two.problem, "");
    EXPECT_EQ(stub.calls("dhdOpen") + stub.calls("dhdOpenID"), 0) << "another program may have it open";
    stub.devices(0);
    EXPECT_EQ(kind("dhd[:INDEX]").devices, Names{});
    EXPECT_NE(kind("dhd[:INDEX]").problem.find("udev"), std::string::npos);
    stub.fail("dhdGetDeviceCount");
    EXPECT_NE(kind("dhd[:INDEX]").problem.find("no driver found"), std::string::npos);
}

TEST(Devices, of_3d_systems_are_told_by_name) {
    const StubLibrary stub("FORCESHADE_HD_LIBRARY", HD_STUB);
    const DeviceKind one = kind("hd[:NAME]");
    EXPECT_EQ(one.devices, Names{"hd"});
    EXPECT_EQ(one.name, "Touch (serial number 8042)");
    EXPECT_EQ(one.place, HD_STUB);
    EXPECT_EQ(one.problem, "");
    stub.devices(0);
    EXPECT_EQ(kind("hd[:NAME]").devices, Names{});
    EXPECT_NE(kind("hd[:NAME]").problem.find("Communication configuration error"), std::string::npos);
}

TEST(Devices, whose_library_is_absent_are_told_with_how_to_install_it) {
    ::setenv("FORCESHADE_DHD_LIBRARY", "/nonexistent/libdhd.so", 1);
    ::setenv("FORCESHADE_HD_LIBRARY", HD_STUB_WITHOUT_FORCE, 1);
    EXPECT_NE(kind("dhd[:INDEX]").problem.find("forcedimension.com"), std::string::npos);
    EXPECT_EQ(kind("dhd[:INDEX]").software, "");
    EXPECT_NE(kind("hd[:NAME]").problem.find("hdSetDoublev"), std::string::npos);
}

TEST(Devices, of_haply_are_asked_of_their_service) {
    test::ServiceScript script;
    script.devices = {"04BA", "049D"};
    test::SimulatedService service(script);
    DeviceKind found = list_devices(service.url())[2];
    EXPECT_EQ(found.option, "haply[:URL]");
    EXPECT_EQ(found.devices,
              (Names{"haply:" + service.url() + "?device=04BA", "haply:" + service.url() + "?device=049D"}));
    EXPECT_EQ(found.software, "Inverse Service 3.5.0.0");
    EXPECT_EQ(found.place, service.url());
    EXPECT_EQ(found.problem, "");
    service.set_devices({});
    found = list_devices(service.url())[2];
    EXPECT_EQ(found.devices, Names{});
    EXPECT_NE(found.problem.find("Haply Hub"), std::string::npos);
    service.set(test::Fault::no_inventory);
    EXPECT_NE(list_devices(service.url(), 0.2)[2].problem.find("Inverse Service 3.x"), std::string::npos);
    service.go_away();
    EXPECT_NE(list_devices(service.url())[2].problem.find("haply.co"), std::string::npos);
    EXPECT_TRUE(service.received().empty()) << "no command is sent";
}

} // namespace
} // namespace forceshade::device::testing
