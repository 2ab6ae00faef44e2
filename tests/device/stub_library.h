// A stub of a vendor's library in the test's own process: named by the environment, steered, read, waited for.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <dlfcn.h>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "device/backends/back_end.h"
#include "tests/io/folder.h"
#include "tests/places.h"

namespace forceshade::device::testing {

using forceshade::testing::Folder;
using forceshade::testing::message_of;
using forceshade::testing::says;

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
    EXPECT_TRUE(says(text, words));
}

/// Asks every millisecond; false if 20 s, which is generous, were not enough.
inline bool wait_until(const std::function<bool()>& enough) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!enough()) {
        if (std::chrono::steady_clock::now() > end)
            return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

inline const std::string kDhdStub = module_of("device", "dhd_stub"), kDhdStubOld = module_of("device", "dhd_stub_old"),
                         kDhdStubWithoutForce = module_of("device", "dhd_stub_without_force"),
                         kHdStub = module_of("device", "HD_stub"),
                         kHdStubWithoutForce = module_of("device", "HD_stub_without_force");

/// From construction on the environment names this library.
class StubLibrary {
public:
    StubLibrary(const char* variable, const std::string& file)
        : handle_(::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL)) {
        if (!handle_)
            throw std::runtime_error(::dlerror());
        ::setenv(variable, file.c_str(), 1);
        call<void()>("stub_reset")();
    }

    template <typename Function> Function* call(const char* name) const {
        auto* function = reinterpret_cast<Function*>(::dlsym(handle_, name));
        if (!function)
            throw std::runtime_error(name);
        return function;
    }

    void fail(const char* name, long from = 1, long count = std::numeric_limits<int>::max()) const {
        call<void(const char*, long, long)>("stub_fail")(name, from, count);
    }
    long calls(const char* name) const { return call<long(const char*)>("stub_calls")(name); }
    void place(double x, double y, double z) const { call<void(double, double, double)>("stub_position")(x, y, z); }
    glm::dvec3 force() const {
        double force[3]{};
        call<void(double*)>("stub_force")(force);
        return {force[0], force[1], force[2]};
    }
    long forces() const { return call<long()>("stub_forces")(); }
    void hand(long kind) const { call<void(long)>("stub_hand")(kind); }
    void press(long mask) const { call<void(long)>("stub_buttons")(mask); }
    void devices(long count) const { call<void(long)>("stub_devices")(count); }
    void most_force(double force) const { call<void(double)>("stub_most_force")(force); }
    std::string order() const { return call<const char*()>("stub_order")(); }
    void record(const std::string& file) const { call<void(const char*)>("stub_record")(file.c_str()); }

private:
    void* handle_;
};

struct Recorded {
    double time = 0; /* s, of the steady clock */
    glm::dvec3 force{0};

    bool is_push() const { return force != glm::dvec3(0); }
};

/// The forces in a record that a stub wrote, in order.
inline std::vector<Recorded> recorded(const std::string& file) {
    std::vector<Recorded> all;
    std::ifstream in(file);
    for (Recorded one; in >> one.time >> one.force.x >> one.force.y >> one.force.z;)
        all.push_back(one);
    return all;
}

/// What a program does that has a device open: no force before it dies.
inline BackEnd* to_be_halted = nullptr;
inline void halt_and_die(int signal) {
    to_be_halted->halt();
    std::signal(signal, SIG_DFL);
}

/// A child opens a device, pushes with it and aborts: no force is left.
inline void expect_no_force_after_abort(const StubLibrary& stub, const std::function<std::unique_ptr<BackEnd>()>& open,
                                        const std::function<void(BackEnd&)>& push) {
    const Folder folder;
    const std::string record = folder / "forces";
    const pid_t child = ::fork();
    if (child == 0) {
        stub.record(record);
        const auto device = open();
        to_be_halted = device.get();
        std::signal(SIGABRT, halt_and_die);
        push(*device);
        std::abort();
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
    const std::vector<Recorded> forces = recorded(record);
    ASSERT_TRUE(std::ranges::any_of(forces, &Recorded::is_push));
    EXPECT_FALSE(forces.back().is_push());
}

} // namespace forceshade::device::testing
