// Which device is taken and why another is not; and the software device itself.
#include <gtest/gtest.h>

#include "tests/gpu/software_device.h"
#include "tests/io/folder.h"

namespace forceshade::compute {
namespace {

DeviceReport device(std::uint32_t index, const std::string& name, const std::string& uuid, bool software) {
    DeviceReport report;
    report.index = index;
    report.name = name;
    report.uuid = uuid;
    report.type = software ? "software" : "discrete";
    report.software = software;
    report.f64 = true;
    return report;
}

// A card that lacks double precision, the software device, a card that cannot be used, and one whose UUID has digits
// only.
std::vector<DeviceReport> four_devices() {
    std::vector<DeviceReport> devices{
        device(0, "GeForce RTX 4090", "00112233445566778899aabbccddeeff", false),
        device(1, "llvmpipe (LLVM 15.0.6, 256 bits)", "6d65736132322e332e36000000000000", true),
        device(2, "Old Card 1.0", "fedcba98765432100123456789abcdef", false),
        device(3, "RADV NAVI31", "00000000030000000000000000000000", false)};
    devices[0].f64 = false;
    devices[2].refusals = {"its driver speaks Vulkan 1.0.65, needed is 1.1.0", "it has no compute queue"};
    return devices;
}

/// Refused, with an error that says all of `words`.
template <typename... Words>
void expect_refused(const std::vector<DeviceReport>& devices, const std::string& wanted, const Words&... words) {
    EXPECT_TRUE(testing::says(
        test::device_error(DeviceError::Kind::no_such_device, [&] { choose_device(devices, wanted, false); }),
        words...));
}

TEST(ChooseDevice, ByIndexUuidOrName) {
    const auto devices = four_devices();
    const auto index = [&](const std::string& wanted) { return choose_device(devices, wanted, false).index; };
    EXPECT_EQ(index("0"), 0u);
    EXPECT_EQ(index("3"), 3u);
    EXPECT_EQ(index("00112233445566778899aabbccddeeff"), 0u);
    EXPECT_EQ(index("00112233-4455-6677-8899-aabbccddeeff"), 0u);
    EXPECT_EQ(index("00112233-4455-6677-8899-AABBCCDDEEFF"), 0u);
    EXPECT_EQ(index("00000000030000000000000000000000"), 3u); // no index, though all digits
    EXPECT_EQ(index("geforce"), 0u);
    EXPECT_EQ(index("RTX 4090"), 0u);
    EXPECT_EQ(index("LLVM"), 1u);
    EXPECT_EQ(index("navi31"), 3u);
}

TEST(ChooseDevice, WithoutAWishItIsHardwareWhereThereIsSome) {
    auto devices = four_devices();
    EXPECT_EQ(choose_device(devices, "", false).index, 0u);
    EXPECT_EQ(choose_device(devices, "", true).index, 3u); // 0 has no double precision
    devices[0].type = "integrated";
    EXPECT_EQ(choose_device(devices, "", false).index, 3u);
    devices[3].type = "virtual";
    EXPECT_EQ(choose_device(devices, "", false).index, 0u);
    devices[0].refusals = devices[3].refusals = {"broken"};
    EXPECT_EQ(choose_device(devices, "", false).index, 1u);
}

// A wish that fits several takes the first that can be used.
TEST(ChooseDevice, PassesOverTheRefused) {
    auto devices = four_devices();
    devices[0].name = "NAVI10";
    EXPECT_EQ(choose_device(devices, "navi", false).index, 0u);
    EXPECT_EQ(choose_device(devices, "navi", true).index, 3u);
}

TEST(ChooseDevice, SaysWhatThereIsAndWhyNot) {
    const auto devices = four_devices();
    expect_refused(devices, "titan", "no such device \"titan\"", "GeForce RTX 4090", "llvmpipe", "usable",
                   "needed is 1.1.0; it has no compute queue", "discrete", "software");
    expect_refused(devices, "2", "cannot use the device \"2\"", "it has no compute queue");
    expect_refused(devices, "7", "no such device \"7\"");
    expect_refused(devices, "fedcba98765432100123456789abcde0", "no such device");
    EXPECT_TRUE(testing::says(
        test::device_error(DeviceError::Kind::no_such_device, [&] { choose_device(devices, "GeForce", true); }),
        "cannot use the device \"GeForce\"", "no double precision"));
}

TEST(ChooseDevice, WithoutAnyDevice) {
    expect_refused({}, "", "no usable Vulkan device", "--engine cpu", "mesa-vulkan-drivers");
    expect_refused({}, "0", "no such device \"0\"", "no Vulkan device at all");
    auto devices = four_devices();
    for (DeviceReport& one : devices)
        one.refusals = {"broken"};
    expect_refused(devices, "", "no usable Vulkan device", "broken");
}

TEST(SoftwareDevice, IsThereAndDescribed) {
    if (std::string(test::tested_gpu()) != "llvmpipe")
        GTEST_SKIP() << "another device is tried";
    const auto devices = list_devices();
    const DeviceReport& found = choose_device(devices, "llvmpipe", true);
    EXPECT_TRUE(found.software);
    EXPECT_EQ(found.type, "software");
    EXPECT_TRUE(found.refusals.empty());
    EXPECT_EQ(found.uuid.size(), 32u);
    EXPECT_TRUE(found.f64);
    EXPECT_GE(found.buffer_range, std::uint64_t(1) << 27);
    EXPECT_GT(found.memory, found.buffer_range);
    EXPECT_GE(found.subgroup, 1u);
    EXPECT_FALSE(found.driver.empty());
    EXPECT_EQ(found.api.substr(0, 2), "1.");
    for (std::size_t i = 0; i < devices.size(); ++i)
        EXPECT_EQ(devices[i].index, i);
}

} // namespace
} // namespace forceshade::compute
