// Libraries that are looked for, and the devices that they tell of.
#include <fstream>

#include "device/backends/devices.h"
#include "device/backends/shared_library.h"
#include "tests/device/simulated_service.h"
#include "tests/device/stub_library.h"

namespace forceshade::device::testing {
namespace {

const SoughtLibrary kSought{"Acme toolkit", "FORCESHADE_TEST_LIBRARY", {"libacme.so.9", "libacme.so"}, "Ask Acme"};

class Library : public ::testing::Test {
protected:
    Library() { ::unsetenv("FORCESHADE_TEST_LIBRARY"); }
    static std::string refusal() {
        return message_of<DeviceAbsent>([] { SharedLibrary library(kSought); });
    }
};

TEST_F(Library, ThatIsNowhereIsToldWithWhatWasTried) {
    expect_words(refusal(), {"Acme toolkit", "libacme.so.9, libacme.so", "LD_LIBRARY_PATH", "FORCESHADE_TEST_LIBRARY",
                             "Ask Acme"});
    ::setenv("FORCESHADE_TEST_LIBRARY", "", 1);
    expect_words(refusal(), {"libacme.so.9, libacme.so", "is not set"});
}

TEST_F(Library, ThatTheEnvironmentNamesIsTakenAndNoOther) {
    ::setenv("FORCESHADE_TEST_LIBRARY", "/nonexistent/libacme.so", 1);
    expect_words(refusal(), {"FORCESHADE_TEST_LIBRARY", "/nonexistent/libacme.so", "No such file", "Ask Acme"});
    SoughtLibrary there = kSought;
    there.names = {kDhdStub};
    EXPECT_THROW(SharedLibrary library(there), DeviceAbsent);
    ::unsetenv("FORCESHADE_TEST_LIBRARY");
    EXPECT_EQ(SharedLibrary(there).file(), kDhdStub);
}

TEST_F(Library, ThatIsNoneIsToldWithTheLinkersWords) {
    const Folder folder;
    const std::string file = folder / "libacme.so";
    std::ofstream(file) << "no library";
    ::setenv("FORCESHADE_TEST_LIBRARY", file.c_str(), 1);
    expect_words(refusal(), {file, "Ask Acme"});
    ::unsetenv("FORCESHADE_TEST_LIBRARY");
    SoughtLibrary broken = kSought;
    broken.names = {"libacme.so.9", file};
    expect_words(message_of<DeviceAbsent>([&] { SharedLibrary library(broken); }), {"libacme.so.9", file + ":"});
}

TEST_F(Library, WithoutAFunctionIsToldWithItsName) {
    ::setenv("FORCESHADE_TEST_LIBRARY", kDhdStub.c_str(), 1);
    const SharedLibrary library(kSought);
    int (*call)() = library.optional("acmeOpen");
    EXPECT_EQ(call, nullptr);
    expect_words(message_of<DeviceAbsent>([&] { library.needed("acmeOpen"); }), {kDhdStub, "acmeOpen", "Acme toolkit"});
    call = library.needed("dhdGetDeviceCount");
    ASSERT_NE(call, nullptr);
    EXPECT_EQ(call(), 1);
}

TEST_F(Library, OfAVendorIsRefusedWithoutWhatMovesTheDevice) {
    ::setenv("FORCESHADE_DHD_LIBRARY", kDhdStubWithoutForce.c_str(), 1);
    ::setenv("FORCESHADE_HD_LIBRARY", kHdStubWithoutForce.c_str(), 1);
    expect_words(message_of<DeviceAbsent>([] { open_dhd(""); }), {kDhdStubWithoutForce, "dhdSetForce"});
    expect_words(message_of<DeviceAbsent>([] { open_hd(""); }), {kHdStubWithoutForce, "hdSetDoublev"});
}

TEST_F(Library, OfAVendorThatIsNotInstalledMeansNoDevice) {
    ::unsetenv("FORCESHADE_DHD_LIBRARY");
    ::unsetenv("FORCESHADE_HD_LIBRARY");
    expect_words(message_of<DeviceAbsent>([] { open_dhd(""); }),
                 {"libdhd.so", "FORCESHADE_DHD_LIBRARY", "LD_LIBRARY_PATH", "forcedimension.com"});
    expect_words(message_of<DeviceAbsent>([] { open_hd(""); }),
                 {"libHD.so", "FORCESHADE_HD_LIBRARY", "LD_LIBRARY_PATH", "OpenHaptics"});
}

DeviceKind kind(const std::string& option) {
    for (const DeviceKind& one : list_devices({}, 0.2))
        if (one.option == option)
            return one;
    ADD_FAILURE() << "no " << option;
    return {};
}

using Names = std::vector<std::string>;

TEST(Devices, ThatNeedNothingAreAlwaysThere) {
    EXPECT_EQ(kind("sim").devices, Names{"sim"});
    EXPECT_EQ(kind("replay:FILE").devices, Names{"replay:FILE"});
    EXPECT_EQ(kind("sim").problem, "");
}

TEST(Devices, OfForceDimensionAreCounted) {
    const StubLibrary stub("FORCESHADE_DHD_LIBRARY", kDhdStub);
    stub.devices(2);
    const DeviceKind two = kind("dhd[:INDEX]");
    EXPECT_EQ(two.devices, (Names{"dhd:0", "dhd:1"}));
    EXPECT_EQ(two.software, "DHD SDK 3.17.6.1");
    EXPECT_EQ(two.place, kDhdStub);
    EXPECT_EQ(two.problem, "");
    EXPECT_EQ(stub.calls("dhdOpen") + stub.calls("dhdOpenID"), 0) << "another program may have it open";
    stub.devices(0);
    EXPECT_EQ(kind("dhd[:INDEX]").devices, Names{});
    EXPECT_TRUE(says(kind("dhd[:INDEX]").problem, "udev"));
    stub.fail("dhdGetDeviceCount");
    EXPECT_TRUE(says(kind("dhd[:INDEX]").problem, "no driver found"));
}

TEST(Devices, Of3dSystemsAreToldByName) {
    const StubLibrary stub("FORCESHADE_HD_LIBRARY", kHdStub);
    const DeviceKind one = kind("hd[:NAME]");
    EXPECT_EQ(one.devices, Names{"hd"});
    EXPECT_EQ(one.name, "Touch (serial number 8042)");
    EXPECT_EQ(one.place, kHdStub);
    EXPECT_EQ(one.problem, "");
    EXPECT_EQ(stub.calls("hdEnable"), 0) << "nothing moves";
    EXPECT_EQ(stub.calls("hdDisableDevice"), 1);
    stub.devices(0);
    EXPECT_EQ(kind("hd[:NAME]").devices, Names{});
    EXPECT_EQ(kind("hd[:NAME]").name, "");
    EXPECT_TRUE(says(kind("hd[:NAME]").problem, "Communication configuration error", "0x0303"));
}

TEST(Devices, WhoseLibraryIsAbsentAreToldWithHowToInstallIt) {
    ::setenv("FORCESHADE_DHD_LIBRARY", "/nonexistent/libdhd.so", 1);
    ::setenv("FORCESHADE_HD_LIBRARY", kHdStubWithoutForce.c_str(), 1);
    EXPECT_TRUE(says(kind("dhd[:INDEX]").problem, "forcedimension.com"));
    EXPECT_EQ(kind("dhd[:INDEX]").software, "");
    EXPECT_TRUE(says(kind("hd[:NAME]").problem, "hdSetDoublev"));
}

TEST(Devices, OfHaplyAreAskedOfTheirService) {
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
    EXPECT_TRUE(says(found.problem, "Haply Hub"));
    service.set(test::Fault::no_inventory);
    EXPECT_TRUE(says(list_devices(service.url(), 0.2)[2].problem, "Inverse Service 3.x"));
    service.go_away();
    EXPECT_TRUE(says(list_devices(service.url())[2].problem, "haply.co"));
    EXPECT_TRUE(service.received().empty()) << "no command is sent";
}

} // namespace
} // namespace forceshade::device::testing
