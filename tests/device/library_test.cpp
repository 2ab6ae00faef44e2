// A library that is not there, is none, or lacks what is needed: said with what was tried and how to install it.
#include <fstream>

#include "device/backends/devices.h"
#include "device/backends/shared_library.h"
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

void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(text.find(word), std::string::npos) << "no " << word << " in: " << text;
}

TEST_F(Library, that_is_nowhere_is_told_with_what_was_tried) {
    expect_words(refusal(), {"Acme toolkit", "libacme.so.9, libacme.so", "LD_LIBRARY_PATH", "FORCESHADE_TEST_LIBRARY",
                             "Ask Acme"});
    ::setenv("FORCESHADE_TEST_LIBRARY", "", 1);
    expect_words(refusal(), {"libacme.so.9, libacme.so", "is not set"});
}

TEST_F(Library, that_the_environment_names_is_taken_and_no_other) {
    ::setenv("FORCESHADE_TEST_LIBRARY", "/nonexistent/libacme.so", 1);
    expect_words(refusal(), {"FORCESHADE_TEST_LIBRARY", "/nonexistent/libacme.so", "No such file", "Ask Acme"});
    SoughtLibrary there = kSought;
    there.names = {DHD_STUB};
    EXPECT_THROW(SharedLibrary library(there), DeviceAbsent);
    ::unsetenv("FORCESHADE_TEST_LIBRARY");
    EXPECT_EQ(SharedLibrary(there).file(), DHD_STUB);
}

TEST_F(Library, that_is_none_is_told_with_the_linkers_words) {
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

TEST_F(Library, without_a_function_is_told_with_its_name) {
    ::setenv("FORCESHADE_TEST_LIBRARY", DHD_STUB, 1);
    const SharedLibrary library(kSought);
    int (*call)() = library.optional("acmeOpen");
    EXPECT_EQ(call, nullptr);
    expect_words(message_of<DeviceAbsent>([&] { library.needed("acmeOpen"); }), {DHD_STUB, "acmeOpen", "Acme toolkit"});
    call = library.needed("dhdGetDeviceCount");
    ASSERT_NE(call, nullptr);
    EXPECT_EQ(call(), 1);
}

TEST_F(Library, of_a_vendor_is_refused_without_what_moves_the_device) {
    ::setenv("FORCESHADE_DHD_LIBRARY", DHD_STUB_WITHOUT_FORCE, 1);
    ::setenv("FORCESHADE_HD_LIBRARY", HD_STUB_WITHOUT_FORCE, 1);
    expect_words(message_of<DeviceAbsent>([] { open_dhd(""); }), {DHD_STUB_WITHOUT_FORCE, "dhdSetForce"});
    expect_words(message_of<DeviceAbsent>([] { open_hd(""); }), {HD_STUB_WITHOUT_FORCE, "hdSetDoublev"});
}

TEST_F(Library, of_a_vendor_that_is_not_installed_means_no_device) {
    ::unsetenv("FORCESHADE_DHD_LIBRARY");
    ::unsetenv("FORCESHADE_HD_LIBRARY");
    try {
        open_dhd("");
        FAIL() << "a Force Dimension SDK is installed here";
    } catch (const DeviceAbsent& absent) {
        EXPECT_EQ(absent.code(), ExitCode::no_device);
        expect_words(absent.what(), {"libdhd.so", "FORCESHADE_DHD_LIBRARY", "LD_LIBRARY_PATH", "forcedimension.com"});
    }
    expect_words(message_of<DeviceAbsent>([] { open_hd(""); }),
                 {"libHD.so", "FORCESHADE_HD_LIBRARY", "LD_LIBRARY_PATH", "OpenHaptics"});
}

} // namespace
} // namespace forceshade::device::testing
