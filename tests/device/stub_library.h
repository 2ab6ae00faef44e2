// A stub of a vendor's library in the test's own process: named by the environment, steered, looked into.
#pragma once

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <dlfcn.h>
#include <glm/vec3.hpp>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "device/backends/back_end.h"
#include "tests/io/folder.h"

namespace forceshade::device::testing {

using forceshade::testing::Folder;
using forceshade::testing::message_of;
using forceshade::testing::says;

inline void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_TRUE(says(text, word));
}

/// From construction on the environment names this library.
class StubLibrary {
public:
    StubLibrary(const char* variable, const char* file) : handle_(::dlopen(file, RTLD_NOW | RTLD_LOCAL)) {
        if (!handle_)
            throw std::runtime_error(::dlerror());
        ::setenv(variable, file, 1);
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

/// The last force in a record that a stub wrote; not a number if there is none.
inline glm::dvec3 last_recorded(const std::string& file) {
    glm::dvec3 force{std::nan("")};
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        double time = 0;
        std::istringstream(line) >> time >> force.x >> force.y >> force.z;
    }
    return force;
}

/// True if a record has a force that is not zero.
inline bool recorded_any(const std::string& file) {
    std::ifstream in(file);
    double time = 0;
    for (glm::dvec3 force; in >> time >> force.x >> force.y >> force.z;)
        if (force != glm::dvec3(0))
            return true;
    return false;
}

/// Runs `work` in a child; the signal that ended it, 0 if it came to its end.
template <typename Work> int signal_of_child(Work&& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        work();
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
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
    const int signal = signal_of_child([&] {
        stub.record(record);
        const auto device = open();
        to_be_halted = device.get();
        std::signal(SIGABRT, halt_and_die);
        push(*device);
        std::abort();
    });
    EXPECT_EQ(signal, SIGABRT);
    EXPECT_TRUE(recorded_any(record));
    EXPECT_EQ(last_recorded(record), glm::dvec3(0));
}

} // namespace forceshade::device::testing
